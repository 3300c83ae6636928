"""The table that a PLC programmer works from, as Markdown and as CSV."""

import csv
import io

from map_model import notation, words

COLUMNS = ("address", "holding", "input", "words", "name", "type", "unit", "scale", "access",
           "text")


def rows(register_map):
    """One dictionary a register, picks written out, in the order of addresses."""
    found = []
    for block_name, block in register_map["block"].items():
        for register in block["registers"]:
            found.append({**register, "block": block_name})
    picks = register_map["picks"]
    for number in range(picks["count"]):
        for register in picks["registers"]:
            found.append({**register, "block": "answer", "access": "r",
                          "address": picks["start"] + number * picks["size"] + register["offset"],
                          "name": f"pick_{number + 1}_{register['name']}"})
    for row in found:
        row.update(holding=notation(row["address"], 4), input=notation(row["address"], 3),
                   words=words(row), scale=f"{row['scale']:g}")
    return sorted(found, key=lambda row: row["address"])


def csv_text(register_map):
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row in rows(register_map):
        writer.writerow([row[column] for column in COLUMNS])
    return out.getvalue()


def table(header, lines):
    body = ["| " + " | ".join(str(cell).replace("|", "\\|") for cell in line) + " |"
            for line in lines]
    return ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)] + body + [""]


def block_section(register_map, name, block):
    end = block["start"] + block["count"] - 1
    functions = ", ".join(str(function) for function in block["functions"])
    lines = [f"## Block {name}: addresses {block['start']} to {end}", "", block["text"].strip(), "",
             f"Functions: {functions}.", ""]
    columns = ("address", "holding", "input", "name", "type", "unit", "scale", "access", "text")
    shown = [row for row in rows(register_map) if row["block"] == name
             and not (row["name"].startswith("pick_") and not row["name"].startswith("pick_1_"))]
    lines += table(columns, [[row[column] for column in columns] for row in shown])
    return lines


def pick_section(picks):
    first, last = picks["start"], picks["start"] + picks["size"] * (picks["count"] - 1)
    starts = [picks["start"] + number * picks["size"] for number in range(picks["count"])]
    return [f"Picks 2 to {picks['count']} are built like pick 1. First registers of the picks "
            f"({first} to {last} in steps of {picks['size']}): "
            + ", ".join(f"{start} ({notation(start, 4)})" for start in starts) + ".", ""]


ROTATIONS = [
    "## Rotations", "",
    "Angles are int32 in 0.0001 deg (or 0.000001 rad, if so configured). With a quaternion the six "
    "registers of the rotation are four int16 of 1/32767 each, in the order of the convention, and "
    "two zeros; resolution 0.004 deg. The pose in the command block is read in the same convention "
    "and the same units. `R` maps the part's axes to those of the frame in which picks are "
    "published.", ""]


def list_sections(register_map):
    lines = ["## Lists", ""]
    for kind, place in (("list", "value"), ("bits", "bit")):
        for entries in register_map[kind].values():
            lines += [entries["text"], ""]
            lines += table((place, "name", "text"),
                           [[e[place], e["name"], e["text"]] for e in entries["values"]])
    return lines


def markdown(register_map):
    lines = [f"# Registers of the {register_map['title']}", "",
             f"Map version {register_map['version']}, checksum {register_map['checksum']} "
             f"(hexadecimal {register_map['checksum']:04X}). Made from `register-map.toml`; "
             "the same table is in `register-map.csv`.", "",
             "`address` is what goes over the wire, counted from 0; `holding` and `input` are the "
             "same register counted from 1 with the 4 or 3 in front. A driver that wants "
             "\"40101\" and a driver that wants \"100\" mean the same register. Wrong by one? "
             "`test_uint32` at 102 (40103) tells: off by one it reads anything but 305419896.", ""]
    for name, block in register_map["block"].items():
        lines += block_section(register_map, name, block)
        if name == "answer":
            lines += pick_section(register_map["picks"])
    return "\n".join(lines + ROTATIONS + list_sections(register_map)).rstrip("\n") + "\n"

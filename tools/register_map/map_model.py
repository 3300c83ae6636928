"""The register map as read from its TOML file, and every rule that it has to keep."""

import binascii
import json
import re
import tomllib

WORDS = {"uint16": 1, "int16": 1, "uint32": 2, "int32": 2, "float32": 2}
READ_MAX = 125  # registers in one read: a limit of the protocol
NAME = re.compile(r"[a-z][a-z0-9_]*\Z")
# What a reader can trip over when it changes; wording is not among it.
BINDING = ("address", "offset", "name", "type", "unit", "scale", "access", "list", "bits",
           "constant", "value", "bit", "start", "count", "size", "functions")


class MapError(Exception):
    """One sentence: what breaks which rule."""


def words(register):
    return WORDS[register["type"]]


def require(condition, message):
    if not condition:
        raise MapError(message)


def check_fields(where, register, place):
    for field in (place, "name", "type", "unit", "scale", "text"):
        require(field in register, f"{where}: a register has no {field}")
    name = register["name"]
    known = (place, "name", "type", "unit", "scale", "access", "text", "list", "bits", "constant",
             "varies")
    for field in register:
        require(field in known, f"{where}.{name}: unknown field {field}")
    require(NAME.match(name), f"{where}.{name}: a name is of a-z, 0-9 and _")
    require(register["type"] in WORDS, f"{where}.{name}: unknown type {register['type']}")
    require(register["text"].strip(), f"{where}.{name}: no text")


def check_places(where, registers, place, start, count, holes):
    """Each place of start..start+count is taken once, or lies in a hole."""
    owner = {}
    for register in registers:
        for at in range(register[place], register[place] + words(register)):
            require(start <= at < start + count, f"{where}.{register['name']}: outside the block")
            require(at not in owner,
                    f"{where}: {register['name']} and {owner.get(at)} share {place} {at}")
            owner[at] = register["name"]
    for at in range(start, start + count):
        require((at in owner) != (at in holes), f"{where}: {place} {at} is empty or taken twice")


def check_numbers(kind, name, entries, place, limit):
    require(entries.get("text"), f"{kind}.{name}: no text")
    seen, names = set(), set()
    for entry in entries["values"]:
        require(0 <= entry[place] < limit, f"{kind}.{name}: {place} {entry[place]} is no word")
        require(entry[place] not in seen, f"{kind}.{name}: {place} {entry[place]} is there twice")
        require(NAME.match(entry["name"]) and entry["name"] not in names,
                f"{kind}.{name}: the name {entry['name']}")
        require(entry.get("text"), f"{kind}.{name}.{entry['name']}: no text")
        seen.add(entry[place])
        names.add(entry["name"])


def check(data):
    """Raises MapError when a rule is broken."""
    picks = data["picks"]
    pick_places = set(range(picks["start"], picks["start"] + picks["count"] * picks["size"]))
    names = set()
    taken = {}
    for block_name, block in data["block"].items():
        registers = block["registers"]
        for register in registers:
            check_fields(block_name, register, "address")
            require(register.get("access") in ("r", "rw"),
                    f"{block_name}.{register['name']}: access is r or rw")
            require((register["access"] == "rw") == (16 in block["functions"]),
                    f"{block_name}.{register['name']}: access and functions contradict")
            require(register["name"] not in names, f"the name {register['name']} is there twice")
            names.add(register["name"])
            for kind in ("list", "bits"):
                require(kind not in register or register[kind] in data[kind],
                        f"{block_name}.{register['name']}: no {kind} {register.get(kind)}")
        require(block["count"] <= READ_MAX, f"{block_name}: more than one read of {READ_MAX}")
        check_places(block_name, registers, "address", block["start"], block["count"],
                     pick_places if block_name == "answer" else set())
        for at in range(block["start"], block["start"] + block["count"]):
            require(at not in taken, f"{block_name} and {taken.get(at)} share address {at}")
            taken[at] = block_name
    for register in picks["registers"]:
        check_fields("picks", register, "offset")
    check_places("picks", picks["registers"], "offset", 0, picks["size"], set())
    command, answer = data["block"]["command"], data["block"]["answer"]
    last = max(command["registers"], key=lambda register: register["address"])
    require(last["name"] == "command_sequence", "command_sequence is not last in its block")
    last = max(answer["registers"], key=lambda register: register["address"])
    require(last["name"] == "result_sequence_tail", "result_sequence_tail is not last")
    for name, entries in data["list"].items():
        check_numbers("list", name, entries, "value", 65536)
    for name, entries in data["bits"].items():
        check_numbers("bits", name, entries, "bit", 16)


def binding(value):
    """The map without its wording."""
    if isinstance(value, dict):
        return {key: binding(inner) for key, inner in value.items()
                if key in BINDING or isinstance(inner, (dict, list))}
    if isinstance(value, list):
        return [binding(v) for v in value]
    return value


def checksum(data):
    """CRC-16 (polynomial 0x1021, start 0) over the map as JSON with sorted keys, wording left out.
    New values of a list, which are appended, change it too: it tells maps apart, not compatible
    ones from others. That is what the version is for."""
    text = json.dumps(binding(data), sort_keys=True, separators=(",", ":"))
    return binascii.crc_hqx(f"{data['version']}{text}".encode(), 0)


def load(path):
    """The checked map as a dictionary, with its checksum under that key."""
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as error:
        raise MapError(f"no TOML: {error}") from error
    try:
        check(data)
    except (KeyError, TypeError) as error:
        raise MapError(f"a field is missing or of the wrong kind: {error}") from error
    return {**data, "checksum": checksum(data)}


def notation(address, digit):
    """Counted from 1 with the table's digit in front: 40101 for holding register 100."""
    return f"{digit}{address + 1:04d}"

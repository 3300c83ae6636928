"""The map as constants for IEC 61131-3 Structured Text."""


def line(name, value, text):
    comment = text.replace("(*", "").replace("*)", "")
    return f"    {name.upper()} : UINT := {value}; (* {comment} *)"


def offsets(name, block):
    lines = [line(f"BP_{name}_START", block["start"], "protocol address"),
             line(f"BP_{name}_COUNT", block["count"], "registers")]
    for register in block["registers"]:
        lines.append(line(f"BP_{name}_{register['name']}", register["address"] - block["start"],
                          f"index in the block, {register['type']} {register['unit']}".strip()))
    return lines


def text(register_map):
    lines = ["(* Made by tools/register_map from register-map.toml: do not change it here.",
             "   Indices count from 0 within the block as read or written in one piece. *)",
             "VAR_GLOBAL CONSTANT",
             line("BP_MAP_VERSION", register_map["version"], "register map_version"),
             line("BP_MAP_CHECKSUM", register_map["checksum"], "register map_checksum")]
    for name, block in register_map["block"].items():
        lines += offsets(name, block)
    picks = register_map["picks"]
    answer_start = register_map["block"]["answer"]["start"]
    lines += [line("BP_PICKS", picks["start"] - answer_start, "index of the first pick"),
              line("BP_PICKS_PER_PAGE", picks["count"], ""),
              line("BP_PICK_SIZE", picks["size"], "registers of a pick")]
    for register in picks["registers"]:
        lines.append(line(f"BP_PICK_{register['name']}", register["offset"],
                          f"index in the pick, {register['type']}"))
    for name, entries in register_map["list"].items():
        for entry in entries["values"]:
            lines.append(line(f"BP_{name}_{entry['name']}", entry["value"], entry["text"]))
    for name, entries in register_map["bits"].items():
        for entry in entries["values"]:
            lines.append(line(f"BP_{name}_{entry['name']}", 1 << entry["bit"], entry["text"]))
    return "\n".join(lines + ["END_VAR"]) + "\n"

"""The map as C++ constants: numbers and enumerations, no code."""

from map_model import WORDS


def camel(name):
    return "".join(part[:1].upper() + part[1:] for part in name.split("_"))


def constant(name, value, text=""):
    line = f"inline constexpr int k{camel(name)} = {value};"
    return f"{line}  // {text}" if text else line


def literal(value):
    return f"{value:.1f}F" if isinstance(value, float) else str(value)


def cpp_type(register):
    return "float" if register["type"] == "float32" else f"std::{register['type']}_t"


def block_lines(name, block):
    lines = [f"// Block {name}: protocol addresses.",
             constant(f"{name}_start", block["start"]), constant(f"{name}_count", block["count"])]
    for register in block["registers"]:
        kind = f"{register['type']} {register['unit']}".strip()
        lines.append(constant(f"address_{register['name']}", register["address"], kind))
        if "constant" in register:
            lines.append(f"inline constexpr {cpp_type(register)} k{camel(register['name'])} = "
                         f"{literal(register['constant'])};")
    return lines + [""]


def pick_lines(picks):
    lines = ["// Picks: offsets within the registers of one pick.",
             constant("picks_start", picks["start"]), constant("picks_per_page", picks["count"]),
             constant("pick_size", picks["size"])]
    for register in picks["registers"]:
        kind = f"{register['type']} {register['unit']}".strip()
        lines.append(constant(f"pick_{register['name']}", register["offset"], kind))
    return lines + [""]


def enum_lines(name, values, place):
    lines = [f"enum class {camel(name)} : std::uint16_t {{"]
    for entry in values:
        number = entry["value"] if place == "value" else f"1U << {entry['bit']}U"
        lines.append(f"  k{camel(entry['name'])} = {number},  // {entry['text']}")
    return lines + ["};"]


def name_lines(name, values):
    """A table of the names, for people: what the commissioning tool prints."""
    kind = camel(name)
    return [f"inline constexpr NamedValue k{kind}Names[] = {{"] + [
        f'    {{static_cast<std::uint16_t>({kind}::k{camel(entry["name"])}), "{entry["name"]}"}},'
        for entry in values] + ["};", ""]


def answer_lines(register_map):
    """All registers of the answer with their names, for comparing answers."""
    found = []
    for register in register_map["block"]["answer"]["registers"]:
        found.append((register["address"], register["name"], register))
    picks = register_map["picks"]
    for number in range(picks["count"]):
        for register in picks["registers"]:
            found.append((picks["start"] + number * picks["size"] + register["offset"],
                          f"pick_{number + 1}_{register['name']}", register))
    lines = ["// The answer's registers. varies: says when or in which order something happened:",
             "// so it differs from one run to the next.",
             "inline constexpr NamedRegister kAnswerRegisters[] = {"]
    for address, name, register in sorted(found, key=lambda entry: entry[0]):
        varies = "true" if register.get("varies") else "false"
        lines.append(f'    {{{address}, {WORDS[register["type"]]}, "{name}", {varies}}},')
    return lines + ["};", ""]


def text(register_map):
    lines = [
        "// Made by tools/register_map from firmware-config/modbus/register-map.toml: change that.",
        "#pragma once", "", "#include <cstdint>", "", "namespace binpick::modbus::map {", "",
        "struct NamedValue {", "  std::uint16_t value;", "  const char* name;", "};",
        "struct NamedRegister {", "  int address, words;", "  const char* name;",
        "  bool varies;", "};", "",
        constant("version", register_map["version"]),
        constant("checksum", register_map["checksum"]), ""]
    for name, block in register_map["block"].items():
        lines += block_lines(name, block)
    lines += pick_lines(register_map["picks"])
    for name, entries in register_map["list"].items():
        lines += enum_lines(name, entries["values"], "value") + name_lines(name, entries["values"])
    for name, entries in register_map["bits"].items():
        kind = f"{name}_bit"
        lines += enum_lines(kind, entries["values"], "bit") + name_lines(kind, entries["values"])
    lines += answer_lines(register_map)
    end = max(b["start"] + b["count"] for b in register_map["block"].values())
    lines += ["// All registers, gaps included.", constant("end", end), "",
              "}  // namespace binpick::modbus::map"]
    return "\n".join(lines) + "\n"

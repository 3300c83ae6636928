"""The map as C++ constants: numbers and enumerations, no code."""


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


def text(register_map):
    lines = [
        "// Made by tools/register_map from firmware-config/modbus/register-map.toml: change that.",
        "#pragma once", "", "#include <cstdint>", "", "namespace binpick::modbus::map {", "",
        "struct NamedValue {", "  std::uint16_t value;", "  const char* name;", "};", "",
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
    end = max(b["start"] + b["count"] for b in register_map["block"].values())
    lines += ["// All registers, gaps included.", constant("end", end), "",
              "}  // namespace binpick::modbus::map"]
    return "\n".join(lines) + "\n"

#!/usr/bin/env python3
"""Makes everything that repeats the register map from firmware-config/modbus/register-map.toml.

    register_map.py MAP --header FILE     C++ constants, written only when they change
    register_map.py MAP --write           the table (.md, .csv) and the PLC's constants (.st)
    register_map.py MAP --check           1 when one of those differs from what --write would write
"""

import argparse
import sys
from pathlib import Path

import cpp_header
import customer_table
import plc_constants
from map_model import MapError, load


def made_from(register_map, path):
    """{path: text} of the files that are kept beside the map and in ../plc."""
    folder = path.parent
    return {
        folder / "register-map.md": customer_table.markdown(register_map),
        folder / "register-map.csv": customer_table.csv_text(register_map),
        folder.parent / "plc" / "binpick_registers.st": plc_constants.text(register_map),
    }


def write_if_changed(path, text):
    """Leaves the time of a file alone that is right: nothing is built again for nothing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("map", type=Path)
    parser.add_argument("--header", type=Path)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    try:
        register_map = load(arguments.map)
    except (MapError, OSError) as error:
        print(f"{arguments.map}: {error}", file=sys.stderr)
        return 1
    if arguments.header:
        write_if_changed(arguments.header, cpp_header.text(register_map))
    stale = []
    for path, text in made_from(register_map, arguments.map).items():
        if arguments.write:
            write_if_changed(path, text)
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            stale.append(path)
    if arguments.check:
        for path in stale:
            print(f"{path}: not what the map says; run {sys.argv[0]} {arguments.map} --write")
        return 1 if stale else 0
    return 0


if __name__ == "__main__":
    sys.exit(main())

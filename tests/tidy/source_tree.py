"""What both checkers need: the project's source files, its include lines, a command line."""

import argparse
import re
from pathlib import Path

FOLDERS = ("core", "drivers", "app", "tests", "tools")
CPP_SUFFIXES = (".cpp", ".hpp", ".h")
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.MULTILINE)


def files(root, suffixes):
    """Files below the project's folders with one of the suffixes, sorted."""
    found = []
    for folder in FOLDERS:
        for path in sorted((Path(root) / folder).rglob("*")):
            if path.suffix in suffixes and path.is_file():
                found.append(path)
    return found


def text_of(path):
    return path.read_text(encoding="utf-8", errors="replace")


def includes(text):
    """(line number, quoted, target) of each include line."""
    for match in INCLUDE.finditer(text):
        line = text.count("\n", 0, match.start()) + 1
        yield line, match.group(1) == '"', match.group(2)


def run(check, description):
    """Prints what `check` finds below the root that the command line names; the exit status."""
    parser = argparse.ArgumentParser(description=description.splitlines()[0])
    parser.add_argument("root", nargs="?", default=Path(__file__).resolve().parents[2])
    faults = check(parser.parse_args().root)
    for fault in faults:
        print(fault)
    return 1 if faults else 0

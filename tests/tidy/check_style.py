#!/usr/bin/env python3
"""House style that a machine can judge. Prints one line a breach; the exit status is 1 when any.

Files of at most 400 lines, functions of at most 70, lines of at most 100 columns, no tabs;
#pragma once in each header, but for those that are included once per vector unit (-inl.hpp); no
`using namespace` in headers; no drawer file names; no marks of unfinished work; every .cpp is
listed in a CMakeLists.txt and every header is included somewhere; what clang-format says, if it is
installed.
"""

import re
import shutil
import subprocess
import sys
from pathlib import Path

from cpp_functions import functions
from source_tree import CPP_SUFFIXES, files, includes, run, text_of

FILE_LINES_MAX = 400
FUNCTION_LINES_MAX = 70
COLUMNS_MAX = 100
DRAWER_NAMES = {"util", "utils", "common", "helper", "helpers", "misc"}
UNFINISHED = re.compile(r"\b(" + "|".join(("TO" + "DO", "FIX" + "ME", "X" + "XX")) + r")\b")
USING_NAMESPACE = re.compile(r"^\s*using\s+namespace\b", re.MULTILINE)

# Files that may be longer, each with its reason.
LONG_FILES = {}


def check_text(relative, text):
    """What holds for every text file."""
    faults = []
    lines = text.split("\n")
    if text and not text.endswith("\n"):
        faults.append(f"{relative}: does not end with a newline")
    if len(lines) - 1 > FILE_LINES_MAX and relative not in LONG_FILES:
        faults.append(f"{relative}: {len(lines) - 1} lines, at most {FILE_LINES_MAX}")
    for number, line in enumerate(lines, 1):
        if len(line) > COLUMNS_MAX:
            faults.append(f"{relative}:{number}: {len(line)} columns, at most {COLUMNS_MAX}")
        if "\t" in line:
            faults.append(f"{relative}:{number}: a tab")
        if UNFINISHED.search(line):
            faults.append(f"{relative}:{number}: a mark of unfinished work")
    return faults


def check_name(relative):
    words = re.split(r"[_\-.]", relative.rsplit("/", 1)[-1].lower())
    drawers = DRAWER_NAMES.intersection(words)
    return [f"{relative}: a file is named for a noun, not '{word}'" for word in sorted(drawers)]


def check_cpp(relative, text):
    """What holds for C++ only."""
    faults = []
    if relative.endswith((".hpp", ".h")):
        if "#pragma once" not in text and not relative.endswith("-inl.hpp"):
            faults.append(f"{relative}: no #pragma once")
        if USING_NAMESPACE.search(text):
            faults.append(f"{relative}: using namespace in a header")
    for first, last, header in functions(text):
        if last - first + 1 > FUNCTION_LINES_MAX:
            name = header.split("(")[0].split()[-1]
            faults.append(f"{relative}:{first}: {name} has {last - first + 1} lines, "
                          f"at most {FUNCTION_LINES_MAX}")
    return faults


def listed_sources(root):
    """Paths below root that some CMakeLists.txt names."""
    listed = set()
    for lists in root.rglob("CMakeLists.txt"):
        folder = lists.parent.relative_to(root)
        if folder.parts and folder.parts[0].startswith(("build", ".")):
            continue
        for word in re.findall(r"[\w./\-]+\.cpp\b", text_of(lists)):
            listed.add((folder / word).as_posix())
    return listed


def check_dead(root, sources):
    """Sources that nothing builds, headers that nothing includes."""
    listed = listed_sources(root)
    included = set()
    for source in sources:
        for _, _, target in includes(text_of(source)):
            included.add(target.rsplit("/", 1)[-1])
    faults = []
    for source in sources:
        relative = source.relative_to(root).as_posix()
        if source.suffix == ".cpp" and relative not in listed:
            faults.append(f"{relative}: no CMakeLists.txt lists it")
        if source.suffix != ".cpp" and source.name not in included:
            faults.append(f"{relative}: nothing includes it")
    return faults


def check_format(root, sources):
    program = shutil.which("clang-format")
    if program is None or not sources:
        return []
    command = [program, "--style=file", "--dry-run", "-Werror"]
    run = subprocess.run(command + [str(s) for s in sources], cwd=root, stdin=subprocess.DEVNULL,
                         capture_output=True, text=True)
    wrong = re.findall(r"^([^:\n]+):(\d+):\d+: error: code should be", run.stderr, re.MULTILINE)
    first = {}
    for path, line in wrong:
        first.setdefault(path, line)
    if run.returncode != 0 and not first:
        return ["clang-format failed: " + run.stderr.strip()]
    return [f"{Path(path).relative_to(root)}:{line}: clang-format would change it"
            for path, line in sorted(first.items())]


def is_script(path):
    return path.suffix == "" and path.is_file() and text_of(path).startswith("#!")


def check(root, with_format=True):
    """All breaches below root, as printable lines."""
    root = Path(root).resolve()
    sources = files(root, CPP_SUFFIXES)
    others = files(root, (".py", ".sh", ".txt", ".cmake", ".in"))
    others += [path for path in files(root, ("",)) if is_script(path)]
    faults = []
    for path in sources + others:
        relative = path.relative_to(root).as_posix()
        text = text_of(path)
        faults += check_text(relative, text) + check_name(relative)
        if path in sources:
            faults += check_cpp(relative, text)
    faults += check_dead(root, sources)
    if with_format:
        faults += check_format(root, sources)
    return faults


if __name__ == "__main__":
    sys.exit(run(check, __doc__))

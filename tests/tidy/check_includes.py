#!/usr/bin/env python3
"""Who may include whom. Prints one line a breach; the exit status is 1 when there is any.

core/        the C++ library without files, clocks, threads and printing; Eigen; Highway
core/train/  core, the whole C++ library, POSIX, assimp, minizip, pugixml, OSMesa
core/diagnosis/  core, and the libraries that core may use but for Highway; core does not know it
drivers/     of core only base, frame and geometry; image and JSON libraries; never app;
             Aravis in drivers/aravis/, libusb in drivers/usb/, Highway in drivers/genicam/
app/         public headers of core and drivers, its own private ones; neither assimp nor OSMesa;
app/simulation/ of these alone uses Bullet;
app/cad/     OpenCASCADE and CLI11; of ours the exit status and the check of what is printed;
app/modbus/  of all these only base, geometry, clock and set-up errors
tests/, tools/ everything

The folders of core form a hierarchy: no two of them include each other, not even by a detour.
"""

import sys
from pathlib import Path

from source_tree import CPP_SUFFIXES, files, includes, run, text_of

LIBRARIES = {  # first part of the path -> library
    "Eigen": "Eigen", "hwy": "Highway", "assimp": "assimp", "GL": "OSMesa",
    "opencv2": "OpenCV", "nlohmann": "nlohmann", "CLI": "CLI11", "gtest": "GoogleTest",
    "gmock": "GoogleTest", "arv.h": "Aravis", "libusb.h": "libusb", "toml++": "tomlplusplus",
    "modbus.h": "libmodbus", "zlib.h": "zlib", "unzip.h": "minizip", "zip.h": "minizip",
    "pugixml.hpp": "pugixml",
    "yaml-cpp": "yaml-cpp", "OpenEXR": "OpenEXR", "liblzf": "liblzf",
    "btBulletDynamicsCommon.h": "Bullet", "LinearMath": "Bullet",
}
OPEN_CASCADE_SUFFIX = ".hxx"  # all of its headers, and nobody else's
POSIX = ("sys", "unistd.h", "fcntl.h", "pthread.h", "signal.h", "poll.h", "dirent.h", "errno.h",
         "time.h", "sched.h", "dlfcn.h", "arpa", "netinet", "spawn.h", "stdio.h", "stdlib.h",
         "ifaddrs.h", "malloc.h", "semaphore.h", "linux")
# Core prints nothing, opens nothing, starts nothing and reads no clock.
NOT_IN_CORE = {
    "iostream", "istream", "ostream", "fstream", "sstream", "strstream", "iomanip", "ios", "iosfwd",
    "filesystem", "syncstream", "spanstream", "thread", "mutex", "shared_mutex", "future",
    "condition_variable", "semaphore", "latch", "barrier", "stop_token", "chrono", "ctime",
    "cstdio", "locale", "codecvt", "csignal", "regex",
}
CORE_EXCEPTIONS = {("core/base/assert.cpp", "cstdio")}  # the last words before abort()

ALLOWED_LIBRARIES = {
    "core": {"std", "Eigen", "Highway"},
    "train": {"std", "POSIX", "Eigen", "assimp", "minizip", "pugixml", "OSMesa"},
    "diagnosis": {"std", "Eigen"},
    "drivers": {"std", "POSIX", "Eigen", "Highway", "OpenCV", "nlohmann", "Aravis", "libusb",
                "yaml-cpp", "OpenEXR", "liblzf"},
    "app": {"std", "POSIX", "Eigen", "OpenCV", "nlohmann", "CLI11", "tomlplusplus", "libmodbus",
            "zlib", "Bullet", "OpenCASCADE"},
}
ALLOWED_AREAS = {
    "core": {"core"},
    "train": {"train", "core"},
    "diagnosis": {"diagnosis", "core"},
    "drivers": {"drivers", "core"},
    "app": {"app", "drivers", "train", "diagnosis", "core"},
}
SHARED_BY_DRIVERS = "genicam"  # payloads and formats: no device library
# Libraries that belong into some folders only.
LIBRARY_FOLDERS = {"Aravis": ("drivers/aravis/",), "libusb": ("drivers/usb/",),
                   "Highway": ("core/", "drivers/genicam/"), "Bullet": ("app/simulation/",),
                   "OpenCASCADE": ("app/cad/",)}
# Made in the build folder: (area, path as it is included).
GENERATED = {("app", "modbus/register_map.hpp")}
# The Modbus side knows registers, poses and sockets: nothing of detection, sensors and the rest.
SIMULATION_SEES = ("app/simulation/", "core/include/binpick/base/",
                   "core/include/binpick/geometry/")
MODBUS_SEES = ("app/modbus/", "app/clock.hpp", "app/setup_error.hpp", "core/include/binpick/base/",
               "core/include/binpick/geometry/")
CAD_SEES = ("app/cad/", "app/exit_code.hpp", "app/standard_output.hpp")
DRIVERS_SEE_OF_CORE = {"base", "frame", "geometry"}
# Where a private header may stand, seen from the area that includes it.
PRIVATE_ROOTS = {
    "core": ("core",), "train": ("core/train", "core"), "diagnosis": ("core",),
    "drivers": ("drivers",), "app": ("app",),
}
PUBLIC_ROOTS = ("core/include", "drivers/include")


def area_of(relative):
    """The layer that a file belongs to, from its path below the root."""
    for area in ("train", "diagnosis"):
        if relative.startswith((f"core/{area}/", f"core/include/binpick/{area}/")):
            return area
    return relative.split("/")[0]


def core_folder_of(relative):
    """base, frame, ... for a file of core; None elsewhere."""
    for prefix in ("core/include/binpick/", "core/"):
        if relative.startswith(prefix):
            return relative[len(prefix):].split("/")[0]
    return None


def library_of(target):
    """The library of an include that is none of our files; None when it is not known."""
    first = target.split("/")[0]
    if target.endswith(OPEN_CASCADE_SUFFIX):
        return "OpenCASCADE"
    if first in LIBRARIES:
        return LIBRARIES[first]
    if first in POSIX:
        return "POSIX"
    if "/" not in target and "." not in target:
        return "std"
    return None


def resolve(root, source, area, target):
    """Path below the root of one of our headers, or None when the include is none of ours."""
    roots = [root / folder for folder in PUBLIC_ROOTS + PRIVATE_ROOTS[area]]
    for folder in [source.parent] + roots:
        header = (folder / target).resolve()
        if header.is_file() and header.is_relative_to(root):
            return header.relative_to(root).as_posix()
    return None


def fault_of_ours(relative, area, header):
    """Why `relative` may not include our file `header`; None when it may."""
    other = area_of(header)
    if other not in ALLOWED_AREAS[area]:
        return f"{area} may not know {other}"
    public = header.startswith(PUBLIC_ROOTS)
    if relative.startswith("app/modbus/") and not header.startswith(MODBUS_SEES):
        return "the Modbus side knows neither detection nor sensors"
    if relative.startswith("app/cad/") and not header.startswith(CAD_SEES):
        return "binpick-cad is a program of its own"
    if relative.startswith("app/simulation/") and not header.startswith(SIMULATION_SEES):
        return "the simulation knows neither detection nor training"
    if not public and area in ("drivers", "app") and other != area:
        return f"a private header of {other}"
    if area == "drivers" and other == "core" and core_folder_of(header) not in DRIVERS_SEE_OF_CORE:
        return "drivers see of core only " + ", ".join(sorted(DRIVERS_SEE_OF_CORE))
    if area == "drivers" and other == "drivers" and not public:
        mine, its = relative.split("/")[1:-1], header.split("/")[1:-1]
        # What stands above the drivers' folders chooses between them.
        if its and mine and mine[:1] != its[:1] and its[:1] != [SHARED_BY_DRIVERS]:
            return "one driver may not include another's private header"
    return None


def fault_of_library(relative, area, target, quoted):
    library = library_of(target)
    if library is None:
        kind = "header that does not exist" if quoted else "library that is not on the list"
        return f"a {kind} for {area}"
    if library not in ALLOWED_LIBRARIES[area]:
        return f"{area} may not use {library}"
    if not relative.startswith(LIBRARY_FOLDERS.get(library, "")):
        return f"{library} belongs into {' or '.join(LIBRARY_FOLDERS[library])}"
    exempt = area not in ("core", "diagnosis") or (relative, target) in CORE_EXCEPTIONS
    if target in NOT_IN_CORE and not exempt:
        return "core has no files, clocks, threads or printing of its own"
    return None


def find_cycle(edges):
    """One cycle in {folder: {folder: example}}, as a list that begins and ends alike; or None."""
    done = set()

    def visit(folder, path):
        if folder in path:
            return path[path.index(folder):] + [folder]
        if folder in done:
            return None
        for other in sorted(edges.get(folder, {})):
            cycle = visit(other, path + [folder])
            if cycle:
                return cycle
        done.add(folder)
        return None

    for folder in sorted(edges):
        cycle = visit(folder, [])
        if cycle:
            return cycle
    return None


def check(root):
    """All breaches below root, as printable lines."""
    root = Path(root).resolve()
    faults = []
    edges = {}
    for source in files(root, CPP_SUFFIXES):
        relative = source.relative_to(root).as_posix()
        area = area_of(relative)
        if area in ("tests", "tools"):
            continue
        for line, quoted, target in includes(text_of(source)):
            if (area, target) in GENERATED:
                continue
            header = resolve(root, source, area, target)
            if header is None:
                fault = fault_of_library(relative, area, target, quoted)
            else:
                fault = fault_of_ours(relative, area, header)
                mine, its = core_folder_of(relative), core_folder_of(header)
                if mine and its and mine != its:
                    edges.setdefault(mine, {}).setdefault(its, f"{relative}:{line}")
            if fault:
                faults.append(f"{relative}:{line}: includes {target}: {fault}")
    cycle = find_cycle(edges)
    if cycle:
        steps = [f"{a} -> {b} ({edges[a][b]})" for a, b in zip(cycle, cycle[1:])]
        faults.append("core: folders include each other: " + ", ".join(steps))
    return faults


if __name__ == "__main__":
    sys.exit(run(check, __doc__))

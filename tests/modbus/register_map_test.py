#!/usr/bin/env python3
"""The register map keeps its rules, what is made from it is up to date, and its maker finds faults.

    register_map_test.py SOURCE_FOLDER
"""

import copy
import csv
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest
from pathlib import Path

ROOT = Path(sys.argv.pop(1)).resolve()
MAP = ROOT / "firmware-config/modbus/register-map.toml"
TOOL = ROOT / "tools/register_map"
sys.dont_write_bytecode = True
sys.path.insert(0, str(TOOL))
import cpp_header  # noqa: E402
from map_model import MapError, check, checksum, load, notation  # noqa: E402


def start(*arguments):
    command = [sys.executable, "-B", str(TOOL / "register_map.py")] + [str(a) for a in arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=60)


class FilesTest(unittest.TestCase):
    def test_what_is_checked_in_is_what_the_map_says(self):
        run = start(MAP, "--check")
        self.assertEqual((run.returncode, run.stdout, run.stderr), (0, "", ""))

    def test_a_change_of_the_map_or_of_a_table_is_found(self):
        folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, folder)
        shutil.copytree(ROOT / "firmware-config", folder / "config")
        copied = folder / "config/modbus/register-map.toml"
        table = folder / "config/modbus/register-map.md"
        table.write_text(table.read_text().replace("40101", "40100", 1))
        run = start(copied, "--check")
        self.assertEqual((run.returncode, run.stdout.count("\n")), (1, 1))
        copied.write_text(copied.read_text().replace("version = 1", "version = 2", 1))
        changed = start(copied, "--check").stdout  # the CSV holds no version
        self.assertEqual(changed.count("\n"), 2)
        self.assertEqual(start(copied, "--write").returncode, 0)
        self.assertEqual(start(copied, "--check").returncode, 0)

    def test_the_table_names_every_register_both_ways(self):
        with open(MAP.with_suffix(".csv"), encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        places = [int(r["address"]) + i for r in rows for i in range(int(r["words"]))]
        self.assertEqual(places, list(range(0, 20)) + list(range(100, 225)))
        for row in rows:
            self.assertEqual(int(row["holding"]), 40001 + int(row["address"]))
            self.assertEqual(int(row["input"]), 30001 + int(row["address"]))
            self.assertTrue(row["text"])

    def test_the_plc_block_uses_the_numbers_of_the_map(self):
        number = re.compile(r"^ +(BP_\w+) : U?INT := (\d+);", re.MULTILINE)
        folder = ROOT / "firmware-config/plc"
        all_names = number.findall((folder / "binpick_registers.st").read_text())
        self.assertEqual(len({name for name, _ in all_names}), len(all_names))
        used = number.findall((folder / "binpick_client.st").read_text())
        self.assertGreater(len(used), 30)
        for name, value in used:
            self.assertEqual(dict(all_names).get(name), value, name)

    def test_notation(self):
        self.assertEqual((notation(0, 4), notation(100, 3)), ("40001", "30101"))


class RulesTest(unittest.TestCase):
    def setUp(self):
        self.data = tomllib.loads(MAP.read_text())

    def broken(self, change, *words):
        data = copy.deepcopy(self.data)
        change(data)
        with self.assertRaises(MapError) as raised:
            check(data)
        for word in words:
            self.assertIn(word, str(raised.exception))

    def test_the_map_keeps_them(self):
        check(self.data)
        answer = self.data["block"]["answer"]
        self.assertLessEqual(answer["count"], 125)

    def test_places(self):
        registers = lambda data: data["block"]["answer"]["registers"]
        self.broken(lambda d: registers(d)[0].update(address=101), "share")
        self.broken(lambda d: registers(d).pop(1), "empty")
        self.broken(lambda d: registers(d)[1].update(address=90), "outside")
        self.broken(lambda d: registers(d)[0].update(type="uint32"), "share")
        self.broken(lambda d: d["block"]["answer"].update(count=126), "125")
        self.broken(lambda d: d["picks"]["registers"].pop(), "empty")

    def test_fields(self):
        first = lambda data: data["block"]["command"]["registers"][0]
        self.broken(lambda d: first(d).pop("unit"), "unit")
        self.broken(lambda d: first(d).update(type="real"), "real")
        self.broken(lambda d: first(d).update(name="Bad Name"), "name")
        self.broken(lambda d: first(d).update(access="r"), "contradict")
        self.broken(lambda d: first(d).update(colour="red"), "colour")

    def test_numbers_are_not_used_twice(self):
        values = self.data["list"]["cause"]["values"]
        self.broken(lambda d: d["list"]["cause"]["values"].append(values[3]), "twice")
        self.broken(lambda d: d["bits"]["state"]["values"].append(
            {"bit": 16, "name": "far", "text": "x"}), "16")

    def test_the_command_ends_with_its_sequence(self):
        def swap(data):
            registers = data["block"]["command"]["registers"]
            registers[-1]["name"], registers[-2]["name"] = "reserved", "command_sequence"
        self.broken(swap, "last")

    def test_checksum_is_of_what_binds_not_of_wording(self):
        data = copy.deepcopy(self.data)
        data["block"]["answer"]["registers"][0]["text"] = "Other words"
        self.assertEqual(checksum(data), checksum(self.data))
        data["picks"]["registers"][0]["scale"] = 0.01
        self.assertNotEqual(checksum(data), checksum(self.data))

    def test_the_header_has_each_address(self):
        text = cpp_header.text(load(MAP))
        for block in self.data["block"].values():
            for register in block["registers"]:
                name = cpp_header.camel("address_" + register["name"])
                self.assertIn(f"k{name} = {register['address']};", text)


class EveryBitIsSet(unittest.TestCase):
    """Of each bit that the map defines, somewhere in the station's code sets it."""

    # How the code names the bits of each list.
    NAMES = {"state": r"\bStateBit::k", "no_pick_reasons": r"\b(NoPickReason(sBit)?|Reason)::k",
             "pick_flags": r"\b(PickFlagsBit|Flag)::k"}

    def test_by_the_station(self):
        station = [path for folder in ("station", "daemon", "modbus")
                   for path in sorted((ROOT / "app" / folder).glob("*.cpp"))]
        code = "\n".join(path.read_text() for path in [*station, ROOT / "app/frame_findings.cpp"])
        bits = load(MAP)["bits"]
        self.assertEqual(set(bits), set(self.NAMES))
        for name, entries in bits.items():
            for entry in entries["values"]:
                with self.subTest(f"{name}.{entry['name']}"):
                    pattern = self.NAMES[name] + cpp_header.camel(entry["name"]) + r"\b"
                    self.assertRegex(code, pattern)


if __name__ == "__main__":
    unittest.main()

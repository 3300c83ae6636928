#!/usr/bin/env python3
"""The units, users and directories as systemd's own tools judge them, in a root of their own.

    units_test.py SYSTEMD-FOLDER

Exit status 77: systemd-analyze, systemd-sysusers or systemd-tmpfiles is not there.
"""

import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TOOLS = ("systemd-analyze", "systemd-sysusers", "systemd-tmpfiles")
FOLDER = Path()
EXPOSURE_MAX = 20  # in tenths
UNIT = "binpickd.service"


class Root:
    """A tree with the unit, what it starts and the targets that it names."""

    def __init__(self, path):
        self.path = Path(path)
        self.units = self.path / "usr/lib/systemd/system"
        self.units.mkdir(parents=True)
        for target in Path("/usr/lib/systemd/system").glob("*.target"):
            shutil.copy(target, self.units)
        shutil.copy(FOLDER / UNIT, self.units)
        for program in ("usr/bin/binpickd", "bin/kill"):
            file = self.path / program
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text("#!/bin/sh\n")
            file.chmod(0o755)
        for kind in ("sysusers.d", "tmpfiles.d"):
            shutil.copytree(FOLDER / kind, self.path / "usr/lib" / kind)
        (self.path / "etc").mkdir()

    def run(self, *command):
        return subprocess.run([command[0], f"--root={self.path}", *command[1:]],
                              capture_output=True, text=True, timeout=60, check=False)

    def verify(self):
        return self.run("systemd-analyze", "verify", "--recursive-errors=no", UNIT)

    def security(self, threshold):
        return self.run("systemd-analyze", "security", "--no-pager", "--offline=true",
                        f"--threshold={threshold}", UNIT)

    def drop_in(self, source):
        """This one and no other."""
        folder = self.path / f"etc/systemd/system/{UNIT}.d"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        shutil.copy(source, folder)

    def change_unit(self, old, new):
        text = (self.units / UNIT).read_text()
        assert text.count(old) == 1, old
        (self.units / UNIT).write_text(text.replace(old, new))


class UnitTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Root(folder.name)

    def assert_good(self, done):
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)

    def test_verifies_without_a_word(self):
        self.assert_good(self.root.verify())

    def test_verification_sees_a_wrong_key(self):
        self.root.change_unit("WatchdogSec=", "WatchdogSecs=")
        self.assertIn("WatchdogSecs", self.root.verify().stderr)

    def test_exposure_is_low(self):
        self.assertEqual(self.root.security(EXPOSURE_MAX).returncode, 0)

    def test_exposure_is_measured(self):
        self.root.change_unit("CapabilityBoundingSet=CAP_NET_BIND_SERVICE\n",
                              "CapabilityBoundingSet=~CAP_SYSLOG\n")
        self.root.change_unit("ProtectSystem=strict\n", "ProtectSystem=no\n")
        self.root.change_unit("SystemCallFilter=@system-service\n", "")
        self.assertNotEqual(self.root.security(EXPOSURE_MAX).returncode, 0)

    def test_drop_ins_verify_and_stay_low(self):
        drop_ins = sorted((FOLDER / "drop-ins").glob("*.conf"))
        self.assertTrue(drop_ins)
        for drop_in in drop_ins:  # each alone: none may hide what another one opens
            with self.subTest(drop_in.name):
                self.root.drop_in(drop_in)
                self.assert_good(self.root.verify())
                done = self.root.security(EXPOSURE_MAX)
                self.assertEqual(done.returncode, 0, done.stdout)

    def test_a_bad_configuration_is_not_started_again(self):
        text = (FOLDER / UNIT).read_text()
        self.assertRegex(text, r"(?m)^RestartPreventExitStatus=.*\b78\b")
        self.assertRegex(text, r"(?m)^StartLimitBurst=\d+$")

    def test_users_and_folders_are_made(self):
        done = self.root.run("systemd-sysusers", "binpick.conf")
        self.assertEqual(done.returncode, 0, done.stderr)
        users = (self.root.path / "etc/passwd").read_text()
        self.assertRegex(users, r"(?m)^binpick:x:\d+:\d+:.*:/usr/sbin/nologin$")
        groups = (self.root.path / "etc/group").read_text()
        self.assertRegex(groups, r"(?m)^plugdev:x:\d+:binpick$")
        done = self.root.run("systemd-tmpfiles", "--create", "binpick.conf")
        self.assertEqual(done.returncode, 0, done.stderr)
        folder = self.root.path / "var/lib/binpick/recordings"
        self.assertEqual(folder.stat().st_mode & 0o7777, 0o750)


if __name__ == "__main__":
    missing = [tool for tool in TOOLS if shutil.which(tool) is None]
    if missing:
        print("SKIPPED: not installed:", ", ".join(missing))
        sys.exit(77)
    FOLDER = Path(sys.argv.pop(1))
    unittest.main()

#!/usr/bin/env python3
"""The Debian packages: made from the build folder, unpacked into an empty root, looked at there.

    package_test.py BUILD-FOLDER

Exit status 77: cpack, dpkg-deb, dpkg-shlibdeps or systemd's tools are not there.
"""

import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TOOLS = ("cpack", "dpkg-deb", "dpkg-shlibdeps", "systemd-analyze", "systemd-sysusers")
BUILD = Path()
UNIT = "binpickd.service"
FILES = (
    "usr/bin/binpick", "usr/bin/binpickd", "usr/lib/systemd/system/binpickd.service",
    "usr/lib/sysusers.d/binpick.conf", "usr/lib/tmpfiles.d/binpick.conf",
    "usr/lib/udev/rules.d/60-binpick-usb.rules", "usr/lib/sysctl.d/60-binpick-net.conf",
    "usr/share/binpick/binpick.toml", "usr/share/binpick/recipes/example.toml",
    "usr/share/binpick/modbus/register-map.md", "usr/share/binpick/sensors/basler-blaze.toml",
    "usr/share/doc/binpick/README.md", "usr/share/doc/binpick/copyright",
    "usr/share/doc/binpick/examples/binpickd.service.d/cpu.conf",
)


def run(*command, **options):
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False,
                          **options)


class PackageTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp())
        done = run("cpack", "-G", "DEB", "-B", str(cls.folder), cwd=BUILD)
        assert done.returncode == 0, done.stdout + done.stderr
        (cls.package,) = cls.folder.glob("binpick_*.deb")
        cls.root = cls.folder / "root"
        done = run("dpkg-deb", "-x", str(cls.package), str(cls.root))
        assert done.returncode == 0, done.stderr

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def field(self, name, package=None):
        return run("dpkg-deb", "-f", str(package or self.package), name).stdout.strip()

    def test_everything_is_in_its_place(self):
        for file in FILES:
            self.assertTrue((self.root / file).is_file(), file)
        found = {path.relative_to(self.root).parts[0] for path in self.root.rglob("*")}
        self.assertEqual(found, {"usr"}, "nothing outside of /usr: /etc is the cell's own")

    def test_libraries_are_dependencies(self):
        depends = self.field("Depends")
        for library in ("libc6", "libaravis-0.8-0", "libmodbus5", "libassimp5", "zlib1g",
                        "libopencv-core", "libopenexr", "libyaml-cpp", "liblzf1", "systemd",
                        "procps"):
            self.assertIn(library, depends)

    def test_step_and_iges_are_a_package_of_their_own(self):
        """So that a station does without OpenCASCADE and what it depends on."""
        self.assertNotIn("libocct", self.field("Depends"))
        self.assertFalse((self.root / "usr/bin/binpick-cad").exists())
        (package,) = self.folder.glob("binpick-cad_*.deb")
        self.assertEqual(self.field("Package", package), "binpick-cad")
        self.assertIn("libocct-data-exchange", self.field("Depends", package))
        root = self.folder / "cad"
        self.assertEqual(run("dpkg-deb", "-x", str(package), str(root)).returncode, 0)
        files = {path.relative_to(root).as_posix() for path in root.rglob("*") if path.is_file()}
        self.assertEqual(files, {"usr/bin/binpick-cad", "usr/share/doc/binpick-cad/copyright"})

    def test_programs_are_stripped_and_belong_to_root(self):
        listing = run("dpkg-deb", "-c", str(self.package)).stdout
        for line in listing.splitlines():
            self.assertIn("root/root", line)
            self.assertNotIn("rwxrwx", line)
        self.assertNotIn(".debug_info",
                         run("objdump", "-h", str(self.root / "usr/bin/binpickd")).stdout)

    def test_the_unit_verifies_where_it_is_unpacked(self):
        units = self.root / "usr/lib/systemd/system"
        for target in Path("/usr/lib/systemd/system").glob("*.target"):
            shutil.copy(target, units)
        kill = self.root / "bin/kill"
        kill.parent.mkdir()
        kill.write_text("#!/bin/sh\n")
        kill.chmod(0o755)
        self.addCleanup(shutil.rmtree, self.root / "bin")
        done = run("systemd-analyze", f"--root={self.root}", "verify", "--recursive-errors=no",
                   UNIT)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        done = run("systemd-analyze", f"--root={self.root}", "security", "--offline=true",
                   "--threshold=20", "--no-pager", UNIT)
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_maintainer_scripts_are_there_and_shell(self):
        control = self.folder / "control"
        done = run("dpkg-deb", "-e", str(self.package), str(control))
        self.assertEqual(done.returncode, 0)
        for script in ("postinst", "prerm", "postrm"):
            self.assertTrue((control / script).stat().st_mode & 0o111, script)
            self.assertEqual(run("sh", "-n", str(control / script)).returncode, 0)

    def test_the_example_is_refused_until_it_is_set(self):
        done = run(str(self.root / "usr/bin/binpickd"), "--check", "--config",
                   str(self.root / "usr/share/binpick/binpick.toml"))
        self.assertEqual(done.returncode, 78)
        self.assertIn("sensor.uri: must be set", done.stderr)


if __name__ == "__main__":
    missing = [tool for tool in TOOLS if shutil.which(tool) is None]
    if missing:
        print("SKIPPED: not installed:", ", ".join(missing))
        sys.exit(77)
    BUILD = Path(sys.argv.pop(1))
    unittest.main()

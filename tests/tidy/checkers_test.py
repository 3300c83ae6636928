#!/usr/bin/env python3
"""The checkers fail on what they are there to find, and pass on what is right."""

import shutil
import sys
import tempfile
import unittest
from pathlib import Path

import check_includes
import check_style
from cpp_functions import functions

HEADER = "#pragma once\n\nint {name}();\n"


class TreeTest(unittest.TestCase):
    def setUp(self):
        self.root = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.root)

    def write(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def assert_one_fault(self, faults, *words):
        self.assertEqual(len(faults), 1, faults)
        for word in words:
            self.assertIn(word, faults[0])


class IncludesTest(TreeTest):
    def setUp(self):
        super().setUp()
        for path in ("core/include/binpick/base/arena.hpp",
                     "core/include/binpick/frame/frame.hpp",
                     "core/include/binpick/detect/detector.hpp",
                     "core/include/binpick/train/mesh.hpp",
                     "core/include/binpick/diagnosis/diagnosis.hpp", "core/diagnosis/start.hpp",
                     "core/search/scan.hpp", "core/train/histogram.hpp", "app/cli/commands.hpp",
                     "drivers/include/binpick/drivers/camera.hpp", "drivers/fake/pattern.hpp",
                     "drivers/replay/recording.hpp"):
            self.write(path, HEADER.format(name="f"))

    def faults(self, path, *targets):
        self.write(path, "".join(f"#include {target}\n" for target in targets))
        return check_includes.check(self.root)

    def test_passes_what_is_allowed(self):
        self.faults("core/search/scan.cpp", '"search/scan.hpp"', "<vector>", "<Eigen/Core>",
                    '"binpick/base/arena.hpp"', '"hwy/highway.h"', "<atomic>")
        self.faults("core/train/trainer.cpp", '"histogram.hpp"', '"search/scan.hpp"', "<thread>",
                    "<assimp/scene.h>", "<GL/osmesa.h>", "<sys/wait.h>", '"binpick/train/mesh.hpp"')
        self.faults("core/diagnosis/start.cpp", '"diagnosis/start.hpp"', '"search/scan.hpp"',
                    '"binpick/diagnosis/diagnosis.hpp"', "<vector>", "<Eigen/Core>")
        self.faults("drivers/replay/recording.cpp", '"recording.hpp"', "<opencv2/imgcodecs.hpp>",
                    '"binpick/frame/frame.hpp"', '"binpick/drivers/camera.hpp"')
        self.faults("tests/core/scan_test.cpp", '"search/scan.hpp"', "<gtest/gtest.h>")
        self.faults("app/main.cpp", '"cli/commands.hpp"', "<CLI/CLI.hpp>", "<chrono>",
                    '"binpick/detect/detector.hpp"', '"binpick/drivers/camera.hpp"',
                    '"binpick/diagnosis/diagnosis.hpp"')
        self.assertEqual(check_includes.check(self.root), [])

    def test_core_knows_no_upper_folder(self):
        for target in ('"binpick/drivers/camera.hpp"', '"binpick/train/mesh.hpp"',
                       '"diagnosis/start.hpp"', '"binpick/diagnosis/diagnosis.hpp"'):
            self.assert_one_fault(self.faults("core/search/scan.cpp", target), "core may not know")

    def test_core_does_not_reach_app_by_a_relative_path(self):
        faults = self.faults("core/search/scan.cpp", '"../../app/cli/commands.hpp"')
        self.assert_one_fault(faults, "core may not know app")

    def test_core_uses_no_other_library(self):
        for target in ("<opencv2/core.hpp>", "<assimp/scene.h>", "<nlohmann/json.hpp>",
                       "<unistd.h>", "<modbus.h>"):
            self.assert_one_fault(self.faults("core/search/scan.cpp", target), "scan.cpp:1")

    def test_core_has_no_files_clocks_threads(self):
        for target in ("<iostream>", "<thread>", "<chrono>", "<fstream>", "<filesystem>"):
            self.assert_one_fault(self.faults("core/search/scan.cpp", target), "of its own")

    def test_training_knows_no_upper_folder(self):
        self.assert_one_fault(self.faults("core/train/trainer.cpp", '"binpick/drivers/camera.hpp"'),
                              "train may not know drivers")

    def test_diagnosis_is_held_to_what_core_is(self):
        for target in ("<fstream>", "<thread>"):
            self.assert_one_fault(self.faults("core/diagnosis/start.cpp", target), "of its own")
        for target in ('"binpick/train/mesh.hpp"', '"binpick/drivers/camera.hpp"'):
            self.assert_one_fault(self.faults("core/diagnosis/start.cpp", target),
                                  "diagnosis may not know")

    def test_app_sees_the_diagnosis_from_outside(self):
        self.assert_one_fault(self.faults("app/main.cpp", '"../core/diagnosis/start.hpp"'),
                              "a private header of diagnosis")

    def test_drivers_see_little_of_core(self):
        self.assert_one_fault(self.faults("drivers/fake/fake.cpp", '"binpick/detect/detector.hpp"'),
                              "drivers see of core only")

    def test_drivers_do_not_know_app_or_each_other(self):
        self.assert_one_fault(self.faults("drivers/fake/fake.cpp", '"../../app/cli/commands.hpp"'),
                              "may not know app")
        self.assert_one_fault(self.faults("drivers/fake/fake.cpp", '"replay/recording.hpp"'),
                              "another's private header")

    def test_each_device_library_has_one_folder(self):
        self.assertEqual(self.faults("drivers/aravis/file.cpp", "<arv.h>"), [])
        self.assert_one_fault(self.faults("drivers/replay/file.cpp", "<arv.h>"),
                              "Aravis belongs into drivers/aravis")
        (self.root / "drivers/replay/file.cpp").unlink()
        self.assert_one_fault(self.faults("app/main.cpp", "<libusb.h>"), "app may not use libusb")

    def test_drivers_share_the_payload_folder(self):
        self.write("drivers/genicam/scan3d.hpp", "#pragma once\n")
        self.assertEqual(self.faults("drivers/aravis/file.cpp", '"genicam/scan3d.hpp"'), [])
    def test_the_modbus_side_knows_no_detection(self):
        self.write("app/modbus/answer.hpp", HEADER.format(name="f"))
        self.assertEqual(self.faults("app/modbus/answer.cpp", '"modbus/answer.hpp"', "<modbus.h>",
                                     '"modbus/register_map.hpp"',
                                     '"binpick/base/arena.hpp"'), [])
        self.assert_one_fault(
            self.faults("app/modbus/answer.cpp", '"binpick/detect/detector.hpp"'),
            "neither detection nor sensors")

    def test_app_sees_public_headers_only(self):
        self.assert_one_fault(self.faults("app/main.cpp", '"../core/search/scan.hpp"'),
                              "a private header of core")

    def test_finds_a_cycle_of_core_folders(self):
        self.write("core/base/a.hpp", '#pragma once\n#include "frame/b.hpp"\n')
        self.write("core/frame/b.hpp", '#pragma once\n#include "search/c.hpp"\n')
        self.assert_one_fault(self.faults("core/search/c.hpp", '"base/a.hpp"'),
                              "base -> frame", "frame -> search", "search -> base")


class StyleTest(TreeTest):
    def faults(self, path, text):
        self.write("core/CMakeLists.txt", "add_library(x base/a.cpp)\n")
        self.write("core/base/a.cpp", '#include "a.hpp"\n')
        self.write("core/base/a.hpp", HEADER.format(name="a"))
        self.write(path, text)
        return check_style.check(self.root, with_format=False)

    def test_passes_what_is_right(self):
        text = '#include "a.hpp"\n\nint a() { return 1; }\n'
        self.assertEqual(self.faults("core/base/a.cpp", text), [])

    def test_finds_long_lines_tabs_and_a_missing_end(self):
        text = '#include "a.hpp"\n// ' + "x" * 98 + "\n"
        self.assert_one_fault(self.faults("core/base/a.cpp", text), "a.cpp:2", "101 columns")
        text = '#include "a.hpp"\n\tint b;\n'
        self.assert_one_fault(self.faults("core/base/a.cpp", text), "a tab")
        self.assert_one_fault(self.faults("core/base/a.cpp", '#include "a.hpp"'), "newline")

    def test_finds_a_long_file(self):
        self.assert_one_fault(self.faults("core/base/a.cpp", '#include "a.hpp"\n' + "//\n" * 400),
                              "401 lines")

    def test_finds_a_long_function(self):
        body = "  ++x;\n" * 69
        text = '#include "a.hpp"\n\nint f(int x) {\n' + body + "}\n"
        self.assert_one_fault(self.faults("core/base/a.cpp", text), "a.cpp:3", "f has 71 lines")
        shorter = text.replace("  ++x;\n", "", 1)
        self.assertEqual(self.faults("core/base/a.cpp", shorter), [])

    def test_finds_marks_of_unfinished_work(self):
        for mark in ("TO" + "DO", "FIX" + "ME"):
            text = f'#include "a.hpp"\n// {mark}: more\n'
            self.assert_one_fault(self.faults("core/base/a.cpp", text), "unfinished")

    def test_finds_header_faults(self):
        self.assert_one_fault(self.faults("core/base/a.hpp", "int a();\n"), "#pragma once")
        self.write("core/base/a-inl.hpp", "int a();\n")
        self.assertEqual(self.faults("core/base/a.cpp", '#include "a.hpp"\n#include "a-inl.hpp"\n'),
                         [])
        (self.root / "core/base/a-inl.hpp").unlink()
        text = "#pragma once\nusing namespace std;\n"
        self.assert_one_fault(self.faults("core/base/a.hpp", text), "using namespace")

    def test_finds_drawers(self):
        for name in ("util", "image_utils", "common", "test_helpers"):
            faults = self.faults(f"tests/{name}.py", "x = 1\n")
            self.assertTrue(any("named for a noun" in fault for fault in faults), faults)

    def test_finds_dead_files(self):
        faults = self.faults("core/base/b.cpp", "int b;\n")
        self.assert_one_fault(faults, "b.cpp", "no CMakeLists.txt")
        (self.root / "core/base/b.cpp").unlink()
        faults = self.faults("core/base/b.hpp", "#pragma once\n")
        self.assert_one_fault(faults, "b.hpp", "nothing includes it")

    @unittest.skipUnless(shutil.which("clang-format"), "clang-format is not installed")
    def test_finds_what_clang_format_would_change(self):
        self.write(".clang-format", "BasedOnStyle: Google\n")
        self.write("core/base/a.cpp", "int   a = 1;\n")
        sources = [self.root / "core/base/a.cpp"]
        faults = check_style.check_format(self.root, sources)
        self.assert_one_fault(faults, "core/base/a.cpp:1", "clang-format")
        self.write("core/base/a.cpp", "int a = 1;\n")
        self.assertEqual(check_style.check_format(self.root, sources), [])


class FunctionsTest(unittest.TestCase):
    def names(self, text):
        return [header.split("(")[0].split()[-1] for _, _, header in functions(text)]

    def test_finds_free_member_and_nested_functions(self):
        self.assertEqual(self.names("""
            namespace a { namespace {
            template <class T, class = std::vector<int>> int free(T x) { if (x) { } return 1; }
            struct S : Base { int member() const noexcept override { return 1; } int x = 0; };
            class T { public: T(); private: struct Impl { void inner() {} }; };
            } }
            a::T::T() : x_{1}, y_(2) { }
            TEST(Subject, Fact) { auto f = [](int i) { return i; }; }
            """), ["free", "member", "inner", "a::T::T", "TEST"])

    def test_takes_no_table_for_a_function(self):
        self.assertEqual(self.names("""
            enum class E : int { kA, kB };
            const std::map<int, int> kTable = {{f(1), 2}, {3, 4}};
            constexpr int kNumbers[] = {1, 2};
            std::vector<int> numbers{1, 2};
            void f(Options options = {}) { }
            """), ["f"])

    def test_reads_over_comments_literals_and_branches(self):
        self.assertEqual(functions("""
            int f() {
              const char* s = "}}}{{{"; char c = '{'; int n = 1'000'000;  // }}}
              auto raw = R"x( } } )x"; /* { */
            #if A
              if (n) {
            #else
              if (!n) {
            #endif
              }
            }
            int g() { return 2; }
            """), [(2, 11, "int f()"), (12, 12, "int g()")])

    def test_counts_from_the_signature_to_the_last_brace(self):
        self.assertEqual(functions("int f(int a,\n      int b)\n{\n  return a;\n}\n"),
                         [(1, 5, "int f(int a, int b)")])


if __name__ == "__main__":
    sys.exit(unittest.main())

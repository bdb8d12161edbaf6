#!/usr/bin/env python3
"""The architecture check must find each kind of fault that it is for, in a small tree that is clean but for that one."""

import tempfile
import unittest
from pathlib import Path

from architecture import check

HEADER = "// What it is for.\n#pragma once\n"


class ArchitectureTest(unittest.TestCase):
    def faults(self, files):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            clean = {
                "src/base/pose.cpp": '#include "taxelsim/pose.h"\n#include "base/pose.h"\n',
                "src/base/pose.h": HEADER,
                "src/gpu/context.h": HEADER + "#include <vulkan/vulkan_raii.hpp>\n",
                "src/sensor/psf.cpp": '#include "geometry/grid.h"\n#include "base/pose.h"\n',
                "src/cli/main.cpp": '#include "episodes/a.h"\n#include "taxelsim/generate.h"\n',
                "src/simulation/CMakeLists.txt": "taxelsim_layer(simulation SOURCES a.cpp USES gpu sensor LINK x::y)\n",
                "include/taxelsim/pose.h": HEADER,
                "shaders/image.comp": "#version 460\n// One workgroup per instance.\n",
            }
            for name, text in (clean | files).items():
                path = root / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
            return check(root)

    def assert_one(self, files, part):
        faults = self.faults(files)
        self.assertEqual(len(faults), 1, faults)
        self.assertIn(part, faults[0])

    def test_clean_tree_has_no_faults(self):
        self.assertEqual(self.faults({}), [])

    def test_driver_outside_its_folder(self):
        self.assert_one({"shaders/depth/a.glsl": "// Slow on Mesa.\n"}, "shaders/depth/a.glsl:1: a driver's name")
        self.assertEqual(self.faults({"shaders/driver/a.glsl": "// Slow on Mesa.\n"}), [])

    def test_too_many_modules(self):
        names = " ".join(f"pass_{number}" for number in range(21))
        calls = f"taxelsim_shader(a a.comp)\nforeach(pass {names})\n  taxelsim_shader_of_vectors(${{pass}} a.comp)\nendforeach()\n"
        self.assertEqual(self.faults({"shaders/CMakeLists.txt": calls + "taxelsim_shader(b b.comp)\n"}), [])
        self.assert_one({"shaders/CMakeLists.txt": calls + "taxelsim_shader_of_vectors(b b.comp)\n"}, "SPIR-V modules of shaders/CMakeLists.txt: 45")

    def test_too_many_constants_of_the_contact_pass(self):
        lists = {"shaders/passes/contact.h": "CONSTANT(0, uint, A)\n" * 30, "shaders/passes/depth.h": "CONSTANT(0, uint, A)\n" * 10}
        self.assert_one(lists, "passes/contact.h and depth.h: 40, at most 39")

    def test_include_up(self):
        self.assert_one({"src/sensor/a.cpp": '#include "scene/scene.h"\n'}, "src/sensor/a.cpp:1: sensor must not include scene/scene.h")

    def test_include_across_one_floor(self):
        self.assert_one({"src/geometry/a.cpp": '\n#include "sensor/psf.h"\n'}, "src/geometry/a.cpp:2")

    def test_public_header_of_a_higher_floor(self):
        self.assert_one({"src/control/a.cpp": '#include "taxelsim/simulator.h"\n'}, "higher floor")

    def test_unknown_public_header(self):
        self.assert_one({"src/cli/a.cpp": '#include "taxelsim/new.h"\n'}, "not in the table")

    def test_vulkan_outside_its_layers(self):
        self.assert_one({"src/sensor/a.cpp": "#include <vulkan/vulkan.h>\n"}, "must not include Vulkan")

    def test_robot_parts_outside_their_layer(self):
        self.assert_one({"src/scene/a.cpp": "#include <kdl/chain.hpp>\n"}, "only control reads robots")
        self.assertEqual(self.faults({"src/control/a.cpp": "#include <kdl/chain.hpp>\n#include <urdf_parser/urdf_parser.h>\n"}), [])

    def test_vulkan_in_a_public_header(self):
        self.assert_one({"include/taxelsim/a.h": HEADER + "#include <vulkan/vulkan.h>\n"}, "public header includes")

    def test_include_without_folder(self):
        self.assert_one({"src/base/a.cpp": '#include "pose.h"\n'}, "write base/pose.h")

    def test_layer_on_no_floor(self):
        self.assert_one({"src/utils/a.cpp": ""}, "src/utils: not on any floor")

    def test_cmake_uses_up(self):
        self.assert_one({"src/gpu/CMakeLists.txt": "taxelsim_layer(gpu SOURCES a.cpp\n  USES base simulation)\n"}, "gpu must not use simulation")

    def test_header_without_purpose(self):
        self.assert_one({"include/taxelsim/a.h": "#pragma once\n"}, "begins with a comment on its purpose")

    def test_shader_without_comment(self):
        self.assert_one({"shaders/lib/a.glsl": "float f() { return 1; }\n"}, "shaders/lib/a.glsl:1")

    def test_machine_path(self):
        self.assert_one({"src/base/a.h": HEADER + "// see " + "/ho" + "me/somebody/notes\n"}, "a path of one machine")

    def test_a_name_in_too_many_files(self):
        self.assert_one({f"src/base/{name}.cpp": "int edge_confidence;\n" for name in "abcdefghi"}, "edge_confidence stands in 9 files")

    def test_long_file(self):
        self.assert_one({"src/base/a.cpp": "int a;\n" * 401}, "src/base/a.cpp: 401 lines")
        self.assertEqual(self.faults({"src/base/a.cpp": "// Long file: one table.\n" + "int a;\n" * 401}), [])

    def test_long_function(self):
        function = "int sum(int a) {\n" + "  ++a;\n" * 69 + "}\n"
        self.assert_one({"src/base/a.cpp": "\n" + function}, "src/base/a.cpp:2: sum has 71 lines")
        self.assertEqual(self.faults({"src/base/a.cpp": "// Long function: one formula a line.\n" + function}), [])

    def test_a_known_long_file_may_not_grow(self):
        known = {"tests/architecture/still_long.txt": "src/base/a.cpp 410\n"}
        self.assertEqual(self.faults({**known, "src/base/a.cpp": "int a;\n" * 410}), [])
        self.assert_one({**known, "src/base/a.cpp": "int a;\n" * 411}, "411 lines")


if __name__ == "__main__":
    unittest.main()

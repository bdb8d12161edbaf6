#!/usr/bin/env python3
"""Checks the architecture of src/ (docs/notes/architecture.md): includes point down the floors only. Checks the lengths of files and functions as well.

    architecture.py ROOT    prints one line per fault, exits with 1 if there is any
"""

import re
import sys
from pathlib import Path

# Top to bottom. Rooms on one floor must not include each other, except for NEIGHBOURS.
FLOORS = [
    ["cli"],
    ["figures"],
    ["generation", "evaluation", "experiments", "characterize"],
    ["episodes"],
    ["simulation", "reference", "scene"],
    ["gpu", "interop", "sensor", "control", "dataset", "geometry"],
    ["base"],
]
NEIGHBOURS = {("sensor", "geometry")}

# The floor that implements each public header; it and those above may include it. `None`: plain types, for all rooms.
HEADERS = {
    "version.h": None,
    "error.h": None,
    "pose.h": None,
    "sensor.h": None,
    "sensor_hints.h": "sensor",
    "object.h": None,
    "contact_misses.h": None,
    "contact_point.h": None,
    "contact_type.h": None,
    "features.h": None,
    "feature_table.h": None,
    "output_table.h": None,
    "task.h": None,
    "progress.h": None,
    "log.h": None,
    "verdict.h": None,
    "simplification_stop.h": "geometry",
    "skin_variation.h": "sensor",
    "stiffness.h": "sensor",
    "device.h": "gpu",
    "control.h": "control",
    "robot.h": "control",
    "trajectory.h": "control",
    "dataset.h": "dataset",
    "counts_range.h": "dataset",
    "scene.h": "scene",
    "experiment.h": "scene",
    "measurement.h": "scene",
    "characterize.h": "characterize",
    "model.h": "simulation",
    "simulator.h": "simulation",
    "environment.h": "episodes",
    "grasp_environment.h": "episodes",
    "policy.h": "episodes",
    "grasp.h": "scene",
    "generate.h": "generation",
    "evaluate.h": "evaluation",
    "evaluation_part.h": "evaluation",
    "grasp_evaluation.h": "evaluation",
    "characterize.h": "characterize",
    "compare.h": "characterize",
    "cross_validate.h": "characterize",
    "readings.h": "characterize",
}

VULKAN_LAYERS = {"gpu", "simulation"}
# Headers of urdfdom and Orocos KDL, for the room control only.
ROBOT_PARTS = {"kdl", "urdf_model", "urdf_parser", "urdf_world", "console_bridge"}
# Rooms that may include the structs that C++ and GLSL share.
SHARED_LAYERS = {"gpu", "simulation", "reference", "geometry", "sensor"}

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
USES = re.compile(r"taxelsim_layer\s*\(\s*(\w+)(.*?)\)", re.DOTALL)
# Assembled at run time, so that this file passes its own check.
MACHINE_PATH = re.compile("|".join("(?<![\\w.}])/" + name + "/" for name in ("work", "home", "root", "Users")))
SOURCE = {".h", ".cpp", ".comp", ".glsl", ".in"}
TEXT = SOURCE | {".txt", ".cmake", ".py", ".md", ".yaml", ".json", ""}
PATH_CHECKED = ["src", "include", "shaders", "cmake", "scripts", "tests", "bench", "docs", "scenes", ".ci"]

# Lengths. A longer file or function needs a reason in a comment: LONG_FILE, LONG_FUNCTION.
MEASURED = ["src", "include", "shaders", "tests", "bench"]
MEASURED_SUFFIXES = {".h", ".cpp", ".comp", ".glsl", ".py"}
MAX_FILE_LINES = 400
MAX_SHADER_LINES = 150  # of a .comp file: main() and calls
MAX_FUNCTION_LINES = 70
MAX_SHADER_FUNCTION_LINES = 50
# Lists files and functions that are too long, with their lengths. None may grow; remove an entry when its file is short enough.
STILL_LONG = "still_long.txt"
# The whole may not grow either. Lower a number when something has become smaller.
PRODUCT = ["src/**/*", "include/**/*", "shaders/**/*", "python/src/**/*", "python/taxelsim/**/*"]
TESTS = ["tests/**/*", "python/tests/**/*"]
MAX_PRODUCT_LINES = 100838
MAX_TEST_LINES = 66366
MAX_CONTACT_INCLUDES = 35
MAX_CONTACT_CONSTANTS = 39
MAX_MODULES = 44
# A feature, and the most files that may name it: its table, its document, and what computes or shows it.
FEATURE = "edge_confidence"
MAX_FEATURE_FILES = 8
# Names of drivers, for shaders/driver only.
DRIVER = re.compile(r"mesa|lavapipe|swiftshader|software driver|lockstep", re.IGNORECASE)
LONG_FILE = "Long file:"
LONG_FUNCTION = "Long function:"
NO_FUNCTION = re.compile(r"(inline )?namespace\b|extern \"C\"|(typedef |static |inline |constexpr |const )*(struct|class|enum|union)\b|layout\(|.*=\s*\{$")


def floor_of(layer):
    for number, rooms in enumerate(FLOORS):
        if layer in rooms:
            return number
    return None


def may_use(layer, other):
    return layer == other or floor_of(layer) < floor_of(other) or (layer, other) in NEIGHBOURS


def lines_of(path):
    return path.read_text(encoding="utf-8", errors="replace").splitlines()


def includes_of(path):
    for number, line in enumerate(lines_of(path), 1):
        match = INCLUDE.match(line)
        if match:
            yield number, match.group(1) == "<", match.group(2)


def check_include(root, layer, path, number, is_system, name):
    where = f"{path.relative_to(root)}:{number}"
    head, _, rest = name.partition("/")
    if head == "vulkan":
        return [] if layer in VULKAN_LAYERS else [f"{where}: {layer} must not include Vulkan ({name})"]
    if head in ROBOT_PARTS:
        return [] if layer == "control" else [f"{where}: {layer} must not include {name}: only control reads robots"]
    if head == "taxelsim":
        if rest not in HEADERS:
            return [f"{where}: public header {name} is not in the table of tests/architecture/architecture.py"]
        owner = HEADERS[rest]
        if owner and floor_of(layer) > floor_of(owner):
            return [f"{where}: {layer} must not include {name} of the higher floor {owner}"]
        return []
    if is_system:
        return []
    if head == "shared":
        return [] if layer in SHARED_LAYERS else [f"{where}: {layer} must not include the device's structs ({name})"]
    if not rest:
        # Without a folder only what the build generates; files of ours are named by their folder.
        exists = (path.parent / name).exists()
        return [f"{where}: write {layer}/{name}"] if exists else []
    if floor_of(head) is None:
        return []
    if not may_use(layer, head):
        return [f"{where}: {layer} must not include {name}: includes point down the floors only"]
    return []


def check_layers(root):
    faults = []
    for folder in sorted(path for path in (root / "src").iterdir() if path.is_dir()):
        layer = folder.name
        if floor_of(layer) is None:
            faults.append(f"src/{layer}: not on any floor")
            continue
        for path in sorted(folder.rglob("*")):
            if path.suffix in (".h", ".cpp"):
                for number, is_system, name in includes_of(path):
                    faults += check_include(root, layer, path, number, is_system, name)
        lists = folder / "CMakeLists.txt"
        if lists.exists():
            for name, body in USES.findall(lists.read_text()):
                words = body.split()
                used = words[words.index("USES") + 1 :] if "USES" in words else []
                used = used[: next((i for i, word in enumerate(used) if word.isupper()), len(used))]
                for other in used:
                    if floor_of(other) is None or not may_use(name, other):
                        faults.append(f"src/{layer}/CMakeLists.txt: {name} must not use {other}")
    return faults


def check_public_headers(root):
    faults = []
    for path in sorted((root / "include").rglob("*.h")) + sorted((root / "include").rglob("*.h.in")):
        where = path.relative_to(root)
        lines = lines_of(path)
        if not lines or not lines[0].startswith("//"):
            faults.append(f"{where}:1: a public header begins with a comment on its purpose")
        if "#pragma once" not in lines:
            faults.append(f"{where}: no #pragma once")
        for number, is_system, name in includes_of(path):
            if not is_system and not name.startswith("taxelsim/") or "vulkan" in name:
                faults.append(f"{where}:{number}: a public header includes {name}")
    return faults


def check_shader_comments(root):
    faults = []
    for path in sorted((root / "shaders").rglob("*")):
        if path.suffix in (".comp", ".glsl"):
            lines = [line for line in lines_of(path) if line.strip() and not line.startswith(("#version", "#extension"))]
            if not lines or not lines[0].lstrip().startswith(("//", "/*")):
                faults.append(f"{path.relative_to(root)}:1: a shader begins with a comment on what a workgroup and an invocation own")
    return faults


def check_machine_paths(root):
    faults = []
    for top in PATH_CHECKED:
        folder = root / top
        for path in sorted(folder.rglob("*")) if folder.exists() else []:
            if path.is_file() and path.suffix in TEXT and "__pycache__" not in path.parts:
                for number, line in enumerate(lines_of(path), 1):
                    if MACHINE_PATH.search(line):
                        faults.append(f"{path.relative_to(root)}:{number}: a path of one machine: {line.strip()}")
    return faults


def source_files(root):
    for top in MEASURED:
        for path in sorted((root / top).rglob("*")):
            if path.suffix in MEASURED_SUFFIXES and "__pycache__" not in path.parts:
                yield path


def long_functions(lines, most):
    """First line, last line and name of each function of more than `most` lines, in code as clang-format lays it out: a definition
    at namespace level starts in the first column and ends with a brace there."""
    start = None
    for number, line in enumerate(lines, 1):
        if start is None:
            if line.endswith("{") and line[0] not in " #/}" and not NO_FUNCTION.match(line):
                start = number
            elif line.endswith("(") or line.endswith(","):
                # The parameters of a definition may take several lines.
                if line[:1] not in ("", " ", "#", "/", "}") and "(" in line and not NO_FUNCTION.match(line):
                    start = number
        elif line.startswith("}"):
            if number - start + 1 > most:
                yield start, number, lines[start - 1].partition("(")[0].split(" ")[-1]
            start = None
        elif line.endswith(";") and not line.startswith(" "):
            start = None


def still_long(root):
    file = root / "tests" / "architecture" / STILL_LONG
    return {name: int(count) for name, count in (line.rsplit(" ", 1) for line in (lines_of(file) if file.exists() else []))}


def check_lengths(root):
    faults = []
    allowed = still_long(root)
    for path in source_files(root):
        where = path.relative_to(root)
        lines = lines_of(path)
        limit = MAX_SHADER_LINES if path.suffix == ".comp" else MAX_FILE_LINES
        if len(lines) > max(limit, allowed.get(str(where), 0)) and not any(LONG_FILE in line for line in lines[:12]):
            faults.append(f"{where}: {len(lines)} lines, at most {limit}; or say why near the top: \"{LONG_FILE} ...\"")
        if path.suffix == ".py":
            continue
        most = MAX_SHADER_FUNCTION_LINES if path.suffix in (".comp", ".glsl") else MAX_FUNCTION_LINES
        for start, end, name in long_functions(lines, most):
            above = lines[max(0, start - 6) : start]
            if end - start + 1 > allowed.get(f"{where}:{name}", 0) and not any(LONG_FUNCTION in line for line in above):
                faults.append(f"{where}:{start}: {name} has {end - start + 1} lines, at most {most}; or say why above it: \"{LONG_FUNCTION} ...\"")
    return faults


def shader_includes(root, name, seen):
    """Adds the files that a shader includes, in any depth, to `seen`."""
    for _, is_system, included in includes_of(root / "shaders" / name):
        if not is_system and included not in seen and (root / "shaders" / included).exists():
            seen.add(included)
            shader_includes(root, included, seen)


def num_modules(root):
    """SPIR-V modules that shaders/CMakeLists.txt lists: one a call, two for those with a variant, in every round of a foreach."""
    file = root / "shaders" / "CMakeLists.txt"
    text = file.read_text() if file.exists() else ""
    text = re.sub(r"function\(.*?endfunction\(\)", "", text, flags=re.DOTALL)
    count = 0
    for items, body in re.findall(r"foreach\(\w+ (.*?)\)(.*?)endforeach\(\)", text, re.DOTALL):
        names = items.split()
        count += len(names) * calls_of(body)
    return count + calls_of(re.sub(r"foreach\(.*?endforeach\(\)", "", text, flags=re.DOTALL))


def calls_of(text):
    return len(re.findall(r"^\s*taxelsim_shader\(", text, re.MULTILINE)) + 2 * len(re.findall(r"^\s*taxelsim_shader_of_vectors\(", text, re.MULTILINE))


def check_shaders(root):
    """The driver's habits stay in shaders/driver, and the contact pass and the list of modules do not grow."""
    faults = []
    for path in sorted((root / "shaders").rglob("*")):
        if path.suffix in (".comp", ".glsl", ".h") and path.parent.name != "driver":
            for number, line in enumerate(lines_of(path), 1):
                if DRIVER.search(line):
                    faults.append(f"{path.relative_to(root)}:{number}: a driver's name outside of shaders/driver: {line.strip()}")
    includes = set()
    if (root / "shaders" / "contact.comp").exists():
        shader_includes(root, "contact.comp", includes)
    interfaces = [root / "shaders" / "passes" / name for name in ("contact.h", "depth.h")]
    constants = [line for interface in interfaces if interface.exists() for line in lines_of(interface) if line.startswith("CONSTANT(")]
    for what, count, most in (
        ("files that shaders/contact.comp includes", len(includes), MAX_CONTACT_INCLUDES),
        ("constants of shaders/passes/contact.h and depth.h", len(constants), MAX_CONTACT_CONSTANTS),
        ("SPIR-V modules of shaders/CMakeLists.txt", num_modules(root), MAX_MODULES),
    ):
        if count > most:
            faults.append(f"{what}: {count}, at most {most}")
    return faults


def check_sizes(root):
    """Lines of the product and of its tests."""
    faults = []
    for what, globs, most in (("product", PRODUCT, MAX_PRODUCT_LINES), ("tests", TESTS, MAX_TEST_LINES)):
        files = {path for pattern in globs for path in root.glob(pattern) if path.suffix in MEASURED_SUFFIXES and "__pycache__" not in path.parts}
        count = sum(len(lines_of(path)) for path in files)
        if count > most:
            faults.append(f"lines of the {what}: {count}, at most {most}")
    product = {path for pattern in (*PRODUCT, "docs/**/*.md") for path in root.glob(pattern) if path.suffix in MEASURED_SUFFIXES | {".md"}}
    naming = sorted(str(path.relative_to(root)) for path in product if FEATURE in path.read_text(encoding="utf-8"))
    if len(naming) > MAX_FEATURE_FILES:
        faults.append(f"{FEATURE} stands in {len(naming)} files, at most {MAX_FEATURE_FILES}: {', '.join(naming)}")
    return faults


def check(root):
    return check_shaders(root) + check_sizes(root) + check_layers(root) + check_public_headers(root) + check_shader_comments(root) + check_machine_paths(root) + check_lengths(root)


def main():
    faults = check(Path(sys.argv[1]).resolve())
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())

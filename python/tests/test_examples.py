"""The programs in examples/ run, their results are what they claim, and the gallery lists them all."""

import ast
import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml
from PIL import Image

import taxelsim

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES, PICTURES = ROOT / "examples", ROOT / "docs/images/gallery"
NAMES = sorted(file.stem for file in EXAMPLES.glob("*.py"))
MIN_LINES, MAX_LINES = 20, 60
MAX_PICTURE_BYTES, PICTURE_WIDTH = 80_000, 1200
NEEDS = {name: "mujoco" for name in NAMES if name.startswith("mujoco")} | {
    "evaluate_onnx": "onnxruntime",
    "clone_servo": "h5py",
    "newton_worlds": "newton",
}
COMPILED_ONLY = {"gains_with_torch", "train_ppo"}  # the campaign `learn` runs it

# Of each program: arguments after the picture, and a pattern of its output with numbers, each of which lies in a range.
CLAIMS: dict[str, tuple[tuple[str, ...], str, tuple[tuple[float, float], ...]]] = {
    "press_mesh": ((), r"within ([\d.]+) N of each load", ((0, 1e-3),)),
    "slide_and_shear": ((), r"([\d.]+) of the load; friction coefficient ([\d.]+)", ((0.599, 0.601), (0.6, 0.6))),
    "edge_angle": ((), r"median ([\d.]+) degrees", ((0, 3),)),
    "several_objects": ((), r"in (\d+)% .* objects ([\d.]+) mm", ((90, 100), (0, 0.5))),
    "own_sensor": ((), r"(\d+) taxels, .* median ([\d.]+) mm", ((64, 64), (0, 0.5))),  # a fifth of the pitch
    # The pressure under a rigid stamp is that of springs, or rises to the rim of a layer.
    "elastic_layer": (
        (),
        r"springs: ([\d.]+) N; .* rim ([\d.]+) .*\nelastic layer: ([\d.]+) N; .* rim ([\d.]+)",
        ((3.95, 4.05), (0.99, 1.01), (3.8, 4.2), (1.5, 4)),
    ),
    "curved_fingertip": ((), r"median ([\d.]+) degrees", ((0, 1),)),
    "cover_mesh": ((), r"(\d+) taxels; .* off by ([\d.]+) mm in the median", ((300, 450), (0, 2))),  # half a taxel
    "three_axis": ((), r"([\d.]+) degrees from raw counts, ([\d.]+) degrees without", ((2, 8), (0, 1.5))),
    "hand_grasp": ((), r"held: (\d+)% .* ([\d.]+) N", ((100, 100), (0, 0.02))),
    "calibrate_gains": (
        (),
        r"differ by ([\d.]+)% and are found within ([\d.]+)%; .* (\d) of 3 found, (\d) wrong",
        ((10, 40), (0, 4), (3, 3), (0, 0)),
    ),
    "pose_from_image": ((), r"found from (\d+) of 128 guesses; median error ([\d.]+) um", ((100, 128), (0, 1))),
    "gains_from_images": ((), r"gains by ([\d.]+) %, places by ([\d.]+) um now", ((0, 1), (0, 20))),  # of 13 %, 821 um
    "resume_and_verify": ((), r"after (\d+) of 64 episodes; (\d+) files are the same\ndamaged: .*SHA-256", ((16, 63), (6, 20))),
    "classify_images": (("1500",), r"([\d.]+)% of 1024 new images right", ((60, 100),)),  # chance: 16.7 %
    "clone_servo": (("300", "100"), r"clone +success in +([\d.]+)% .*\nprincipal_axis success in +([\d.]+)%", ((20, 100), (50, 100))),
    "evaluate_onnx": ((), r"tracker +([\d.]+)%", ((30, 100),)),
    "mujoco_batch": ((), r"edge angle ([\d.]+) degrees", ((0, 3),)),
    "mujoco_weigh": ((), r"error of the weight ([\d.]+) %", ((0, 0.5),)),
    # The least grip force is 0.981 N / (2 * 0.6) = 0.82 N.
    "mujoco_gripper": ((), r"from a grip force of ([\d.]+) N .* skins ([\d.]+) N", ((0.9, 0.9), (0.97, 0.99))),
    "contact_points": ((), r"pressure ([\d.]+) mm.* force ([\d.]+) N", ((0, 1.7), (0, 1e-3))),  # half a taxel
    "newton_worlds": ((), r"error of the angle ([\d.]+) degrees", ((0, 3),)),
    "other_engine": ((), r"([\d.]+) mm by poses, ([\d.]+) mm by contact points", ((0, 0.3), (0, 1.7))),
}


def run(name: str, picture: Path, *arguments: str, timeout: float = 120) -> str:
    package = Path(taxelsim.__file__).parents[1]
    # The package under test, whatever else is installed.
    argv = [str(EXAMPLES / f"{name}.py"), str(picture), *arguments]
    setup = f"import sys, runpy; sys.path.insert(0, {str(package)!r}); sys.argv = {argv!r}"
    command = [sys.executable, "-c", f"{setup}; runpy.run_path(sys.argv[0], run_name='__main__')"]
    environment = {**os.environ, "MPLBACKEND": "Agg"}
    finished = subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False, env=environment)
    assert finished.returncode == 0, finished.stderr
    return finished.stdout


@pytest.mark.parametrize("name", sorted(set(NAMES) - COMPILED_ONLY))
def test_runs_and_claims_what_it_prints(name: str, tmp_path: Path) -> None:
    pytest.importorskip(NEEDS.get(name, "matplotlib"))
    arguments, pattern, ranges = CLAIMS[name]
    with_genesis = name == "other_engine" and importlib.util.find_spec("genesis") is not None
    compiles = with_genesis or name == "newton_worlds"  # for minutes at first
    text = run(name, tmp_path / "picture.png", *arguments, timeout=600 if compiles else 120)
    found = re.search(pattern, text)
    assert found, text
    for number, (low, high) in zip(map(float, found.groups()), ranges, strict=True):
        assert low <= number <= high, text
    with Image.open(tmp_path / "picture.png") as picture:
        drawn = np.asarray(picture.convert("L"))
    assert drawn.shape[1] == PICTURE_WIDTH
    assert drawn.std() > 20, "an empty picture"
    for file in tmp_path.glob("*.yaml"):
        assert taxelsim.load_sensor(file).name == name


@pytest.mark.parametrize("name", sorted(COMPILED_ONLY))
def test_compiles(name: str) -> None:
    compile((EXAMPLES / f"{name}.py").read_text(), name, "exec")


def test_the_gallery_lists_every_program_once() -> None:
    lines = re.findall(r"^examples = (\[.*\])$", (EXAMPLES / "gallery.toml").read_text(), re.MULTILINE)
    assert sorted(name for line in lines for name in yaml.safe_load(line)) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_form_of_a_program(name: str) -> None:
    source = (EXAMPLES / f"{name}.py").read_text()
    assert MIN_LINES <= source.count("\n") <= MAX_LINES
    document = ast.get_docstring(ast.parse(source))
    assert document is not None
    title, paragraph, command, *_ = document.split("\n\n")
    assert "\n" not in title
    assert title.endswith(".")
    assert "Prints" in paragraph
    assert command.startswith(f"python3 examples/{name}.py [")
    file = PICTURES / f"{name}.png"
    assert file.stat().st_size <= MAX_PICTURE_BYTES
    with Image.open(file) as picture:
        assert picture.width == PICTURE_WIDTH

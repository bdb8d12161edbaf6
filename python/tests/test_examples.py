"""The programs in examples/ run, and their results are what they claim. The training example is only compiled."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest

import taxelsim

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def run(name: str, *arguments: object, timeout: float = 120) -> str:
    package = Path(taxelsim.__file__).parents[1]
    # The package under test, whatever else is installed.
    setup = f"import sys, runpy; sys.path.insert(0, {str(package)!r}); sys.argv = {[str(EXAMPLES / name), *map(str, arguments)]!r}"
    command = [sys.executable, "-c", f"{setup}; runpy.run_path(sys.argv[0], run_name='__main__')"]
    finished = subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False)
    assert finished.returncode == 0, finished.stderr
    return finished.stdout


def percentages(text: str) -> list[float]:
    return [float(number) for number in re.findall(r"([\d.]+)%", text)]


def test_press_mesh() -> None:
    assert "sum of the true forces: 5.000 N" in run("press_mesh.py")


def test_own_sensor(tmp_path: Path) -> None:
    text = run("own_sensor.py", tmp_path / "own.yaml")
    assert "64 taxels" in text
    assert taxelsim.load_sensor(tmp_path / "own.yaml").name == "own_sensor"
    found = re.search(r"median ([\d.]+) mm", text)
    assert found
    assert float(found.group(1)) < 0.5  # a fifth of the pitch


def test_pose_from_image() -> None:
    found = re.search(r"found from (\d+) of 128 guesses", run("pose_from_image.py"))
    assert found
    assert int(found.group(1)) > 100


def test_gains_from_images() -> None:
    found = re.findall(r"off at first, ([\d.]+) (?:%|um) now", run("gains_from_images.py"))
    gains, places = map(float, found)
    assert gains < 1  # of 13 %
    assert places < 20  # of 821 um


def test_classify_images() -> None:
    right, chance = percentages(run("classify_images.py", 1500).splitlines()[-1])
    assert right > 3 * chance


def test_clone_servo() -> None:
    pytest.importorskip("h5py")
    clone, servo = percentages(run("clone_servo.py", 300, 100))
    assert servo > 50
    assert clone > servo / 4


def test_evaluate_onnx(tmp_path: Path) -> None:
    pytest.importorskip("onnx")
    pytest.importorskip("onnxruntime")
    text = run("evaluate_onnx.py")
    assert text.split()[0] == "tracker"
    assert percentages(text)[0] > 30


def test_mujoco_batch() -> None:
    pytest.importorskip("mujoco")
    text = run("mujoco_batch.py")
    found = re.search(r"median error of the edge angle ([\d.]+) degrees", text)
    assert found
    assert float(found.group(1)) < 3


def test_mujoco_weigh() -> None:
    pytest.importorskip("mujoco")
    found = re.search(r"largest error of the weight ([\d.]+) %", run("mujoco_weigh.py"))
    assert found
    assert float(found.group(1)) < 0.5


def check_other_engine(text: str, engine: str) -> None:
    assert text.startswith(f"engine: {engine}")
    found = re.search(r"along y: ([\d.]+) mm by poses, ([\d.]+) mm by contact points", text)
    assert found
    by_pose, by_contact = map(float, found.groups())
    assert by_pose < 0.3
    assert by_contact < 1.7  # half a taxel: one point on one taxel, paper eq. (2)


def test_other_engine() -> None:
    arguments = ["--stand-in"] if importlib.util.find_spec("genesis") else []
    check_other_engine(run("other_engine.py", *arguments), "stand-in")


def test_other_engine_with_genesis() -> None:
    if importlib.util.find_spec("genesis") is None:
        pytest.skip("Genesis World is not installed")
    check_other_engine(run("other_engine.py", timeout=600), "Genesis World")  # minutes of compilation at the first run


def test_train_ppo_compiles() -> None:
    source = (EXAMPLES / "train_ppo.py").read_text()
    compile(source, "train_ppo.py", "exec")

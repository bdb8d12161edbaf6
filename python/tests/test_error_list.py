"""Every error of the list is what taxelsim says, and its example is a message of its kind."""

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import taxelsim
from taxelsim.error_list import ERRORS, KnownError, known_error

ROOT = Path(__file__).resolve().parents[2]
SENSOR = taxelsim.SCENES / "sensors/wts0614.yaml"
IDENTITY = [0, 0, 0.0095, 1, 0, 0, 0]
# Messages that need a broken device: the campaign `faults` provokes them, here their words are looked for in the sources.
BY_FAULTS = {"The device has no memory left": "the device has no memory for buffer", "The device was lost": "the device was lost during "}


@pytest.fixture(scope="module")
def simulator() -> taxelsim.Simulator:
    model = taxelsim.Model(taxelsim.Device.open(), taxelsim.load_sensor(SENSOR), [taxelsim.Sphere(0.01)])
    return taxelsim.Simulator(model, 4)


def scene_text(old: str, new: str) -> str:
    text = (taxelsim.SCENES / "labelled_contacts.yaml").read_text().replace("sensors/", f"{taxelsim.SCENES}/sensors/")
    text = text.replace("objects/", f"{taxelsim.SCENES}/objects/")
    assert re.search(old, text, re.MULTILINE)
    return re.sub(old, new, text, count=1, flags=re.MULTILINE)


def loading(text: str) -> Callable[[Path], object]:
    def load(folder: Path) -> object:
        (folder / "scene.yaml").write_text(text)
        return taxelsim.load_scene(folder / "scene.yaml")

    return load


def program(*words: object, **environment: str) -> None:
    """Runs the program, and raises what Python would."""
    done = subprocess.run(
        [sys.executable, "-m", "taxelsim", *map(str, words)], capture_output=True, text=True, env={**os.environ, **environment}, check=False
    )
    if done.returncode:
        message = done.stderr.strip().splitlines()[-1].removeprefix("taxelsim: ")
        raise (taxelsim.InputError if done.returncode == 2 else taxelsim.DeviceError)(message)


def mesh(folder: Path) -> object:
    (folder / "part.obj").write_text("v 0 0 0\nf 1 2 9\n")
    return taxelsim.load_mesh(folder / "part.obj")


def small_set(folder: Path) -> taxelsim.Dataset:
    if not (folder / "out").exists():
        taxelsim.generate(taxelsim.load_scene(taxelsim.SCENES / "labelled_contacts.yaml", num_episodes=2), folder / "out")
    return taxelsim.Dataset(folder / "out")


def changed_shard(folder: Path) -> object:
    small_set(folder)
    with (folder / "out/shard-000000.h5").open("r+b") as file:
        file.seek(3000)
        file.write(b"xx")
    return taxelsim.Dataset(folder / "out")["data/tactile_image"][:]


def other_scene(folder: Path) -> object:
    small_set(folder)
    return taxelsim.generate(taxelsim.load_scene(taxelsim.SCENES / "edge_servo.yaml", num_episodes=2), folder / "out")


def forked(simulator: taxelsim.Simulator) -> None:
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            simulator.step(0.01)
        except taxelsim.DeviceError as error:
            os.write(writing, str(error).encode())
        os._exit(0)
    os.waitpid(child, 0)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        raise taxelsim.DeviceError(pipe.read())


frame = ("frame", "--sensor", SENSOR)
PROVOKE: dict[str, Callable[[Path, taxelsim.Simulator], object]] = {
    "A value is not allowed": lambda folder, _: loading(scene_text(r"load: .*", "load: -1"))(folder),
    "A key is unknown": lambda folder, _: loading(scene_text(r"^name:", "nam:"))(folder),
    "A key is missing": lambda folder, _: loading("format_version: 1\nname: x\nkind: servo\n")(folder),
    "A file is not YAML": lambda folder, _: loading("a: [1\n")(folder),
    "A file belongs to a newer version": lambda folder, _: loading("format_version: 9\nname: x\n")(folder),
    "A file does not exist": lambda folder, _: taxelsim.load_scene(folder / "none.yaml"),
    "A mesh cannot be read": lambda folder, _: mesh(folder),
    "An object is neither a shape nor a file": lambda _, simulator: taxelsim.Model(
        taxelsim.Device.open(), taxelsim.load_sensor(SENSOR), ["blob:1"]
    ),
    "A load is out of reach": lambda *_: program(*frame, "--object", "sphere:0.01", "--load", 1e5),
    "A quaternion is not a rotation": lambda _, simulator: simulator.set_objects(0, np.zeros((4, 7))),
    "An array has another shape": lambda _, simulator: simulator.set_objects(0, np.zeros((3, 7))),
    "A number is not finite": lambda _, simulator: simulator.set_objects(0, np.tile([np.nan, *IDENTITY[1:]], (4, 1))),
    "An argument is unknown": lambda *_: taxelsim.Sphere(radiu=1),  # type: ignore[call-arg]
    "An output was not requested": lambda _, simulator: simulator.vjp(np.zeros((4, 6, 14))),
    "There is no Vulkan device": lambda *_: program(*frame, "--object", "sphere:0.01", "--load", 1, VK_ICD_FILENAMES="/nonexistent"),
    "No device has this name": lambda *_: taxelsim.Device.open("nosuch"),
    "A batch does not fit": lambda _, simulator: taxelsim.Simulator(simulator.model, 10**9),
    "A device does not survive fork()": lambda _, simulator: forked(simulator),
    "A shard was changed": lambda folder, _: changed_shard(folder),
    "A folder holds another data set": lambda folder, _: other_scene(folder),
    "A folder is no data set": lambda folder, _: taxelsim.Dataset(folder),
    "A column is not there": lambda folder, _: small_set(folder)["data/nosuch"],
    "An index is outside": lambda folder, _: small_set(folder).episode(99),
    "The file system refused": lambda folder, _: taxelsim.pictures.save_png(folder / "none/x.png", np.zeros((2, 2, 3), np.uint8)),
}


@pytest.mark.parametrize("error", [error for error in ERRORS if error.title not in BY_FAULTS], ids=lambda error: error.title)
def test_each_error_is_what_taxelsim_says(error: KnownError, tmp_path: Path, simulator: taxelsim.Simulator) -> None:
    with pytest.raises(error.raised) as raised:
        PROVOKE[error.title](tmp_path, simulator)
    message = str(raised.value)
    assert re.search(error.pattern, message), message
    assert "\n" not in message
    assert known_error(message) is error


def test_errors_of_broken_devices_are_in_the_sources() -> None:
    sources = "".join(file.read_text() for file in (ROOT / "src/gpu").glob("*.cpp"))
    for words in BY_FAULTS.values():
        assert words in sources


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: error.title)
def test_examples_are_messages_of_their_kind(error: KnownError) -> None:
    shown = error.example.replace("...,", "0" * 56 + ",").replace("... as", "0" * 56 + " as")
    assert re.search(error.pattern, shown)
    assert error.cause.endswith(".")
    assert error.remedy.endswith(".")

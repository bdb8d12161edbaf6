"""Random sensors, objects and steps: every bit of every output of the fast paths compared with the plain path.

    PYTHONPATH=build/release/python:bench/python build/venv/bin/python tests/differential/compare_paths.py [--scenes 100] [--first 0]

Objects slide, jump, leave and come back; some press with loads, and some instances begin new episodes. Prints the outputs that differ, by
scene and step, and exits with 1 if there are any. The path for polyhedra is on in both: its heights agree within rounding only. A number
gives the same scene on every machine.
"""

import argparse
import json
import os
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from report import lowest_height

import taxelsim
from taxelsim.errors import Error

PLAIN = "kinds,sequences,untouched,candidates,lockstep,alone"
MESHES = Path(__file__).parents[2] / "scenes" / "objects"
SOLIDS = (
    "sphere:0.01",
    "sphere:0.004",
    "cylinder:0.008,0.03",
    "capsule:0.005,0.02",
    "box:0.02,0.03,0.01",
    "cone:0.01,0.02",
    "torus:0.012,0.004",
)
OBJECTS = (*SOLIDS, *(str(MESHES / name) for name in ("hex_prism.obj", "cross.obj", "knob_5k.obj", "edge_bar.obj")))
SPRINGS = ("winkler", "winkler", "winkler", "mass_spring_damper", "deformation_mask", "proximity", "lugre")
LAWS = (*SPRINGS, "elastic_layer")
NUM_STEPS = 7
STEP = 0.01  # s


@dataclass(frozen=True)
class Step:
    """Inputs of a step."""

    ids: NDArray[np.int32]  # (N, S)
    poses: NDArray[np.float64]  # (N, S, 7)
    loads: NDArray[np.float32]  # (N,), N
    driven_by_load: NDArray[np.bool_]  # (N,)
    resets: NDArray[np.int32]


@dataclass(frozen=True)
class Scene:
    """A sensor, its options and its steps."""

    sensor: dict[str, Any]
    objects: list[str]
    outputs: taxelsim.OutputOptions
    max_regions: int
    steps: list[Step]

    def describe(self) -> str:
        """A line."""
        skin, (num_instances, num_slots) = self.sensor["skin"], self.steps[0].ids.shape
        options = [key for key in ("friction_coefficient", "relaxation", "normal_damping", "normal_exponent") if key in skin]
        law, objects = " + ".join([skin["law"], *options]), ", ".join(Path(name).name for name in self.objects)
        return f"{law}, {self.sensor['depth_sampling']}, {objects}, {num_instances} instances, {num_slots} slots"


class Draws:
    """Random choices."""

    def __init__(self, number: int) -> None:
        self.random = np.random.default_rng(number)

    def one(self, *values: Any) -> Any:
        """One of the values."""
        return values[self.random.integers(len(values))]

    def happens(self, probability: float) -> bool:
        """True with this probability."""
        return bool(self.random.random() < probability)


def random_skin(draws: Draws) -> dict[str, Any]:
    """A contact law with some of its options."""
    law = draws.one(*LAWS)
    skin: dict[str, Any] = {"thickness_mm": 2, "law": law}
    if law == "proximity":
        skin["sensitivity"] = 1e8
    elif law == "elastic_layer":
        skin |= {"elastic_modulus": 5e5, "poisson_ratio": 0.45, "base": draws.one("bonded", "half_space")}
        skin |= {"margin_mm": draws.one(0, 4), "iterations": draws.one(5, 20)}
    else:
        skin["normal_contact_stiffness"] = 1.5e8
    if law in ("winkler", "elastic_layer") and draws.happens(0.25):
        skin["relaxation"] = [{"fraction": 0.3, "time": 0.05}, {"fraction": 0.2, "time": 0.5}][: draws.one(1, 2)]
    elif law == "winkler" and draws.happens(0.3):
        skin["normal_damping"] = 2e4
    if law == "winkler" and draws.happens(0.25):
        skin["normal_exponent"] = 1.5
    if law in ("winkler", "mass_spring_damper", "elastic_layer") and draws.happens(0.4):
        skin |= {"friction_coefficient": 0.6, "tangential_stiffness": 1e8}
    return skin


def random_sensor(draws: Draws) -> dict[str, Any]:
    """One grid of one or several tiles, or several patches."""
    skin = random_skin(draws)
    coupled = skin["law"] == "elastic_layer"
    rows, cols = draws.one((6, 14), (3, 5), (5, 8)) if coupled else draws.one((6, 14), (3, 5), (1, 9), (12, 12), (20, 33), (40, 40))
    sensor: dict[str, Any] = {"format_version": 1, "name": "random", "skin": skin}
    if not coupled and draws.happens(0.3):
        sensor["patches"] = [
            {"num_rows": rows // 2 + 1, "num_cols": cols // 2 + 1, "pitch_mm": 3.4, "pose": {"position": [0.012 * n - 0.01, 0, 0]}}
            for n in range(draws.one(2, 3))
        ]
    else:
        sensor |= {"num_rows": rows, "num_cols": cols, "pitch_mm": 3.4}
    sensor["samples_per_taxel"] = draws.one(2, 3) if coupled else draws.one(1, 2, 3, 4, 4, 5)
    sensor["depth_sampling"] = draws.one("point", "area")
    if draws.happens(0.6):
        gaussian = {"sigma": draws.one(0.5, 1.5), "size": draws.one(3, 5, 9)}
        sensor["psf"] = {"gaussian": gaussian, "normalization": draws.one("per_source", "none")}
    readout: dict[str, Any] = {"curve": {"counts_per_newton": 2400}, "trigger": 0.01, "adc_bits": 12}
    if draws.happens(0.3):
        readout["noise"] = 3
    if draws.happens(0.2):
        readout |= {"hysteresis_strength": 0.1, "hysteresis_width": 0.01, "low_pass_time": 0.01}
    if draws.happens(0.15):
        readout["delay"] = 2 * STEP
    if draws.happens(0.1):
        sensor["frame_rate"] = 60
    return {**sensor, "readout": readout}


def random_outputs(draws: Draws) -> taxelsim.OutputOptions:
    """Some of the outputs."""
    likely = dict.fromkeys(("tactile_normal_force", "tactile_shear_force", "penetration_depth"), 0.7)
    rare = dict.fromkeys(("contact_features", "clean_contact_features", "tactile_jacobian", "clean_tactile_jacobian"), 0.2)
    return taxelsim.OutputOptions(**{name: draws.happens(probability) for name, probability in {**likely, **rare}.items()})


def random_pose(draws: Draws, shape: taxelsim.Object) -> NDArray[np.float64]:
    """Over the middle of the array, from 0.5 mm above the skin to 1.3 mm deep."""
    rotation = draws.random.normal(size=4) * (1, draws.one(0, 1), draws.one(0, 1), 1)
    rotation /= np.linalg.norm(rotation)
    x, y = draws.random.uniform(-0.03, 0.03, 2)
    return np.array([x, y, -lowest_height(shape, list(rotation)) - draws.random.uniform(-5e-4, 1.3e-3), *rotation])


def random_steps(draws: Draws, shapes: list[taxelsim.Object], law: str) -> Iterator[Step]:
    """Objects of all instances slide, jump, leave and come back."""
    num_instances, num_slots = draws.one(3, 7, 40, 300), draws.one(1, 1, 1, 2)
    loaded = law != "proximity" and draws.happens(0.35)
    ids = np.zeros((num_instances, num_slots), np.int32)
    poses = np.zeros((num_instances, num_slots, 7))
    for n in range(NUM_STEPS):
        for place in np.ndindex(ids.shape):
            if n == 0 or draws.happens(0.35):
                ids[place] = draws.random.integers(len(shapes))
                poses[place] = random_pose(draws, shapes[ids[place]])
            else:
                poses[place][:3] += draws.random.normal(size=3) * (3e-4, 3e-4, 1e-4)
        there = np.where(draws.random.random(ids.shape) < 0.1, -1, ids).astype(np.int32)
        driven = draws.random.random(num_instances) < (0.7 if loaded and draws.happens(0.8) else 0)
        resets = np.flatnonzero(draws.random.random(num_instances) < (0.15 if draws.happens(0.4) else 0)).astype(np.int32)
        yield Step(there, poses.copy(), draws.random.uniform(0, 3, num_instances).astype(np.float32), driven, resets)


def random_scene(number: int) -> Scene:
    """The scene of this number."""
    draws = Draws(number)
    sensor = random_sensor(draws)
    law = sensor["skin"]["law"]
    objects = [OBJECTS[k] for k in draws.random.choice(len(OBJECTS), draws.one(1, 1, 1, 2, 3), replace=False)]
    outputs = random_outputs(draws)
    max_regions = draws.one(0, 4) if outputs.contact_features or outputs.clean_contact_features else 0
    return Scene(sensor, objects, outputs, max_regions, list(random_steps(draws, [taxelsim.parse_object(name) for name in objects], law)))


def outputs_of(groups: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, NDArray[Any]]]:
    """All arrays of a frame's groups by name, copied."""
    for name, value in groups.items():
        if isinstance(value, dict):
            yield from outputs_of(value, f"{prefix}{name}.")
        else:
            yield prefix + name, np.array(value)


def frames_of(device: taxelsim.Device, scene: Scene, plain: str) -> list[dict[str, NDArray[Any]]]:
    """The outputs of each step. `plain`: fast paths that are off."""
    os.environ["TAXELSIM_PLAIN"] = plain
    with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
        json.dump(scene.sensor, file)
        file.flush()
        sensor = taxelsim.load_sensor(file.name)
    model = taxelsim.Model(device, sensor, [taxelsim.parse_object(name) for name in scene.objects])
    num_instances, num_slots = scene.steps[0].ids.shape
    simulator = taxelsim.Simulator(model, num_instances, num_slots=num_slots, outputs=scene.outputs, max_regions=scene.max_regions)
    frames = []
    for step in scene.steps:
        if len(step.resets):
            simulator.reset(step.resets)
        simulator.set_objects(step.ids, step.poses) if num_slots > 1 else simulator.set_objects(step.ids[:, 0], step.poses[:, 0])
        simulator.set_loads(step.loads, where=step.driven_by_load) if step.driven_by_load.any() else simulator.set_loads(None)
        simulator.step(STEP)
        frames.append(dict(outputs_of(simulator.read().as_dict())))
    return frames


def attempt(device: taxelsim.Device, scene: Scene, plain: str) -> tuple[list[dict[str, NDArray[Any]]], str]:
    """frames_of(), or why the scene is refused."""
    try:
        return frames_of(device, scene, plain), ""
    except Error as error:  # samples too far apart for a layer, or more iterations than the driver allows
        return [], str(error)


def differences(plain_frames: list[dict[str, NDArray[Any]]], fast_frames: list[dict[str, NDArray[Any]]]) -> Iterator[str]:
    """Outputs that differ, or are not finite."""
    for n, (plain, fast) in enumerate(zip(plain_frames, fast_frames, strict=True)):
        for name, values in plain.items():
            if values.tobytes() != fast[name].tobytes():
                instances = np.flatnonzero((values != fast[name]).reshape(len(values), -1).any(axis=1))
                yield f"step {n}, {name}, instances {instances[:5].tolist()}"
            if not np.isfinite(values.astype(np.float64)).all():
                yield f"step {n}, {name}: not finite"


def main() -> None:
    """Compares the scenes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=100)
    parser.add_argument("--first", type=int, default=0, help="number of the first scene")
    options = parser.parse_args()
    device = taxelsim.Device.open()
    num_different = num_refused = 0
    for number in range(options.first, options.first + options.scenes):
        scene = random_scene(number)
        (plain, plain_error), (fast, fast_error) = attempt(device, scene, PLAIN), attempt(device, scene, "")
        found = [f"plain: {plain_error}; fast: {fast_error}"] if bool(plain_error) != bool(fast_error) else list(differences(plain, fast))
        num_refused += plain_error != "" and fast_error != ""
        num_different += bool(found)
        print(f"{number}: {scene.describe()}: {'; '.join(found[:8]) or plain_error or 'same bits'}", flush=True)
    print(f"{options.scenes} scenes: {num_different} differ, {num_refused} refused")
    sys.exit(num_different > 0 or num_refused > options.scenes // 4)


if __name__ == "__main__":
    main()

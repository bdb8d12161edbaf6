"""Fixtures: a scene of short episodes, and vector environments of it."""

from pathlib import Path

import numpy as np
import pytest

import taxelsim
from taxelsim.envs import TactileVectorEnv
from taxelsim.policies.observations import SENSOR_OBSERVATIONS

NUM_STEPS = 12  # of an episode of the scene below

OF_ANY_SENSOR = (*(name for name in SENSOR_OBSERVATIONS if name != "taxel_counts"), "proprioception")
"""Observations that need neither three-axis taxels nor joints."""

RECORD = "tactile_image, poses, actions"

SCENE = """
format_version: 1
name: short
kind: servo
sensor: {sensor}
{robot}objects:
  - {{name: bar, cylinder: {{radius_mm: 4, length_mm: 100}}, orientation: {{rpy_deg: [90, 0, 0]}}, edge: [0, 0, 1]}}
episode: {{num_steps: {num_frames}, simulation_rate: {rate}, control_rate: 100}}
randomization:
  x_mm: [-2, 2]
  y_mm: [-2, 2]
  yaw_deg: [-30, 30]
  load: [1, 3]
  gain: [0.8, 1.2]
  noise: [0, 20]
controllers:
  - name: servo
    tactile_servo:
      edge_angle: {{reference_deg: 90, kp: 4}}
      total_force: {{kp: 10}}
      max_linear_velocity_mm: 40
task:
  edge_angle: {{reference_deg: 90, tolerance_deg: 20}}
  total_force: {{tolerance: 1}}
  hold: 0.05
  travel_mm: {travel}
record: [{record}]
data_set: {{episodes: 24, seed: 5}}
"""


def write_scene(
    folder: Path, *, rate: int = 100, num_frames: int | None = None, travel: float = 0, robot: str = "", record: str = RECORD
) -> Path:
    """robot: value of the key `robot`; default: a free-flying sensor."""
    file = folder / "short.yaml"
    sensor = taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml"
    num_frames = num_frames or NUM_STEPS * rate // 100 + 1
    text = SCENE.format(
        sensor=sensor.resolve(), num_frames=num_frames, rate=rate, travel=travel, robot=robot and f"robot: {robot}\n", record=record
    )
    file.write_text(text if travel else text.replace("  travel_mm: 0\n", ""))
    return file


@pytest.fixture(scope="session")
def scene(tmp_path_factory: pytest.TempPathFactory) -> taxelsim.Scene:
    return taxelsim.load_scene(write_scene(tmp_path_factory.mktemp("scene")))


PAN_TILT = "{pan_tilt: {position_step_deg: 0}}"  # joints pan and tilt, without quantisation


@pytest.fixture(scope="session")
def pan_tilt_scene(tmp_path_factory: pytest.TempPathFactory) -> taxelsim.Scene:
    return taxelsim.load_scene(write_scene(tmp_path_factory.mktemp("pan_tilt"), robot=PAN_TILT))


@pytest.fixture
def make(device: taxelsim.Device, scene: taxelsim.Scene):
    """Makes a vector environment of the scene."""

    def make(num_envs: int, **arguments) -> TactileVectorEnv:
        return TactileVectorEnv(scene, num_envs, device=device, **arguments)

    return make


def actions_of(step: int, num_envs: int, num_actions: int = 6) -> np.ndarray:
    """Actions that differ by step and environment, and do not depend on num_envs."""
    k, i, a = np.ogrid[step : step + 1, :num_envs, :num_actions]
    return (0.3 * np.sin(1.7 * k + 2.3 * i + 0.9 * a))[0].astype(np.float32)

"""One side of mujoco_tactile.py: verifies one simulator, times it and measures its memory, in a process of its own. Prints JSON.

python tactile_peer.py JOB.json; the keys are those of Job.
"""

from __future__ import annotations

import json
import sys
import time
from abc import ABC, abstractmethod
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Images = NDArray[np.float64]

STEP = 0.001  # s
AWAY = 0.1  # m, height without contact
PAD_HEIGHT = 0.01  # m, more than any penetration


@dataclass(frozen=True)
class Job:
    """What to compute."""

    peer: str  #: taxelsim, mujoco_forward or mujoco_step.
    points: int  #: Points per taxel and side.
    num_envs: int
    seconds: float  #: Least time to measure.
    object: dict[str, Any]  #: {"radius", "length"}, m: a cylinder along its z; or {"file"}: a mesh, m.
    sensor: str  #: Sensor file of taxelsim with `points` samples per side.
    grid: tuple[int, int, float]  #: Rows, columns, pitch (m).
    poses: str  #: NPY file (K, 7): positions (m) and quaternions (w, x, y, z) of the object in the sensor frame.
    images: str  #: NPY file to write: depths of the first K environments, (K, rows, columns), m.


class Peer(ABC):
    """A batch of arrays, each with one object."""

    @abstractmethod
    def step(self, poses: NDArray[np.float64]) -> None:
        """Moves the objects to `poses` (num_envs, 7) and computes all frames."""

    @abstractmethod
    def depths(self) -> Images:
        """(num_envs, rows, columns): mean depth of the points of each taxel in the last frame, m."""


class TaxelsimPeer(Peer):
    """The frame: depths, forces, point spread, counts, features."""

    def __init__(self, job: Job) -> None:
        import taxelsim

        text = "cylinder:{radius},{length}".format(**job.object) if "radius" in job.object else job.object["file"]
        model = taxelsim.Model(taxelsim.Device.open(), taxelsim.load_sensor(job.sensor), [taxelsim.parse_object(text)])
        self.simulator = taxelsim.Simulator(model, job.num_envs)
        self.simulator.prepare()
        self.what = f"taxelsim {taxelsim.__version__}"

    def step(self, poses: NDArray[np.float64]) -> None:
        self.simulator.set_objects(0, poses)
        self.simulator.step(STEP)
        self.simulator.read()

    def depths(self) -> Images:
        return np.asarray(self.simulator.read().ground_truth.penetration_depth, np.float64)


class MujocoPeer(Peer):
    """mujoco.batch.Batch with the sensor `tactile`: depth and sliding speed at points of the skin.

    mujoco_forward: kinematics, collision and sensor at the poses. mujoco_step: a time step, then the sensor at the new state.
    """

    def __init__(self, job: Job) -> None:
        import mujoco
        from mujoco.batch import Batch

        files = {"skin.obj": skin_mesh(*job.grid, job.points).encode()}
        if "file" in job.object:
            files["object.obj"] = Path(job.object["file"]).read_bytes()
        model = mujoco.MjModel.from_xml_string(model_text(job), files)
        self.grid, self.points, self.takes_steps = job.grid, job.points, job.peer == "mujoco_step"
        self.stage = int(model.sensor_needstage[0])
        self.batch = Batch(model, job.num_envs)
        self.positions, self.velocities = self.batch.bind("qpos"), self.batch.bind("qvel")
        self.data = self.batch.bind("sensordata")
        self.what = f"MuJoCo {mujoco.__version__}"

    def step(self, poses: NDArray[np.float64]) -> None:
        self.positions[:] = poses
        self.velocities[:] = 0
        if self.takes_steps:
            self.batch.step(stage=self.stage)
        else:
            self.batch.forward(stage=self.stage)

    def depths(self) -> Images:
        rows, cols, _ = self.grid
        n = self.points
        depth = np.maximum(self.data[:, : rows * cols * n * n], 0)  # the two speeds follow
        return np.asarray(depth.reshape(-1, rows, n, cols, n).mean(axis=(2, 4)))


def skin_mesh(num_rows: int, num_cols: int, pitch: float, points: int) -> str:
    """OBJ text of the skin: `points` x `points` vertices per taxel, in the order of the taxels' samples."""
    rows, cols = num_rows * points, num_cols * points
    lines = [
        f"v {(i - (rows - 1) / 2) * pitch / points:.9g} {(j - (cols - 1) / 2) * pitch / points:.9g} 0"
        for i in range(rows)
        for j in range(cols)
    ]
    for i in range(rows - 1):
        for j in range(cols - 1):
            a, b = i * cols + j + 1, (i + 1) * cols + j + 1
            lines += [f"f {a} {b} {a + 1}", f"f {b} {b + 1} {a + 1}"]
    return "\n".join(lines) + "\n"


def model_text(job: Job) -> str:
    """MJCF. The pad is a box: its contacts select the objects that the sensor evaluates. The skin on it does not collide.

    A mesh collides by its convex hull; a second geom without collision gives it the distance field.
    """
    rows, cols, pitch = job.grid
    if "file" in job.object:
        asset = '<mesh name="object" file="object.obj"/>'
        geoms = '<geom type="mesh" mesh="object"/><geom type="sdf" mesh="object" contype="0" conaffinity="0"/>'
    else:
        asset, geoms = "", f'<geom type="cylinder" size="{job.object["radius"]} {job.object["length"] / 2}"/>'
    return f"""<mujoco>
  <option timestep="{STEP}" gravity="0 0 0"/>
  <asset><mesh name="skin" file="skin.obj" inertia="shell"/>{asset}</asset>
  <worldbody>
    <body name="pad">
      <geom type="box" pos="0 0 {-PAD_HEIGHT / 2}" size="{rows * pitch / 2} {cols * pitch / 2} {PAD_HEIGHT / 2}"/>
      <geom name="skin" type="mesh" mesh="skin" contype="0" conaffinity="0"/>
    </body>
    <body name="object">
      <freejoint/><inertial pos="0 0 0" mass="0.1" diaginertia="1e-5 1e-5 1e-5"/>{geoms}
    </body>
  </worldbody>
  <sensor><tactile mesh="skin" geom="skin"/></sensor>
</mujoco>"""


def verify(peer: Peer, poses: NDArray[np.float64]) -> Images:
    """Depths (num_envs, rows, columns) of `poses`. Exits if contact is missing, or stays without contact."""
    away = poses.copy()
    away[:, 2] = AWAY
    peer.step(away)
    if peer.depths().any():
        sys.exit("depths without contact")
    peer.step(poses)
    depths = peer.depths()
    missing = ~depths.any(axis=(1, 2))
    if missing.any():
        sys.exit(f"environment {int(missing.argmax())} has no contact")
    peer.step(away)
    if peer.depths().any():
        sys.exit("depths after the end of the contact")
    return depths


def peak_memory() -> int:
    """Largest resident set of this process, bytes. ru_maxrss would include that of the parent before exec."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return 1024 * next(int(line.split()[1]) for line in lines if line.startswith("VmHWM"))


def main() -> None:
    """Verifies, warms up, times."""
    values = json.loads(Path(sys.argv[1]).read_text())
    job = Job(**{**values, "grid": tuple(values["grid"])})
    poses = np.load(job.poses)
    rows = np.arange(job.num_envs)
    start_memory = peak_memory()
    peer: Any = TaxelsimPeer(job) if job.peer == "taxelsim" else MujocoPeer(job)
    np.save(job.images, verify(peer, poses[rows % len(poses)])[: len(poses)])
    num_steps, start = 0, time.perf_counter()
    while time.perf_counter() - start < job.seconds:
        peer.step(poses[(rows + num_steps) % len(poses)])
        num_steps += 1
    seconds = time.perf_counter() - start
    print(
        json.dumps(
            {
                "what": peer.what,
                "frames_per_second": job.num_envs * num_steps / seconds,
                "peak_memory_bytes": peak_memory(),
                "interpreter_memory_bytes": start_memory,
            }
        )
    )


if __name__ == "__main__":
    main()

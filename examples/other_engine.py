"""Poses and contacts of a batched engine other than MuJoCo, without a loop over simulations: balls roll over pads, tracked by touch.

The engine is Genesis World (pip install torch genesis-world; run with 1.4.5 on the CPU). Where it is not installed, or with --stand-in, a
stand-in moves the balls on a line.

python3 examples/other_engine.py [--stand-in]
"""

import importlib.util
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

import taxelsim

Contacts = tuple[NDArray[Any], NDArray[Any], NDArray[Any]]

RADIUS, DENSITY = 0.01, 19300  # m, kg/m^3: balls of tungsten, 0.79 N
HEIGHT, DEPTH = 0.5, 0.0004  # m: surface of the pads; the balls roll on a hard plate that lies 0.4 mm deeper, under the soft cover
START = -0.01  # m, along y
TIME_STEP = 0.01  # s
GRAVITY = 9.81  # m/s^2


class GenesisEngine:
    """Balls on a fixed plate in Genesis World, one per simulation, with these speeds along y (m/s)."""

    def __init__(self, speeds: NDArray[np.float64]) -> None:
        import genesis as gs

        gs.init(backend=gs.cpu, logging_level="warning")
        self.name = f"Genesis World {gs.__version__}"
        self.scene = gs.Scene(sim_options=gs.options.SimOptions(dt=TIME_STEP, substeps=10, gravity=(0, 0, -GRAVITY)), show_viewer=False)
        plate = gs.morphs.Box(size=(0.1, 0.1, 0.02), pos=(0, 0, HEIGHT - DEPTH - 0.01), fixed=True)
        self.plate = self.scene.add_entity(plate)
        ball = gs.morphs.Sphere(radius=RADIUS, pos=(0, START, HEIGHT - DEPTH + RADIUS))
        self.ball = self.scene.add_entity(ball, material=gs.materials.Rigid(rho=DENSITY))
        self.scene.build(n_envs=len(speeds))
        velocities = np.zeros((len(speeds), 6))
        velocities[:, 1], velocities[:, 3] = speeds, -speeds / RADIUS
        self.ball.set_dofs_velocity(velocities)

    def step(self) -> None:
        self.scene.step()

    def poses(self) -> NDArray[np.float64]:
        """(N, 7): positions (m) and quaternions (w, x, y, z) of the balls in the world."""
        # from_dlpack() shares the memory of tensors on the CPU; .cpu() copies those of a GPU.
        parts = self.ball.get_pos().cpu(), self.ball.get_quat().cpu()
        return np.concatenate([np.from_dlpack(part) for part in parts], axis=1, dtype=np.float64)

    def contacts(self) -> Contacts:
        """Simulation, position (m) and force (N) on the plate of each contact, in the world."""
        found = {key: np.from_dlpack(value.cpu()) for key, value in self.plate.get_contacts(with_entity=self.ball).items()}
        valid = found["valid_mask"]  # (N, most contacts of a simulation)
        plate_is_a = found["link_a"] == self.plate.base_link_idx
        forces = np.where(plate_is_a[..., np.newaxis], found["force_a"], found["force_b"])
        return np.nonzero(valid)[0], found["position"][valid], forces[valid]


class StandIn:
    """Balls that move on a line, where no engine is installed: no physics."""

    name = "stand-in (pip install genesis-world for physics)"

    def __init__(self, speeds: NDArray[np.float64]) -> None:
        self.time, self.speeds = 0.0, speeds

    def step(self) -> None:
        self.time += TIME_STEP

    def poses(self) -> NDArray[np.float64]:
        y, half = START + self.speeds * self.time, -self.speeds * self.time / RADIUS / 2
        zeros = np.zeros_like(y)
        return np.column_stack((zeros, y, zeros + HEIGHT + RADIUS - DEPTH, np.cos(half), np.sin(half), zeros, zeros))

    def contacts(self) -> Contacts:
        points = self.poses()[:, :3] - (0, 0, RADIUS)
        weight = DENSITY * GRAVITY * 4 / 3 * np.pi * RADIUS**3
        return np.arange(len(points)), points, np.tile([0, 0, -weight], (len(points), 1))


def matrices(poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 4, 4) of positions and quaternions (N, 7)."""
    w, x, y, z = poses[:, 3:].T / np.linalg.norm(poses[:, 3:], axis=1)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    result = np.tile(np.eye(4), (len(poses), 1, 1))
    result[:, :3, :3] = np.moveaxis(np.array(rows), -1, 0)
    result[:, :3, 3] = poses[:, :3]
    return result


def main() -> None:
    speeds = np.linspace(0.005, 0.02, 256)  # m/s
    if "--stand-in" in sys.argv or importlib.util.find_spec("genesis") is None:
        engine: GenesisEngine | StandIn = StandIn(speeds)
    else:
        engine = GenesisEngine(speeds)
    print(f"engine: {engine.name}")
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")
    device = taxelsim.Device.open()
    by_pose = taxelsim.Simulator(taxelsim.Model(device, sensor, [taxelsim.Sphere(radius=RADIUS)]), len(speeds))
    by_contact = taxelsim.Simulator(taxelsim.Model(device, sensor), len(speeds), max_contacts=4)

    X_WS = np.tile([0, 0, HEIGHT, 1, 0, 0, 0], (len(speeds), 1))  # the pads lie on the plate
    X_SW = np.linalg.inv(matrices(X_WS))
    errors = []
    for _ in range(50):
        engine.step()
        poses = engine.poses()
        by_pose.set_objects(0, X_SW @ matrices(poses))
        by_contact.set_contacts(*taxelsim.contact_points(*engine.contacts(), X_WS))
        for simulator in (by_pose, by_contact):
            simulator.step(TIME_STEP)
        frames = by_pose.read(), by_contact.read()
        errors.append([np.abs(frame.center_of_pressure[:, 1] - poses[:, 1]) for frame in frames])

    print(f"image by poses, counts:\n{frames[0].tactile_image[0]}\nimage by contact points, counts:\n{frames[1].tactile_image[0]}")
    pose_error, contact_error = 1e3 * np.median(errors, axis=(0, 2))
    print(f"median error of the centre of pressure along y: {pose_error:.2f} mm by poses, {contact_error:.2f} mm by contact points")


if __name__ == "__main__":
    main()

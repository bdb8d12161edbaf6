"""Poses and contacts of a batched engine other than MuJoCo, through DLPack: balls roll over pads, each is tracked by touch.

Genesis World is the model of the interface: `ball.get_pos()` (N, 3), m, and `ball.get_quat()` (N, 4), (w, x, y, z), are tensors of the
whole batch, and contacts are flat arrays with the number of their simulation. `StandIn` below has the same calls, so that this runs
without an engine; it moves balls on a line and is no physics. With Genesis, `np.from_dlpack(ball.get_pos().cpu())` is the same line.

python3 examples/other_engine.py
"""

import numpy as np

import taxelsim


class StandIn:
    """N balls of 10 mm radius that roll along y over a plate at z = 0.5 m, 0.4 mm deep in its soft cover."""

    radius, height, depth = 0.01, 0.5, 0.0004  # m

    def __init__(self, num_simulations: int) -> None:
        self.time = 0.0
        self.speeds = np.linspace(0.005, 0.02, num_simulations)  # m/s

    def step(self, dt: float) -> None:
        self.time += dt

    def get_pos(self) -> np.ndarray:
        y = -0.01 + self.speeds * self.time
        return np.column_stack((np.zeros_like(y), y, np.full_like(y, self.height + self.radius - self.depth)))

    def get_quat(self) -> np.ndarray:
        half = -self.speeds * self.time / self.radius / 2
        return np.column_stack((np.cos(half), np.sin(half), np.zeros_like(half), np.zeros_like(half)))

    def get_contacts(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Simulation, position and force on the plate of each contact, in the world: one per ball, 2 N."""
        points = self.get_pos() * (1, 1, 0) + (0, 0, self.height)
        return np.arange(len(points)), points, np.tile([0.0, 0, -2], (len(points), 1))


def matrices(positions: np.ndarray, quaternions: np.ndarray) -> np.ndarray:
    """Poses (N, 4, 4)."""
    poses = np.tile(np.eye(4), (len(positions), 1, 1))
    for pose, quaternion in zip(poses, quaternions, strict=True):
        pose[:3, :3] = [taxelsim.Pose(rotation=quaternion).transform(axis) for axis in np.eye(3)]
    poses[:, :3, :3] = np.swapaxes(poses[:, :3, :3], 1, 2)
    poses[:, :3, 3] = positions
    return poses


def main() -> None:
    num_simulations, dt = 256, 0.01
    engine = StandIn(num_simulations)
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")
    device = taxelsim.Device.open()
    by_pose = taxelsim.Simulator(taxelsim.Model(device, sensor, [taxelsim.Sphere(radius=engine.radius)]), num_simulations)
    by_contact = taxelsim.Simulator(taxelsim.Model(device, sensor), num_simulations, max_contacts=4)

    X_WS = np.tile([0, 0, engine.height, 1, 0, 0, 0], (num_simulations, 1))  # the pads lie in the plate
    X_SW = np.linalg.inv(matrices(X_WS[:, :3], X_WS[:, 3:]))
    errors = []
    for _ in range(50):
        engine.step(dt)
        positions, quaternions = np.from_dlpack(engine.get_pos()), np.from_dlpack(engine.get_quat())
        by_pose.set_objects(0, X_SW @ matrices(positions, quaternions))
        by_contact.set_contacts(*taxelsim.contact_points(*map(np.from_dlpack, engine.get_contacts()), X_WS))
        for simulator in (by_pose, by_contact):
            simulator.step(dt)
        frames = by_pose.read(), by_contact.read()
        errors.append([np.abs(frame.center_of_pressure[:, 1] - positions[:, 1]) for frame in frames])

    print(f"image by poses, counts:\n{frames[0].tactile_image[0]}\nimage by contact points, counts:\n{frames[1].tactile_image[0]}")
    pose_error, contact_error = 1e3 * np.median(errors, axis=(0, 2))
    print(f"median error of the centre of pressure along y: {pose_error:.2f} mm by poses, {contact_error:.2f} mm by contact points")


if __name__ == "__main__":
    main()

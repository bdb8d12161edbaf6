"""Finds where a stamp presses from one tactile image, by Gauss-Newton steps with the tactile Jacobian.

python3 examples/pose_from_image.py
"""

import numpy as np

import taxelsim

NUM_GUESSES = 128
STAMP = taxelsim.Box(size=[0.012, 0.007, 0.01])
LIFT = 0.005  # m, of the stamp's origin over its lower face


def poses_of(places: np.ndarray) -> np.ndarray:
    """Poses (N, 7) from x, y, depth (m) and yaw (rad)."""
    poses = np.zeros((len(places), 7))
    poses[:, :2] = places[:, :2]
    poses[:, 2] = LIFT - places[:, 2]
    poses[:, 3], poses[:, 6] = np.cos(places[:, 3] / 2), np.sin(places[:, 3] / 2)
    return poses


def by_place(jacobian: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Derivatives (N, 4, taxels) of forces by x, y, depth and yaw of the stamp, from those by the twist of the sensor."""
    v_x, v_y, v_z, w_z = (-jacobian[:, k] for k in (0, 1, 2, 5))  # by the stamp's twist at the origin of S
    x, y = places[:, 0, None], places[:, 1, None]
    return np.stack((v_x, v_y, -v_z, w_z + y * v_x - x * v_y), axis=1)  # a turn about the stamp's own axis


def main() -> None:
    """Presses once, forgets the pose, and finds it again from many guesses at once."""
    random = np.random.default_rng(4)
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").replace(depth_sampling=taxelsim.DepthSampling.AREA)
    model = taxelsim.Model(taxelsim.Device.open(), sensor, [STAMP])
    simulator = taxelsim.Simulator(model, NUM_GUESSES, outputs=taxelsim.OutputOptions(taxel_jacobian=True))

    def press(places: np.ndarray) -> taxelsim.Frame:
        simulator.reset()  # each press is a first step, without memory of the one before
        simulator.set_objects(0, poses_of(places))
        simulator.step(0.01)
        return simulator.read()

    truth = np.array([0.0012, -0.0031, 0.0004, 0.5])
    wanted = press(np.tile(truth, (NUM_GUESSES, 1))).ground_truth.tactile_normal_force[0].flatten().astype(float)

    places = truth + random.uniform(-1, 1, (NUM_GUESSES, 4)) * [0.003, 0.003, 0.0002, 0.4]
    for _ in range(30):
        frame = press(places).ground_truth
        residual = wanted - frame.tactile_normal_force.reshape(NUM_GUESSES, -1)
        matrix = by_place(frame.taxel_jacobian.reshape(NUM_GUESSES, 6, -1), places) * np.array([1e-3, 1e-3, 1e-4, 0.1])[:, None]
        normal = matrix @ matrix.transpose(0, 2, 1)
        damping = 1e-3 * np.trace(normal, axis1=1, axis2=2)[:, None, None] * np.eye(4)
        step = np.linalg.solve(normal + damping, matrix @ residual[:, :, None])[:, :, 0]
        places += np.clip(step, -0.5, 0.5) * [1e-3, 1e-3, 1e-4, 0.1]
        places[:, 2] = np.clip(places[:, 2], 1e-5, 0.0015)
    frame = press(places).ground_truth
    loss = np.square(wanted - frame.tactile_normal_force.reshape(NUM_GUESSES, -1)).sum(1)
    best = places[np.argmin(loss)]
    found = np.abs(places - truth).max(1) < 1e-4
    print(f"found from {found.sum()} of {NUM_GUESSES} guesses up to 3 mm and 23 degrees away")
    print(f"best guess off by {1e6 * np.abs(best - truth)[:2].max():.2f} um and {np.degrees(abs(best[3] - truth[3])):.4f} degrees")


if __name__ == "__main__":
    main()

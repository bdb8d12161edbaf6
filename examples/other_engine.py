"""Takes poses and contacts from a batched engine other than MuJoCo: 256 balls of tungsten roll on a plate 0.4 mm deep in soft pads.

Genesis World (run with 1.4.5) has arrays of all environments; where it is not installed, balls move on a line. Prints the errors of both.

python3 examples/other_engine.py [PICTURE]    pip install torch genesis-world
"""

import importlib.util
import sys

import matplotlib.pyplot as plt
import numpy as np

import taxelsim.pictures

RADIUS, DENSITY, SPEEDS, DEPTH, START, DT = 0.01, 19300, np.linspace(0.005, 0.02, 256), 0.0004, [0, -0.01, 0.0096], 0.01  # SI


def engine():  # yields poses (N, 7) of the balls; simulation, position and force on the plate of each contact; in the world
    if not importlib.util.find_spec("genesis"):
        poses, weight = np.tile([*START, 1, 0, 0, 0], (len(SPEEDS), 1)), DENSITY * 9.81 * 4 / 3 * np.pi * RADIUS**3  # m; N
        for poses[:, 1] in START[1] + np.outer(DT * np.arange(1, 51), SPEEDS):
            yield poses, (np.arange(len(poses)), poses[:, :3] - [0, 0, RADIUS], np.tile([0, 0, -weight], (len(poses), 1)))
    gs = importlib.import_module("genesis")
    gs.init(backend=gs.cpu, logging_level="warning")
    scene = gs.Scene(sim_options=gs.options.SimOptions(dt=DT, substeps=10, gravity=(0, 0, -9.81)), show_viewer=False)
    plate = scene.add_entity(gs.morphs.Box(size=(0.1, 0.1, 0.02), pos=(0, 0, -DEPTH - 0.01), fixed=True))
    ball = scene.add_entity(gs.morphs.Sphere(radius=RADIUS, pos=START), material=gs.materials.Rigid(rho=DENSITY))
    scene.build(n_envs=len(SPEEDS))
    ball.set_dofs_velocity(np.outer(SPEEDS, [0, 1, 0, -1 / RADIUS, 0, 0]))
    while True:
        scene.step()  # then from_dlpack() shares the memory of tensors on the CPU; .cpu() copies those of a GPU
        found = {key: np.from_dlpack(value.cpu()) for key, value in plate.get_contacts(with_entity=ball).items()}
        valid = found["valid_mask"]  # (N, most contacts of a simulation)
        forces = np.where((found["link_a"] == plate.base_link_idx)[..., None], found["force_a"], found["force_b"])[valid]
        poses = np.hstack([np.from_dlpack(part.cpu()) for part in (ball.get_pos(), ball.get_quat())]).astype(float)
        yield poses, (np.nonzero(valid)[0], found["position"][valid], forces)


def main() -> None:
    model = taxelsim.Model(taxelsim.Device.open(), taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml", [taxelsim.Sphere(RADIUS)])
    by_pose, by_contact = taxelsim.Simulator(model, len(SPEEDS)), taxelsim.Simulator(model, len(SPEEDS), max_contacts=4)
    tracks = []  # mm, along y: true, by poses, by contact points
    for _, (poses, contacts) in zip(range(50), engine(), strict=False):
        by_pose.set_objects(0, poses)
        by_contact.set_contacts(*taxelsim.contact_points(*contacts, X_WS=np.tile([0, 0, 0, 1, 0, 0, 0], (len(poses), 1))))
        by_pose.step(DT)
        by_contact.step(DT)
        tracks.append(1e3 * np.stack((poses[:, :3], by_pose.read().center_of_pressure, by_contact.read().center_of_pressure))[..., 1])
    true, pose, contact = np.moveaxis(tracks, 1, 0)  # (steps, balls)
    print(f"median error: {np.median(abs(pose - true)):.2f} mm by poses, {np.median(abs(contact - true)):.2f} mm by contact points")
    plt.rcParams["font.size"] = 15
    figure, axes = plt.subplots(figsize=(12, 5.5), layout="constrained")
    axes.plot(true[:, ::85], "C7-", pose[:, ::85], "C0.", contact[:, ::85], "C2x")
    axes.set(xlabel="step", ylabel="y (mm)", title="four balls (lines), tracked by poses (dots) and by contact points (crosses)")
    taxelsim.pictures.save_figure(sys.argv[1] if len(sys.argv) > 1 else "other_engine.png", figure)


if __name__ == "__main__":
    main()

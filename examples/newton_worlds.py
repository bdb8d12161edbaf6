"""Holds bars between two fingers with tactile arrays in 256 worlds of Newton, and reads the angle of each bar from the images.

Newton moves hands and bars, one kernel of Warp passes the poses of all worlds. Prints the error of the angles and the times of both.

python3 examples/newton_worlds.py [PICTURE]    pip install 'newton[sim]'
"""

import sys

import matplotlib.pyplot as plt
import newton
import numpy as np
import warp as wp

import taxelsim.newton
from taxelsim.pictures import draw_taxels, save_figure

N, DT, RADIUS, SKIN = 256, 0.002, 0.006, 0.0005  # worlds; s; m, of the bar; m, from the face of a finger to the surface of its skin


def hand(angle: float) -> newton.ModelBuilder:
    builder = newton.ModelBuilder()
    builder.default_shape_cfg.ke, builder.default_shape_cfg.kd, builder.default_shape_cfg.density = 1e5, 500, 3000
    bar = builder.add_body(xform=wp.transform(q=wp.quat_from_axis_angle(wp.vec3(1, 0, 0), angle)))
    builder.add_shape_capsule(bar, radius=RADIUS, half_height=0.03, label="bar")
    for side, label in (-1, "left"), (1, "right"):
        finger, skin = builder.add_link(), wp.transform((side * (RADIUS - SKIN), 0, 0), wp.quat(-side / 2, 0.5, 0.5, -side / 2))
        builder.add_shape_box(finger, xform=wp.transform((side * (RADIUS + 0.01), 0, 0)), hx=0.01, hy=0.02, hz=0.03)
        builder.add_site(finger, xform=skin, label=label)  # z out of the skin, y up
        builder.add_articulation([builder.add_joint_prismatic(-1, finger, axis=(-side, 0, 0), target_q=0.006, target_ke=200, target_kd=9)])
    return builder


def main() -> None:
    worlds, angles = newton.ModelBuilder(), np.linspace(-1, 1, N)  # rad
    for angle in angles:
        worlds.add_world(hand(float(angle)))
    model = worlds.finalize(device="cpu")
    solver, state, control, times = newton.solvers.SolverMuJoCo(model), model.state(), model.control(), {}
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")
    tactile = taxelsim.newton.attach(model, {"left": sensor, "right": sensor}, ["bar"])
    for _ in range(10):
        with wp.ScopedTimer("physics", print=False, dict=times):
            for _ in range(10):
                solver.step(state, state, control, None, DT)
        with wp.ScopedTimer("touch", print=False, dict=times):
            frame = tactile.observe(state, 10 * DT)["left"]
    error = np.degrees((frame.edge_angle - angles) % np.pi - np.pi / 2)
    print(f"median error of the angle {np.median(abs(error)):.2f} degrees, mean force {frame.total_force.mean():.2f} N")
    physics, touch = (np.median(of_part[5:]) for of_part in times.values())  # ms, without the first ones, which compile
    print(f"{N} worlds: ten physics steps {physics:.0f} ms, two tactile arrays {touch:.1f} ms, {100 * touch / (physics + touch):.1f} %")
    figure, axes = plt.subplots(1, 4, figsize=(12, 3.4), layout="constrained", sharey=True)
    for axis, k in zip(axes, (0, 85, 170, 255), strict=True):
        draw_taxels(axis, sensor, frame.tactile_image[k])
        axis.set_title(f"bar at {np.degrees(angles[k]):.0f}°")
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "newton_worlds.png", figure)


if __name__ == "__main__":
    main()

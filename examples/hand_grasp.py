"""Closes a hand with five tactile fingertips on a bar, and holds it with a force for each finger.

The Shadow hand of the scene has a sensor on the palm and on each fingertip. Each finger closes until its taxels read the target force,
while a ball moves on the palm. Prints the share of grasps that are held, and the largest error of a force at the end.

python3 examples/hand_grasp.py [PICTURE]
"""

import sys
import tempfile

import matplotlib.pyplot as plt
import numpy as np

import taxelsim
from taxelsim.pictures import colour_map, draw_taxels, save_figure

FINGERS = ["first", "middle", "ring", "little", "thumb"]


def main() -> None:
    scene = taxelsim.load_scene(taxelsim.SCENES / "shadow_grasp.yaml", num_episodes=4)
    held = taxelsim.evaluate_grasp(scene)[0].total.held_rate
    with tempfile.TemporaryDirectory() as folder:
        taxelsim.generate(scene, folder)
        episode = taxelsim.Dataset(folder).episode(0)
    forces = np.column_stack([episode[f"data/{finger}/total_force"] for finger in FINGERS])  # (frames, fingers), N
    target = episode["meta/target_force"]
    error = np.abs(forces[-1] - target).max()
    print(f"held: {held:.0%} of {scene.num_episodes} grasps; largest error of a force at the end {error:.3f} N")

    plt.rcParams.update({"font.size": 15, "lines.linewidth": 3})
    figure, axes = plt.subplot_mosaic([FINGERS, ["force"] * 5], figsize=(12, 7), layout="constrained", height_ratios=[1.1, 1])
    sensors = dict(scene.sensors)
    time = np.arange(len(forces)) / 100  # s, 100 Hz
    images = {finger: episode[f"data/{finger}/tactile_image"][-1] for finger in FINGERS}
    for index, finger in enumerate(FINGERS):
        draw_taxels(axes[finger], sensors[finger], images[finger], range=max(image.max() for image in images.values()))
        axes[finger].set(title=f"{finger}, {forces[-1, index]:.2f} N", xticks=[-4, 0, 4], ylabel="x (mm)" if index == 0 else "")
        axes["force"].plot(time, forces[:, index], color=colour_map()(index / 4.5), label=finger)
        axes["force"].axhline(target[index], color=colour_map()(index / 4.5), linewidth=1, linestyle="--")
    axes["force"].set(xlabel="time (s)", ylabel="force (N)", title="read by each fingertip; dashed: target")
    axes["force"].legend(loc="center left")
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "hand_grasp.png", figure)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Errors of the palm's servo and forces of all fingers in data sets of an arm with a hand, and a figure of one episode of each.

    for scene in rest given; do
      build/release/bin/taxelsim generate scenes/experiments/paper/arm_hand_${scene}_scene.yaml -o build/arm_hand/$scene
    done
    build/venv/bin/python bench/python/arm_hand.py build/arm_hand/rest build/arm_hand/given --figure docs/images/arm_hand.png

Needs h5py, NumPy and, for the figure, Matplotlib (python/requirements/learn.txt).
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

PALM = "palm"
REFERENCE_ANGLE = 0.0  # degrees, of the scenes
REFERENCE_FORCE = 4.0  # N
RADIUS = 0.016  # m, of the cylinder
PITCH = {PALM: 0.0034}  # m; all others: 0.0025
COLORS = dict(zip(("first", "middle", "ring", "little", "thumb"), ("#1f5fbf", "#c2571a", "#1b7f5c", "#b3261e", "#7b4fb5"), strict=True))
STEADY = 2.0  # s, window at the end of an episode

Floats = NDArray[np.float64]


def rotated(rotation: Floats, vector: Floats) -> Floats:
    """Vectors after rotations (w, x, y, z)."""
    w, u = rotation[..., :1], rotation[..., 1:]
    return vector + 2 * np.cross(u, np.cross(u, vector) + w * vector)


class Grasps:
    """All episodes of a data set; arrays are (episodes x frames x ...)."""

    def __init__(self, directory: Path) -> None:
        with h5py.File(directory / "dataset.h5") as file:
            ends = file["meta/episode_ends"][:]
            self.shape = (len(ends), int(ends[0]))
            self.targets: Floats = file["meta/target_force"][:]
            description = file["meta/target_force"].attrs["description"].decode()
            self.fingers = description.rsplit(": ", 1)[1].rstrip(".").split(", ")
            self.time = self._read(file, "time")[0]
            self.object_pose = self._read(file, "object_pose")[:, :, 0]
            self.poses = {name: self._read(file, f"{name}/sensor_pose") for name in (PALM, *self.fingers)}
            self.forces = {name: self._read(file, f"{name}/total_force") for name in (PALM, *self.fingers)}
            self.true_forces = {name: self._read(file, f"{name}/ground_truth/total_force") for name in (PALM, *self.fingers)}
            self.images = {name: self._read(file, f"{name}/tactile_image") for name in (PALM, *self.fingers)}

    def _read(self, file: h5py.File, name: str) -> Any:
        rows = file[f"data/{name}"][:]
        return rows.reshape(*self.shape, *rows.shape[1:])

    def in_palm(self, points: Floats) -> Floats:
        """Points of the world (episodes x frames x 3) in the frame of the palm's sensor."""
        inverse = self.poses[PALM][..., 3:] * np.array([1.0, -1.0, -1.0, -1.0])
        return rotated(inverse, points - self.poses[PALM][..., :3])

    def edge_angle(self) -> Floats:
        """True angle of the cylinder's axis in the plane of the palm's sensor, degrees."""
        origin = self.object_pose[..., :3]
        tip = origin + rotated(self.object_pose[..., 3:], np.broadcast_to([0.0, 0.0, 1.0], origin.shape))
        axis = self.in_palm(tip) - self.in_palm(origin)
        return np.degrees(np.arctan(axis[..., 1] / axis[..., 0]))


def print_table(name: str, grasps: Grasps) -> None:
    """Means, largest values and root mean squares over all episodes."""
    error = np.abs(grasps.edge_angle() - REFERENCE_ANGLE)
    late = grasps.time >= grasps.time[-1] - STEADY
    print(f"{name}: {grasps.shape[0]} episodes of {grasps.time[-1]:.2f} s; the last {STEADY:g} s")
    print(f"  edge angle error, degrees: {error[:, 0].mean():.2f} at the start; {np.sqrt((error[:, late] ** 2).mean()):.3f} rms,")
    print(f"    {error[:, late].max():.3f} at most")
    for label, forces in (("measured", grasps.forces), ("true", grasps.true_forces)):
        palm = forces[PALM][:, late] - REFERENCE_FORCE
        print(f"  {label} force error, N: palm {np.sqrt((palm**2).mean()):.3f} rms, {np.abs(palm).max():.3f} at most")
        for f, finger in enumerate(grasps.fingers):
            rest = forces[finger][:, late] - grasps.targets[:, f, None, None].reshape(-1, 1)
            print(f"    {finger} {np.sqrt((rest**2).mean()):.3f} rms, {np.abs(rest).max():.3f} at most")
    lost = sum(int((grasps.forces[finger][:, late] <= 0).sum()) for finger in (PALM, *grasps.fingers))
    print(f"  frames of a sensor without contact: {lost} of {error[:, late].size * (1 + len(grasps.fingers))}")


def draw_palm_view(axes: Any, grasps: Grasps, frame: int) -> None:
    """Cylinder and sensors in the plane of the palm's sensor, mm; x of the sensor points up."""
    origin = grasps.object_pose[:1, frame : frame + 1]
    for sign in (-1, 0, 1):
        ends = []
        for along in (-0.07, 0.07):
            tip = origin[..., :3] + rotated(origin[..., 3:], np.array([[[0.0, 0.0, along]]]))
            pose = grasps.poses[PALM][:1, frame : frame + 1]
            ends.append(rotated(pose[..., 3:] * np.array([1.0, -1.0, -1.0, -1.0]), tip - pose[..., :3])[0, 0])
        direction = (ends[1] - ends[0])[:2] / np.linalg.norm((ends[1] - ends[0])[:2])
        side = sign * RADIUS * np.array([-direction[1], direction[0]])
        line = np.array([end[:2] + side for end in ends]) * 1e3
        axes.plot(line[:, 1], line[:, 0], color="0.45", ls="-" if sign else "--", lw=1)
    for name, poses in grasps.poses.items():
        rows, columns = grasps.images[name].shape[2:]
        half = np.array([rows, columns]) / 2 * PITCH.get(name, 0.0025)
        corners = np.array([[x, y, 0.0] for x, y in ((-1, -1), (-1, 1), (1, 1), (1, -1), (-1, -1))]) * np.array([*half, 0.0])
        pose, palm = poses[0, frame], grasps.poses[PALM][0, frame]
        world = pose[:3] + rotated(np.broadcast_to(pose[3:], (5, 4)), corners)
        outline = rotated(np.broadcast_to(palm[3:] * np.array([1.0, -1.0, -1.0, -1.0]), (5, 4)), world - palm[:3]) * 1e3
        axes.fill(outline[:, 1], outline[:, 0], alpha=0.6, color="#999999" if name == PALM else COLORS[name])
    axes.set(title=f"after {grasps.time[frame]:.2f} s", xlabel="y of the palm's sensor, mm", ylabel="x, mm", aspect="equal")


def draw(file: Path, sets: dict[str, Grasps]) -> None:
    """A row for each data set: angle, forces, and the palm's view at the start and at the end of episode 0."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(
        len(sets), 5, figsize=(20, 4 * len(sets)), width_ratios=(1, 1, 1, 0.75, 0.75), squeeze=False, layout="constrained"
    )
    for row, (name, grasps) in zip(axes, sets.items(), strict=True):
        angles = grasps.edge_angle()
        row[0].plot(grasps.time, angles.T, color="0.8", lw=0.7)
        row[0].plot(grasps.time, angles[0], color="#1f5fbf")
        row[0].axhline(REFERENCE_ANGLE, color="k", lw=0.6)
        row[0].set(title=f"{name}: true edge angle", xlabel="time, s", ylabel="degrees")
        row[1].plot(grasps.time, grasps.forces[PALM].T, color="0.8", lw=0.7)
        row[1].plot(grasps.time, grasps.forces[PALM][0], color="#444444")
        row[1].axhline(REFERENCE_FORCE, color="k", lw=0.6)
        row[1].set(title="palm, force", xlabel="time, s", ylabel="N", ylim=(0, None))
        for finger in grasps.fingers:
            row[2].plot(grasps.time, grasps.forces[finger][0], lw=1, color=COLORS[finger], label=finger)
        for target in sorted(set(grasps.targets[0])):
            row[2].axhline(target, color="k", lw=0.6)
        row[2].set(title="fingers, force", xlabel="time, s", ylabel="N", ylim=(0, None))
        row[2].legend(fontsize=8)
        for axis in row[:3]:
            axis.grid(alpha=0.3)
        draw_palm_view(row[3], grasps, 0)
        draw_palm_view(row[4], grasps, grasps.shape[1] - 1)
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, dpi=70, metadata={"Software": None})
    plt.close(figure)


def main() -> None:
    """Prints the tables and writes the figure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data_sets", type=Path, nargs="+", metavar="DIR", help="data sets of arm_hand_rest_scene and arm_hand_given_scene")
    parser.add_argument("--figure", type=Path, help="PNG of episode 0 of each (grey: all others)")
    arguments = parser.parse_args()
    sets = {directory.name: Grasps(directory) for directory in arguments.data_sets}
    for name, grasps in sets.items():
        print_table(name, grasps)
    if arguments.figure:
        draw(arguments.figure, sets)


if __name__ == "__main__":
    main()

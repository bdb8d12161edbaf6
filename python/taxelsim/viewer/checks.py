"""Mistakes of scenes that a picture shows: an object in millimetres, upside down, or away from the sensor."""

from __future__ import annotations

from collections.abc import Set
from typing import TYPE_CHECKING

import numpy as np

from .._arrays import rotation_matrices
from .._core import Object, Scene, Sensor, bounds_of

if TYPE_CHECKING:
    from .source import Episode, Source

MAX_RATIO = 100  # of the sizes of object and sensor


def extent_of(sensor: Sensor) -> float:
    """m, longest side of the box around all taxels."""
    pitch = max(max(patch.pitch) for patch in sensor.patches)
    return float(np.ptp(sensor.taxel_positions, axis=0).max() + pitch)


def size_warning(item: Object, sensor: Sensor) -> str | None:
    """A line about an object that is MAX_RATIO times larger or smaller than the sensor."""
    size = float(np.linalg.norm(np.subtract(*bounds_of(item)[::-1])))
    extent = extent_of(sensor)
    if not np.isfinite(size) or extent / MAX_RATIO <= size <= extent * MAX_RATIO:
        return None
    ratio = f"{size / extent:,.0f} times" if size > extent else f"1/{extent / size:,.0f} of"
    advice = "a mesh in millimetres needs `scale: 0.001`" if size > extent else "is its `scale` right?"
    return f"object {item.name} is {size:.3g} m long, {ratio} the sensor's {extent:.3g} m; {advice}"


def place_warning(item: Object, episode: Episode) -> str | None:
    """A line about an object that is away from the sensor, behind its skin or without contact in all frames."""
    poses = episode.per_sensor("data/pose", (7,))
    low, high = np.array(bounds_of(item))
    name = f"episode {episode.number}: object {item.name}"
    if poses is not None and np.isfinite([low, high]).all():
        X_SO = poses[:, 0]
        corners = np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, 8)
        points = rotation_matrices(X_SO[:, 3:]) @ corners + X_SO[:, :3, None]  # (F, 3, 8), in S
        taxels = episode.sensor.taxel_positions
        gaps = np.maximum(0, np.maximum(points.min(2) - taxels.max(0), taxels.min(0) - points.max(2)))
        gap, extent = float(np.linalg.norm(gaps, axis=1).min()), extent_of(episode.sensor)
        if gap > extent:
            return f"{name} is not near the sensor: {gap:.3g} m away, the sensor is {extent:.3g} m long"
        height = (points.mean(2) - taxels.mean(0)) @ episode.sensor.taxel_normals.mean(0)
        if height[0] < 0:
            return f"{name} starts behind the skin: is it, or the sensor, upside down?"
    return None if episode.image.any() else f"{name} does not touch the sensor in any frame"


def size_warnings(scene: Scene, missing: Set[int]) -> list[str]:
    """A line for each object of the wrong size, and for meshes that are not found."""
    known = [item for index, item in enumerate(scene.objects) if index not in missing]
    lines = [line for item in known if (line := size_warning(item, scene.sensor)) is not None]
    if missing:
        names = ", ".join(scene.objects[index].name for index in sorted(missing))
        lines.append(f"meshes of {names} are not found and not drawn; assets names the folder that holds them")
    return lines


def place_warnings(source: Source) -> list[str]:
    """A line for each episode whose object is not where it should be."""
    lines = []
    for episode in source.episodes:
        index = episode.object_index
        line = None if index is None or index in source.missing else place_warning(source.scene.objects[index], episode)
        lines += [] if line is None else [line]
    if source.scene.objects and not {"data/pose", "data/object_pose"} & source.episodes[0].columns.keys():
        lines.append("poses are not recorded, so that objects are not drawn; add `poses` to `record` of the scene")
    return lines

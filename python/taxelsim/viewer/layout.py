"""How the viewer arranges the episodes: one tab each."""

from __future__ import annotations

import fnmatch
import itertools
from collections.abc import Sequence

import rerun.blueprint as rrb

from .recording import COUNT_AXES, EpisodeWriter
from .series import Series

# Plots by title: patterns of the paths of their time series. A plot has one unit.
_PLOTS = {
    "force, N": ("*features/*_force", "*ground_truth/*_force"),
    "centre, m": ("*features/center_of_pressure", "*ground_truth/center_of_pressure"),
    "edge angle, rad": ("*features/edge_angle", "*ground_truth/*edge_angle", "*errors/*edge_angle"),
    "errors": ("*errors/*",),
    "actions": ("actions/*",),
    "contacts": ("*contact/*",),
    "robot": ("robot/*",),
    "more features": ("*features/*",),
    "more ground truth": ("*ground_truth/*",),
}


def _plots(root: str, series: Sequence[Series]) -> list[rrb.TimeSeriesView]:
    paths = [item.path for item in series]
    chosen = {title: [path for path in paths if any(fnmatch.fnmatch(path, p) for p in patterns)] for title, patterns in _PLOTS.items()}
    return [
        rrb.TimeSeriesView(name=title, origin=root, contents=[f"/{root}/{path}" for path in found])
        for title, found in chosen.items()
        if found
    ]


def _images(writer: EpisodeWriter) -> list[rrb.Spatial2DView]:
    root, sensors = writer.root, range(writer.num_sensors)
    of = f" of {writer.name}" if writer.name else ""
    images = [rrb.Spatial2DView(name=f"tactile image{of}, counts", origin=f"{root}/{writer.image_path(k)}") for k in sensors]
    if writer.has_taxel_counts:
        images += [
            rrb.Spatial2DView(name=f"counts{of} along {axis}", origin=f"{root}/{writer.counts_path(k, axis)}")
            for k in sensors
            for axis in COUNT_AXES
        ]
    return images


def _episode_tab(writers: Sequence[EpisodeWriter]) -> rrb.Horizontal:
    """One episode: one writer, or one for each sensor with columns of its own."""
    root = writers[0].root
    sensors = [
        (writer.sensor_path(k), writer.name or (f"sensor {k}" if k else "sensor")) for writer in writers for k in range(writer.num_sensors)
    ]
    frames = [("world", "world"), *sensors] if writers[0].name else [*sensors, ("world", "world")]
    spaces = [rrb.Spatial3DView(name=name, origin=f"{root}/{path}", contents=[f"/{root}/world/**"]) for path, name in frames]
    images = [image for writer in writers for image in _images(writer)]
    arranged = rrb.Grid(*images) if writers[0].name else rrb.Tabs(*images)
    words = rrb.TextDocumentView(name="episode", origin=f"{root}/summary")
    plots = _plots(root, [series for writer in writers for series in writer.series])
    return rrb.Horizontal(
        rrb.Vertical(rrb.Tabs(*spaces), arranged, row_shares=[2, 1]),
        rrb.Vertical(rrb.Tabs(*plots, words)),
        name=root.replace("_", " "),
    )


def blueprint_of(writers: Sequence[EpisodeWriter]) -> rrb.Blueprint:
    """The layout of a recording."""
    episodes = [list(group) for _, group in itertools.groupby(writers, lambda writer: writer.root)]
    tabs = rrb.Tabs(*map(_episode_tab, episodes))
    panels = rrb.BlueprintPanel(state="collapsed"), rrb.SelectionPanel(state="collapsed"), rrb.TimePanel(state="collapsed", timeline="time")
    return rrb.Blueprint(tabs, *panels)

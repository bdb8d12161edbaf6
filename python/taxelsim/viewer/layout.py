"""How the viewer arranges the episodes: one tab each."""

from __future__ import annotations

import fnmatch
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


def _episode_tab(writer: EpisodeWriter) -> rrb.Horizontal:
    root, sensors = writer.root, range(writer.num_sensors)
    frames = [*((writer.sensor_path(k), f"sensor {k}" if k else "sensor") for k in sensors), ("world", "world")]
    spaces = [rrb.Spatial3DView(name=name, origin=f"{root}/{path}", contents=[f"/{root}/world/**"]) for path, name in frames]
    images = [rrb.Spatial2DView(name="tactile image, counts", origin=f"{root}/{writer.image_path(k)}") for k in sensors]
    if writer.has_taxel_counts:
        images += [
            rrb.Spatial2DView(name=f"counts along {axis}", origin=f"{root}/{writer.counts_path(k, axis)}")
            for k in sensors
            for axis in COUNT_AXES
        ]
    words = rrb.TextDocumentView(name="episode", origin=f"{root}/summary")
    return rrb.Horizontal(
        rrb.Vertical(rrb.Tabs(*spaces), rrb.Tabs(*images), row_shares=[2, 1]),
        rrb.Vertical(rrb.Tabs(*_plots(root, writer.series), words)),
        name=root.replace("_", " "),
    )


def blueprint_of(writers: Sequence[EpisodeWriter]) -> rrb.Blueprint:
    """The layout of a recording."""
    tabs = rrb.Tabs(*[_episode_tab(writer) for writer in writers])
    panels = rrb.BlueprintPanel(state="collapsed"), rrb.SelectionPanel(state="collapsed"), rrb.TimePanel(state="collapsed", timeline="time")
    return rrb.Blueprint(tabs, *panels)

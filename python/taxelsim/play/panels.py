"""The side panel of the playground: a figure of each sensor, curves over time, and a table of predicted and true features."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence

import numpy as np
import viser
from numpy.typing import NDArray
from viser import uplot

from .._core import counts_range
from .._counts import IMAGE_UNITS
from .._pictures import sensor_figure
from .prediction import Features, Linearization
from .state import View, step_time

COUNTS, NEWTONS = IMAGE_UNITS
_JPEG_QUALITY = 90
_LEAST_FORCE = 1e-3  # N, of the brightest colour
_NUM_POINTS = 200  # of a curve
_BLUE, _ORANGE = "#0072b2", "#d55e00"
_COLOURS = (_BLUE, "#e69f00", "#009e73", "#cc79a7", "#56b4e9", _ORANGE, "#f0e442", "#000000")  # Okabe and Ito, Color universal design, 2008


class Scale:
    """The value of the brightest colour, by unit: the largest so far, so that colours do not flicker."""

    def __init__(self) -> None:
        self._ranges: dict[str, float] = {}

    def range_of(self, unit: str, values: NDArray[np.float64], noise: float) -> float:
        """The range that includes `values`. noise: counts."""
        found = counts_range(values, noise) if unit == COUNTS else float(values.max(initial=_LEAST_FORCE))
        self._ranges[unit] = max(self._ranges.get(unit, 0.0), found)
        return self._ranges[unit]


def shown(view: View, unit: str) -> NDArray[np.float64]:
    """One value per taxel: counts, or true normal forces."""
    return view.newtons if unit == NEWTONS else view.counts.astype(np.float64)


class Panels:
    """Figures, table and curves in the side panel of a server."""

    def __init__(self, gui: viser.GuiApi, title: str, names: Sequence[str]) -> None:
        """names: of the sensors of a robot; one empty name for a sensor alone, whose curves show the edge angle and predictions as well."""
        self._title = title
        self._figures = [
            gui.add_image(np.full((8, 8, 3), 255, np.uint8), label=name or None, format="jpeg", jpeg_quality=_JPEG_QUALITY)
            for name in names
        ]
        self._table = gui.add_html("")
        self._points: deque[tuple[float, ...]] = deque(maxlen=_NUM_POINTS)
        self._time = self._angle = 0.0
        self._is_alone = not names[0]
        labels = ("total_force, N", "edge_angle, deg") if self._is_alone else ("total_force, N",)
        self._curves = [
            gui.add_uplot(
                *_empty_plot(label, names), title=None if self._is_alone else label, scales={"x": uplot.Scale(time=False)}, height=150
            )
            for label in labels
        ]

    def show(self, views: Sequence[View], unit: str, range: float, prediction: Linearization | None) -> None:
        """Draws a frame of each sensor."""
        expected = None if prediction is None else prediction.features_at(views[0].pose)
        for figure, view in zip(self._figures, views, strict=True):
            figure.image = _figure_of(view, self._title, unit, range, prediction)
        self._table.content = "" if expected is None else _table(views[0].truth, expected)
        self._draw_curves(views, expected)

    def _draw_curves(self, views: Sequence[View], expected: Features | None) -> None:
        self._time += step_time(views[0].sensor)
        forces = [view.truth.total_force for view in views]
        if self._is_alone:
            # Without a prediction its line lies under that of the truth: uPlot draws no axis for values that are not numbers.
            both = (expected or views[0].truth, views[0].truth)
            angles = [_continued(f.edge_angle, self._angle) for f in both]
            self._angle = angles[1]
            forces = [*(f.total_force for f in both), *map(math.degrees, angles)]
        self._points.append((self._time, *forces))
        time, *curves = np.array(self._points).T
        width = len(curves) // len(self._curves)
        for k, plot in enumerate(self._curves):
            plot.data = (time, *curves[k * width : (k + 1) * width])


def _empty_plot(label: str, names: Sequence[str]) -> tuple[tuple[NDArray[np.float64], ...], tuple[uplot.Series, ...]]:
    """Data and series: the prediction and `label` for a sensor alone, else each sensor."""
    lines = [(name, _COLOURS[k % len(_COLOURS)]) for k, name in enumerate(names)]
    lines = lines if names[0] else [("predicted", _ORANGE), (label, _BLUE)]
    series = (uplot.Series(label="s"), *(uplot.Series(label=name, stroke=colour) for name, colour in lines))
    return (np.zeros(2),) * len(series), series


def _figure_of(view: View, title: str, unit: str, range: float, prediction: Linearization | None) -> NDArray[np.uint8]:
    f = view.features
    line = f"{f['total_force']:.4g} N   angle {math.degrees(f['edge_angle']):.1f}°   area {1e6 * f['contact_area']:.3g} mm²"
    images = [("", shown(view, unit))]
    if prediction is not None:
        images = [("true normal forces", view.newtons), ("predicted by the Jacobian", prediction.newtons_at(view.pose))]
        unit = NEWTONS
    if unit == NEWTONS:  # whole millinewtons, which fit into the cells
        images, range = [(name, np.rint(1e3 * values)) for name, values in images], 1e3 * range
    return sensor_figure(view.sensor, images, view.name or title, line, "mN" if unit == NEWTONS else COUNTS, range)


def _continued(angle: float, last: float) -> float:
    """The angle of the same line that is nearest to `last`, rad, so that a curve continues beyond 90 degrees."""
    return angle - math.pi * round((angle - last) / math.pi)


def _table(true: Features, predicted: Features) -> str:
    lines = ["                      true  predicted"]
    lines.append(f"total_force, N  {true.total_force:10.3f} {predicted.total_force:10.3f}")
    for axis, name in enumerate("xy"):
        values = (round(1e3 * each.center_of_pressure[axis], 3) + 0.0 for each in (true, predicted))
        lines.append("center {}, mm    {:10.3f} {:10.3f}".format(name, *values))
    lines.append(f"edge_angle, deg {math.degrees(true.edge_angle):10.2f} {math.degrees(predicted.edge_angle):10.2f}")
    return "<pre style='font-size: 80%; margin: 0 0.7em'>" + "\n".join(lines) + "</pre>"

"""The playground: a server of viser, its GUI, and a thread that computes the newest settings."""

from __future__ import annotations

import html
import math
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from .._core import Device, Sensor, load_sensor, max_depth_error_of, parse_object
from ..errors import Error, InputError
from ..pictures import ARROW_TAXELS, TactilePictures, colours_of, taxel_axes
from ..program import SCENES
from ..viewer.shapes import taxel_quads, triangles_of
from . import fields
from .server import LOOPBACK, start_server
from .state import Press, Settings, View, law_name, settings_at
from .texts import program_text, scene_text

DEFAULT_SENSOR, DEFAULT_OBJECT = "wts0614", "cylinder:0.008,0.04"
UNITS = 100.0
"""Units of the 3-D scene per metre: controls and camera of viser suit a scene of that size."""
_OBJECT_COLOUR, _ARROW_COLOUR = (190, 190, 200), (230, 60, 60)


def sensor_of(name: str | Path | Sensor) -> Sensor:
    """A sensor, from a sensor file or by the name of one that ships with the package. Raises InputError."""
    if isinstance(name, Sensor):
        return name
    shipped = SCENES / "sensors" / f"{name}.yaml"
    return load_sensor(shipped if shipped.is_file() and "/" not in str(name) else name)


class Playground:
    """Serves a page on the loopback interface in which an object is pressed into a sensor. All browsers share one state.

    >>> taxelsim.play.Playground("wts0614", ["sphere:0.01"])  # the last line of a notebook cell shows the page

    sensor: a Sensor, a sensor file, or the name of one that ships with the package.
    objects: texts of parse_object(); the page offers all of them.
    device: default Device.open().
    port: of 127.0.0.1; 0: a free one.

    Raises InputError for a sensor or an object that is not valid, ImportError without viser.
    """

    def __init__(
        self,
        sensor: str | Path | Sensor = DEFAULT_SENSOR,
        objects: Sequence[str] = (DEFAULT_OBJECT,),
        *,
        device: Device | None = None,
        port: int = 0,
    ) -> None:
        base = sensor_of(sensor)
        self._specs = list(objects) or [DEFAULT_OBJECT]
        items = [parse_object(spec, max_depth_error=max_depth_error_of(base.skin)) for spec in self._specs]
        self._press = Press(device or Device.open(), base, items)
        half = math.sqrt(0.5)
        self._settings = Settings(rotation=(half, half, 0.0, 0.0), depth=0.05 * base.skin.thickness)
        self._condition = threading.Condition()
        self._pending: Settings | None = self._settings
        self._is_closed = False
        self.view: View | None = None
        """The newest frame."""
        self.num_views = 0
        """Frames so far."""
        self._server, guard = start_server(port, "taxelsim play")
        self.url = f"http://{LOOPBACK}:{self._server.get_port()}/{guard.token}/"
        """Address of the page, with the token. Any user of this machine who has it can use the playground."""
        self._build()
        self._worker = threading.Thread(target=self._work, daemon=True)
        self._worker.start()

    def close(self) -> None:
        """Stops the server and the computation."""
        with self._condition:
            self._is_closed = True
            self._condition.notify()
        self._worker.join()
        self._server.stop()

    def _repr_html_(self) -> str:
        return f'<iframe src="{html.escape(self.url)}" width="100%" height="700" style="border:0"></iframe>'

    def change(self, change: Callable[[Settings], Settings]) -> None:
        """Applies a change to the newest settings. The worker computes the newest only. An error is a line on the page."""
        with self._condition:
            try:
                self._settings = self._pending = change(self._settings)
            except Error as error:
                self._status.value = str(error)
            self._condition.notify()

    def _work(self) -> None:
        while True:
            with self._condition:
                self._condition.wait_for(lambda: self._pending is not None or self._is_closed)
                if self._is_closed:
                    return
                settings, self._pending = self._pending, None
            assert settings is not None
            try:
                if self._press.needs_model(settings):
                    self._status.value = "building the model ..."
                begun = time.perf_counter()
                view = self._press.view(settings)
                self._show(view, time.perf_counter() - begun)
            except (Error, ArithmeticError, ValueError) as error:
                self._status.value = str(error)

    def _build(self) -> None:
        base, gui, scene = self._press.base, self._server.gui, self._server.scene
        self._status = gui.add_text("status", "starting ...", disabled=True)
        self._image = gui.add_image(np.zeros((8, 8, 3), np.uint8), label="tactile image", format="png")
        self._numbers = gui.add_html("")
        self._object = gui.add_dropdown("object", [f"{i}: {spec}" for i, spec in enumerate(self._specs)])
        self._object.on_update(lambda _: self._choose_object())
        self._add_slider("depth, mm", 1e3 * base.skin.thickness, 1e3 * self._settings.depth, self._set_depth, ("randomization", "depth_mm"))
        self._add_slider("load, N (0: by depth)", 20.0, 0.0, self._set_load, ("randomization", "load"))
        skin, readout = base.skin, base.readout
        self._add_change("noise, counts", "noise", 0.05 * readout.saturation, readout.noise, ("readout", "noise"))
        self._add_change("friction", "friction", 2.0, skin.friction.friction_coefficient, ("skin", "friction_coefficient"))
        if base.psf.sigma == 0:
            self._add_change("point spread, taxels", "spread", 2.0, 0.0, ("psf", "gaussian", "sigma"))
        laws, samplings = fields.choices("skin", "law"), fields.choices("sensor", "depth_sampling")
        own = next(law for law in laws if law.replace("_", "") == law_name(skin))
        self._add_choice("contact law", "law", laws, own)
        self._add_choice("sampling", "sampling", samplings, base.depth_sampling.name.lower())
        gui.add_button("copy as Python").on_click(lambda event: self._send(event, "play.py", program_text))
        gui.add_button("save as scene").on_click(lambda event: self._send(event, "play.yaml", scene_text))
        corners = taxel_quads(base)[0].reshape(-1, 4, 3)
        self._taxels = [
            scene.add_mesh_simple(f"/taxels/{i}", UNITS * quad, np.array([[0, 1, 2], [0, 2, 3]]), color=(20, 20, 60), side="double")
            for i, quad in enumerate(corners)
        ]
        self._arrows = scene.add_arrows("/shear", np.zeros((1, 2, 3), np.float32), _ARROW_COLOUR, visible=False)
        self._gizmo = scene.add_transform_controls("/object", scale=2.0)
        self._gizmo.on_update(lambda event: self._drag(event.target))
        self._draw_object()
        self._pictures = TactilePictures(base)
        extent = UNITS * float(np.ptp(base.taxel_positions, axis=0).max() + 0.01)
        self._server.initial_camera.position = (0.6 * extent, 0.0, 0.8 * extent)
        self._server.initial_camera.look_at = (0.0, 0.0, 0.0)

    def _draw_object(self) -> None:
        shape = self._press.objects[self._settings.object_index].shape
        vertices, triangles = triangles_of(shape, 0.1)
        self._server.scene.add_mesh_simple("/object/shape", UNITS * vertices, triangles, color=_OBJECT_COLOUR, opacity=0.5, side="double")

    def _add_slider(self, label: str, high: float, value: float, use: Callable[[float], None], key: tuple[str, ...]) -> None:
        limits = fields.key(*key)
        high = max(min(high, limits.get("maximum", high)), value)
        hint = limits["description"]
        slider = self._server.gui.add_slider(label, 0.0, high, high / 500, value, hint=hint)

        def update(_: Any) -> None:
            if math.isfinite(slider.value) and 0 <= slider.value <= high:
                use(slider.value)
            else:
                self._status.value = f"{label}: {slider.value} is not allowed: 0 to {high:.4g}"

        slider.on_update(update)

    def _changed(self, **changes: Any) -> None:
        self.change(lambda s: replace(s, changes=replace(s.changes, **changes)))

    def _add_change(self, label: str, name: str, high: float, value: float, key: tuple[str, ...]) -> None:
        self._add_slider(label, high, value, lambda number: self._changed(**{name: number}), key)

    def _add_choice(self, label: str, name: str, values: list[str], value: str) -> None:
        dropdown = self._server.gui.add_dropdown(label, values, initial_value=value)

        def update(_: Any) -> None:
            if dropdown.value in values:
                self._changed(**{name: dropdown.value})
            else:
                self._status.value = f"{label}: {dropdown.value!r:.40} is not allowed: {', '.join(values)}"

        dropdown.on_update(update)

    def _set_depth(self, millimetres: float) -> None:
        self.change(lambda s: replace(s, depth=1e-3 * millimetres, load=None))

    def _set_load(self, newtons: float) -> None:
        self.change(lambda s: replace(s, load=newtons if newtons > 0 else None))

    def _choose_object(self) -> None:
        index = self._object.value.partition(":")[0]
        if index.isdecimal() and int(index) < len(self._specs):
            self.change(lambda s: replace(s, object_index=int(index)))
            self._draw_object()

    def _drag(self, target: Any) -> None:
        position, rotation = np.array(target.position) / UNITS, np.array(target.wxyz)
        self.change(lambda s: settings_at(s, self._press.objects[s.object_index], position, rotation))

    def _send(self, event: Any, name: str, text_of: Callable[..., str]) -> None:
        view = self.view
        if view is None or event.client is None:
            return
        index = view.settings.object_index
        try:
            text = text_of(view, self._press.objects[index], self._specs[index])
            event.client.send_file_download(name, text.encode(), save_immediately=True)
        except InputError as error:
            self._status.value = str(error)

    def _show(self, view: View, seconds: float) -> None:
        picture = self._pictures.draw(view.counts[None])[0]
        colours = colours_of(view.counts / self._pictures.range)
        with self._server.atomic():
            for taxel, colour in zip(self._taxels, colours, strict=True):
                taxel.color = tuple(colour.tolist())
            self._show_shear(view)
            if view.settings.load is not None:
                self._gizmo.position = UNITS * view.pose[:3]
            elif self.view is None or self.view.settings.depth != view.settings.depth:
                self._gizmo.position, self._gizmo.wxyz = UNITS * view.pose[:3], view.pose[3:]
            self._image.image = np.repeat(np.repeat(picture, 2, 0), 2, 1)
            f = view.features
            self._numbers.content = (
                f"<pre>force      {f['total_force']:9.3f} N\npeak       {f['peak_force']:9.3f} N\n"
                f"edge angle {math.degrees(f['edge_angle']):9.1f} deg</pre>"
            )
            reached = "" if view.load_reached else "; the load is out of reach"
            self._status.value = f"{1e3 * seconds:.0f} ms{reached}"
        self.view, self.num_views = view, self.num_views + 1

    def _show_shear(self, view: View) -> None:
        scale = float(np.abs(view.shear).max(initial=0.0))
        self._arrows.visible = scale > 0
        if scale > 0:
            pitch = max(view.sensor.patches[0].pitch)
            vectors = np.einsum("ta,tas->ts", view.shear / scale, taxel_axes(view.sensor)) * (ARROW_TAXELS * pitch)
            starts = view.sensor.taxel_positions
            seen = np.linalg.norm(view.shear, axis=1) > 0.05 * scale
            self._arrows.points = (UNITS * np.stack([starts, starts + vectors], 1)[seen]).astype(np.float32)


__all__ = ["Playground"]

"""The playground: a server of viser, its controls, and a thread that computes the newest settings."""

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

from .._arguments import LENGTH_UNITS
from .._core import Device, Object, Robot, Scene, Sensor, is_scene_file, load_scene, load_sensor, max_depth_error_of, parse_object
from ..errors import Error, InputError
from ..program import SCENES
from . import fields
from .changes import law_name
from .joints import add_joint_sliders
from .panels import COUNTS, NEWTONS, Panels, Scale, shown
from .prediction import Linearization
from .scene_3d import Scene3D
from .server import LOOPBACK, start_server
from .skins import UNITS
from .state import Item, Press, Settings, View, settings_at, with_object_at
from .texts import program_text, robot_program_text, scene_text
from .uploads import MAX_BYTES, SUFFIXES, Upload

DEFAULT_SENSOR, DEFAULT_OBJECT = "wts0614", "cylinder:0.008,0.04"
UP_AXES = ("z", "y", "x")


def sensor_of(name: str | Path | Sensor) -> Sensor:
    """A sensor, from a sensor file or by the name of one that ships with the package. Raises InputError."""
    if isinstance(name, Sensor):
        return name
    shipped = SCENES / "sensors" / f"{name}.yaml"
    return load_sensor(shipped if shipped.is_file() and "/" not in str(name) else name)


def scene_of(name: str | Path | Sensor) -> Scene | None:
    """A scene of kind grasp, from its file; None for a sensor. Raises InputError for a scene of another kind."""
    if isinstance(name, Sensor) or not (Path(name).is_file() and is_scene_file(name)):
        return None
    scene = load_scene(name)
    if scene.kind is not Scene.Kind.GRASP:
        raise InputError(f"{name}: kind: {scene.kind.name.lower()} is not allowed: a sensor file, or a scene of kind grasp")
    return scene


class Playground:
    """Serves a page on the loopback interface in which objects are pressed into sensors. All browsers share one state.

    >>> taxelsim.play.Playground("wts0614", ["sphere:0.01"])  # the last line of a notebook cell shows the page

    sensor: a Sensor, a sensor file, the name of one that ships with the package, or a scene of kind grasp. The page of a scene has sliders
        of the joints of its robot, and all of its objects.
    objects: texts of parse_object(); the page offers all of them. Not allowed with a scene.
    device: default Device.open().
    port: of 127.0.0.1; 0: a free one.

    Raises InputError for a sensor, a scene or an object that is not valid, ImportError without viser.
    """

    def __init__(
        self,
        sensor: str | Path | Sensor = DEFAULT_SENSOR,
        objects: Sequence[str] = (),
        *,
        device: Device | None = None,
        port: int = 0,
    ) -> None:
        scene = scene_of(sensor)
        if scene is None:
            self._press, self._settings = _press_of(device or Device.open(), sensor_of(sensor), objects)
        else:
            self._press, self._settings = robot_press_of(device or Device.open(), scene, objects)
        self._base = next(iter(self._press.sensors.values()))
        self._title = self._base.name if scene is None else scene.name
        self._scene_file = "" if scene is None else str(scene.file)
        self._condition = threading.Condition()
        self._tasks: list[Callable[[], None]] = []
        self._pending: Settings | None = self._settings
        self._is_closed = False
        self._unit = COUNTS
        self._scale = Scale()
        self._prediction: Linearization | None = None
        self.views: tuple[View, ...] = ()
        """The newest frame of each sensor."""
        self.num_views = 0
        """Frames so far."""
        self._server, guard = start_server(port, "taxelsim play", MAX_BYTES, self._say)
        self.url = f"http://{LOOPBACK}:{self._server.get_port()}/{guard.token}/"
        """Address of the page, with the token. Any user of this machine who has it can use the playground."""
        self._build()
        self._worker = threading.Thread(target=self._work, daemon=True)
        self._worker.start()

    @property
    def view(self) -> View | None:
        """The newest frame of the first sensor."""
        return self.views[0] if self.views else None

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
                self._say(str(error))
            self._condition.notify()

    def _say(self, line: str) -> None:
        self._status.value = line

    def _later(self, task: Callable[[], None]) -> None:
        """Lets the worker, which alone uses the device, do a task before the next frame."""
        with self._condition:
            self._tasks.append(task)
            self._condition.notify()

    def _work(self) -> None:
        while True:
            with self._condition:
                self._condition.wait_for(lambda: self._pending is not None or self._tasks or self._is_closed)
                if self._is_closed:
                    return
                tasks, self._tasks = self._tasks, []
                settings, self._pending = self._pending, None
            try:
                for task in tasks:
                    task()
                if settings is not None:
                    self._compute(settings)
                elif self.views:
                    self._show(self.views)
            except (Error, ArithmeticError, ValueError) as error:
                self._say(str(error))

    def _compute(self, settings: Settings) -> None:
        if self._press.needs_model(settings):
            self._say("building the model ...")
            self._scale, self._prediction, self._predicts.value = Scale(), None, False
        begun = time.perf_counter()
        views = self._press.views(settings)
        self._show(views)
        self.views, self.num_views = views, self.num_views + 1
        reached = "" if views[0].load_reached else "; the load is out of reach"
        self._say(f"{1e3 * (time.perf_counter() - begun):.0f} ms{reached}")

    def _show(self, views: tuple[View, ...]) -> None:
        unit = NEWTONS if self._prediction is not None else self._unit
        values = np.concatenate([shown(view, unit) for view in views])
        brightest = self._scale.range_of(unit, values, max(view.sensor.readout.noise for view in views))
        newest = views[0].settings
        with self._server.atomic():
            is_new = self.view is None or self.view.settings.depth != newest.depth
            self._scene.show(views, values / brightest, moves=is_new or newest.load is not None)
            self._panels.show(views, unit, brightest, self._prediction)

    def _build(self) -> None:
        gui, robot = self._server.gui, self._press.robot
        self._status = gui.add_text("status", "starting ...", disabled=True)
        self._panels = Panels(gui, self._title, list(self._press.sensors))
        if robot is None:
            self._build_object()
        else:
            add_joint_sliders(gui, robot, self._settings.positions, lambda q: self.change(lambda s: replace(s, positions=q)))
        follows = gui.add_checkbox("sliding adds up shear", self._settings.follows)
        follows.on_update(lambda _: self.change(lambda s: replace(s, follows=bool(follows.value))))
        self._build_sensor()
        with gui.add_folder("view"):
            unit = gui.add_dropdown("taxels show", (COUNTS, NEWTONS), initial_value=self._unit)
            unit.on_update(lambda _: self._show_unit(unit.value))
            self._predicts = gui.add_checkbox("predict by the Jacobian from here", False, visible=robot is None)
            self._predicts.on_update(lambda event: self._predict(event.client is not None and bool(self._predicts.value)))
        gui.add_button("copy as Python").on_click(lambda event: self._send(event, "play.py", self._program))
        if robot is None:
            gui.add_button("save as scene").on_click(lambda event: self._send(event, "play.yaml", lambda: scene_text(*self._seen)))
        self._scene = Scene3D(self._server, self._press, self._settings, self._drag)
        if robot is None:
            self._scene.draw_object(self._shape)

    def _build_object(self) -> None:
        gui = self._server.gui
        with gui.add_folder("object"):
            self._object = gui.add_dropdown("object", self._object_names())
            self._object.on_update(lambda _: self._choose_object())
            upload = gui.add_upload_button("upload a mesh", mime_type=",".join(SUFFIXES))
            upload.on_upload(lambda event: self._receive(event.target.value, event.client))
            thickness = self._base.skin.thickness
            self._add_slider(fields.field("randomization", "depth_mm"), 1e3 * thickness, 1e3 * self._settings.depth, self._set_depth)
            self._add_slider(fields.field("randomization", "load"), 20.0, 0.0, self._set_load)

    def _build_sensor(self) -> None:
        base = self._base
        with self._server.gui.add_folder("sensor"):
            skin, readout = base.skin, base.readout
            self._add_choice(fields.field("skin", "law"), lambda law: law.replace("_", "") == law_name(skin))
            self._add_choice(fields.field("sensor", "depth_sampling"), lambda name: name == base.depth_sampling.name.lower())
            self._add_change(fields.field("skin", "friction_coefficient"), 2.0, skin.friction.friction_coefficient)
            self._add_change(fields.field("readout", "noise"), 0.05 * readout.saturation, readout.noise)
            if all(sensor.psf.sigma == 0 for sensor in self._press.sensors.values()):
                self._add_change(fields.field("psf", "gaussian", "sigma"), 2.0, 0.0)

    @property
    def _shape(self) -> Any:
        return self._press.items[self._settings.object_index].object.shape

    def _object_names(self) -> list[str]:
        return [f"{i}: {item.spec}" for i, item in enumerate(self._press.items)]

    def _add_slider(self, field: fields.Field, high: float, value: float, use: Callable[[float], None]) -> None:
        low = max(field.low, 0.0)
        value = max(value, low)
        high = max(min(field.high, high), value)
        slider = self._server.gui.add_slider(field.label, low, high, (high - low) / 500, value, hint=field.text)

        def update(_: Any) -> None:
            if math.isfinite(slider.value) and low <= slider.value <= high:
                use(slider.value)
            else:
                self._say(f"{field.label}: {slider.value} is not allowed: {low:.4g} to {high:.4g}")

        slider.on_update(update)

    def _changed(self, **changes: Any) -> None:
        self.change(lambda s: replace(s, changes=replace(s.changes, **changes)))

    def _add_change(self, field: fields.Field, high: float, value: float) -> None:
        self._add_slider(field, high, value, lambda number: self._changed(**{field.name: number}))

    def _add_choice(self, field: fields.Field, is_own: Callable[[str], bool]) -> None:
        dropdown = self._server.gui.add_dropdown(
            field.label, field.choices, initial_value=next(filter(is_own, field.choices)), hint=field.text
        )

        def update(_: Any) -> None:
            if dropdown.value in field.choices:
                self._changed(**{field.name: dropdown.value})
            else:
                self._say(f"{field.name}: {dropdown.value!r:.40} is not allowed: {', '.join(field.choices)}")

        dropdown.on_update(update)

    def _set_depth(self, millimetres: float) -> None:
        self.change(lambda s: replace(s, depth=1e-3 * millimetres, load=None))

    def _set_load(self, newtons: float) -> None:
        self.change(lambda s: replace(s, load=newtons if newtons > 0 else None))

    def _show_unit(self, unit: str) -> None:
        if unit in (COUNTS, NEWTONS):
            self._unit = unit
            self._later(lambda: None)

    def _predict(self, wanted: bool) -> None:
        def linearize() -> None:
            self._prediction = self._press.linearize() if wanted else None

        self._later(linearize)

    def _choose_object(self) -> None:
        index = self._object.value.partition(":")[0]
        if index.isdecimal() and int(index) < len(self._press.items):
            self.change(lambda s: replace(s, object_index=int(index)))
            self._scene.draw_object(self._shape)

    def _receive(self, uploaded: Any, client: Any) -> None:
        """Reads an uploaded mesh and asks for the unit of its file."""
        try:
            self._say(f"reading {uploaded.name!r:.80} ...")
            upload = Upload.of(uploaded.name, uploaded.content)
        except Error as error:
            self._say(str(error))
            return
        self._say(f"{upload.name}: which unit?")
        with client.gui.add_modal(f"Which unit has {upload.name}?") as question:
            sides = " x ".join(f"{side:.4g}" for side in upload.sides)
            client.gui.add_text("bounding box", f"{sides} units of the file, {upload.num_triangles} triangles", disabled=True)
            unit = client.gui.add_dropdown("unit", tuple(LENGTH_UNITS), initial_value=upload.likely_unit)
            up_axis = client.gui.add_dropdown("axis that points away from the skin", UP_AXES)
            accept, cancel = client.gui.add_button("use it"), client.gui.add_button("cancel")

        def use(_: Any) -> None:
            question.close()
            try:
                self._say(f"simplifying {upload.name} ...")
                mesh = upload.mesh(unit.value, up_axis.value, max_depth_error_of(self._base.skin))
            except Error as error:
                self._say(str(error))
                return
            self._later(lambda: self._add(Item(Object(mesh), upload.name, LENGTH_UNITS[unit.value], up_axis.value)))

        accept.on_click(use)
        cancel.on_click(lambda _: question.close())

    def _add(self, item: Item) -> None:
        index = self._press.add(item)
        self._object.options = self._object_names()
        self._object.value = self._object.options[index]  # calls _choose_object()

    def _drag(self, number: int, target: Any) -> None:
        position, rotation = np.array(target.position) / UNITS, np.array(target.wxyz)
        if self._press.robot is None:
            self.change(lambda s: settings_at(s, self._press.items[s.object_index].object, position, rotation))
        else:
            self.change(lambda s: with_object_at(s, number, position, rotation))

    @property
    def _seen(self) -> tuple[View, Item]:
        """The newest frame of a sensor alone, and the object in it."""
        return self.views[0], self._press.items[self.views[0].settings.object_index]

    def _program(self) -> str:
        return program_text(*self._seen) if self._press.robot is None else robot_program_text(self.views, self._press, self._scene_file)

    def _send(self, event: Any, name: str, text_of: Callable[[], str]) -> None:
        if not self.views or event.client is None:
            return
        try:
            text = text_of()
            event.client.send_file_download(name, text.encode(), save_immediately=True)
        except Error as error:
            self._say(str(error))


def _press_of(device: Device, base: Sensor, objects: Sequence[str]) -> tuple[Press, Settings]:
    max_depth_error = max_depth_error_of(base.skin)
    items = [Item(parse_object(spec, max_depth_error=max_depth_error), spec) for spec in list(objects) or [DEFAULT_OBJECT]]
    half = math.sqrt(0.5)
    return Press(device, {"": base}, items), Settings(rotation=(half, half, 0.0, 0.0), depth=0.05 * base.skin.thickness)


def robot_press_of(device: Device, scene: Scene, objects: Sequence[str]) -> tuple[Press, Settings]:
    """Sensors and objects of a scene of kind grasp, at its start. Raises InputError for other objects."""
    if objects:
        raise InputError(f"objects: {', '.join(objects)} is not allowed: a scene has its own objects")
    robot = Robot(scene.file)
    items = [Item(item, item.name) for item in scene.objects]
    settings = Settings(positions=tuple(joint[-1] for joint in robot.joints), objects=tuple(scene.object_poses))
    return Press(device, dict(scene.sensors), items, robot), settings


__all__ = ["Playground"]

"""A Python program and a scene that reproduce a View."""

from __future__ import annotations

from typing import Any

from .._core import Box, Capsule, Cone, Cylinder, HalfSpace, Sphere, Torus, lowest_point, sensor_text
from ..errors import InputError
from .state import Item, Settings, View, step_time

_FIELDS: dict[type, tuple[str, ...]] = {
    Sphere: ("radius",),
    Cylinder: ("radius", "length"),
    Capsule: ("radius", "length"),
    Box: ("size",),
    HalfSpace: (),
    Cone: ("radius", "height"),
    Torus: ("major_radius", "minor_radius"),
}


def _numbers(values: Any) -> str:
    return ", ".join(repr(float(value)) for value in values)


def program_text(view: View, item: Item) -> str:
    """A program that computes the tactile image of a view, step by step along its path. It reads a mesh file from the current folder."""

    def step_of(s: Settings) -> str:
        return f"    ([{_numbers(s.row)}], [{_numbers(lowest_point(item.object, s.rotation))}], {s.load!r}),"

    steps = "\n".join(map(step_of, view.path))
    mesh = "" if type(item.object.shape) in _FIELDS else f"scale={item.scale!r}, up_axis={item.up_axis!r}, "
    return f'''import tempfile
from pathlib import Path

import numpy as np
import taxelsim

SENSOR = """\\
{sensor_text(view.sensor)}"""
STEPS = [  # pose of the lowest point in S: m, quaternion w, x, y, z; the lowest point in the object, m; load, N, None: by depth
{steps}
]

with tempfile.TemporaryDirectory() as folder:
    file = Path(folder, "sensor.yaml")
    file.write_text(SENSOR)
    sensor = taxelsim.load_sensor(file)
item = taxelsim.parse_object({item.spec!r}, {mesh}max_depth_error=taxelsim.max_depth_error_of(sensor.skin))
model = taxelsim.Model(taxelsim.Device.open(), sensor, [item])
simulator = taxelsim.Simulator(model)
for pose, anchor, load in STEPS:
    simulator.set_loads(load)
    simulator.set_objects(0, np.array([pose]), anchor=np.array(anchor))
    simulator.step({step_time(view.sensor)!r})
    frame = simulator.read()
print(frame.tactile_image[0])
'''


def _shape_text(item: Item) -> str:
    shape = item.object.shape
    kind = type(shape)
    if kind not in _FIELDS:
        return f"mesh: {item.spec!r}\n    scale: {item.scale!r}\n    up_axis: {item.up_axis}"
    values = ", ".join(f"{name}: {getattr(shape, name)!r}" for name in _FIELDS[kind])
    return f"{'half_space' if kind is HalfSpace else kind.__name__.lower()}: {{{values}}}"


def scene_text(view: View, item: Item) -> str:
    """A scene of one episode whose tactile image is that of a view of one step. Raises InputError if a scene cannot hold the view."""
    s = view.settings
    if s.load is None and s.depth < 0:
        raise InputError(f"depth: {s.depth:.3g} m is not allowed in a scene: >= 0 m, an object in contact")
    if len(view.path) > 1 and view.shear.any():
        raise InputError("a scene holds no path of a drag: copy as Python, or switch off that sliding adds up shear")
    sensor = "\n".join(f"  {line}" for line in sensor_text(view.sensor).splitlines() if not line.startswith("format_version"))
    push = f"depth: {s.depth!r}" if s.load is None else f"load: {s.load!r}"
    return f"""format_version: 1
name: playground
kind: contacts
sensor:
{sensor}
objects:
  - {_shape_text(item)}
    orientation: {{rotation: [{_numbers(s.rotation)}]}}
    anchor: [{_numbers(lowest_point(item.object, s.rotation))}]
episode: {{num_steps: 1, simulation_rate: {1 / step_time(view.sensor)!r}}}
randomization: {{x: {s.x!r}, y: {s.y!r}, {push}}}
data_set: {{episodes: 1, seed: 0}}
"""

"""A Python program and a scene that reproduce a View."""

from __future__ import annotations

from .._core import Box, Capsule, Cone, Cylinder, HalfSpace, Object, Sphere, Torus, lowest_point, sensor_text
from ..errors import InputError
from .state import DEFAULT_STEP, View

_FIELDS = {
    Sphere: ("radius",),
    Cylinder: ("radius", "length"),
    Capsule: ("radius", "length"),
    Box: ("size",),
    HalfSpace: (),
    Cone: ("radius", "height"),
    Torus: ("major_radius", "minor_radius"),
}


def _step(view: View) -> float:
    return 1 / view.sensor.frame_rate if view.sensor.frame_rate > 0 else DEFAULT_STEP


def program_text(view: View, item: Object, spec: str) -> str:
    """A program that computes the tactile image of a view. spec: the object in the notation of the command line."""
    s = view.settings
    depth = s.depth if s.load is None else 0.0
    return f'''import tempfile
from pathlib import Path

import numpy as np
import taxelsim

SENSOR = """\\
{sensor_text(view.sensor)}"""

with tempfile.TemporaryDirectory() as folder:
    file = Path(folder, "sensor.yaml")
    file.write_text(SENSOR)
    sensor = taxelsim.load_sensor(file)
item = taxelsim.parse_object({spec!r}, max_depth_error=taxelsim.max_depth_error_of(sensor.skin))
model = taxelsim.Model(taxelsim.Device.open(), sensor, [item])
simulator = taxelsim.Simulator(model)
simulator.set_loads({s.load!r})
pose = [{s.x!r}, {s.y!r}, {-depth!r}, {", ".join(map(repr, s.rotation))}]  # m, quaternion w, x, y, z
simulator.set_objects(0, np.array([pose]), anchor=np.array({list(lowest_point(item, s.rotation))!r}))
simulator.step({_step(view)!r})
print(simulator.read().tactile_image[0])
'''


def _shape_text(item: Object, spec: str) -> str:
    kind = type(item.shape)
    if kind not in _FIELDS:
        return f"mesh: {spec!r}"
    values = ", ".join(f"{name}: {getattr(item.shape, name)!r}" for name in _FIELDS[kind])
    return f"{'half_space' if kind is HalfSpace else kind.__name__.lower()}: {{{values}}}"


def scene_text(view: View, item: Object, spec: str) -> str:
    """A scene of one episode whose tactile image is that of a view. Raises InputError if the object lies above the skin."""
    s = view.settings
    if s.load is None and s.depth < 0:
        raise InputError(f"depth: {s.depth:.3g} m is not allowed in a scene: >= 0 m, an object in contact")
    sensor = "\n".join(f"  {line}" for line in sensor_text(view.sensor).splitlines() if not line.startswith("format_version"))
    push = f"depth: {s.depth!r}" if s.load is None else f"load: {s.load!r}"
    return f"""format_version: 1
name: playground
kind: contacts
sensor:
{sensor}
objects:
  - {_shape_text(item, spec)}
    orientation: {{rotation: [{", ".join(map(repr, s.rotation))}]}}
    anchor: [{", ".join(map(repr, lowest_point(item, s.rotation)))}]
episode: {{num_steps: 1, simulation_rate: {1 / _step(view)!r}}}
randomization: {{x: {s.x!r}, y: {s.y!r}, {push}}}
data_set: {{episodes: 1, seed: 0}}
"""

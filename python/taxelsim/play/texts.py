"""A Python program and a scene that reproduce a View."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from .._core import Box, Capsule, Cone, Cylinder, HalfSpace, Sphere, Torus, lowest_point, sensor_text
from ..errors import InputError
from .state import DEFAULT_STEP, Item, Press, Settings, View, step_time

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


def robot_program_text(views: Sequence[View], press: Press, scene_file: str) -> str:
    """A program that computes the tactile images of all sensors of a robot, step by step along their path. It reads the scene file."""

    def step_of(s: Settings) -> str:
        objects = ", ".join(f"([{_numbers(X.position)}], [{_numbers(X.rotation)}])" for X in s.objects)
        return f"    ([{_numbers(s.positions)}], [{objects}]),"

    by_name = {view.name: view for view in views}
    steps = "\n".join(map(step_of, views[0].path))
    groups = "\n".join(f'    ({group.names!r}, """\\\n{sensor_text(by_name[group.names[0]].sensor)}"""),' for group in press.groups)
    return f"""import tempfile
from pathlib import Path

import numpy as np
import taxelsim

SCENE = {scene_file!r}
SENSORS = [  # names of sensors with equal settings; their sensor file
{groups}
]
STEPS = [  # joint positions, rad or m; X_WO of each object: m, quaternion w, x, y, z
{steps}
]


def poses_in(X_WS, objects):
    return [[*X.position, *X.rotation] for X in (X_WS.inverse() * taxelsim.Pose(*pose) for pose in objects)]


scene, robot, device = taxelsim.load_scene(SCENE), taxelsim.Robot(SCENE), taxelsim.Device.open()
images = {{}}
for names, text in SENSORS:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "sensor.yaml")
        file.write_text(text)
        sensor = taxelsim.load_sensor(file)
    model = taxelsim.Model(device, sensor, scene.objects)
    simulator = taxelsim.Simulator(model, len(names), num_slots=len(scene.objects))
    simulator.reset()  # each sensor has noise of its own
    for positions, objects in STEPS:
        X_WS = dict(zip((name for name, _ in robot.sensors), robot.sensor_poses(positions)))
        poses = np.array([poses_in(X_WS[name], objects) for name in names])
        simulator.set_objects(np.tile(np.arange(len(objects)), (len(names), 1)), poses)
        simulator.step(1 / sensor.frame_rate if sensor.frame_rate > 0 else {DEFAULT_STEP!r})
        frame = simulator.read()
    images.update(zip(names, frame.tactile_image.copy()))
for name, image in images.items():
    print(name, image, sep="\\n")
"""


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

"""`taxelsim ros2 SCENE`: publishes the touch of the sensors of a scene to ROS 2, without an installation of ROS."""

from __future__ import annotations

import argparse
import os
import signal
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from .._arguments import checked_positive
from .._core import Device, Model, Scene, load_scene
from ..environment import NO_OUTPUTS, Environment
from ..errors import InputError
from ..inputs import NO_OBJECT
from ..simulator import Simulator
from .running import run_command

_TERMINATED = 128 + signal.SIGTERM
_MIN_RATE, _MAX_RATE = 1e-2, 1e6  # Hz


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the arguments of the subcommand."""
    add = parser.add_argument
    add("scene", type=Path, metavar="SCENE", help="scene with objects; its sensors are published")
    add("--episode", type=int, default=0, metavar="N", help="scenes of kind servo: begins with the press at the start of this episode")
    add("--object", type=int, metavar="N", help="index of the object that poses move; default: that of the episode, else 0")
    add("--rate", type=float, metavar="HZ", help="frames per second; default: frame_rate of the sensor, else simulation_rate of the scene")
    add("--for", type=float, dest="seconds", metavar="SECONDS", help="ends after this time; default: Ctrl-C ends")
    add("--domain", type=int, default=os.environ.get("ROS_DOMAIN_ID") or 0, metavar="N", help="0 to 232; default: ROS_DOMAIN_ID, else 0")
    add("--interface", default="lo", metavar="NAME", help="network interface; default: lo, without multicast")
    add("--allow-input", action="store_true", help="takes poses of the object from /tactile/cmd_object_pose")
    add("--device", default="", metavar="NAME", help='"cpu", "discrete", an index, or part of a name; default: the best')


def main(arguments: Sequence[str]) -> int:
    """Runs the subcommand. Returns the exit status of run_command()."""
    parser = argparse.ArgumentParser(prog="taxelsim ros2", description=__doc__)
    add_arguments(parser)
    options = parser.parse_args(arguments)
    return run_command("ros2", lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    try:
        from ..ros2.bridge import Bridge
    except ModuleNotFoundError as error:
        raise ImportError(f"{error}: the bridge needs cyclonedds: pip install 'taxelsim[ros2]'") from error
    scene = load_scene(options.scene)
    rate = (scene.sensor.frame_rate or scene.simulation_rate) if options.rate is None else options.rate
    if not _MIN_RATE <= rate <= _MAX_RATE:
        raise InputError(f"--rate: {rate} is not allowed: {_MIN_RATE:g} to {_MAX_RATE:g} Hz")
    seconds = None if options.seconds is None else checked_positive("--for", options.seconds)
    if not scene.objects:
        raise InputError(f"{scene.file}: this scene has no objects, whose poses move")
    if scene.kind != Scene.Kind.SERVO and not options.allow_input:
        raise InputError(f"{scene.file}: without --allow-input nothing touches the sensors of a scene of this kind, only of kind servo")
    simulators, item = _simulators(scene, Device.open(options.device), options.episode, options.object)
    sensors = {name: simulator.model.sensor for name, simulator in simulators.items()}
    with Bridge(sensors, domain=options.domain, interface=options.interface, allow_input=options.allow_input) as bridge:
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(_TERMINATED))
        print(f"publishes {rate:g} frames/s on {options.interface}, domain {options.domain}; Ctrl-C ends", flush=True)
        num_frames, num_late = 0, 0
        begun = due = time.monotonic()
        while seconds is None or due < begun + seconds:
            for name, pose in bridge.take_poses().items():
                simulators[name].set_loads(None)
                simulators[name].set_objects(item, [pose])
            for simulator in simulators.values():
                simulator.step(1 / rate)
            bridge.publish({name: simulator.read() for name, simulator in simulators.items()})
            num_frames, due = num_frames + 1, due + 1 / rate
            wait = due - time.monotonic()
            if wait < 0:
                num_late, due = num_late + 1, due - wait
            time.sleep(max(wait, 0))
    print(f"{num_frames} frames were published, {num_late} of them late", file=sys.stderr)


def _simulators(scene: Scene, device: Device, episode: int, item: int | None) -> tuple[dict[str, Simulator], int]:
    """A simulator of each sensor, by name, and the index of the object that poses move. In a scene of kind servo it touches."""
    start = None
    if scene.kind == Scene.Kind.SERVO:
        environment = Environment(device, scene)
        environment.reset([True], [episode])
        start = environment.observe()
        item = int(start.objects[0]) if item is None else item
    num_sensors = 1 if start is None else start.X_SO.shape[1]
    only = {"": scene.sensor} if num_sensors == 1 else {f"sensor_{k}": scene.sensor for k in range(num_sensors)}
    simulators = {}
    for name, sensor in (dict(scene.sensors) or only).items():
        outputs = NO_OUTPUTS.replace(taxel_counts=sensor.readout.three_axis is not None)
        simulators[name] = Simulator(Model(device, sensor, scene.objects), outputs=outputs)
    for k, simulator in enumerate(simulators.values()):
        if start is None:
            simulator.set_objects(NO_OBJECT, [[0, 0, 0, 1, 0, 0, 0]])
        else:
            simulator.set_objects(item or 0, start.X_SO[:, k])
        simulator.step(1 / scene.simulation_rate)  # compiles the kernels
        simulator.read()
    return simulators, item or 0

"""Sides, groups, areas and joints of an Open-X-Tactile export: which sensor and which joint becomes which array."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .._core import Scene, Sensor
from ..dataset.provenance import Provenance
from ..errors import InputError
from ..pictures import TACTILE_IMAGE, TAXEL_COUNTS
from ..viewer.scene_files import scene_of, sensor_of
from .features import column_of, num_sensors, shown_sensors
from .oxt_rules import GRIPPER_SLOT, MAX_ARM_JOINTS, NUM_AREAS, NUM_HAND_SLOTS, SIDES
from .source import Source

JOINTS = "data/robot/joint_position"
POSE = "data/sensor_pose"
NO_JOINTS = "none"

FINGER_AREAS = {"thumb": 0, "index": 1, "first": 1, "middle": 2, "ring": 3, "little": 4, "pinky": 4, "palm": 5}
"""Functional areas by names of sensors, as the Aether parser of FTP-1 numbers five fingertips and a palm."""


@dataclass(frozen=True)
class Pad:
    """One sensor. Where several have an axis of one column, `index` is the place on it."""

    name: str
    prefix: str  #: Group of columns in data/, "" without one.
    index: int | None
    sensor: Sensor
    side: str
    area: int

    def values(self, columns: dict[str, NDArray[Any]], column: str) -> NDArray[Any]:
        """(F, ...) of a column of this sensor."""
        found = columns[column_of(self.prefix, column)]
        return found if self.index is None else found[:, self.index]


@dataclass(frozen=True)
class Group:
    """Sensors of one side and one model: arrays <side>_tactile_<member>_<name>."""

    side: str
    name: str
    pads: tuple[Pad, ...]
    column: str = TACTILE_IMAGE

    def key(self, member: str) -> str:
        return f"{self.side}_tactile_{member}_{self.name}"


@dataclass(frozen=True)
class Joints:
    """Joints of one side: indices in data/robot/joint_position, and slots of those of the hand."""

    arm: tuple[int, ...]
    hand: tuple[int, ...]
    slots: tuple[int, ...]


@dataclass(frozen=True)
class Layout:
    """The arrays of an export."""

    pads: tuple[Pad, ...]
    groups: tuple[Group, ...]
    wrists: dict[str, Pad]  #: Pad of the wrist, by side.
    joints: dict[str, Joints]  #: Joints of arm and hand, by side.
    joint_names: tuple[str, ...]
    scene: Scene

    @staticmethod
    def of(source: Source) -> Layout:
        """Throws InputError for a sensor or joint whose place is neither known nor given."""
        options, folder = source.options, source.data.folder
        scene, _ = scene_of(Provenance.of(folder).scene, [Path(name) for name in options.assets], folder)
        pads = tuple(_pads(source, scene))
        groups = list(_groups(pads, TACTILE_IMAGE, ""))
        three_axis = tuple(pad for pad in pads if column_of(pad.prefix, TAXEL_COUNTS) in source.data)
        groups += _groups(three_axis, TAXEL_COUNTS, "_axes")
        sides = tuple(dict.fromkeys(pad.side for pad in pads))
        names = tuple(name for name, *_ in _core.joints_of(scene)) if JOINTS in source.data else ()
        joints = _joints(source, names, sides, is_hand=scene.kind == Scene.Kind.GRASP)
        wrists = _wrists(source, pads, sides)
        if not wrists and not joints:
            raise InputError(
                f"{folder}: no pose of a wrist and no joints, from which FTP-1 derives actions: record poses, or give wrist or joints"
            )
        return Layout(pads, tuple(groups), wrists, joints, names, scene)


def _pads(source: Source, scene: Scene) -> Iterator[Pad]:
    data = source.data
    count = num_sensors(data)
    places = _pairs("place", source.options.place)
    numbered = iter(range(NUM_AREAS))
    for prefix in shown_sensors(data):
        for index in [None] if count == 1 else range(count):
            label = prefix or data.sensor or ("sensor" if index is None else str(index))
            side, area = _place(label, places.pop(label, None), known=label if prefix or data.sensor else next(numbered))
            sensor = sensor_of(scene, prefix or data.sensor)
            yield Pad(label, prefix, index, sensor, side, area)
    if places:
        raise InputError(f"place: {min(places)!r} is not allowed: a sensor of {data.folder}")


def _place(label: str, given: tuple[str, str] | None, known: str | int) -> tuple[str, int]:
    """Side and area: as given, else the area of a finger by its name; sensors without names are pads of a gripper."""
    if given is None:
        area = FINGER_AREAS.get(known) if isinstance(known, str) else known
        if area is None:
            raise InputError(
                f"place: the functional area of sensor {label!r} is not known: --place {label}=N, {_known_areas()}; "
                f"{label}=left:N on the left hand"
            )
        return SIDES[0], area
    side, number = given
    return side or SIDES[0], _checked_number(f"place: {label}", number, NUM_AREAS)


def _known_areas() -> str:
    return "0 to 4 from thumb tip to little finger tip, 5 palm, less than 24"


def _checked_number(name: str, text: str, limit: int) -> int:
    if not re.fullmatch(r"\d{1,4}", text) or int(text) >= limit:
        raise InputError(f"{name}: {text!r} is not allowed: an integer from 0 to {limit - 1}")
    return int(text)


def _pairs(option: str, items: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Side and value by name, of NAME=VALUE and NAME=SIDE:VALUE."""
    result: dict[str, tuple[str, str]] = {}
    for item in items:
        name, _, value = item.partition("=")
        side, colon, rest = value.rpartition(":")
        if not name or not rest or (colon and side not in SIDES):
            raise InputError(f"{option}: {item!r} is not allowed: NAME=VALUE or NAME=SIDE:VALUE with a side {' or '.join(SIDES)}")
        if name in result:
            raise InputError(f"{option}: {name!r} found twice")
        result[name] = side, rest
    return result


def _groups(pads: Sequence[Pad], column: str, suffix: str) -> Iterator[Group]:
    """One group for each side and model of sensor: FTP-1 groups areas that share geometry and meaning."""
    members: dict[tuple[str, str, int], list[Pad]] = {}
    for pad in pads:
        members.setdefault((pad.side, _key_part(pad.sensor.name) + suffix, pad.sensor.num_taxels), []).append(pad)
    names = [(side, name) for side, name, _ in members]
    for (side, name, num_taxels), found in members.items():
        areas = [pad.area for pad in found]
        if len(set(areas)) < len(areas):
            raise InputError(f"place: area {max(areas, key=areas.count)} of {side}_{name} found twice: give each sensor an area of its own")
        yield Group(side, name if names.count((side, name)) == 1 else f"{name}_{num_taxels}", tuple(found), column)


def _key_part(name: str) -> str:
    return re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_") or "sensor"


def _wrists(source: Source, pads: Sequence[Pad], sides: Sequence[str]) -> dict[str, Pad]:
    """The sensor whose pose stands for the wrist: as given, else the only one of a side."""
    wrists: dict[str, Pad] = {}
    for name in source.options.wrist:
        pad = next((pad for pad in pads if pad.name == name), None)
        if pad is None:
            raise InputError(f"wrist: {name!r} is not allowed: {', '.join(pad.name for pad in pads)}")
        if column_of(pad.prefix, POSE) not in source.data:
            raise InputError(f"wrist: {source.data.folder} has no poses of sensor {name!r}: record poses in the scene")
        wrists[pad.side] = pad
    for side in sides:
        (first, *others) = [pad for pad in pads if pad.side == side]
        if side not in wrists and not others and column_of(first.prefix, POSE) in source.data:
            wrists[side] = first
    return wrists


def _joints(source: Source, names: Sequence[str], sides: Sequence[str], *, is_hand: bool) -> dict[str, Joints]:
    """Joints by side. A robot that carries its only sensor is an arm. Joints of a hand need their slots."""
    given = source.options.joints
    if given == (NO_JOINTS,) or (not names and not given):
        return {}
    if not given:
        if is_hand or len(sides) > 1:
            example = ",".join(f"{name}=SLOT" for name in names[:2])
            raise InputError(
                f"joints: the slots of joints {', '.join(names)} are not known: --joints {example}, ... with 0 to "
                f"{NUM_HAND_SLOTS - 1} ({GRIPPER_SLOT} is a gripper), NAME alone for a joint of the arm, or --joints {NO_JOINTS}"
            )
        given = tuple(names)
    arm: dict[str, list[int]] = {}
    hand: dict[str, list[tuple[int, int]]] = {}
    for item in given:
        side, joint, slot = _joint(item, names, sides)
        if slot is None:
            arm.setdefault(side, []).append(joint)
        else:
            hand.setdefault(side, []).append((joint, slot))
    joints = {}
    for side in dict.fromkeys((*arm, *hand)):
        pairs = hand.get(side, [])
        found = Joints(tuple(arm.get(side, ())), tuple(joint for joint, _ in pairs), tuple(slot for _, slot in pairs))
        joints[side] = _checked(side, found)
    return joints


def _joint(item: str, names: Sequence[str], sides: Sequence[str]) -> tuple[str, int, int | None]:
    """Side, index and slot (None: of the arm) of [SIDE:]NAME[=SLOT]."""
    side, colon, rest = item.rpartition(":")
    name, equals, slot = rest.partition("=")
    if colon and side not in sides:
        raise InputError(f"joints: {item!r} is not allowed: a side with a sensor, {' or '.join(sides)}")
    if not colon and len(sides) > 1:
        raise InputError(f"joints: {item!r} is not allowed: SIDE:{rest}, since both sides have sensors")
    if name not in names:
        raise InputError(f"joints: {name!r} is not allowed: {', '.join(names) or 'the data set has no joints'}")
    return side or sides[0], names.index(name), _checked_number(f"joints: {name}", slot, NUM_HAND_SLOTS) if equals else None


def _checked(side: str, joints: Joints) -> Joints:
    if len(joints.arm) > MAX_ARM_JOINTS:
        raise InputError(f"joints: {len(joints.arm)} joints of the {side} arm are not allowed: at most {MAX_ARM_JOINTS}")
    for what, values in (("slot", joints.slots), ("joint", joints.arm + joints.hand)):
        if len(set(values)) < len(values):
            raise InputError(f"joints: {what} {max(values, key=values.count)} of the {side} side found twice")
    return joints


def rotation_vectors(poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """Poses (F, 7), x y z qw qx qy qz, as (F, 6), x y z and axis times angle (rad, at most pi)."""
    quaternions = poses[:, 3:] * np.where(poses[:, 3:4] < 0, -1.0, 1.0)
    sines = np.linalg.norm(quaternions[:, 1:], axis=1)
    angles = 2 * np.arctan2(sines, quaternions[:, 0])
    scales = np.divide(angles, sines, out=np.full(len(poses), 2.0), where=sines > 0)
    return np.concatenate((poses[:, :3], quaternions[:, 1:] * scales[:, None]), axis=1)


def quaternion_poses(poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """Inverse of rotation_vectors(): (F, 7) of (F, 6), with qw >= 0."""
    angles = np.linalg.norm(poses[:, 3:], axis=1)
    scales = np.divide(np.sin(angles / 2), angles, out=np.full(len(poses), 0.5), where=angles > 0)
    return np.concatenate((poses[:, :3], np.cos(angles / 2)[:, None], poses[:, 3:] * scales[:, None]), axis=1)

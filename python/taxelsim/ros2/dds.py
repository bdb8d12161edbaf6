"""ROS 2 endpoints of Cyclone DDS, with the names and QoS that rmw_cyclonedds_cpp gives them. Needs the package cyclonedds.

Cyclone DDS serialises a message in Python, which takes 0.5 ms, and 2 ms for a point cloud. A Writer therefore serialises its first message
only: those that follow differ in their stamp and in their numbers, which lie at a fixed offset.
"""

from __future__ import annotations

import struct
from functools import cache
from typing import Any

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import make_idl_struct, types
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from .messages import TYPE_HASHES, TYPES

_PRIMITIVES = {
    "bool": bool,
    "float64": types.float64,
    "int32": types.int32,
    "string": str,
    "uint8": types.uint8,
    "uint32": types.uint32,
}
_STAMP = struct.Struct("<iI")  # s, ns
_FIRST_FIELD = 4  # bytes of the header of CDR; the stamp is the first field of all messages of TYPE_HASHES


@cache
def idl_type(name: str) -> Any:
    """The type of a message of TYPES."""
    fields = {}
    for line in TYPES[name].splitlines():
        kind, field = line.split()
        element = kind.removesuffix("[]")
        of = idl_type(element) if element in TYPES else _PRIMITIVES[element]
        fields[field] = of if element == kind else types.sequence[of]
    package, short = name.split("/")
    return make_idl_struct(f"{short}_", f"{package}.msg.dds_.{short}_", fields)


def _filled(name: str, content: dict[str, Any]) -> Any:
    """A message of TYPES from its fields as dicts."""
    values = dict(content)
    for line in TYPES[name].splitlines():
        kind, field = line.split()
        element = kind.removesuffix("[]")
        if element in TYPES:
            value = values[field]
            values[field] = _filled(element, value) if element == kind else [_filled(element, item) for item in value]
    return idl_type(name)(**values)


def _numbers(content: dict[str, Any]) -> bytes:
    """The real numbers and bytes of a message, in its order."""
    parts = []
    for value in content.values():
        if isinstance(value, dict):
            parts.append(_numbers(value))
        elif isinstance(value, float):
            parts.append(struct.pack("<d", value))
        elif isinstance(value, bytes):
            parts.append(value)
    return b"".join(parts)


def _user_data(schema: str) -> bytes:
    """USER_DATA of an endpoint, in which ROS 2 finds the hash of its type."""
    return f"typehash=RIHS01_{TYPE_HASHES[schema]};".encode()


class _Serialized:
    """A message that is serialised. Each schema has a subclass, with the description `__idl__` of its type."""

    def __init__(self, cdr: bytes) -> None:
        self._cdr = cdr

    def serialize(self, **_: Any) -> bytes:
        return self._cdr


class Writer:
    """Publishes the messages of a topic as rmw's default does: reliable, keep last 10, volatile."""

    def __init__(self, participant: DomainParticipant, topic: str, schema: str, frame_id: str) -> None:
        qos = Qos(
            Policy.Reliability.Reliable(duration(infinite=True)),
            Policy.History.KeepLast(10),
            Policy.Durability.Volatile,
            Policy.WriterDataLifecycle(autodispose=False),
            Policy.DataRepresentation(use_cdrv0_representation=True),
            Policy.Userdata(_user_data(schema)),
        )
        self._schema = schema
        self._frame_id = frame_id
        self._type: Any = type("Serialized", (_Serialized,), {"__idl__": idl_type(schema).__idl__})
        self._writer = DataWriter(participant, Topic(participant, f"rt{topic}", self._type), qos)
        self._cdr = bytearray()
        self._place = slice(0, 0)
        self._layout: tuple[int, Any] | None = None

    def write(self, content: dict[str, Any], stamp: int) -> None:
        """Publishes a message from its fields without the header. stamp: ns."""
        time, numbers = divmod(stamp, 10**9), _numbers(content)
        layout = (len(numbers), content.get("encoding"))
        if layout != self._layout:
            header = {"stamp": dict(zip(("sec", "nanosec"), time, strict=True)), "frame_id": self._frame_id}
            self._cdr = bytearray(_filled(self._schema, {"header": header, **content}).serialize(use_version_2=False))
            first = self._cdr.rindex(numbers)  # the last field, or the last but is_dense
            self._place, self._layout = slice(first, first + len(numbers)), layout
        _STAMP.pack_into(self._cdr, _FIRST_FIELD, *time)
        self._cdr[self._place] = numbers
        self._writer.write(self._type(bytes(self._cdr)))


class Reader:
    """Takes the newest message of a topic from publishers of any reliability."""

    def __init__(self, participant: DomainParticipant, topic: str, schema: str) -> None:
        qos = Qos(
            Policy.Reliability.BestEffort,
            Policy.History.KeepLast(1),
            Policy.Durability.Volatile,
            Policy.DataRepresentation(use_cdrv0_representation=True),
            Policy.Userdata(_user_data(schema)),
        )
        self._reader = DataReader(participant, Topic(participant, f"rt{topic}", idl_type(schema)), qos)

    def take(self) -> Any:
        """The newest message since the last call, or None. Raises errors of many kinds for bytes that are no such message."""
        samples = self._reader.take()
        return samples[0] if samples and samples[0].sample_info.valid_data else None

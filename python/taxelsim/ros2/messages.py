"""ROS 2 messages of exports and of the bridge: their definitions and type hashes, and arrays as their fields. Needs no package of ROS."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

_HEADER = "std_msgs/Header header\n"
TYPES = {
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
    "geometry_msgs/Pose": "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
    "geometry_msgs/Twist": "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n",
    "geometry_msgs/Wrench": "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n",
    "geometry_msgs/PoseStamped": f"{_HEADER}geometry_msgs/Pose pose\n",
    "geometry_msgs/TwistStamped": f"{_HEADER}geometry_msgs/Twist twist\n",
    "geometry_msgs/WrenchStamped": f"{_HEADER}geometry_msgs/Wrench wrench\n",
    "sensor_msgs/Image": f"{_HEADER}uint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\nuint8[] data\n",
    "sensor_msgs/PointField": "string name\nuint32 offset\nuint8 datatype\nuint32 count\n",
    "sensor_msgs/PointCloud2": f"{_HEADER}uint32 height\nuint32 width\nsensor_msgs/PointField[] fields\nbool is_bigendian\n"
    "uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
}
"""Fields of each message."""

TYPE_HASHES = {
    "geometry_msgs/PoseStamped": "10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8",
    "geometry_msgs/WrenchStamped": "8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77",
    "sensor_msgs/Image": "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47",
    "sensor_msgs/PointCloud2": "9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5",
}
"""SHA-256 of the type description (REP 2016), which `ros2 topic info --verbose` prints after RIHS01_, of the messages of the bridge."""

_ENCODINGS = {("<u2", 1): "mono16", ("<i4", 1): "32SC1", ("<i4", 3): "32SC3", ("<f4", 1): "32FC1"}
_FLOAT32 = 7  # PointField.datatype


def definition_of(name: str) -> str:
    """The text of a message of TYPES, then those of all messages that it contains, as ROS 2 concatenates them."""
    names = [name]
    for found in names:  # grows
        fields = [line.split()[0].removesuffix("[]") for line in TYPES[found].splitlines()]
        names += [field for field in fields if field in TYPES and field not in names]
    rest = "".join(f"{'=' * 80}\nMSG: {inner}\n{TYPES[inner]}" for inner in names[1:])
    return TYPES[name] + rest


def _vector(values: Sequence[float] | NDArray[Any]) -> dict[str, float]:
    """A Vector3 or a Point from (3) or more numbers."""
    return {"x": float(values[0]), "y": float(values[1]), "z": float(values[2])}


def pose(values: Sequence[float] | NDArray[Any]) -> dict[str, Any]:
    """A PoseStamped from (7) position (m) and quaternion (w, x, y, z)."""
    return {"pose": {"position": _vector(values), "orientation": {**_vector(values[4:]), "w": float(values[3])}}}


def wrench(values: NDArray[Any]) -> dict[str, Any]:
    """A WrenchStamped from (6) force (N) and torque (N m)."""
    return {"wrench": {"force": _vector(values), "torque": _vector(values[3:])}}


def twist(values: NDArray[Any]) -> dict[str, Any]:
    """A TwistStamped from (6) linear (m/s) and angular velocity (rad/s)."""
    return {"twist": {"linear": _vector(values), "angular": _vector(values[3:])}}


def image(values: NDArray[Any]) -> dict[str, Any]:
    """An Image from (num_rows, num_cols): rows of a grid along x; or from (num_taxels): one row."""
    return pixels(values[..., None])


def pixels(values: NDArray[Any]) -> dict[str, Any]:
    """An Image, whose channels are the last axis."""
    *rows, width, channels = values.shape
    little = values.astype(values.dtype.newbyteorder("<"), copy=False)
    size = {"height": rows[0] if rows else 1, "width": width, "step": width * channels * values.itemsize}
    return {**size, "encoding": _ENCODINGS[little.dtype.str, channels], "is_bigendian": 0, "data": little.tobytes()}


def point_cloud(names: tuple[str, ...], points: NDArray[Any]) -> dict[str, Any]:
    """A PointCloud2 from (num_points, len(names)), little-endian float32."""
    fields = [{"name": name, "offset": 4 * k, "datatype": _FLOAT32, "count": 1} for k, name in enumerate(names)]
    size = {"height": 1, "width": len(points), "point_step": 4 * len(names), "row_step": points.nbytes}
    return {**size, "fields": fields, "is_bigendian": False, "data": points.tobytes(), "is_dense": True}

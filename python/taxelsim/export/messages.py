"""Definitions of the ROS 2 messages that an export has, as ROS 2 concatenates them: a message, then those that it contains."""

from __future__ import annotations

_HEADER = "std_msgs/Header header\n"
_TYPES = {
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
}


def definition_of(name: str) -> str:
    """The text of a message of _TYPES with all messages that it contains."""
    names = [name]
    for found in names:  # grows
        fields = [line.split()[0] for line in _TYPES[found].splitlines()]
        names += [field for field in fields if field in _TYPES and field not in names]
    rest = "".join(f"{'=' * 80}\nMSG: {inner}\n{_TYPES[inner]}" for inner in names[1:])
    return _TYPES[name] + rest

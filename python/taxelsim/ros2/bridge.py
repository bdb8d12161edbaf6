"""A bridge to ROS 2: publishes frames over DDS, and takes poses of objects where that is allowed. Needs the package cyclonedds."""

from __future__ import annotations

import gc
import os
import socket
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from cyclonedds.core import DDSException, Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from numpy.typing import NDArray

from .._arrays import QUATERNION_TOLERANCE
from .._core import Sensor
from .._log import logger
from ..errors import InputError, IoError
from ..frame import Frame
from .dds import Reader, Writer
from .topics import Topic, namespace_of, topics_of

LOOPBACK = "lo"
MAX_DOMAIN = 232
"""Largest domain whose ports exist."""
MAX_DISTANCE = 10.0
"""m, largest coordinate of an object that the bridge takes."""
_FIRST_PORT, _PORTS_PER_DOMAIN = 7400, 250  # RTPS 2.5, section 9.6.2.3

# ROS 2 configures Cyclone DDS like this for ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST.
_LOOPBACK_ONLY = (
    "<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
    '<Peers><Peer address="localhost"/></Peers></Discovery>'
)


def _configuration(interface: str) -> str:
    """The configuration of Cyclone DDS, which ignores CYCLONEDDS_URI when it is given one. Raises InputError."""
    names = [name for _, name in socket.if_nameindex()]
    if interface not in names:
        raise InputError(f"interface: {interface!r:.60} is not allowed: {', '.join(names)}")
    multicast = "false" if interface == LOOPBACK else "true"
    general = (
        f'<General><Interfaces><NetworkInterface name="{interface}" multicast="{multicast}"/></Interfaces>'
        f"<AllowMulticast>{multicast}</AllowMulticast></General>"
    )
    return f"<CycloneDDS><Domain>{general}{_LOOPBACK_ONLY if interface == LOOPBACK else ''}</Domain></CycloneDDS>"


def _receive_from(interface: str, domain: int) -> None:
    """Binds the sockets of a domain to an interface: Cyclone DDS sends on its interface only, but listens on all of them.

    Raises OSError where Linux is older than 5.7 and the user is not root.
    """
    ports = range(_FIRST_PORT + _PORTS_PER_DOMAIN * domain, _FIRST_PORT + _PORTS_PER_DOMAIN * (domain + 1))
    for file in filter(Path.is_socket, Path("/proc/self/fd").iterdir()):
        with socket.socket(fileno=os.dup(int(file.name))) as copy:
            if copy.family == socket.AF_INET and copy.type == socket.SOCK_DGRAM and copy.getsockname()[1] in ports:
                copy.setsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, interface.encode())


class Bridge:
    """A participant of DDS that is a publisher of ROS 2 for one sensor or several.

    >>> with Bridge(sensor) as bridge:
    ...     bridge.publish(simulator.read())  # /tactile/image, /tactile/taxels, /tactile/contact_wrench, /tactile/contact_pose

    Calls are for one thread at a time. publish() can wait for a slow reliable subscriber, as in ROS 2; take_poses() does not wait.
    """

    def __init__(
        self, sensors: Sensor | Mapping[str, Sensor], *, domain: int = 0, interface: str = LOOPBACK, allow_input: bool = False
    ) -> None:
        """Joins a domain. A process has one bridge per domain, and no other participant of Cyclone DDS in it.

        sensors: a sensor, whose topics are /tactile/TOPIC; or several by name, whose topics are /tactile/NAME/TOPIC.
        domain: 0 to 232, ROS_DOMAIN_ID of the subscribers.
        interface: name of the network interface. On "lo" there is no multicast: ROS 2 needs ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST.
        allow_input: whether to subscribe to /tactile/cmd_object_pose, or /tactile/NAME/cmd_object_pose. DDS has no access control here:
            every program that reaches the interface can send poses.

        Raises InputError for another interface, domain or name of a sensor; IoError if DDS cannot open it.
        """
        if not 0 <= domain <= MAX_DOMAIN:
            raise InputError(f"domain: {domain} is not allowed: 0 to {MAX_DOMAIN}")
        self._sensors = {"": sensors} if isinstance(sensors, Sensor) else dict(sensors)
        namespaces = {name: namespace_of(name) for name in self._sensors}
        configuration = _configuration(interface)
        try:
            self._domain: Domain | None = Domain(domain, configuration)
            if interface == LOOPBACK:
                _receive_from(interface, domain)
            participant = DomainParticipant(domain, Qos(Policy.Userdata(b"enclave=/;")))
            self._writers: dict[str, list[tuple[Topic, Writer]]] = {
                name: [
                    (topic, Writer(participant, f"{namespaces[name]}/{topic.name}", topic.schema, name or "sensor"))
                    for topic in topics_of(sensor)
                ]
                for name, sensor in self._sensors.items()
            }
            self._readers = {
                name: Reader(participant, f"{namespace}/cmd_object_pose", "geometry_msgs/PoseStamped")
                for name, namespace in namespaces.items()
                if allow_input
            }
        except (DDSException, OSError) as error:
            raise IoError(f"DDS on interface {interface}, domain {domain}: {' '.join(str(error).split())}") from error

    def publish(self, frame: Frame | Mapping[str, Frame], *, instance: int = 0, stamp: int | None = None) -> None:
        """Publishes the newest frame of each sensor.

        frame: of a Simulator, or of an Environment with one sensor, in the memory of the host; of several sensors by name, some or all.
        instance: index of the row. stamp: ns since 1970; default: now.

        Raises InputError, and publishes nothing, for a frame of another sensor. `contact_pose` has a message only for frames with contact.
        """
        frames: Mapping[str, Frame] = {"": frame} if isinstance(frame, Frame) else frame
        for name, of_sensor in frames.items():
            self._check(name, of_sensor, instance)
        now = time.time_ns() if stamp is None else stamp
        for name, of_sensor in frames.items():
            for topic, writer in self._writers[name]:
                content = topic.content(of_sensor, instance)
                if content is not None:
                    writer.write(content, now)

    def _check(self, name: str, frame: Frame, instance: int) -> None:
        if name not in self._sensors:
            raise InputError(f"frame of sensor {name!r:.60} is not allowed: {', '.join(map(repr, self._sensors))}")
        images, num_taxels = frame.tactile_image, self._sensors[name].num_taxels
        if not 0 <= instance < len(images):
            raise InputError(f"instance: {instance} is not allowed: 0 to {len(images) - 1}")
        if images[0].size != num_taxels:
            raise InputError(f"tactile_image: {images[0].size} taxels are not allowed for a sensor of {num_taxels}")

    def take_poses(self) -> dict[str, NDArray[np.float64]]:
        """The newest pose of an object that came for each sensor since the last call, by name of the sensor.

        (7) position (m) and quaternion (w, x, y, z) of the object in the sensor frame, as set_objects() takes it. A pose that is not
        finite, not a rotation, over MAX_DISTANCE away or in another frame is refused with a line in the log.
        """
        poses = {}
        for name, reader in self._readers.items():
            try:
                message = reader.take()
                if message is not None:
                    poses[name] = _pose_of(message, name or "sensor")
            except InputError as error:
                logger.warning("%s/cmd_object_pose: refused: %s", namespace_of(name), error)
            except Exception as error:  # bytes of a stranger raise errors of many kinds
                logger.warning("%s/cmd_object_pose: refused: no PoseStamped: %.80s", namespace_of(name), type(error).__name__)
        return poses

    def close(self) -> None:
        """Leaves the domain. A second call does nothing."""
        self._writers, self._readers = {}, {}
        self._domain = None
        gc.collect()  # entities of cyclonedds end with their last reference, and refer to each other

    def __enter__(self) -> Bridge:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _pose_of(message: Any, frame_id: str) -> NDArray[np.float64]:
    """The pose (7) of a PoseStamped with a unit quaternion. Raises InputError."""
    if message.header.frame_id != frame_id:
        raise InputError(f"frame_id {message.header.frame_id!r:.60} is not allowed: {frame_id!r}")
    position, orientation = message.pose.position, message.pose.orientation
    p = np.array([position.x, position.y, position.z])
    if not (np.abs(p) <= MAX_DISTANCE).all():
        raise InputError(f"position {p.tolist()} is not allowed: -{MAX_DISTANCE:g} to {MAX_DISTANCE:g} m")
    q = np.array([orientation.w, orientation.x, orientation.y, orientation.z])
    length = float(np.linalg.norm(np.clip(q, -2, 2)))  # clipped, so that no square overflows
    if not abs(length - 1) <= QUATERNION_TOLERANCE:
        raise InputError(f"orientation (w, x, y, z) = {q.tolist()} is not allowed: a quaternion of length 1")
    return np.concatenate((p, q / length))

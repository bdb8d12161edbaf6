"""A stand-in for a node of ROS 2: Cyclone DDS with types from the type store of rosbags, which also decodes. Imports nothing of taxelsim.

node.py echo DOMAIN FILE COUNT SCHEMA TOPIC [SCHEMA TOPIC ...]
    Prints "ready" once each topic has had a message, and takes COUNT messages of each topic from FIRST_STAMP on. Writes a pickle: endpoints
    found by discovery, and by topic a list of (stamp in ns, time of receipt in ns, message as dicts).
node.py stamps ...
    The same without the messages.
node.py talk DOMAIN SCHEMA TOPIC
    Prints "ready" once a subscriber is there, and publishes each line of hexadecimal digits on stdin.
"""

import dataclasses
import pickle
import struct
import sys
import time
from pathlib import Path

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription
from cyclonedds.core import InstanceState, Policy, Qos, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import make_idl_struct, types
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_JAZZY)
FIRST_STAMP = 10**9  # ns; messages before it are for discovery
PATIENCE = 20  # s without a message
DEPTH = 5000  # messages of a topic that wait for this process
CONFIGURATION = (
    '<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces>'
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    '<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex><Peers><Peer address="localhost"/></Peers></Discovery></Domain></CycloneDDS>'
)
PRIMITIVES = {name: getattr(types, name) for name in ("float64", "int32", "uint8", "uint32")} | {"bool": bool, "string": str}


def type_of(name):
    """The IDL type of a message of the type store."""

    def described(node):
        kind, what = node
        if kind == Nodetype.SEQUENCE:
            return types.sequence[described(what[0])]
        return type_of(what) if kind == Nodetype.NAME else PRIMITIVES[what[0]]

    fields = {field: described(node) for field, node in STORE.fielddefs[name][1]}
    return make_idl_struct(name.rpartition("/")[2] + "_", name.replace("/msg/", ".msg.dds_.") + "_", fields)


class Bytes:
    """A message as CDR."""

    def __init__(self, cdr):
        self.cdr = cdr

    def serialize(self, **_):
        return self.cdr

    @classmethod
    def deserialize(cls, cdr, **_):
        return cls(bytes(cdr))


def topic_of(participant, schema, topic):
    return Topic(participant, f"rt{topic}", type("Bytes", (Bytes,), {"__idl__": type_of(schema).__idl__}))


def stamp_of(cdr):
    """ns, of the header, which is the first field."""
    seconds, nanoseconds = struct.unpack_from("<iI", cdr, 4)
    return seconds * 10**9 + nanoseconds


def endpoints(participant):
    """(topic, type, reliability, history, durability, user data) of the writers and readers of other participants."""
    found = {}
    for name, builtin in (("writers", BuiltinTopicDcpsPublication), ("readers", BuiltinTopicDcpsSubscription)):
        samples = BuiltinDataReader(participant, builtin).take(100)
        policies = [Policy.Reliability, Policy.History, Policy.Durability]
        found[name] = [
            (
                sample.topic_name,
                sample.type_name,
                *(str(sample.qos[policy]) for policy in policies),
                sample.qos[Policy.Userdata].data.decode(),
            )
            for sample in samples
            if sample.participant_key != participant.guid
        ]
    return found


def echo(participant, file, count, names, keeps_messages):
    qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(DEPTH))
    schemas = dict(zip(names[1::2], names[::2], strict=True))
    readers = {topic: DataReader(participant, topic_of(participant, schema, topic), qos) for topic, schema in schemas.items()}
    news = WaitSet(participant)
    for reader in readers.values():
        news.attach(ReadCondition(reader, ViewState.Any | InstanceState.Any | SampleState.NotRead))
    taken = {topic: [] for topic in readers}
    waiting = set(readers)
    last = time.monotonic()
    while any(len(messages) < count for messages in taken.values()) and time.monotonic() < last + PATIENCE:
        news.wait(duration(milliseconds=100))
        for topic, reader in readers.items():
            for sample in reader.take(100):
                last = time.monotonic()
                if stamp_of(sample.cdr) >= FIRST_STAMP:
                    taken[topic].append((time.time_ns(), sample.cdr))
                elif topic in waiting:
                    waiting.remove(topic)
                    if not waiting:
                        print("ready", flush=True)
    decoded = {}
    for topic, messages in taken.items():
        found = [(STORE.deserialize_cdr(cdr, schemas[topic]), receipt, cdr) for receipt, cdr in messages]
        decoded[topic] = [
            (stamp_of(cdr), receipt, dataclasses.asdict(message) if keeps_messages else None) for message, receipt, cdr in found
        ]
    Path(file).write_bytes(pickle.dumps({"endpoints": endpoints(participant), "messages": decoded}))


def talk(participant, schema, topic):
    writer = DataWriter(participant, topic_of(participant, schema, topic))
    while not writer.get_matched_subscriptions():
        time.sleep(0.01)
    print("ready", flush=True)
    for line in sys.stdin:
        writer.write(writer.data_type(bytes.fromhex(line)))


if __name__ == "__main__":
    mode, domain, *rest = sys.argv[1:]
    keep = Domain(int(domain), CONFIGURATION)
    own = DomainParticipant(int(domain))
    if mode in ("echo", "stamps"):
        echo(own, rest[0], int(rest[1]), rest[2:], keeps_messages=mode == "echo")
    else:
        talk(own, *rest)

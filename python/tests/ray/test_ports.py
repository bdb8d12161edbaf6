"""What listens: Ray's own services on loopback, and no dashboard."""

import contextlib
import os
from pathlib import Path

import pytest

from taxelsim.ray import cluster as module

LISTEN = "0A"  # state of a socket in /proc/net/tcp
LOOPBACK = {"0100007F", "00000000000000000000000001000000", "0000000000000000FFFF00000100007F"}  # 127.0.0.1, ::1, ::ffff:127.0.0.1


def family(process: int) -> list[int]:
    """A process and all that it started, directly or not."""
    parents = {}
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            parents[int(folder.name)] = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
    found = [process]
    for parent in found:
        found += [child for child, its in parents.items() if its == parent]
    return found


def command_line(process: int) -> bytes:
    with contextlib.suppress(OSError):
        return Path(f"/proc/{process}/cmdline").read_bytes()
    return b""


def sockets(process: int) -> set[str]:
    """Numbers of the sockets of a process."""
    found = set()
    for file in Path(f"/proc/{process}/fd").iterdir():
        with contextlib.suppress(OSError):
            found.add(str(file.readlink()).removeprefix("socket:[").rstrip("]"))
    return found


def listening(processes: list[int]) -> set[str]:
    """Hexadecimal addresses on which these processes listen."""
    inodes: set[str] = set()
    for process in processes:
        with contextlib.suppress(OSError):
            inodes |= sockets(process)
    rows = [line.split() for name in ("tcp", "tcp6") for line in Path("/proc/net", name).read_text().splitlines()[1:]]
    return {row[1].partition(":")[0] for row in rows if row[3] == LISTEN and row[9] in inodes}


def test_nothing_listens_beyond_this_machine(cluster):
    processes = family(os.getpid())
    names = [name for process in processes if (name := command_line(process))]
    assert any(b"gcs_server" in name for name in names)
    assert sum(b"raylet/raylet" in name for name in names) >= 3
    # Without the dashboard this process keeps the usage statistics, which are off, and has no page.
    assert all(b"--disable-frontend" in name for name in names if b"dashboard/dashboard.py" in name)
    found = listening(processes)
    assert found
    assert found <= LOOPBACK


@pytest.mark.parametrize(("address", "warnings"), [("127.0.0.1", 0), ("10.0.0.1", 1)])
def test_a_cluster_of_its_own_is_asked_for_the_same(monkeypatch, caplog, address, warnings):
    """And a version of Ray that listens on all addresses nevertheless is reported."""
    asked = {}

    def init(**options: object) -> None:
        asked.update(options)
        asked["variable"], asked["constant"] = os.environ[module._CLUSTER_VARIABLE], module.ray._private.ray_constants.ENABLE_RAY_CLUSTER

    monkeypatch.setattr(module.ray, "init", init)
    monkeypatch.setattr(module.ray, "nodes", lambda: [{"NodeManagerAddress": address}])
    monkeypatch.delenv(module._CLUSTER_VARIABLE, raising=False)
    with caplog.at_level("WARNING", logger="taxelsim"):
        module._start_local(2)
    assert asked["include_dashboard"] is False
    assert (asked["address"], asked["num_cpus"], asked["variable"], asked["constant"]) == ("local", 2, "0", False)
    assert module._CLUSTER_VARIABLE not in os.environ
    assert len(caplog.records) == warnings

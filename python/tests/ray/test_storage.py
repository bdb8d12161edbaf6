"""The storage without a cluster: retries, verified uploads, names, the view, and tasks of a worker."""

import hashlib
import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar

import fsspec
import pytest
from fsspec.implementations.memory import MemoryFileSystem

import taxelsim
from taxelsim import _core
from taxelsim.ray import node
from taxelsim.ray import storage as module
from taxelsim.ray.node import SceneName
from taxelsim.ray.shards import ShardJob, _scratch, runs_of
from taxelsim.ray.storage import Storage, is_remote

from .conftest import write_sharded_scene


class Flaky(MemoryFileSystem):
    """Fails a given number of times. Options truncate uploads, or revoke the rights of the user."""

    protocol = "flaky"
    cachable = False
    failures: ClassVar[list[Exception]] = []
    cut = 0
    opened = 0

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        Flaky.opened += 1

    def put_file(self, lpath: str, rpath: str, *arguments: Any, **options: Any) -> None:
        if Flaky.failures:
            raise Flaky.failures.pop()
        super().put_file(lpath, rpath, *arguments, **options)
        if Flaky.cut:
            Flaky.cut -= 1
            self.store[rpath].truncate(3)


@pytest.fixture
def flaky(monkeypatch: pytest.MonkeyPatch) -> type[Flaky]:
    fsspec.register_implementation("flaky", Flaky, clobber=True)
    monkeypatch.setattr(module, "FIRST_DELAY", 0.0)
    Flaky.failures, Flaky.cut, Flaky.opened = [], 0, 0
    Flaky.store.clear()
    return Flaky


@pytest.fixture
def shard(tmp_path: Path) -> tuple[Path, str]:
    file = tmp_path / "shard-000000.h5"
    file.write_bytes(b"content of a shard")
    return file, hashlib.sha256(b"content of a shard").hexdigest()


def test_uploads_are_tried_again_with_new_credentials(flaky, shard):
    flaky.failures = [PermissionError("ExpiredToken: the token has expired"), OSError("connection reset")]
    storage = Storage("flaky://bucket/set", {})
    storage.upload(*shard)
    assert storage.digest("shard-000000.h5") == (shard[1], 18)
    assert flaky.opened >= 3, "each attempt reads the credentials again"
    assert storage.sizes() == {"shard-000000.h5": 18}


def test_an_upload_that_was_cut_off_is_made_again(flaky, shard):
    flaky.cut = 2
    storage = Storage("flaky://bucket/set", {})
    storage.upload(*shard)
    assert storage.digest("shard-000000.h5") == (shard[1], 18)


def test_the_last_failure_is_one_line(flaky, shard):
    flaky.failures = [PermissionError("ExpiredToken:\n the token has expired")] * module.ATTEMPTS
    with pytest.raises(taxelsim.IoError, match=r"^flaky://bucket/set/shard-000000.h5: ExpiredToken: the token has expired$"):
        Storage("flaky://bucket/set", {}).upload(*shard)
    assert not flaky.failures
    flaky.cut = module.ATTEMPTS
    with pytest.raises(taxelsim.IoError, match=r"its SHA-256 is \w{64} after the upload, \w{64} before"):
        Storage("flaky://bucket/set", {}).upload(*shard)


def test_names_cannot_leave_the_directory(flaky, tmp_path):
    storage = Storage("flaky://bucket/set", {})
    for name in ("../dataset.yaml", "/etc/passwd", "a/shard-000000.h5", "shard-000000.h5/../../x", "dataset.yaml\n"):
        with pytest.raises(taxelsim.InputError, match="is no name of a file that belongs there"):
            storage.read(name)
    (tmp_path / "evil.h5").write_bytes(b"")
    with pytest.raises(taxelsim.InputError, match="is no name"):
        storage.upload(tmp_path / "evil.h5", "")
    assert storage.read("dataset.yaml") is None
    with pytest.raises(taxelsim.InputError, match=r"^nowhere://x: .*nowhere"):
        Storage("nowhere://x", {})


def test_the_view_of_shards_that_are_elsewhere(device, scene, tmp_path):
    one, elsewhere = tmp_path / "one", tmp_path / "elsewhere"
    taxelsim.generate(scene, one, device=device)
    elsewhere.mkdir()
    shutil.copy(one / "dataset.yaml", elsewhere)
    _core.write_view(elsewhere, scene.num_steps)
    assert (elsewhere / "dataset.h5").read_bytes() == (one / "dataset.h5").read_bytes()
    assert (elsewhere / "dataset.h5.sha256").read_bytes() == (one / "dataset.h5.sha256").read_bytes()
    with pytest.raises(taxelsim.InputError, match="0 is not allowed: at least 1"):
        _core.write_view(elsewhere, 0)


def test_scratch_of_killed_processes_is_removed(tmp_path, scene):
    job = ShardJob(SceneName.of(scene), 1, scratch=str(tmp_path))
    left = tmp_path / "taxelsim-scratch-left"
    left.mkdir()
    (left / "shard-000000.h5").write_bytes(b"")
    with _scratch(job) as first, _scratch(job) as second:
        assert first.is_dir(), "another worker does not remove a folder that is in use"
        assert second.is_dir()
        assert not left.exists()
    assert list(tmp_path.iterdir()) == []


def test_scenes_of_the_package_have_the_same_name_on_all_nodes():
    scene = taxelsim.load_scene(taxelsim.SCENES / "edge_servo.yaml", 7, 3)
    name = SceneName.of(scene)
    assert name.file == "package:edge_servo.yaml"
    assert name.load().resolved == scene.resolved


def test_numbers_make_ranges():
    assert runs_of([0, 1, 2, 5, 7, 8]) == [range(3), range(5, 6), range(7, 9)]
    assert runs_of([]) == []


def test_addresses():
    assert is_remote("s3://bucket/set")
    assert not is_remote("file:///data/set")
    assert not is_remote("/data/set")


def test_a_node_that_reads_another_scene_is_refused(tmp_path):
    file = write_sharded_scene(tmp_path, 4)
    name = SceneName.of(taxelsim.load_scene(file, num_episodes=9))
    assert name.load().num_episodes == 9
    file.write_text(file.read_text().replace("load: [1, 3]", "load: [1, 4]"))
    with pytest.raises(taxelsim.InputError, match=r"short.yaml: is another scene on .* than where the run was started"):
        name.load()


def test_a_device_that_was_lost_is_opened_again(monkeypatch):
    monkeypatch.setattr(node.ray, "get_runtime_context", lambda: SimpleNamespace(get_node_id=lambda: "node"))
    found: list[node.Outcome] = []
    opened = node._opened()
    for error in (taxelsim.IoError("full"), taxelsim.DeviceError("lost\ndevice")):
        assert node._opened() is opened
        with node.outcomes(found):
            raise error
    assert node._opened() is not opened
    assert [outcome.failure for outcome in found] == ["full", "lost device"]

"""taxelsim.ray.generate() on a cluster that loses nodes, and its storage."""

import os
import signal
from pathlib import Path
from typing import Any

import fsspec
import numpy as np
import pytest

import taxelsim
import taxelsim.ray
from taxelsim.ray.storage import MANIFEST, checksum_line, shard_name

from .conftest import KIND, files_of, replace_node

pytestmark = pytest.mark.filterwarnings("ignore")  # of Ray and of the libraries of the storage
WORKERS = taxelsim.ray.Workers(kind=KIND)


@pytest.fixture(scope="module")
def expected(scene, tmp_path_factory) -> dict[str, bytes]:
    """Files of one process."""
    out = tmp_path_factory.mktemp("one") / "out"
    taxelsim.generate(scene, out)
    return files_of(out)


@pytest.fixture
def begun(expected, tmp_path) -> Path:
    """The directory of a data set with one shard, of the kind of this process."""
    for name in (MANIFEST, shard_name(0), shard_name(0) + ".sha256"):
        (tmp_path / name).write_bytes(expected[name])
    return tmp_path


def test_nodes_of_another_kind_are_refused_and_their_tasks_made_elsewhere(cluster, scene, expected, begun):
    seen: list[tuple[int, int]] = []
    summary = taxelsim.ray.generate(scene, begun, on_progress=lambda *progress: seen.append(progress))
    assert files_of(begun) == expected
    assert list(summary.refused) in ([], [cluster.other.node_id])
    assert [done for done, _ in seen] == sorted(done for done, _ in seen)
    assert seen[-1] == (21, 21)
    assert summary.num_simulated == 17


def test_all_nodes_of_another_kind_are_one_line(cluster, scene, begun):
    manifest = begun / MANIFEST
    text = manifest.read_text()
    probe = text.partition("probe_sha256: ")[2][:64]
    manifest.write_text(text.replace(probe, "0" * 64))
    with pytest.raises(taxelsim.InputError, match=r"probe_sha256.* \(all 2 nodes are refused\)$") as error:
        taxelsim.ray.generate(scene, begun, workers=WORKERS)
    assert "\n" not in str(error.value)
    assert files_of(begun).keys() == {"dataset.yaml", "shard-000000.h5", "shard-000000.h5.sha256"}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"task_seconds": 0.0}, "task_seconds: 0.0 is not allowed: a finite number above 0"),
        ({"max_retries": -1}, "max_retries: -1 is not allowed: at least 0"),
        ({"workers": taxelsim.ray.Workers(cpus=0)}, "workers: 0 processors"),
        ({"address": "127.0.0.1:1"}, "address: 127.0.0.1:1 found, and this process is connected to a cluster already"),
        ({"num_cpus": 2}, "num_cpus: belongs to a local cluster"),
        ({"num_cpus": 0}, "num_cpus: 0 is not allowed"),
        ({"policy": lambda observation: observation}, "the identity is empty, which a data set needs"),
    ],
)
def test_bad_arguments_are_refused(cluster, scene, tmp_path, arguments, message):
    with pytest.raises(taxelsim.InputError, match=message):
        taxelsim.ray.generate(scene, tmp_path / "out", **arguments)
    assert not (tmp_path / "out").exists()


def test_a_directory_that_nodes_do_not_share_is_refused(cluster, scene, tmp_path, monkeypatch):
    """This machine does not see what a node wrote."""
    monkeypatch.setattr(taxelsim.ray.data_set._Run, "_manifest", lambda self: None)
    with pytest.raises(taxelsim.InputError, match="give a directory that all share"):
        taxelsim.ray.generate(scene, tmp_path / "out", workers=WORKERS)


def test_a_mount_that_vanished_is_no_new_data_set(cluster, scene, tmp_path, monkeypatch):
    """Nodes find the directory without its manifest."""
    monkeypatch.setattr(taxelsim.ray.tasks, "FIRST_DELAY", 0.0)
    monkeypatch.setattr(taxelsim.ray.data_set._Run, "_manifest", lambda self: b"of the mount")
    with pytest.raises(taxelsim.IoError, match=r"a task failed 3 times, lastly: .*dataset.yaml cannot be seen on"):
        taxelsim.ray.generate(scene, tmp_path / "out", workers=WORKERS, max_retries=2)
    assert not (tmp_path / "out").exists()


def test_a_set_of_s3_has_the_bytes_of_one_process(cluster, scene, expected, s3):
    files = fsspec.filesystem("s3", skip_instance_cache=True, **s3)

    def stored() -> dict[str, bytes]:
        files.invalidate_cache()
        return {path.rpartition("/")[2]: files.cat_file(path) for path in files.ls("bucket/a/set")}

    taxelsim.ray.generate(scene, "s3://bucket/a/set", workers=WORKERS, storage_options=s3)
    assert stored() == expected

    # Uploads that were cut off: a shard without checksum, half a shard without one, half a checksum.
    files.rm("bucket/a/set/shard-000001.h5.sha256")
    files.rm("bucket/a/set/shard-000002.h5.sha256")
    files.pipe_file("bucket/a/set/shard-000002.h5", expected["shard-000002.h5"][:100])
    files.pipe_file("bucket/a/set/shard-000003.h5.sha256", expected["shard-000003.h5.sha256"][:30])
    # A name that leads out of the directory is no line of a checksum file.
    outside = checksum_line("0" * 64, "../../shard-000004.h5")
    files.pipe_file("bucket/a/set/shard-000004.h5.sha256", outside)
    summary = taxelsim.ray.generate(scene, "s3://bucket/a/set", workers=WORKERS, storage_options=s3)
    assert summary.num_simulated == 4 * 4
    assert stored() == expected

    files.pipe_file("bucket/a/set/shard-000000.h5", b"damaged")
    with pytest.raises(taxelsim.InputError, match=r"shard-000000.h5: its SHA-256 is .* repair=True makes it again"):
        taxelsim.ray.generate(scene, "s3://bucket/a/set", workers=WORKERS, storage_options=s3)
    taxelsim.ray.generate(scene, "s3://bucket/a/set", workers=WORKERS, storage_options=s3, repair=True)
    assert stored() == expected


def test_a_node_killed_in_the_middle_of_a_shard_changes_no_byte(cluster, scene, tmp_path):
    lost = tmp_path / "lost"

    def act(observation: Any) -> Any:
        import ray

        if ray.is_initialized() and not lost.exists():
            lost.write_text(ray.get_runtime_context().get_node_id())
            for process in (os.getppid(), os.getpid()):  # Ray's process of the node, and its worker
                os.kill(process, signal.SIGKILL)
        return np.zeros((len(observation), 6), np.float32)

    policy = taxelsim.Policy(act, identity="zero", check_batch=False)
    one, many = tmp_path / "one", tmp_path / "many"
    lost.touch()  # not in this process
    taxelsim.generate(scene, one, policy=policy)
    lost.unlink()
    summary = taxelsim.ray.generate(scene, many, policy=policy, workers=WORKERS)
    replace_node(cluster, lost.read_text())
    assert summary.num_retries >= 1
    assert summary.num_simulated == 21
    assert files_of(many) == files_of(one)
    assert Path(many, shard_name(0)).exists()

"""taxelsim.ray.evaluate() on a cluster that loses nodes."""

import os
import pickle
import re
import signal
import threading
from typing import Any

import fsspec
import numpy as np
import pytest

import taxelsim
import taxelsim.ray
from taxelsim.ray.evaluation import gaps

from ..policies.networks import write_mlp
from ..policies.test_runs import arrays_of
from .conftest import KIND, replace_node

pytestmark = pytest.mark.filterwarnings("ignore")  # of Ray and of the libraries of the storage
WORKERS = taxelsim.ray.Workers(kind=KIND)
LOCK = threading.Lock()  # no pickle takes it


def arrays(evaluations: list[taxelsim.Evaluation]) -> list[Any]:
    return [arrays_of(evaluation) for evaluation in evaluations]


def test_a_lost_node_and_nodes_of_another_kind_change_no_verdict(cluster, scene, tmp_path):
    """A node is lost in the middle of an episode, and another computes other values."""
    lost, same = tmp_path / "lost", [node.node_id for node in cluster.same]

    def act(observation: Any) -> Any:
        import ray

        node = ray.get_runtime_context().get_node_id() if ray.is_initialized() else ""
        if node in same and not lost.exists():
            lost.write_text(node)
            for process in (os.getppid(), os.getpid()):  # Ray's process of the node, and its worker
                os.kill(process, signal.SIGKILL)
        return np.tanh(np.asarray(observation)[:, :6].astype(np.float32))

    policy = taxelsim.Policy(act, identity="tanh", check_batch=False)
    expected = taxelsim.evaluate(scene, ["servo"], policy=policy)
    # The part that is there says which device counts.
    taxelsim.evaluate_part(scene, ["servo"], episodes=range(3), policy=policy).save(tmp_path / "episodes-00000000-00000002.json")
    assert not lost.exists()
    seen: list[tuple[int, int]] = []
    found = taxelsim.ray.evaluate(
        scene, ["servo"], policy=policy, parts=tmp_path, batch_size=4, on_progress=lambda *progress: seen.append(progress)
    )
    replace_node(cluster, lost.read_text())
    assert arrays(found) == arrays(expected)
    assert [done for done, _ in seen] == sorted({done for done, _ in seen})
    assert seen[-1] == (21, 21)

    # Nothing is left to play. The parts are those of the command line.
    assert arrays(taxelsim.ray.evaluate(scene, ["servo"], policy=policy, parts=tmp_path)) == arrays(expected)
    files = sorted(tmp_path.glob("episodes-*.json"))
    assert len(files) > 2
    assert arrays(taxelsim.merge_evaluations(scene, files, ["servo"], policy=policy)) == arrays(expected)
    with pytest.raises(taxelsim.InputError, match=r"episodes-00000000-00000002.json: has another policy"):
        taxelsim.ray.evaluate(scene, ["servo"], policy=taxelsim.Policy(act, identity="other"), parts=tmp_path)
    files[1].write_text(files[1].read_text()[:200])
    with pytest.raises(taxelsim.InputError, match=files[1].name):
        taxelsim.ray.evaluate(scene, ["servo"], policy=policy, parts=tmp_path)


def test_keeps_parts_in_s3_and_reads_networks_on_the_nodes(cluster, scene, s3, tmp_path):
    network = write_mlp(tmp_path / "network.onnx")
    expected = taxelsim.evaluate(scene, policy=network)
    arguments = {"policy": network, "workers": WORKERS, "batch_size": 16, "parts": "s3://bucket/evaluation", "storage_options": s3}
    assert arrays(taxelsim.ray.evaluate(scene, **arguments)) == arrays(expected)
    files = fsspec.filesystem("s3", skip_instance_cache=True, **s3)
    assert len(files.ls("bucket/evaluation")) > 1
    files.rm(files.ls("bucket/evaluation")[0])
    assert arrays(taxelsim.ray.evaluate(scene, **arguments)) == arrays(expected)


def test_what_a_policy_raises_continues_here(cluster, scene):
    def act(observation: Any) -> Any:
        raise ZeroDivisionError("of the policy")

    with pytest.raises(ZeroDivisionError, match="of the policy"):
        taxelsim.ray.evaluate(scene, policy=act, workers=WORKERS)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"controllers": ["none"]}, "controllers: none is not allowed: the scene has servo"),
        ({"policy": lambda observation, lock=LOCK: observation}, "policy <lambda>: cannot be pickled: "),
        ({"policy": "missing.onnx"}, "missing.onnx: No such file"),
        ({"policy": lambda observation: observation[:, :1]}, r"all 2 nodes are refused"),
        ({"task_seconds": float("inf")}, "task_seconds: inf is not allowed: a finite number above 0"),
        ({"batch_size": 0}, "batch_size: 0 is not allowed: at least 1"),
        ({"parts": __file__}, "parts: .*test_evaluate.py: File exists"),
    ],
)
def test_bad_arguments_are_refused(cluster, scene, arguments, message):
    with pytest.raises(taxelsim.InputError, match=message):
        taxelsim.ray.evaluate(scene, workers=WORKERS, **arguments)


def test_scenes_without_a_task_are_refused():
    with pytest.raises(taxelsim.InputError, match=r"edge_servo.yaml: has no task"):
        taxelsim.ray.evaluate(taxelsim.SCENES / "edge_servo.yaml")


def test_a_network_that_changed_is_refused_when_it_is_unpickled(tmp_path):
    file = write_mlp(tmp_path / "network.onnx")
    content = pickle.dumps(taxelsim.OnnxPolicy(file))
    assert pickle.loads(content).identity == taxelsim.OnnxPolicy(file).identity
    write_mlp(file, num_inputs=7)
    with pytest.raises(taxelsim.InputError, match="is another network than when the policy was pickled"):
        pickle.loads(content)


def test_episodes_that_no_part_has():
    assert gaps(10, [range(2, 4), range(3, 6), range(8, 9)]) == [range(2), range(6, 8), range(9, 10)]
    assert gaps(10, []) == [range(10)]
    assert gaps(10, [range(4, 10), range(4)]) == []


def test_evaluates_a_grasp_with_gains_and_a_policy(cluster, tmp_path):
    text = (taxelsim.SCENES / "gripper_grasp.yaml").read_text().replace("robots/", f"{taxelsim.SCENES}/robots/")
    (tmp_path / "scene.yaml").write_text(re.sub(r"(?m)^data_set: .*$", "data_set: {episodes: 3, episodes_per_shard: 1}", text))
    scene = taxelsim.load_scene(tmp_path / "scene.yaml")
    policy = taxelsim.Policy(lambda observation: np.zeros((len(observation), 2), np.float32), identity="still", check_batch=False)
    expected = taxelsim.evaluate_grasp(scene, [5, 20], policy=policy)
    found = taxelsim.ray.evaluate_grasp(scene, [5, 20], policy=policy, workers=WORKERS, parts=tmp_path, task_seconds=0.1)
    assert len(list(tmp_path.glob("episodes-*.json"))) > 1
    assert [(one.policy, one.gain) for one in found] == [(one.policy, one.gain) for one in expected]
    for one, other in zip(found, expected, strict=True):
        for name, values in other.verdicts.items():
            np.testing.assert_array_equal(one.verdicts[name], values, name)
    with pytest.raises(taxelsim.InputError, match=r"scene.yaml: a scene of kind grasp is not allowed: taxelsim.ray.evaluate_grasp"):
        taxelsim.ray.evaluate(scene)
    with pytest.raises(taxelsim.InputError, match=r"edge_follow.yaml: a scene of kind grasp is needed: taxelsim.ray.evaluate"):
        taxelsim.ray.evaluate_grasp(taxelsim.SCENES / "benchmark/edge_follow.yaml")

"""Policies in evaluate() and generate()."""

from __future__ import annotations

import os
import signal
import threading
import time

import numpy as np
import pytest

import taxelsim
from taxelsim.policies import OnnxPolicy, Policy
from taxelsim.policies.failures import save_failures

from ..envs.conftest import NUM_STEPS, write_scene
from .networks import write_mlp


def push(observation: np.ndarray) -> np.ndarray:
    """Regulates a force of 2 N, along z only."""
    actions = np.zeros((len(observation), 6), np.float32)
    actions[:, 2] = 0.1 * (2 + observation[:, 5])
    return actions


@pytest.fixture(scope="module")
def scene(tmp_path_factory) -> taxelsim.Scene:
    return taxelsim.load_scene(write_scene(tmp_path_factory.mktemp("scene")))


def arrays_of(evaluation: taxelsim.Evaluation) -> dict[str, bytes]:
    return {name: values.tobytes() for name, values in evaluation.verdicts.items()}


def test_verdicts_do_not_depend_on_the_batch(device, scene):
    policy = Policy(push, history=1)
    whole, *_ = taxelsim.evaluate(scene, policy=policy, device=device)
    parts, *_ = taxelsim.evaluate(scene, policy=policy, device=device, batch_size=7, num_slices=3)
    assert whole.controller == "policy"
    assert arrays_of(whole) == arrays_of(parts)
    assert whole.total.num_episodes == 24


def test_history_follows_the_episodes_of_an_instance(device, scene):
    def follow(observation: np.ndarray) -> np.ndarray:
        return push(observation.mean(axis=1))

    policy = Policy(follow, history=4)
    whole, *_ = taxelsim.evaluate(scene, policy=policy, device=device)
    parts, *_ = taxelsim.evaluate(scene, policy=policy, device=device, batch_size=3, num_slices=2)
    assert arrays_of(whole) == arrays_of(parts)


def test_verdicts_equal_those_of_the_environment(device, scene):
    evaluation, *_ = taxelsim.evaluate(scene, policy=push, device=device)
    assert evaluation.controller == "push"
    environment = taxelsim.Environment(device, scene, 24)
    environment.reset(np.ones(24, bool), np.arange(24))
    limits = np.repeat([0.04, 1.0], 3)
    for _ in range(NUM_STEPS):
        frame = environment.observe()
        observation = np.zeros((24, 6), np.float32)
        observation[:, 5] = -frame.total_force
        environment.step(push(observation).astype(float) * limits)
    verdicts, state = environment.judge(range(24)), environment.task_state()
    for name in ("travel", "laps", "peak_force", "num_losses"):
        assert np.array_equal(state[name], verdicts[name]), name
    for name, values in evaluation.verdicts.items():
        assert np.array_equal(verdicts[name], values, equal_nan=values.dtype.kind == "f"), name


def test_controllers_are_a_control_arm(device, scene):
    both = taxelsim.evaluate(scene, ["servo"], policy=push, device=device)
    alone = taxelsim.evaluate(scene, ["servo"], device=device)
    assert [evaluation.controller for evaluation in both] == ["push", "servo"]
    assert arrays_of(both[1]) == arrays_of(alone[0])


def test_batch_dependence_is_reported_once(device, scene, tmp_path, caplog):
    policy = OnnxPolicy(write_mlp(tmp_path / "mixing.onnx", mix_rows=True))
    first, *_ = taxelsim.evaluate(scene, policy=policy, device=device)
    assert [record.message for record in caplog.records] == [
        "mixing: actions of this policy depend on the batch: it is called with exactly 1 rows at a time"
    ]
    second, *_ = taxelsim.evaluate(scene, policy=policy, device=device, batch_size=5)
    assert arrays_of(first) == arrays_of(second)


def late(function):
    """A policy that acts well at first."""
    calls = []

    def act(observation):
        calls.append(len(observation))
        return push(observation) if len(calls) < 5 else function(observation)

    return Policy(act, check_batch=False)


def test_exceptions_of_the_policy_pass_through(device, scene):
    def fail(observation):
        raise KeyError("not a number of mine")

    with pytest.raises(KeyError, match="of mine"):
        taxelsim.evaluate(scene, policy=late(fail), device=device)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda actions: np.where(np.arange(len(actions))[:, None] == 2, np.nan, actions), r"nan found in episode 2 \(instance 2\)"),
        (lambda actions: actions.T, r"shape \(24, 6\) expected, \(6, 24\) found; did you mean"),
        (lambda actions: actions[:, :3], r"shape \(24, 6\) expected, \(24, 3\) found"),
        (lambda actions: actions.astype(int), "dtype int64 found"),
        (lambda actions: None, "dtype object found"),
    ],
)
def test_bad_actions_are_refused(device, scene, change, message):
    with pytest.raises(taxelsim.InputError, match=message):
        taxelsim.evaluate(scene, policy=late(lambda observation: change(push(observation))), device=device, num_slices=1)


@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_ends_a_policy_that_hangs(device, scene):
    def hang(observation):
        while True:
            time.sleep(0.01)

    threading.Timer(1, os.kill, (os.getpid(), signal.SIGINT)).start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        taxelsim.evaluate(scene, policy=Policy(hang, check_batch=False), device=device)
    assert time.monotonic() - start < 10


def test_data_set_of_a_policy_resumes_with_the_same_policy_only(device, scene, tmp_path):
    policy = Policy(push, identity="a" * 64)
    result = taxelsim.generate(scene, tmp_path / "out", policy=policy, device=device)
    assert result.complete
    assert taxelsim.generate(scene, tmp_path / "out", policy=policy, device=device).progress.episodes_resumed == 24
    with pytest.raises(taxelsim.InputError, match="policy"):
        taxelsim.generate(scene, tmp_path / "out", policy=Policy(push, identity="b" * 64), device=device)
    with pytest.raises(taxelsim.InputError, match="id"):
        taxelsim.generate(scene, tmp_path / "none", policy=push, device=device)


def test_failed_episodes_are_played_again_and_kept(device, scene, tmp_path):
    policy = Policy(push)
    evaluation, *_ = taxelsim.evaluate(scene, policy=policy, device=device)
    failed = evaluation.verdicts["episode"][~evaluation.verdicts["success"]]
    assert len(failed) > 1
    files = save_failures(scene, policy, failed, tmp_path / "failures", device, batch_size=4)
    assert [file.name for file in files] == [f"episode-{number:06d}.npz" for number in failed]
    with np.load(files[1]) as content:
        assert content["tactile_image"].shape == (NUM_STEPS + 1, 6, 14)
        assert content["episode"] == failed[1]
        errors = content["errors"][-1]
        last = evaluation.verdicts["settling_time"][failed[1]]
        assert content["frame_number"].tolist() == list(range(NUM_STEPS + 1))
        assert np.isnan(last) or errors[1] <= 1
    assert files[1].with_suffix(".png").read_bytes().startswith(b"\x89PNG")

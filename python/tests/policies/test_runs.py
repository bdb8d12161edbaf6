"""Policies in evaluate() and generate()."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

import taxelsim
from taxelsim.policies import OnnxPolicy, Policy
from taxelsim.policies.policy import PolicyCalls

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
        (lambda actions: actions.T, r"shape \(6, 24\) is not allowed: \(24, 6\); did you mean"),
        (lambda actions: actions[:, :3], r"shape \(24, 3\) is not allowed: \(24, 6\)"),
        (lambda actions: actions.astype(int), "dtype int64 is not allowed"),
        (lambda actions: None, "dtype object is not allowed"),
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


@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_gives_the_evaluations_that_are_complete(device, tmp_path):
    servo = Path(write_scene(tmp_path)).read_text().split("controllers:\n")[1].split("task:")[0]
    text = (tmp_path / "short.yaml").read_text().replace(servo, servo + servo.replace("name: servo", "name: twin"))
    (tmp_path / "short.yaml").write_text(text)
    scene = taxelsim.load_scene(tmp_path / "short.yaml", num_episodes=1000)

    def interrupt(progress: taxelsim.Progress) -> None:
        if progress.episodes_done > 1050:  # in the second arm, which has hundreds of frames left
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(taxelsim.Interrupted) as caught:
        taxelsim.evaluate(scene, device=device, batch_size=16, on_progress=interrupt)
    assert isinstance(caught.value, KeyboardInterrupt)
    assert [evaluation.controller for evaluation in caught.value.partial] == ["servo"]
    expected, *_ = taxelsim.evaluate(scene, ["servo"], device=device)
    assert arrays_of(caught.value.partial[0]) == arrays_of(expected)


class Recorder(PolicyCalls):
    """Keeps what the scheduler shows to the policy: tactile image, pose and features, by episode and frame."""

    seen: ClassVar[dict[tuple[int, int], bytes]] = {}

    def __call__(self, arrays, instances, first_instance):
        frame = arrays["frame"]
        for i in instances:
            values = (frame["tactile_image"][i], frame["total_force"][i], frame["edge_angle"][i], arrays["X_SO"][i])
            key = int(arrays["episodes"][i]), int(arrays["frame_numbers"][i])
            self.seen[key] = b"".join(np.ascontiguousarray(value).tobytes() for value in values)
        return super().__call__(arrays, instances, first_instance)


def wide_mlp(tmp_path: Path) -> OnnxPolicy:
    """A policy of which rows depend on the batch, so that it is called with a fixed number of rows."""
    return OnnxPolicy(write_mlp(tmp_path / "mixing.onnx", mix_rows=True))


@pytest.mark.parametrize("make_policy", [lambda path: push, wide_mlp], ids=["callable", "onnx"])
def test_failed_episodes_are_kept_as_they_were(device, tmp_path, monkeypatch, make_policy):
    scene = taxelsim.load_scene(write_scene(tmp_path, record="tactile_image, features, poses, actions"))
    monkeypatch.setattr("taxelsim.runs.PolicyCalls", Recorder)
    Recorder.seen.clear()
    policy = make_policy(tmp_path)
    evaluation, *_ = taxelsim.evaluate(scene, policy=policy, device=device)
    evaluated = dict(Recorder.seen)
    assert len(evaluated) == 24 * (NUM_STEPS + 1)
    folder = tmp_path / "failures"
    again, *_ = taxelsim.evaluate(scene, policy=policy, device=device, batch_size=7, save_failures=folder)
    assert arrays_of(again) == arrays_of(evaluation)
    failed = evaluation.verdicts["episode"][~evaluation.verdicts["success"]]
    assert 1 < len(failed) < 24 if policy is push else len(failed) > 1

    data = taxelsim.Dataset(folder)
    assert data["meta/episode"][:].tolist() == failed.tolist()
    assert not data["meta/success"][:].any()
    for k, number in enumerate(failed):
        episode = data.episode(k)
        assert len(episode["data/tactile_image"]) == NUM_STEPS + 1
        for frame in range(NUM_STEPS + 1):
            image = episode["data/tactile_image"][frame].astype(np.uint32)
            values = (image, episode["data/total_force"][frame], episode["data/edge_angle"][frame], episode["data/pose"][frame])
            assert b"".join(np.ascontiguousarray(value).tobytes() for value in values) == evaluated[int(number), frame], (number, frame)


def test_failures_are_a_data_set_for_render(device, scene, tmp_path):
    evaluation, *_ = taxelsim.evaluate(scene, policy=push, device=device, save_failures=tmp_path / "out", max_failures=2)
    failed = evaluation.verdicts["episode"][~evaluation.verdicts["success"]][:2]
    arguments = ["render", str(tmp_path / "out"), "-o", str(tmp_path / "out.png"), "--frames", "3", "--episode"]
    program = [sys.executable, "-m", "taxelsim", *arguments]
    found = subprocess.run([*program, str(failed[1])], capture_output=True, text=True)
    assert found.returncode == 0, found.stderr
    assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")
    refused = subprocess.run([*program, "999"], capture_output=True, text=True)
    assert refused.returncode == 2
    assert f"--episode 999: {tmp_path / 'out'} has episodes {failed[0]}, {failed[1]}" in refused.stderr


def test_failures_that_cannot_be_kept_are_refused_before_the_evaluation(device, scene, tmp_path):
    def unused(observation):
        raise AssertionError("called")

    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "file").touch()
    (tmp_path / "blind").mkdir()
    blind = taxelsim.load_scene(write_scene(tmp_path / "blind", record="poses, actions"))
    for arguments, message in (
        ({"scene": scene, "save_failures": tmp_path / "full"}, "need a new or an empty directory"),
        ({"scene": blind, "save_failures": tmp_path / "new"}, "record: tactile_image is missing"),
        ({"scene": scene, "save_failures": tmp_path / "new", "max_failures": 0}, "max_failures: 0 is not allowed: at least 1"),
        ({"scene": scene, "save_failures": tmp_path / "new", "policy": None}, "there is no policy"),
    ):
        with pytest.raises(taxelsim.InputError, match=message):
            taxelsim.evaluate(**{"policy": unused, "device": device, **arguments})
    assert not (tmp_path / "new").exists()


def test_a_policy_that_always_succeeds_leaves_no_directory(device, tmp_path):
    easy = write_scene(tmp_path)
    easy.write_text(easy.read_text().replace("{tolerance: 1}", "{tolerance: 100}").replace("tolerance_deg: 20", "tolerance_deg: 90"))
    evaluation, *_ = taxelsim.evaluate(easy, policy=push, device=device, save_failures=tmp_path / "failures")
    assert evaluation.verdicts["success"].all()
    assert not (tmp_path / "failures").exists()


def test_chosen_episodes_are_those_of_the_whole_data_set(device, scene, tmp_path):
    policy = Policy(push, identity="a" * 64)
    taxelsim.generate(scene, tmp_path / "whole", policy=policy, device=device)
    taxelsim.generate(scene, tmp_path / "part", policy=policy, episodes=[20, 3], device=device)
    whole, part = taxelsim.Dataset(tmp_path / "whole"), taxelsim.Dataset(tmp_path / "part")
    for k, number in enumerate((20, 3)):
        expected, found = whole.episode(number), part.episode(k)
        assert expected.keys() == found.keys()
        for name, values in expected.items():
            if name == "meta/episode_ends":  # counts the frames of the data set
                continue
            assert np.array_equal(values, found[name], equal_nan=False), name
    with pytest.raises(taxelsim.InputError, match="other episodes"):
        taxelsim.generate(scene, tmp_path / "part", policy=policy, device=device)
    for episodes, message in (([1, 1], "1 found twice"), ([], "at least 1 needed")):
        with pytest.raises(taxelsim.InputError, match=message):
            taxelsim.generate(scene, tmp_path / "none", policy=policy, episodes=episodes, device=device)

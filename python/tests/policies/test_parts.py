"""Evaluations in parts: evaluate_part(), merge_evaluations() and the command line."""

import json
import os
import pickle
import signal
import threading
from pathlib import Path

import pytest

import taxelsim
from taxelsim.commands.evaluate import main

from ..envs.conftest import write_scene
from .networks import write_mlp
from .test_runs import arrays_of, push


@pytest.fixture(scope="module")
def scene(tmp_path_factory) -> taxelsim.Scene:
    return taxelsim.load_scene(write_scene(tmp_path_factory.mktemp("scene")))


def test_parts_give_the_evaluations_of_one_run(device, scene, tmp_path):
    policy = taxelsim.Policy(push, identity="push 1")
    whole = taxelsim.evaluate(scene, ["servo"], policy=policy, device=device)
    parts: list[taxelsim.EvaluationPart | str] = []
    for episodes in (range(15, 24), range(15)):
        parts.append(taxelsim.evaluate_part(scene, ["servo"], episodes=episodes, policy=policy, device=device, batch_size=4))
    first = parts[0]
    assert first.episodes == range(15, 24)
    assert first.controllers == ["policy", "servo"]
    assert first.policy == "push 1"
    assert pickle.loads(pickle.dumps(first)) == first
    first.save(tmp_path / "first.json")
    parts[0] = str(tmp_path / "first.json")
    merged = taxelsim.merge_evaluations(scene, parts, ["servo"], policy=policy)
    assert [arrays_of(evaluation) for evaluation in merged] == [arrays_of(evaluation) for evaluation in whole]
    assert [evaluation.controller for evaluation in merged] == ["policy", "servo"]
    assert merged[0].total.success_rate == whole[0].total.success_rate

    with pytest.raises(taxelsim.InputError, match=r"^episodes 0\.\.14 are missing"):
        taxelsim.merge_evaluations(scene, [first], ["servo"], policy=policy)
    with pytest.raises(taxelsim.InputError, match=r"first\.json: has another set of controllers \(policy, servo there, policy expected\)"):
        taxelsim.merge_evaluations(scene, parts, policy=policy)
    with pytest.raises(taxelsim.InputError, match=r"first\.json: has another policy \(push 1 there, push 2 expected\)"):
        taxelsim.merge_evaluations(scene, parts, ["servo"], policy=taxelsim.Policy(push, identity="push 2"))
    with pytest.raises(taxelsim.InputError, match=r"first\.json: has another seed"):
        taxelsim.merge_evaluations(taxelsim.load_scene(scene.file, seed=77), parts, ["servo"], policy=policy)
    with pytest.raises(taxelsim.InputError, match="altered"):
        taxelsim.EvaluationPart.from_json(first.to_json().replace('"seed": ', '"seed": 1'))
    with pytest.raises(taxelsim.InputError, match=r"missing\.json: cannot be read as part"):
        taxelsim.EvaluationPart.load(tmp_path / "missing.json")


@pytest.mark.parametrize("episodes", [range(0), range(0, 4, 2), range(20, 25), range(-1, 3)])
def test_refuses_ranges_that_are_none(device, scene, episodes):
    with pytest.raises(taxelsim.InputError, match=r"^episodes: range\("):
        taxelsim.evaluate_part(scene, episodes=episodes, device=device)


@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_gives_no_part(device, scene):
    many = taxelsim.load_scene(scene.file, num_episodes=1_000_000)
    timer = threading.Timer(1, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            taxelsim.evaluate_part(many, episodes=range(1_000_000), device=device, batch_size=64)
    finally:
        timer.cancel()


def test_command_prints_the_same_from_parts(device, tmp_path, capsys):
    file = write_mlp(tmp_path / "net.onnx", num_actions=3, settings={"actions": "v_x,v_y,v_z"})
    arguments = [str(write_scene(tmp_path)), "--policy", str(file), "--controller", "servo", "--episodes", "12", "--json"]

    def output(*more: str) -> str:
        assert main([*arguments, *more]) == 0
        return capsys.readouterr().out

    def message(*more: str) -> str:
        assert main([*arguments, *more]) == 2
        return capsys.readouterr().err

    whole, out = output(), str(tmp_path / "out")
    assert "6 episodes of each" in output("--part", "1/2", "-o", out)
    assert "episodes 6..11 are missing" in message("--merge", out)
    output("--episode-range", "6..11", "-o", out)
    assert sorted(file.name for file in Path(out).iterdir()) == ["episodes-00000000-00000005.json", "episodes-00000006-00000011.json"]
    assert output("--merge", out) == whole
    assert json.loads(whole)["controllers"][1]["controller"] == "servo"
    assert "part 13/13 of 12 episodes is empty" in output("--part", "13/13", "-o", out)
    output("--part", "2/2", "-o", out)  # found on disk
    assert "has another seed" in message("--part", "2/2", "-o", out, "--seed", "8")
    assert "--part: 3/2 is not K/N" in message("--part", "3/2", "-o", out)
    assert "--episode-range: 6..12 is not allowed: the scene has episodes 0 to 11" in message("--episode-range", "6..12", "-o", out)
    assert "--output: needs" in message("--part", "1/2")
    assert "--save-failures: not with" in message("--merge", out, "--save-failures", str(tmp_path / "failures"))

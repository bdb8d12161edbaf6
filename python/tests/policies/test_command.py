"""`taxelsim evaluate SCENE --policy FILE`."""

from __future__ import annotations

import json

import pytest

from taxelsim.commands.evaluate import main

from ..envs.conftest import write_scene
from .networks import write_mlp


def test_prints_rates_and_a_paired_comparison(device, tmp_path, capsys):
    file = write_mlp(tmp_path / "net.onnx", num_actions=3, settings={"actions": "v_x,v_y,v_z"})
    scene = write_scene(tmp_path)
    failures = tmp_path / "failures"
    arguments = [str(scene), "--policy", str(file), "--controller", "servo", "--save-failures", str(failures), "--max-failures", "2"]
    assert main([*arguments, "--episodes", "12"]) == 0
    output = capsys.readouterr()
    lines = output.out.splitlines()
    assert lines[2].split()[:3] == ["policy", "episodes", "of"]
    assert lines[3].startswith("net ")
    assert lines[4].startswith("servo ")
    assert lines[-1].startswith("net - servo: ")
    assert f"of {12 - int(json_of([str(scene), '--policy', str(file), '--episodes', '12'], capsys)['successes'])} failed" in output.err
    assert len(list(failures.glob("*.npz"))) == 2


def json_of(arguments: list[str], capsys) -> dict:
    assert main([*arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)["controllers"][0]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--controller", "x"], "--controller x: not in this scene; it has servo"),
        (["--actions", "v_x"], "shape (12, 1) expected, (12, 6) found"),
        (["--observations", "sound"], "'sound' found, allowed are contact"),
        (["--history", "2"], "input 'obs' has shape ['batch', 6], the observation ['batch', 12]"),
    ],
)
def test_bad_input_gives_one_line(device, tmp_path, capsys, arguments, message):
    file = write_mlp(tmp_path / "net.onnx")
    assert main([str(write_scene(tmp_path)), "--policy", str(file), *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert len(error.splitlines()) == 1

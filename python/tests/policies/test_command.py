"""`taxelsim evaluate SCENE --policy FILE`."""

import json
import subprocess
import sys

import pytest

import taxelsim
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
    assert len(taxelsim.Dataset(failures)["meta/episode"]) == 2


def json_of(arguments: list[str], capsys) -> dict:
    assert main([*arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)["controllers"][0]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--controller", "x"], "--controller x: not in this scene; it has servo"),
        (["--actions", "v_x"], "shape (12, 6) is not allowed: (12, 1)"),
        (["--observations", "sound"], "'sound' is not allowed: contact"),
        (["--history", "2"], "input 'obs' has shape ['batch', 6], the observation ['batch', 12]"),
    ],
)
def test_bad_input_gives_one_line(device, tmp_path, capsys, arguments, message):
    file = write_mlp(tmp_path / "net.onnx")
    assert main([str(write_scene(tmp_path)), "--policy", str(file), *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert len(error.splitlines()) == 1


def test_ctrl_c_keeps_what_is_complete(device, tmp_path, capsys, monkeypatch):
    file = write_mlp(tmp_path / "net.onnx")

    def interrupted(scene, controllers, **arguments):
        raise taxelsim.Interrupted(taxelsim.evaluate(scene, **arguments))

    monkeypatch.setattr("taxelsim.commands.evaluate.evaluate", interrupted)
    assert main([str(write_scene(tmp_path)), "--policy", str(file), "--controller", "servo"]) == 130
    output = capsys.readouterr()
    assert output.err == "interrupted: 1 of 2 policies and controllers are complete\n"
    assert output.out.splitlines()[3].startswith("net ")


def test_program_hands_policies_to_python(tmp_path):
    arguments = [sys.executable, "-m", "taxelsim", "evaluate", "missing.yaml", "--policy"]
    found = subprocess.run([*arguments, str(tmp_path / "missing.onnx")], capture_output=True, text=True)
    assert found.returncode == 2
    assert found.stderr == f"taxelsim evaluate: {tmp_path / 'missing.onnx'}: No such file or directory\n"

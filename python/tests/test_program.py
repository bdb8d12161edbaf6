"""The command line: which subcommands run in Python."""

import importlib
import os
import subprocess

import pytest

from taxelsim.program import PROGRAM, SUBCOMMANDS, is_python_command


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ([], False),
        (["generate", "scene.yaml"], False),
        (["evaluate", "scene.yaml"], False),
        (["evaluate", "scene.yaml", "--policy", "p.onnx"], True),
        (["evaluate", "scene.yaml", "--policy=p.onnx"], True),
        (["evaluate", "scene.yaml", "--policyholder"], False),
        (["generate", "--policy", "p.onnx"], False),
        (["render", "out", "-o", "out.png"], False),
        (["render", "out", "-o", "out.mp4"], True),
        (["render", "out", "--output=out.gif"], True),
        (["render", "mp4", "-o", "gif"], False),
        (["finish", "out"], False),
        (["finish", "out", "--card"], True),
        (["view", "out"], True),
    ],
)
def test_is_python_command(arguments, expected):
    assert is_python_command(arguments) is expected


@pytest.mark.parametrize("name", SUBCOMMANDS)
def test_program_and_package_have_the_same_subcommands(tmp_path, name):
    assert callable(importlib.import_module(f"taxelsim.commands.{name}").main)
    (tmp_path / "python3").write_text('#!/bin/sh\n[ "$1" = -c ] && shift 3 && echo "$@"\n')  # prints the arguments
    (tmp_path / "python3").chmod(0o755)
    for word in SUBCOMMANDS[name] or ("x",):
        arguments = [name, word, "x"]
        found = subprocess.run(
            [PROGRAM, *arguments], capture_output=True, text=True, env={**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}"}
        )
        assert found.stdout.split() == arguments
    assert name in subprocess.run([PROGRAM, "--help"], capture_output=True, text=True).stdout

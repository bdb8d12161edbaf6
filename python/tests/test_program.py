"""The command line: which subcommands run in Python."""

import importlib
import os
import subprocess

import pytest
from taxelsim._core import is_python_command

from taxelsim.program import PROGRAM


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
        (["robot", "hand.yaml", "--png", "view.png"], False),
        (["robot", "hand.yaml", "--view"], True),
        (["finish", "out"], False),
        (["finish", "out", "--card"], True),
        (["inspect", "out"], False),
        (["inspect", "out.zarr", "--format", "oxt"], True),
        (["view", "out"], True),
        (["view", "\udcff"], True),  # a name that is not UTF-8
    ],
)
def test_is_python_command(arguments, expected):
    assert is_python_command(arguments) is expected


@pytest.mark.parametrize(
    "command",
    [
        "evaluate --policy",
        "finish --card",
        "inspect --format",
        "render .mp4",
        "render .gif",
        "robot --view",
        "report x",
        "view x",
        "sensor x",
        "export x",
        "import x",
    ],
)
def test_the_program_starts_python_for_the_subcommands_of_the_package(tmp_path, command):
    name, word = command.split()
    assert callable(importlib.import_module(f"taxelsim.commands.{name}").main)
    (tmp_path / "python3").write_text('#!/bin/sh\n[ "$1" = -c ] && shift 3 && echo "$@"\n')  # prints the arguments
    (tmp_path / "python3").chmod(0o755)
    arguments = [name, word, "x"]
    found = subprocess.run(
        [PROGRAM, *arguments], capture_output=True, text=True, env={**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}"}
    )
    assert found.stdout.split() == arguments
    assert name in subprocess.run([PROGRAM, "--help"], capture_output=True, text=True).stdout

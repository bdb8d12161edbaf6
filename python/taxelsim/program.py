"""The command line: `python3 -m taxelsim` and the script `taxelsim`."""

from __future__ import annotations

import importlib
import os
import sys
from pathlib import Path
from typing import NoReturn

from ._core import is_python_command

PROGRAM = Path(__file__).parent / "bin" / "taxelsim"
SCENES = Path(__file__).parent / "scenes"
"""Folder of the scenes, sensors, objects and robots that ship with the package."""


def main() -> NoReturn:
    """Runs a subcommand that is written in Python, or replaces this process by the program of the package, with the same arguments."""
    if is_python_command(sys.argv[1:]):
        sys.exit(importlib.import_module(f".commands.{sys.argv[1]}", __package__).main(sys.argv[2:]))
    if not PROGRAM.exists():
        print(f"taxelsim: {PROGRAM} is missing; install the package again: pip install --force-reinstall taxelsim", file=sys.stderr)
        sys.exit(1)
    os.execv(PROGRAM, [os.fspath(PROGRAM), *sys.argv[1:]])

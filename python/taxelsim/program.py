"""The command line: `python3 -m taxelsim` and the script `taxelsim`."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

PROGRAM = Path(__file__).parent / "bin" / "taxelsim"
SCENES = Path(__file__).parent / "scenes"
"""Folder of the scenes, sensors, objects and robots that ship with the package."""


SUBCOMMANDS: dict[str, tuple[str, ...]] = {
    "evaluate": ("--policy",),
    "finish": ("--card",),
    "render": (".mp4", ".gif"),
    "report": (),
    "view": (),
    "export": (),
    "import": (),
}
"""Subcommands that are written in Python, by name, with the words that select Python: an option, or the end of a file name; none: always.
`main(arguments) -> int` of the module taxelsim.commands.<name> runs one. src/cli/python_subcommands.cpp has the same table."""


def is_python_command(arguments: Sequence[str]) -> bool:
    """Whether the first of the arguments names a subcommand that is written in Python."""
    if not arguments or arguments[0] not in SUBCOMMANDS:
        return False
    words = SUBCOMMANDS[arguments[0]]
    return not words or any(_matches(argument, word) for argument in arguments[1:] for word in words)


def _matches(argument: str, word: str) -> bool:
    return argument.endswith(word) if word.startswith(".") else argument.split("=")[0] == word


def main() -> NoReturn:
    """Runs a subcommand that is written in Python, or replaces this process by the program of the package, with the same arguments."""
    name, arguments = "".join(sys.argv[1:2]), sys.argv[2:]
    if is_python_command([name, *arguments]):
        sys.exit(importlib.import_module(f".commands.{name}", __package__).main(arguments))
    if not PROGRAM.exists():
        print(f"taxelsim: {PROGRAM} is missing; install the package again: pip install --force-reinstall taxelsim", file=sys.stderr)
        sys.exit(1)
    os.execv(PROGRAM, [os.fspath(PROGRAM), *sys.argv[1:]])

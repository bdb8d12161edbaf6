"""`taxelsim robot FILE --view`: a page that shows a robot and moves its joints."""

from __future__ import annotations

import argparse
import json
import subprocess
from collections.abc import Sequence

from ..program import PROGRAM
from .running import run_command
from .serving import serve


def main(arguments: Sequence[str]) -> int:
    """Runs the subcommand. Returns the exit status of run_command()."""
    parser = argparse.ArgumentParser(prog="taxelsim robot", description=__doc__, allow_abbrev=False)
    parser.add_argument("file", metavar="FILE", help="robot file, or scene with a robot (YAML)")
    parser.add_argument("--view", action="store_true", help="serves the page on 127.0.0.1, until Ctrl-C")
    parser.add_argument("--port", type=int, default=0, help="port of 127.0.0.1; default: a free one")
    # All other arguments are those of the program, which checks them and computes the posture.
    options, others = parser.parse_known_args(arguments)
    return run_command("robot", lambda: _run(options, others))


def _run(options: argparse.Namespace, others: Sequence[str]) -> int:
    done = subprocess.run([PROGRAM, "robot", options.file, "--json", *others], stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        return done.returncode
    try:
        from ..play.robot_page import RobotPage
    except ModuleNotFoundError as error:
        raise ImportError(f"{error}: the view of a robot needs viser: pip install 'taxelsim[play]'") from error
    serve(RobotPage(options.file, [joint["position"] for joint in json.loads(done.stdout)["joints"]], port=options.port))
    return 0

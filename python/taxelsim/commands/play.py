"""`taxelsim play [SENSOR] [OBJECT ...]`: a playground in the browser."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from .._core import Device
from .running import run_command
from .serving import serve


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the arguments of the subcommand."""
    add = parser.add_argument
    add("sensor", nargs="?", default="wts0614", metavar="SENSOR", help="sensor file, or name of one that ships with the package")
    add("objects", nargs="*", default=[], metavar="OBJECT", help="mesh file, or a solid such as cylinder:0.008,0.04, in m")
    add("--port", type=int, default=0, help="port of 127.0.0.1; default: a free one")
    add("--device", default="", metavar="NAME", help='"cpu", "discrete", an index, or part of a name; default: the best')


def main(arguments: Sequence[str]) -> int:
    """Runs the subcommand. Returns the exit status of run_command()."""
    parser = argparse.ArgumentParser(prog="taxelsim play", description=__doc__)
    add_arguments(parser)
    options = parser.parse_args(arguments)
    return run_command("play", lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    try:
        from ..play import Playground
    except ModuleNotFoundError as error:
        raise ImportError(f"{error}: the playground needs viser: pip install 'taxelsim[play]'") from error
    serve(Playground(options.sensor, options.objects, device=Device.open(options.device), port=options.port))

"""`taxelsim view DIR|SCENE`: shows episodes in the viewer Rerun."""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from .._core import Device
from .._files import require_folder, write_whole
from ..errors import InputError, IoError
from ..viewer import view
from ..viewer.measurements import is_measurement
from .running import run_command

if TYPE_CHECKING:
    import rerun

LOOPBACK = "127.0.0.1"
GRPC_PORT, WEB_PORT = 9876, 9090  # defaults of Rerun
INTERRUPTED = 130


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the arguments of the subcommand."""
    add = parser.add_argument
    add("path", type=Path, metavar="DIR|SCENE", help="data set, measurement, or scene file: its episodes are simulated and not kept")
    add("--episode", type=int, nargs="+", action="extend", metavar="N", help="numbers of the episodes; default: the first three")
    add("--assets", type=Path, action="append", default=[], metavar="DIR", help="folder with meshes of a data set's scene; repeatable")
    add("--range", type=float, metavar="COUNTS", help="brightest colour; default: the 99.9th percentile of the data set")
    add("--device", default="", metavar="NAME", help='simulates a scene: "cpu", "discrete", an index, or part of a name; default: the best')
    output = parser.add_mutually_exclusive_group()
    output.add_argument("--save", type=Path, metavar="FILE.rrd", help="writes a file instead of opening a window; needs no display")
    output.add_argument(
        "--web", action="store_true", help=f"serves a page for a browser on ports {WEB_PORT} and {GRPC_PORT} of this machine, until Ctrl-C"
    )


def main(arguments: Sequence[str]) -> int:
    """Runs the subcommand. Returns the exit status of run_command()."""
    parser = argparse.ArgumentParser(prog="taxelsim view", description=__doc__)
    add_arguments(parser)
    options = parser.parse_args(arguments)
    return run_command("view", lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    if options.save and options.save.suffix != ".rrd":
        raise InputError(f"--save {options.save}: the name of a file that ends in .rrd is needed")
    if options.save:
        require_folder(options.save)
    if not (options.save or options.web or _has_display()):
        raise InputError("there is no display: --save FILE.rrd writes a file, --web serves a page for a browser")
    # Opened where a scene is simulated, so that a data set needs no device.
    device = Device.open(options.device) if options.path.is_file() and not is_measurement(options.path) else None
    recording = view(options.path, options.episode, assets=options.assets, device=device, isolated=True, range=options.range)
    if options.save:
        save(recording, options.save)
    else:
        _show(recording, web=options.web)


def _has_display() -> bool:
    return not sys.platform.startswith("linux") or any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))


def save(recording: rerun.RecordingStream, file: Path) -> None:
    """Writes a recording as a whole. Raises IoError."""
    write_whole(file, recording.memory_recording().drain_as_bytes())


def _show(recording: rerun.RecordingStream, *, web: bool) -> None:
    """Runs the viewer of rerun-sdk until it is closed. It listens on the loopback interface only."""
    from rerun_cli.__main__ import main as run_viewer  # `python3 -m rerun` would look for it in the current folder first

    web_options = ["--web-viewer-port", str(WEB_PORT), "--web-viewer" if _has_display() else "--serve-web"] if web else []
    ports = f"ports {WEB_PORT} and {GRPC_PORT}" if web else f"port {GRPC_PORT}"
    place = f"open http://{LOOPBACK}:{WEB_PORT}/?url=rerun%2Bhttp://{LOOPBACK}:{GRPC_PORT}/proxy; Ctrl-C ends. " if web else ""
    print(f"{place}The viewer listens on {ports} of {LOOPBACK}.", file=sys.stderr, flush=True)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "view.rrd")
        save(recording, file)
        sys.argv = ["rerun", "--bind", LOOPBACK, "--port", str(GRPC_PORT), *web_options, os.fspath(file)]
        status = run_viewer()
    if status == INTERRUPTED:
        raise KeyboardInterrupt
    if status != 0:
        raise IoError(f"the viewer ended with status {status}; --save FILE.rrd writes a file for another machine")

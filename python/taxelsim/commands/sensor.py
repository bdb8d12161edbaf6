"""`taxelsim sensor from-mesh|from-pattern FILE -o FILE.yaml`: a sensor file from a mesh, or from places of taxels, and its picture."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path

from .._arguments import LENGTH_UNITS, checked_positive
from .._core import Sensor, load_mesh, sensor_text
from .._files import write_whole
from ..errors import InputError
from ..patterns import Placed, cover_shape, draw, grid_on_shape, load_pattern
from ..patterns.placement import UP, GridOptions
from ..patterns.taxels import LIKE
from ..pictures import save_png
from .running import run_command


def main(arguments: Sequence[str]) -> int:
    """Runs the subcommand. Returns the exit status of run_command()."""
    options = _parser().parse_args(arguments)
    return run_command("sensor", lambda: _run(options))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="taxelsim sensor", description=__doc__)
    kinds = parser.add_subparsers(dest="kind", required=True)
    pattern = kinds.add_parser("from-pattern", help="taxels at the places of a CSV file (columns x, y, z, nx, ny, nz) or NPZ file")
    mesh = kinds.add_parser("from-mesh", help="taxels over the surface of a mesh: STL, OBJ, PLY or glTF")
    for command in (pattern, mesh):
        add = command.add_argument
        add("source", type=Path, metavar="FILE")
        add("-o", "--output", required=True, type=Path, metavar="FILE.yaml", help="sensor file; FILE.png shows its taxels from three sides")
        add("--unit", required=True, choices=LENGTH_UNITS, help="unit of length of the source, which files do not state")
        add("--like", type=Path, default=LIKE, metavar="SENSOR", help=f"sensor file that gives skin and electronics; default: {LIKE.name}")
        add("--name", help="name of the sensor; default: that of the output")
    pattern.add_argument("--size", type=float, metavar="M", help="m, side of a taxel; default: the median distance of neighbours")
    add = mesh.add_argument
    add("--pitch", required=True, type=float, metavar="M", help="m, side of a taxel")
    add("--grid", nargs=2, type=int, metavar=("ROWS", "COLS"), help="a flat grid instead of a cover of the surface")
    add("--direction", nargs=3, type=float, metavar=("X", "Y", "Z"), help="covers what faces it; default: everything, of a grid +z")
    add("--half-angle", type=float, default=90.0, metavar="DEG", help="largest angle of a normal from the direction (90)")
    add("--region", nargs=6, type=float, metavar=("X0", "Y0", "Z0", "X1", "Y1", "Z1"), help="m, box without taxels outside of it")
    add("--raised", type=float, default=0.0, metavar="M", help="m, height of the outer skin over the surface (0)")
    return parser


def _run(options: argparse.Namespace) -> None:
    output: Path = options.output
    picture = output.with_suffix(".png")
    if output.suffix not in (".yaml", ".yml"):
        raise InputError(f"--output {output}: ending {output.suffix!r} is not allowed: .yaml")
    for file in (output, picture):
        if file.exists():
            raise InputError(f"{file}: exists; choose another output or remove it")
    name = output.stem if options.name is None else options.name
    placed = None
    if options.kind == "from-pattern":
        sensor: Sensor = load_pattern(options.source, unit=options.unit, size=options.size, name=name, like=options.like)
    else:
        placed = _on_mesh(options, name)
        sensor = placed.sensor
    save_png(picture, draw(sensor))
    write_whole(output, sensor_text(sensor).encode())
    print(f"{output}: {sensor.num_taxels} taxels, drawn in {picture}")
    if placed is not None:
        position, rotation = (
            ", ".join(f"{value + 0.0:.9g}" for value in values) for values in (placed.X_BS.position, placed.X_BS.rotation)
        )
        print(f"mount on the mesh: {{position: [{position}], rotation: [{rotation}]}}")


def _on_mesh(options: argparse.Namespace, name: str) -> Placed:
    mesh = load_mesh(options.source, scale=LENGTH_UNITS[options.unit])
    pitch = checked_positive("--pitch", options.pitch)
    common: GridOptions = {"raised": options.raised, "like": options.like, "name": name}
    if options.direction:
        common["direction"] = options.direction
    if options.grid:
        if options.region:
            raise InputError("--region: not for a --grid, which has its place by --direction")
        rows, cols = options.grid
        return grid_on_shape(mesh, rows, cols, pitch, **GridOptions(direction=UP) | common)
    region = None if options.region is None else (options.region[:3], options.region[3:])
    return cover_shape(mesh, pitch, half_angle=math.radians(options.half_angle), region=region, **common)

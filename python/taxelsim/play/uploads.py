"""Meshes that a browser uploads. A child process with limits of time and memory reads them, so that no file can harm the playground."""

from __future__ import annotations

import io
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path, PurePath

import numpy as np

from .. import _mesh_child as child
from .._arguments import LENGTH_UNITS
from .._core import LONGEST_PLAUSIBLE, Mesh
from ..errors import InputError

SUFFIXES = (".stl", ".obj", ".ply", ".glb")
"""Formats that name no other files."""
MAX_BYTES = 32 << 20
"""Of an uploaded file."""
MAX_TRIANGLES = 200_000
"""Of a mesh after its simplification."""
_MAX_LINE = 400  # characters of an error


def checked_name(name: str) -> str:
    """The last part of a file name, for messages and programs. Raises InputError for another format."""
    base = PurePath(name.replace("\\", "/")).name
    if PurePath(base).suffix.lower() not in SUFFIXES or not base.isprintable():
        raise InputError(f"mesh: {base!r:.80} is not allowed: a file of {', '.join(SUFFIXES)}")
    return base


def read_in_child(name: str, content: bytes, scale: float = 1.0, up_axis: str = "z", max_depth_error: float = 0.0) -> Mesh:
    """The mesh of a file. Raises InputError for a file that is no mesh or exceeds the limits."""
    package = Path(child.__file__).absolute().parents[1]
    with tempfile.TemporaryDirectory(prefix="taxelsim-play-") as folder:
        file = Path(folder, "mesh").with_suffix(PurePath(name).suffix.lower())
        file.write_bytes(content)
        command = [sys.executable, "-m", child.__name__, str(file), repr(scale), up_axis, repr(max_depth_error)]
        try:
            done = subprocess.run(command, capture_output=True, timeout=child.MAX_SECONDS, cwd=package, check=False)
        except subprocess.TimeoutExpired:
            raise InputError(f"{name}: not read within {child.MAX_SECONDS} s") from None
    if done.returncode == 2:
        raise InputError(done.stderr.decode(errors="replace").strip().replace(str(file), name)[:_MAX_LINE])
    if done.returncode != 0:
        raise InputError(f"{name}: reading it took more than {child.MAX_SECONDS} s or {child.MAX_ADDRESS_SPACE >> 30} GiB")
    with np.load(io.BytesIO(done.stdout), allow_pickle=False) as arrays:
        return Mesh(arrays["vertices"], arrays["triangles"])


@dataclass(frozen=True)
class Upload:
    """A file that a browser sent."""

    name: str
    content: bytes
    sides: tuple[float, float, float]  #: Of the bounding box, units of the file.
    num_triangles: int

    @staticmethod
    def of(name: str, content: bytes) -> Upload:
        """Reads a file. Raises InputError."""
        name = checked_name(name)
        if not 0 < len(content) <= MAX_BYTES:
            raise InputError(f"{name}: {len(content)} bytes are not allowed: 1 to {MAX_BYTES}")
        mesh = read_in_child(name, content)
        x, y, z = np.ptp(mesh.vertices, axis=0).tolist()
        return Upload(name, content, (x, y, z), len(mesh.triangles))

    @property
    def likely_unit(self) -> str:
        """A key of LENGTH_UNITS: "mm" for a mesh that is implausibly long in metres."""
        return "mm" if max(self.sides) > LONGEST_PLAUSIBLE else "m"

    def mesh(self, unit: str, up_axis: str, max_depth_error: float) -> Mesh:
        """The simplified mesh. unit: a key of LENGTH_UNITS. Raises InputError."""
        if unit not in LENGTH_UNITS:
            raise InputError(f"unit: {unit!r:.20} is not allowed: {', '.join(LENGTH_UNITS)}")
        mesh = read_in_child(self.name, self.content, LENGTH_UNITS[unit], up_axis, max_depth_error)
        if len(mesh.triangles) > MAX_TRIANGLES:
            raise InputError(f"{self.name}: {len(mesh.triangles)} triangles after simplification are not allowed: at most {MAX_TRIANGLES}")
        return mesh

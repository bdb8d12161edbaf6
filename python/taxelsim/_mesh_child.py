"""Reads a mesh file in a process with limits: `python3 -m taxelsim._mesh_child FILE SCALE UP_AXIS MAX_DEPTH_ERROR`.

It writes vertices and triangles to stdout as .npz, or one line to stderr and ends with status 2.
"""

from __future__ import annotations

import resource
import sys

import numpy as np

from ._core import load_mesh
from .errors import Error

MAX_SECONDS = 60
"""Of processor time, and of elapsed time until the parent gives up."""
MAX_ADDRESS_SPACE = 4 << 30
"""Bytes."""


def main(file: str, scale: str, up_axis: str, max_depth_error: str) -> int:
    """Returns the exit status."""
    for limit, value in ((resource.RLIMIT_CORE, 0), (resource.RLIMIT_CPU, MAX_SECONDS), (resource.RLIMIT_AS, MAX_ADDRESS_SPACE)):
        resource.setrlimit(limit, (value, value))
    try:
        mesh = load_mesh(file, scale=float(scale), up_axis=up_axis, max_depth_error=float(max_depth_error))
    except Error as error:
        print(error, file=sys.stderr)
        return 2
    np.savez(sys.stdout.buffer, vertices=mesh.vertices, triangles=mesh.triangles)
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))

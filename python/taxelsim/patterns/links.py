"""Taxels on links of a URDF, without a physics engine."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from .._core import Box, Cylinder, Pose, Sphere, axis_angle, load_mesh
from .._log import logger
from ..errors import InputError, IoError
from .placement import UP, CoverOptions, GridOptions, Placed, cover_shape, grid_on_shape, turned
from .surface import Shape

if TYPE_CHECKING:
    from typing_extensions import Unpack


def grid_on_link(
    urdf: str | PathLike[str],
    link: str,
    rows: int,
    cols: int,
    pitch: float | Sequence[float],
    *,
    collision: int | None = None,
    **options: Unpack[GridOptions],
) -> Placed:
    """A flat grid on a flat part of a link. X_BS is the pose of the sensor in the link, the `mount` of a robot file.

    collision: number of the <collision> of the link, from 0; needed if it has several.
    options: as for grid_on_shape(), with the direction in the frame of the link.

    Raises InputError for a link or geometry that is not there, and IoError for a file that cannot be read.
    """
    shape, X_BO = _shape_of(Path(urdf), link, collision)
    placed = grid_on_shape(shape, rows, cols, pitch, **turned(X_BO, GridOptions(direction=UP) | options))
    return Placed(placed.sensor, X_BO * placed.X_BS)


def cover_link(
    urdf: str | PathLike[str], link: str, pitch: float, *, collision: int | None = None, **options: Unpack[CoverOptions]
) -> Placed:
    """Taxels over the curved surface of a link. options: as for cover_shape(). Otherwise as grid_on_link()."""
    shape, X_BO = _shape_of(Path(urdf), link, collision)
    placed = cover_shape(shape, pitch, **turned(X_BO, options))
    return Placed(placed.sensor, X_BO * placed.X_BS)


def link_shapes(urdf: Path) -> dict[str, list[tuple[Shape, Pose]]]:
    """Shapes of each link in O, and their poses X_LO in the link: visual ones; those for collisions where a visual one cannot be read.

    A link whose shapes cannot be read has none. Raises InputError for a file that is no URDF, and IoError for one that cannot be read.
    """
    shapes: dict[str, list[tuple[Shape, Pose]]] = {}
    for name, link in _links(urdf).items():
        shapes[name] = []
        for tag in ("visual", "collision"):
            try:
                found = [_placed_shape(urdf, name, element) for element in link.findall(tag)]
            except (InputError, IoError) as error:
                logger.info("%s", error)
                continue
            if found:
                shapes[name] = found
                break
    return shapes


def _links(urdf: Path) -> dict[str, ElementTree.Element]:
    try:
        root = ElementTree.fromstring(urdf.read_bytes())
    except OSError as error:
        raise IoError(f"{urdf}: {error.strerror}") from error
    except ElementTree.ParseError as error:
        raise InputError(f"{urdf}: {error}") from error
    return {element.get("name", ""): element for element in root.findall("link")}


def _shape_of(urdf: Path, link: str, collision: int | None) -> tuple[Shape, Pose]:
    """Shape of a link in O, and its pose X_BO in the link."""
    links = _links(urdf)
    if link not in links:
        raise InputError(f"{urdf}: link {link!r} is not there; it has {', '.join(map(repr, links)) or 'none'}")
    found = links[link].findall("collision")
    if collision is None and len(found) != 1:
        raise InputError(f"{urdf}: link {link!r} has {len(found)} <collision>, 1 allowed without the argument collision")
    if collision is not None and not 0 <= collision < len(found):
        raise InputError(f"collision: {collision} is not allowed: link {link!r} has {len(found)}, counted from 0")
    return _placed_shape(urdf, link, found[collision or 0])


def _placed_shape(urdf: Path, link: str, element: ElementTree.Element) -> tuple[Shape, Pose]:
    """Shape of a <visual> or <collision>, and its pose in the link."""
    geometry = element.find("geometry")
    kinds = list(geometry) if geometry is not None else []
    if len(kinds) != 1:
        raise InputError(f"{urdf}: link {link!r}: {len(kinds)} shapes in <geometry> are not allowed: 1")
    return _shape(urdf, link, kinds[0]), _origin(urdf, link, element.find("origin"))


def _shape(urdf: Path, link: str, element: ElementTree.Element) -> Shape:
    def numbers(key: str, count: int) -> list[float]:
        return _numbers(f"{urdf}: link {link!r}: {key} of <{element.tag}>", element.get(key, ""), count)

    if element.tag == "box":
        return Box(numbers("size", 3))
    if element.tag == "sphere":
        return Sphere(numbers("radius", 1)[0])
    if element.tag == "cylinder":
        return Cylinder(radius=numbers("radius", 1)[0], length=numbers("length", 1)[0])
    if element.tag == "mesh":
        scale = numbers("scale", 3) if element.get("scale") else [1.0]
        if len(set(scale)) > 1:
            raise InputError(f"{urdf}: link {link!r}: scale {scale} of a mesh is not allowed: equal along x, y and z")
        return load_mesh(_mesh_file(urdf, element.get("filename", "")), scale=scale[0])
    raise InputError(f"{urdf}: link {link!r}: <{element.tag}> is not allowed: <box>, <sphere>, <cylinder> or <mesh>")


def _mesh_file(urdf: Path, name: str) -> Path:
    """A file relative to the URDF; one of a package in a folder of that name above the URDF, or next to one."""
    if not name.startswith("package://"):
        return urdf.parent / name.removeprefix("file://")
    package, _, rest = name.removeprefix("package://").partition("/")
    above = urdf.resolve().parents
    found = [folder for folder in (*(f for f in above if f.name == package), *(f / package for f in above)) if (folder / rest).is_file()]
    if not found:
        raise InputError(f"{urdf}: {name} is not found: a folder {package!r} above the file, or next to one, with {rest!r} is expected")
    return found[0] / rest


def _origin(urdf: Path, link: str, element: ElementTree.Element | None) -> Pose:
    """Roll about x, then pitch about y, then yaw about z, all fixed axes."""
    if element is None:
        return Pose()
    xyz, rpy = (_numbers(f"{urdf}: link {link!r}: {key} of <origin>", element.get(key, "0 0 0"), 3) for key in ("xyz", "rpy"))
    turns = [Pose(rotation=axis_angle([float(i == k) for i in range(3)], angle)) for k, angle in enumerate(rpy)]
    return Pose(xyz, (turns[2] * turns[1] * turns[0]).rotation)


def _numbers(name: str, text: str, count: int) -> list[float]:
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        values = []
    if len(values) != count or not all(map(math.isfinite, values)):
        raise InputError(f"{name}: {text!r} is not allowed: {count} finite number{'s' if count > 1 else ''}")
    return values

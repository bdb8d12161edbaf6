"""Bodies, sites and shapes of a Newton model by label, one in each world."""

from __future__ import annotations

from collections.abc import Sequence
from fnmatch import fnmatch
from typing import Any

import newton
import numpy as np
from numpy.typing import NDArray

from ..errors import InputError

Indices = NDArray[np.int32]


def sensor_frames(model: Any, label: str) -> Indices:
    """(N, 2): body and site, or -1, of a sensor in each world. The label is that of a body, whose frame is S, or of a site.

    Raises InputError for one that is in no world, as in a model without worlds.
    """
    bodies, flags = model.shape_body.numpy(), model.shape_flags.numpy()
    sites = np.flatnonzero(flags & int(newton.ShapeFlags.SITE))
    labels = [*model.body_label, *(model.shape_label[site] for site in sites)]
    worlds = np.concatenate((model.body_world.numpy(), model.shape_world.numpy()[sites]))
    on_body = np.stack((np.arange(model.body_count), np.full(model.body_count, -1)), axis=1)
    pairs = np.concatenate((on_body, np.stack((bodies[sites], sites), axis=1))).astype(np.int32)
    found = _one_per_world("body or site", label, labels, worlds, model.world_count)
    if (worlds[found] < 0).any():
        raise InputError(f"body or site {label!r} is in no world: add its builder with ModelBuilder.replicate() or add_world()")
    frames: Indices = pairs[found]
    return frames


def shape_indices(model: Any, labels: Sequence[str]) -> Indices:
    """(N, S): shapes in each world. Raises InputError for one that is listed twice."""
    worlds = model.shape_world.numpy()
    columns = [_one_per_world("shape", label, model.shape_label, worlds, model.world_count) for label in labels]
    for k, column in enumerate(columns):
        if any(column[0] == other[0] for other in columns[:k]):
            raise InputError(f"shapes: shape {labels[k]!r} is listed twice")
    return np.stack(columns, axis=1)


def _one_per_world(kind: str, label: str, labels: Sequence[str], worlds: NDArray[np.int32], num_worlds: int) -> Indices:
    """(N): the entity with this label in each world, or the one that all worlds share. Raises InputError for 0 or several."""
    found = np.array([i for i, name in enumerate(labels) if fnmatch(name, label)], np.int32)
    is_shared = worlds[found] < 0
    own = found[~is_shared]
    counts = np.bincount(worlds[own], minlength=num_worlds) + np.count_nonzero(is_shared)
    if len(found) == 0:
        first = dict.fromkeys(name for name, world in zip(labels, worlds, strict=True) if world <= 0)
        raise InputError(f"{kind} {label!r} is not in the model; it has {', '.join(map(repr, first))}")
    if (counts != 1).any():
        world = int(np.argmax(counts != 1))
        raise InputError(f"{kind} {label!r}: {counts[world]} found in world {world}, 1 allowed")
    indices = np.full(num_worlds, found[0], np.int32)
    indices[worlds[own]] = own
    return indices

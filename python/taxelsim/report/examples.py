"""Example images of each stratum: an object and a level of force."""

from __future__ import annotations

import numpy as np

from ..dataset.layout import label_of
from ..pictures import TACTILE_IMAGE, shown_column
from .sample import Sample
from .summary import EXAMPLE_LEVELS, Example, Summary

MAX_OBJECTS = 12  # with examples


def examples_of(sample: Sample, summary: Summary) -> list[Example]:
    """One frame of each object at each of EXAMPLE_LEVELS, percentiles of the measured force, or of the sum of counts without features.

    Recorded contact points count as one object.
    """
    force_name = "data/total_force" if "data/total_force" in sample.data else TACTILE_IMAGE
    forces = np.concatenate([block.reshape(len(block), -1).sum(1) for block in sample.frames(force_name)])
    frames = np.concatenate([np.arange(first, end) for first, end in sample.blocks])
    episodes = np.searchsorted(sample.data.episode_ends, frames, "right")
    label = label_of(sample.data)
    names = sample.column(label)[np.searchsorted(sample.episodes, episodes)] if label else np.full(len(frames), summary.scene.name)
    shown = shown_column(sample.data)
    axes = () if shown == TACTILE_IMAGE else (3,)
    examples = []
    for name in list(summary.objects or np.unique(names))[:MAX_OBJECTS]:
        chosen = np.flatnonzero(names == name)
        if not len(chosen):
            continue
        order = chosen[np.argsort(forces[chosen], kind="stable")]
        for level in EXAMPLE_LEVELS:
            k = order[round(level / 100 * (len(order) - 1))]
            image = sample.data[shown][int(frames[k])].reshape(-1, summary.sensor.num_taxels, *axes)
            examples.append(Example(f"{name}, {level} % of forces below", float(forces[k]), sample.data[force_name].unit, image[0]))
    return examples

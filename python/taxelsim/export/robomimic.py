"""robomimic: one HDF5 file with a group data/demo_N for each episode."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from .. import __version__
from ..errors import InputError
from .features import SUCCESS, Feature, short_name
from .source import Block, Source
from .staging import staged_file

BLOCK_FRAMES = 1 << 14  # that are in memory at once
VALID_EVERY = 10  # every tenth episode, or the last of fewer, is in mask/valid
_EPISODE_BYTES = 1 << 14  # more than the group of an episode and its headers take
_GYM = 2  # the reader's number of a Gymnasium environment


def write(source: Source, out: Path, plan: dict[str, Any], report: Callable[[int], None]) -> None:
    """Writes the file `out`; an interrupted export begins again.

    report: called with the number of frames since the last call. Throws InputError.
    """
    if source.action is None:
        raise InputError(f"{source.data.folder}: no column data/action, which robomimic needs: record actions in the scene")
    named = {**source.named_tactile("tactile", "_"), "state": source.state}
    named |= {short_name(name).replace(".", "_"): feature for name, feature in source.columns.items()}
    observations = {name: feature for name, feature in named.items() if feature is not None}
    bytes_per_frame = 16 + 4 * sum(len(feature.names) for feature in (*observations.values(), source.action))
    columns = (*source.frame_columns(), *((SUCCESS,) if source.has_success else ()))
    with staged_file(out) as staged, h5py.File(staged, "w", locking=False) as file:  # staged_file() has the lock
        data = file.create_group("data")
        for first, end in source.parts(BLOCK_FRAMES):
            block = source.block(first, end, columns)
            _reserve(
                file,
                (2 if source.options.next_observations else 1) * bytes_per_frame * block.num_frames + _EPISODE_BYTES * block.num_episodes,
            )
            _write_episodes(data, block, source.action, observations, with_next=source.options.next_observations)
            report(block.num_frames)
        _reserve(file, _EPISODE_BYTES * source.num_episodes)
        data.attrs["total"] = source.num_frames
        data.attrs["env_args"] = json.dumps({"env_name": source.scene_name, "type": _GYM, "env_kwargs": {}})
        units = dict.fromkeys(source.named_tactile("tactile", "_"), "counts")
        names = {name: list(feature.names) for name, feature in {**observations, "actions": source.action}.items()}
        data.attrs["taxelsim"] = json.dumps(
            {"version": __version__, **source.identity(), "episodes": plan["options"]["episodes"], "names": names, "units": units}
        )
        _write_masks(file, source.num_episodes)


def _reserve(file: Any, num_bytes: int) -> None:
    """Claims space on the disk, which the file returns when it is closed.

    A full disk is an OSError here. HDF5 can crash if it fails to write.
    """
    os.posix_fallocate(file.id.get_vfd_handle(), file.id.get_filesize(), num_bytes)


def _write_episodes(data: Any, block: Block, action: Feature, observations: dict[str, Feature], *, with_next: bool) -> None:
    success = block.values.get(SUCCESS, np.zeros(block.num_episodes))
    actions = action.vectors(block.values)
    vectors = {name: feature.vectors(block.values) for name, feature in observations.items()}
    for episode, (length, end) in enumerate(zip(block.lengths.tolist(), block.ends.tolist(), strict=True)):
        frames = slice(end - length, end)
        group = data.create_group(f"demo_{block.first_episode + episode}")
        group.attrs["num_samples"] = length
        is_last = np.arange(length) == length - 1
        group["actions"] = actions[frames]
        group["dones"] = is_last.astype(np.int64)
        group["rewards"] = is_last * np.float64(success[episode] == 1)
        for name, values in vectors.items():
            group[f"obs/{name}"] = values[frames]
            if with_next:
                group[f"next_obs/{name}"] = _next_of(values[frames])


def _next_of(values: NDArray[Any]) -> NDArray[Any]:
    """Of each frame the next one. The last frame has none and keeps its own; `dones` is 1 there."""
    return np.concatenate((values[1:], values[-1:]))


def _write_masks(file: Any, num_episodes: int) -> None:
    numbers = np.arange(num_episodes)
    is_valid = numbers % VALID_EVERY == min(VALID_EVERY, num_episodes) - 1
    for name, chosen in (("train", ~is_valid), ("valid", is_valid)):
        file[f"mask/{name}"] = np.array([f"demo_{number}".encode() for number in numbers[chosen]], dtype="S")

"""Keeps failed episodes of a policy: plays them again and stores what happened."""

from __future__ import annotations

import os
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import TASK_MEASURES, Device, Scene
from ..environment import Environment, EnvironmentFrame, Task
from ..pictures import pictures, taxel_map
from .policy import Policy, PolicyCalls

_COLUMNS = 8  # pictures per row of a contact sheet
_MAX_PICTURES = 32


def save_failures(
    scene: Scene, policy: Policy, episodes: NDArray[np.uint64], directory: str | os.PathLike[str], device: Device, batch_size: int = 256
) -> list[Path]:
    """Plays `episodes` again and writes episode-<number>.npz and a picture of the same name into `directory`. Returns the .npz files.

    A file holds one row per control tick: tactile_image (counts), frame_number, time (s), X_WS and X_SO (position, quaternion w, x, y, z),
    total_force (N, measured), twist (the command, in S; without action noise), errors (by TASK_MEASURES), contact.
    """
    Task.of(scene)
    folder = Path(directory)
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for first in range(0, len(episodes), batch_size):
        numbers = np.asarray(episodes[first : first + batch_size], np.uint64)
        rows = _play(Environment(device, scene, len(numbers)), PolicyCalls(policy, scene), numbers)
        for i, number in enumerate(numbers):
            file = folder / f"episode-{number:06d}.npz"
            columns = {name: np.stack([row[name][i] for row in rows]) for name in rows[0]}
            constants = {"episode": number, "scene": scene.resolved, "policy": policy.identity, "measures": TASK_MEASURES}
            np.savez_compressed(file, **{name: np.asarray(value) for name, value in {**constants, **columns}.items()})  # type: ignore[arg-type]
            _write_png(file.with_suffix(".png"), _sheet(scene, columns["tactile_image"]))
            files.append(file)
    return files


def _play(environment: Environment, calls: PolicyCalls, episodes: NDArray[np.uint64]) -> list[dict[str, NDArray[Any]]]:
    everything = np.arange(len(episodes), dtype=np.int32)
    environment.reset(np.ones(len(episodes), np.bool_), episodes)
    rows: list[dict[str, NDArray[Any]]] = []
    for _ in range(0, environment.num_frames, environment.control_period):
        if rows:
            environment.step(rows[-1]["twist"])
        frame = environment.observe()
        twists = calls._commands(frame, everything, 0)
        state = environment.task_state()
        rows.append({**_columns(frame), "twist": twists, "errors": state.errors.copy(), "contact": state.contact.copy()})
    return rows


def _columns(frame: EnvironmentFrame) -> dict[str, NDArray[Any]]:
    return {
        "tactile_image": frame.tactile_image.copy(),
        "total_force": frame.total_force.copy(),
        "frame_number": frame.frame_numbers.copy(),
        "time": frame.times.copy(),
        "X_WS": frame.X_WS.copy(),
        "X_SO": frame.X_SO.copy(),
    }


def _sheet(scene: Scene, images: NDArray[Any]) -> NDArray[np.uint8]:
    """Pictures of evenly spaced frames (T, ...), in rows from left to right."""
    chosen = images[np.unique(np.linspace(0, len(images) - 1, _MAX_PICTURES).astype(int))]
    sensors = chosen.reshape(len(chosen), -1, scene.sensor.num_taxels)
    pixels = taxel_map(scene.sensor.taxel_positions)
    frames = np.concatenate([pictures(sensors[:, s], scene.sensor.readout.saturation, pixels) for s in range(sensors.shape[1])], axis=2)
    framed = np.pad(frames, ((0, -len(frames) % _COLUMNS), (2, 2), (2, 2), (0, 0)), constant_values=255)
    lines = framed.reshape(-1, _COLUMNS, *framed.shape[1:])
    return np.concatenate([np.concatenate(list(line), axis=1) for line in lines], axis=0)


def _write_png(file: Path, image: NDArray[np.uint8]) -> None:
    """Writes an image (height, width, 3) without filters."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    height, width, _ = image.shape
    lines = np.concatenate([np.zeros((height, 1), np.uint8), image.reshape(height, -1)], axis=1)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    file.write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines.tobytes(), 9)) + chunk(b"IEND", b"")
    )

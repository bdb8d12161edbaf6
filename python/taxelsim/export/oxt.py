"""Open-X-Tactile: Zarr of version 2 with touch by side, group and functional area, as FTP-1 reads it (oxt_rules has the contract)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .features import column_of, short_name
from .oxt_camera import Camera, camera_of
from .oxt_layout import JOINTS, POSE, Group, Layout, rotation_vectors
from .oxt_rules import CAMERAS, TYPES
from .source import Source
from .staging import staged_folder
from .zarr_store import Row, ZarrStore

PIECE_BYTES = 64 << 20  # of the array with the longest rows, before compression
CHUNK_BYTES = 2 << 20
MAX_PIECE = 1 << 13  # frames
_EXACT = 1 << 24  # largest integer below which float32 has all
_CAMERA = CAMERAS[0]


def write(source: Source, out: Path, plan: dict[str, Any], report: Callable[[int], None]) -> None:
    """Writes the folder `out`. report: called with the number of frames since the last call. Throws InputError."""
    arrays = _Arrays(source)
    with staged_folder(out, plan) as folder:
        store = ZarrStore(folder, source, arrays.rows, arrays.piece)
        store.write(arrays.values, report)
        store.finish(plan, arrays.about())


class _Arrays:
    """The arrays of data/ and their values."""

    def __init__(self, source: Source) -> None:
        self._source, self._layout = source, Layout.of(source)
        self._camera: Camera = camera_of(source, self._layout)
        self._tasks, self._task_of_episode = source.tasks()
        self._texts = np.array(self._tasks)
        self._vectors = {short_name(name).replace(".", "_"): feature for name, feature in source.columns.items()}
        rows = self._row_types()
        longest = max(dtype.itemsize * int(np.prod(shape)) for dtype, shape, _ in rows.values())
        self.piece = min(MAX_PIECE, _power_of_two(PIECE_BYTES // longest))
        self.rows = {name: self._row(*row) for name, row in rows.items()}
        self._columns = self._column_names()

    def _row(self, dtype: np.dtype[Any], shape: tuple[int, ...], attributes: dict[str, Any]) -> Row:
        chunk = _power_of_two(CHUNK_BYTES // (dtype.itemsize * int(np.prod(shape))))
        return Row(dtype, shape, min(self.piece, chunk), attributes)

    def _row_types(self) -> dict[str, tuple[np.dtype[Any], tuple[int, ...], dict[str, Any]]]:
        """Type, shape of a row, and attributes of each array."""
        layout, float32, float64, int64 = self._layout, np.dtype(np.float32), np.dtype(np.float64), np.dtype(np.int64)
        rows: dict[str, tuple[np.dtype[Any], tuple[int, ...], dict[str, Any]]] = {"timestamps": (float64, (), {"unit": "s"})}
        rows["sub_task_instruction"] = (self._texts.dtype, (), {})
        rows[_CAMERA] = (np.dtype(np.uint8), self._camera.shape, self._camera.about)
        for group in layout.groups:
            pads = {"unit": "counts", "sensors": [pad.name for pad in group.pads]}
            shape = self._source.data[column_of(group.pads[0].prefix, group.column)].shape[1:]
            rows[group.key("data")] = (float32, (len(group.pads), *shape[group.pads[0].index is not None :]), pads)
            rows[group.key("area")] = (int64, (len(group.pads),), {})
            rows[group.key("sensor")] = (np.array(group.pads[0].sensor.name).dtype, (), {})
            rows[group.key("type")] = (np.array(TYPES[0]).dtype, (), {})
        for side, pad in layout.wrists.items():
            rows[f"{side}_wrist_pose"] = (float64, (6,), {"unit": "m, rad", "frame": f"frame of sensor {pad.name!r} in the world"})
        for side, joints in layout.joints.items():
            for name, indices in (("arm_joints", joints.arm), ("hand_joints", joints.hand)):
                if indices:
                    names = [layout.joint_names[index] for index in indices]
                    rows[f"{side}_{name}"] = (float64, (len(indices),), {"unit": "rad or m", "names": names})
            if joints.hand:
                rows[f"{side}_hand_joints_idx"] = (int64, (len(joints.hand),), {})
        taken = [name for name in self._vectors if name in rows]
        if taken:
            raise InputError(f"columns: {taken[0]} is not allowed: every export has it")
        return rows | {name: (float32, (len(feature.names),), {"names": list(feature.names)}) for name, feature in self._vectors.items()}

    def _column_names(self) -> tuple[str, ...]:
        layout = self._layout
        names = ["data/time", *(column_of(pad.prefix, group.column) for group in layout.groups for pad in group.pads)]
        names += [column_of(pad.prefix, POSE) for pad in layout.wrists.values()]
        names += [JOINTS] if layout.joints else []
        return tuple(dict.fromkeys((*names, *(name for feature in self._vectors.values() for name in feature.columns))))

    def values(self, first: int, end: int) -> dict[str, NDArray[Any]]:
        """All arrays of the frames [first, end)."""
        source, layout, count = self._source, self._layout, end - first
        columns = source.frames(first, end, self._columns)
        episodes = np.searchsorted(source.ends, np.arange(first, end), side="right")
        values: dict[str, NDArray[Any]] = {"timestamps": columns["data/time"]}
        values["sub_task_instruction"] = self._texts[self._task_of_episode[episodes]]
        values[_CAMERA] = self._camera.draw(first, end, columns)
        for group in layout.groups:
            values[group.key("data")] = _counts(group, columns)
            values[group.key("area")] = np.tile(np.array([pad.area for pad in group.pads]), (count, 1))
            values[group.key("sensor")] = np.full(count, group.pads[0].sensor.name)
            values[group.key("type")] = np.full(count, TYPES[0])
        for side, pad in layout.wrists.items():
            values[f"{side}_wrist_pose"] = rotation_vectors(pad.values(columns, POSE))
        for side, joints in layout.joints.items():
            for name, indices in (("arm_joints", joints.arm), ("hand_joints", joints.hand)):
                if indices:
                    values[f"{side}_{name}"] = columns[JOINTS][:, list(indices)]
            if joints.hand:
                values[f"{side}_hand_joints_idx"] = np.tile(np.array(joints.slots), (count, 1))
        return values | {name: feature.vectors(columns) for name, feature in self._vectors.items()}

    def about(self) -> dict[str, Any]:
        """Attributes of the folder: the contract, and that all is simulated."""
        pads = [{"name": pad.name, "side": pad.side, "area": pad.area, "sensor": pad.sensor.name} for pad in self._layout.pads]
        contract = "Open-X-Tactile, as of FTP-1 (arXiv 2606.13102)"
        return {"contract": contract, "simulated": True, "unit_of_touch": "counts", "rgb": self._camera.about, "sensors": pads}


def _counts(group: Group, columns: dict[str, NDArray[Any]]) -> NDArray[np.float32]:
    """(F, N, *taxels). Throws InputError for counts that float32 does not have."""
    counts = np.stack([pad.values(columns, group.column) for pad in group.pads], axis=1)
    if counts.dtype.itemsize > np.dtype(np.uint16).itemsize and np.abs(counts).max(initial=0) > _EXACT:
        raise InputError(f"{group.key('data')}: counts above {_EXACT} are not allowed: float32 has no more digits")
    return counts.astype(np.float32)


def _power_of_two(most: int) -> int:
    """The largest power of two that is at most `most`, at least 1."""
    return 1 << max(0, most.bit_length() - 1)

"""The contract of Open-X-Tactile, which FTP-1 (arXiv 2606.13102) publishes with its policy, as rules that a folder keeps or breaks.

Each rule says where it stands. Sources, in the repository ftp1-policy:

- README: data_processing/README.md, with the number of the section
- buffer: data_processing/common/replay_buffer.py, class ReplayBuffer
- loader: src/openpi/dataset_zarr.py, class ZarrDataset
- model: src/openpi/models_pytorch/ftp1_model_config.py
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import Error, InputError

SIDES = ("right", "left")
TYPES = ("state", "binary", "image")
RELEASED_TYPE = "matrix"  # of released sets: the parser of Aether writes it, the README does not have it
CAMERAS = ("camera_main_rgb", "camera_ego_rgb", "right_wrist_camera_rgb", "left_wrist_camera_rgb")
NUM_AREAS = 24  # functional areas of a hand
NUM_HAND_SLOTS = 32
GRIPPER_SLOT = 28
MAX_ARM_JOINTS = 7
_READ_BYTES = 16 << 20  # that are in memory at once

Fault = str  # what is wrong: array, value found, value allowed


@dataclass
class Store:
    """A Zarr folder of version 2 that is checked."""

    folder: Path
    arrays: dict[str, Any]  #: Arrays of data/, by name.
    ends: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))  #: meta/episode_ends.
    is_own: bool = False  #: Whether taxelsim exported it.

    @property
    def num_frames(self) -> int:
        return int(self.ends[-1])

    def groups(self) -> Iterator[tuple[str, str]]:
        """Side and name of the tactile groups that have at least one member."""
        found: dict[tuple[str, str], None] = {}
        for name in self.arrays:
            side, _, rest = name.partition("_tactile_")
            member, _, group = rest.partition("_")
            if side in SIDES and member in ("data", "area", "sensor", "type") and group:
                found[side, group] = None
        yield from found

    def pieces(self, name: str) -> Iterator[tuple[int, NDArray[Any]]]:
        """First frame and values of an array, some frames at a time."""
        array = self.arrays[name]
        step = max(1, _READ_BYTES // max(1, array.dtype.itemsize * int(np.prod(array.shape[1:]))))
        for first in range(0, array.shape[0], step):
            yield first, self.rows(name, first, first + step)

    def rows(self, name: str, first: int, end: int) -> NDArray[Any]:
        """Frames [first, end) of an array. Throws InputError for a damaged chunk."""
        try:
            values: NDArray[Any] = np.asarray(self.arrays[name][first:end])
        except Error:
            raise
        except (OSError, ValueError, RuntimeError) as error:
            raise InputError(f"{self.folder}: {name}: frames {first} to {end - 1}: {' '.join(str(error).split())}") from error
        return values


@dataclass(frozen=True)
class Packed:
    """An array whose codec is not installed, such as that of the pictures of released sets: its shape and type are known."""

    name: str
    codec: str
    shape: tuple[int, ...]
    dtype: np.dtype[Any]

    @property
    def ndim(self) -> int:
        return len(self.shape)

    def __getitem__(self, rows: object) -> NDArray[Any]:
        raise InputError(f"{self.name}: packed by the codec {self.codec}, which is not installed")


def _array(folder: Path, group: Any, name: str) -> Any:
    """An array of data/. Throws ValueError for one that Zarr cannot read."""
    try:
        return group[name]
    except ValueError:
        about = json.loads((folder / "data" / name / ".zarray").read_text(encoding="utf-8"))
        codec = (about["compressor"] or {}).get("id")
        if not codec:
            raise
        return Packed(name, codec, tuple(about["shape"]), np.dtype(about["dtype"]))


def open_store(folder: Path) -> Store:
    """Opens a folder. Throws InputError if it is no Zarr folder of version 2 with data/ and meta/episode_ends."""
    try:
        import zarr
    except ImportError as error:
        raise ImportError("Open-X-Tactile needs the package zarr: pip install 'taxelsim[export]'") from error
    if (folder / "zarr.json").exists() and not (folder / ".zgroup").exists():
        raise InputError(f"{folder}: Zarr version 3 is not allowed: version 2, which Open-X-Tactile has")
    if not (folder / ".zgroup").is_file():
        raise InputError(f"{folder}: no Open-X-Tactile set: a Zarr folder of version 2 with .zgroup expected")
    try:
        root: Any = zarr.open_group(str(folder), mode="r", zarr_format=2)
        if "data" not in root or "meta" not in root or "episode_ends" not in root["meta"]:
            raise InputError(f"{folder}: no Open-X-Tactile set: data/ and meta/episode_ends expected")
        names = sorted(file.parent.name for file in (folder / "data").glob("*/.zarray"))
        arrays = {name: _array(folder, root["data"], name) for name in names}
        ends = np.asarray(root["meta/episode_ends"][:])
    except Error:
        raise
    except (OSError, ValueError, LookupError, TypeError) as error:
        raise InputError(f"{folder}: {' '.join(str(error).split())}") from error
    return Store(folder, arrays, ends, "taxelsim" in root.attrs)


@dataclass(frozen=True)
class Rule:
    """A rule. A note is kept by readers that take more than the contract, or names what a reader leaves out."""

    text: str
    source: str
    faults: Callable[[Store], Iterator[Fault]]
    is_note: bool = False
    reads_values: bool = False  #: Of arrays with a row per frame, all of them.


def _ends(store: Store) -> Iterator[Fault]:
    ends = store.ends
    if ends.ndim != 1 or ends.dtype.kind not in "iu" or not len(ends):
        yield f"meta/episode_ends: {ends.dtype} {ends.shape} found, (episodes) of integers expected"
    elif (np.diff(ends.astype(np.int64), prepend=0) <= 0).any():
        yield f"meta/episode_ends: {ends[:5].tolist()} found, rising numbers above 0 expected"


def _time_major(store: Store) -> Iterator[Fault]:
    for name, array in store.arrays.items():
        if not array.shape or array.shape[0] != store.num_frames:
            yield f"{name}: shape {array.shape} found, {store.num_frames} frames expected"


def _timestamps(store: Store) -> Iterator[Fault]:
    array = store.arrays.get("timestamps")
    if array is None or array.ndim != 1 or array.dtype.kind not in "iuf":
        yield "timestamps: (T) of numbers expected"
        return
    begins = np.append(0, store.ends[:-1])
    last: Any = None
    for first, times in store.pieces("timestamps"):
        times = np.asarray(times)
        joined = times if last is None else np.append(last, times)
        offset = first if last is None else first - 1
        fall = np.flatnonzero(~(np.diff(joined) > 0)) + offset + 1
        fall = fall[~np.isin(fall, begins)]
        if len(fall):
            yield f"timestamps: frame {fall[0]} is not later than the frame before"
            return
        last = times[-1]


def _instruction(store: Store) -> Iterator[Fault]:
    array = store.arrays.get("sub_task_instruction")
    if array is None or array.ndim != 1 or array.dtype.kind not in "UOT":
        yield "sub_task_instruction: (T) of texts expected"
        return
    for first, texts in store.pieces("sub_task_instruction"):
        empty = [index for index, text in enumerate(texts.tolist()) if not str(text).strip()]
        if empty:
            yield f"sub_task_instruction: no text in frame {first + empty[0]}"
            return


def _rgb(store: Store) -> Iterator[Fault]:
    found = [name for name in CAMERAS if name in store.arrays]
    if not found:
        yield f"no RGB stream: one of {', '.join(CAMERAS)} expected"
    for name in found:
        array = store.arrays[name]
        if array.ndim != 4 or 3 not in (array.shape[1], array.shape[3]) or array.dtype != np.uint8:
            yield f"{name}: {array.dtype} {array.shape} found, uint8 (T, H, W, 3) expected"


def _members(store: Store) -> Iterator[Fault]:
    if not any(True for _ in store.groups()):
        yield "no tactile group: <side>_tactile_data_<group> expected"
    for side, group in store.groups():
        missing = [member for member in ("data", "area", "sensor", "type") if f"{side}_tactile_{member}_{group}" not in store.arrays]
        if missing:
            yield f"{side}_tactile_{missing[0]}_{group}: missing"


def _data_groups(store: Store) -> Iterator[tuple[str, str, Any]]:
    for side, group in store.groups():
        data = store.arrays.get(f"{side}_tactile_data_{group}")
        if data is not None:
            yield side, group, data


def _tactile_shapes(store: Store) -> Iterator[Fault]:
    for side, group, data in _data_groups(store):
        if data.ndim < 3:
            yield f"{side}_tactile_data_{group}: shape {data.shape} found, (T, N, *shape) expected"
            continue
        area = store.arrays.get(f"{side}_tactile_area_{group}")
        if area is not None and area.shape != data.shape[:2]:
            yield f"{side}_tactile_area_{group}: shape {area.shape} found, {data.shape[:2]} expected"
        for member in ("sensor", "type"):
            text = store.arrays.get(f"{side}_tactile_{member}_{group}")
            if text is not None and (text.shape != data.shape[:1] or text.dtype.kind not in "UOT"):
                yield f"{side}_tactile_{member}_{group}: {text.dtype} {text.shape} found, texts {data.shape[:1]} expected"


def _integers(store: Store, name: str, limit: int) -> Iterator[Fault]:
    if store.arrays[name].dtype.kind not in "iu":
        yield f"{name}: {store.arrays[name].dtype} found, integers expected"
        return
    for first, values in store.pieces(name):
        wrong = np.argwhere((values < 0) | (values >= limit))
        if len(wrong):
            yield f"{name}: {values[tuple(wrong[0])]} found in frame {first + wrong[0][0]}, 0 to {limit - 1} expected"
            return


def _areas(store: Store) -> Iterator[Fault]:
    for side, group in store.groups():
        name = f"{side}_tactile_area_{group}"
        if name in store.arrays:
            yield from _integers(store, name, NUM_AREAS)


def _types_besides(store: Store, allowed: tuple[str, ...]) -> Iterator[Fault]:
    for side, group in store.groups():
        name = f"{side}_tactile_type_{group}"
        if name in store.arrays:
            wrong = {str(text) for _, texts in store.pieces(name) for text in set(texts.tolist())} - set(allowed)
            if wrong:
                yield f"{name}: {min(wrong)!r} found, {', '.join(TYPES)} expected"


def _types(store: Store) -> Iterator[Fault]:
    yield from _types_besides(store, (*TYPES, RELEASED_TYPE))


def _released_types(store: Store) -> Iterator[Fault]:
    yield from _types_besides(store, TYPES)


def _images(store: Store) -> Iterator[Fault]:
    for side, group, data in _data_groups(store):
        kind = store.arrays.get(f"{side}_tactile_type_{group}")
        if kind is None or str(kind[0]) != "image":
            continue
        if data.ndim not in (4, 5) or (data.ndim == 5 and data.shape[-1] != 3):
            yield f"{side}_tactile_data_{group}: shape {data.shape} found, (T, N, H, W, 3) or (T, N, H, W) of images expected"


def _poses(store: Store) -> Iterator[Fault]:
    for name in ("camera_ego_pose", *(f"{side}_wrist_pose" for side in SIDES)):
        array = store.arrays.get(name)
        if array is not None and (array.ndim != 2 or array.shape[1] != 6):
            yield f"{name}: shape {array.shape} found, (T, 6) expected: x y z and a rotation vector"


def _arms(store: Store) -> Iterator[Fault]:
    for side in SIDES:
        array = store.arrays.get(f"{side}_arm_joints")
        if array is not None and (array.ndim != 2 or not 1 <= array.shape[1] <= MAX_ARM_JOINTS):
            yield f"{side}_arm_joints: shape {array.shape} found, (T, 1 to {MAX_ARM_JOINTS}) expected"


def _hands(store: Store) -> Iterator[Fault]:
    for side in SIDES:
        joints, slots = (store.arrays.get(f"{side}_hand_joints{end}") for end in ("", "_idx"))
        if joints is None and slots is None:
            continue
        if joints is None or slots is None or joints.ndim != 2 or joints.shape != slots.shape:
            shapes = " and ".join(str(array.shape) if array is not None else "none" for array in (joints, slots))
            yield f"{side}_hand_joints and {side}_hand_joints_idx: {shapes} found, two arrays (T, K) expected"
            continue
        yield from _integers(store, f"{side}_hand_joints_idx", NUM_HAND_SLOTS)
        if len(set(slots[0].tolist())) < slots.shape[1]:
            yield f"{side}_hand_joints_idx: {slots[0].tolist()} found, different slots expected"


def _states(store: Store) -> Iterator[Fault]:
    names = [f"{side}_{what}" for side in SIDES for what in ("wrist_pose", "arm_joints", "hand_joints")]
    if not any(name in store.arrays for name in names):
        yield f"no state: one of {', '.join(names)} expected, from which actions are derived"


def _read_sides(store: Store) -> Iterator[Fault]:
    for side in dict.fromkeys(side for side, _ in store.groups()):
        if f"{side}_hand_joints" not in store.arrays:
            yield f"{side}_hand_joints: missing, and FTP-1 then reads neither touch nor poses of the {side} side"


def _name(store: Store) -> Iterator[Fault]:
    if store.folder.suffix != ".zarr":
        yield f"{store.folder.name}: FTP-1 reads the folders NAME.zarr of a folder"


def _missing_chunks(store: Store) -> Iterator[Fault]:
    for name, array in store.arrays.items():
        if isinstance(array, Packed):
            continue
        expected = math.prod(-(-size // chunk) for size, chunk in zip(array.shape, array.chunks, strict=True))
        files = sum(1 for file in (store.folder / "data" / name).rglob("*") if file.is_file() and not file.name.startswith("."))
        if files < expected:
            yield f"{name}: {expected - files} of {expected} chunks are missing, and Zarr reads them as {array.fill_value}"


def _own_chunks(store: Store) -> Iterator[Fault]:
    yield from _missing_chunks(store) if store.is_own else ()


def _other_chunks(store: Store) -> Iterator[Fault]:
    yield from () if store.is_own else _missing_chunks(store)


def _finite(store: Store) -> Iterator[Fault]:
    for name, array in store.arrays.items():
        if array.dtype.kind != "f":
            continue
        for first, values in store.pieces(name):
            wrong = np.argwhere(~np.isfinite(values))
            if len(wrong):
                yield f"{name}: {values[tuple(wrong[0])]} found in frame {first + wrong[0][0]}, a finite number expected"
                break


RULES = (
    Rule("meta/episode_ends rises from above 0", "buffer", _ends),
    Rule("arrays in data/ are time-major, with the frames of the last episode end", "README 2, buffer", _time_major),
    Rule("timestamps (T), rising in an episode", "README 2.2, 4.1", _timestamps, reads_values=True),
    Rule("sub_task_instruction (T), a text for each frame", "README 2.2, 4.1", _instruction, reads_values=True),
    Rule("at least one RGB stream, uint8 (T, H, W, 3)", "README 3.1, loader", _rgb),
    Rule("tactile groups have the members data, area, sensor and type", "README 3.2", _members),
    Rule("data (T, N, *shape), area (T, N), sensor and type (T)", "README 3.2", _tactile_shapes),
    Rule(f"functional areas 0 to {NUM_AREAS - 1}", "README 3.2, model", _areas, reads_values=True),
    Rule(f"types {', '.join(TYPES)}", "README 3.2", _types, reads_values=True),
    Rule("images (T, N, H, W, 3)", "README 3.2, loader", _images),
    Rule("poses (T, 6): x y z and rotation vector", "README 3.1, 4.2", _poses),
    Rule(f"at most {MAX_ARM_JOINTS} joints of an arm", "loader, model", _arms),
    Rule(
        f"joints of a hand with slots, 0 to {NUM_HAND_SLOTS - 1}, {GRIPPER_SLOT} a gripper", "README 4.3, model", _hands, reads_values=True
    ),
    Rule("a state from which actions are derived", "README 4.1", _states),
    Rule("numbers are finite", "loader", _finite, reads_values=True),
    Rule("an export of taxelsim has all its chunks", "taxelsim", _own_chunks),
    Rule("no chunk is missing, which writers may leave out where all values are equal", "Zarr 2", _other_chunks, is_note=True),
    Rule("no type `matrix`, which released sets have", "README 3.2", _released_types, is_note=True, reads_values=True),
    Rule("the folder is called NAME.zarr", "README 2.1, loader", _name, is_note=True),
    Rule("sides with touch have hand joints", "loader", _read_sides, is_note=True),
)


def check(store: Store, *, reads_values: bool = True) -> list[tuple[Rule, list[Fault]]]:
    """All rules with their faults; those after the first two need arrays of one length, and are left out where these fail.

    reads_values: False leaves out the rules that read arrays of frames.
    """
    findings: list[tuple[Rule, list[Fault]]] = []
    for index, rule in enumerate(rule for rule in RULES if reads_values or not rule.reads_values):
        findings.append((rule, list(rule.faults(store))))
        if index < 2 and findings[-1][1]:
            break
    return findings

"""Policies from ONNX files. Needs the package onnxruntime."""

from __future__ import annotations

import hashlib
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError

_TYPES = {"tensor(float)": np.float32, "tensor(double)": np.float64, "tensor(int32)": np.int32, "tensor(int64)": np.int64}
_SETTINGS = ("observations", "action", "actions", "image_unit", "normalized", "history", "linear_scale", "angular_scale")


class OnnxPolicy:
    """A network in an ONNX file as a policy: a batch of observations in, actions in [-1, 1] out.

    The first axis of all inputs and of the first output is the batch; a fixed batch size is filled up by repeated rows.
    One input takes the observation, flattened if the input has two axes; several observations are flattened and joined in
    their order. Several inputs take the observations of their names. Computes on the processor in one thread, deterministically.
    May be pickled: the process that unpickles it reads the same file.

    Settings of the policy can be stored in the file as metadata `taxelsim.observations` ("contact" or
    "contact,proprioception"), `taxelsim.action`, `taxelsim.actions`, `taxelsim.image_unit`,
    `taxelsim.normalized` ("true"), `taxelsim.history`, `taxelsim.linear_scale`, `taxelsim.angular_scale`.
    """

    def __init__(self, file: str | PathLike[str]) -> None:
        try:
            import onnxruntime
        except ImportError as error:
            raise ImportError("ONNX policies need onnxruntime: pip install onnxruntime") from error
        path = Path(file)
        try:
            content = path.read_bytes()
        except OSError as error:
            raise InputError(f"{path}: {error.strerror}") from error
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = options.inter_op_num_threads = 1
        options.use_deterministic_compute = True
        options.log_severity_level = 4
        try:
            # By name, because weights may be in a second file.
            self._session = onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
        except Exception as error:  # onnxruntime has no common base class of its errors
            raise InputError(f"{path}: not a network that onnxruntime can run: {str(error).splitlines()[0]}") from error
        self.file = path
        self.name = path.stem
        self.identity = _identity(path, content)  #: SHA-256 of the file, and of files of weights in its folder that it names.
        self._inputs = self._session.get_inputs()
        self._output = self._session.get_outputs()[0].name
        for tensor in self._inputs:
            if tensor.type not in _TYPES:
                raise InputError(f"{path}: input {tensor.name!r}: {tensor.type} is not allowed: {', '.join(_TYPES)}")
        fixed = {tensor.shape[0] for tensor in self._inputs if tensor.shape and isinstance(tensor.shape[0], int)}
        if len(fixed) > 1:
            raise InputError(f"{path}: inputs have different batch sizes: {sorted(fixed)}")
        self.batch_size = fixed.pop() if fixed else None  #: Fixed batch size, or None.
        self.settings = self._read_settings()

    def _read_settings(self) -> dict[str, Any]:
        metadata = self._session.get_modelmeta().custom_metadata_map
        settings: dict[str, Any] = {}
        for key, value in metadata.items():
            if not key.startswith("taxelsim."):
                continue
            name = key.removeprefix("taxelsim.")
            try:
                settings[name] = _parse_setting(name, value)
            except ValueError as error:
                raise InputError(f"{self.file}: metadata {key}: {value!r} found, {error}") from None
        return settings

    def __call__(self, observation: Any) -> NDArray[Any]:
        """Actions (rows, ...) of a batch of observations."""
        feeds = {tensor.name: self._feed(tensor, observation) for tensor in self._inputs}
        if self.batch_size is None:
            return self._run(feeds)
        n = len(next(iter(feeds.values())))
        results = []
        for first in range(0, n, self.batch_size):
            rows = np.minimum(np.arange(first, first + self.batch_size), n - 1)
            results.append(self._run({name: values[rows] for name, values in feeds.items()})[: n - first])
        return np.concatenate(results)

    def __reduce__(self) -> tuple[Any, ...]:
        return _reopened, (str(self.file.absolute()), self.identity)

    def _run(self, feeds: dict[str, NDArray[Any]]) -> NDArray[Any]:
        actions: NDArray[Any] = self._session.run([self._output], feeds)[0]
        return actions

    def _feed(self, tensor: Any, observation: Any) -> NDArray[Any]:
        values = self._values(tensor, observation)
        if len(tensor.shape) == 2 and values.ndim != 2:
            values = values.reshape(len(values), -1)
        sizes = zip(tensor.shape, values.shape, strict=False)
        fits = values.ndim == len(tensor.shape) and all(not isinstance(size, int) or size == found for size, found in list(sizes)[1:])
        if not fits:
            raise InputError(f"{self.file}: input {tensor.name!r} has shape {tensor.shape}, the observation {['batch', *values.shape[1:]]}")
        return np.ascontiguousarray(values, _TYPES[tensor.type])

    def _values(self, tensor: Any, observation: Any) -> NDArray[Any]:
        if not isinstance(observation, dict):
            if len(self._inputs) > 1:
                names = ",".join(t.name for t in self._inputs)
                raise InputError(
                    f"{self.file}: {len(self._inputs)} inputs ({names}) found, but there is one observation; "
                    f"choose one for each input by its name: --observations {names}, or Policy(..., observations={tuple(names.split(','))})"
                )
            return np.asarray(observation)
        if tensor.name in observation:
            return np.asarray(observation[tensor.name])
        if len(self._inputs) == 1:
            return np.concatenate([values.reshape(len(values), -1) for values in observation.values()], axis=1)
        raise InputError(
            f"{self.file}: input {tensor.name!r} found, the observations are {', '.join(observation)}; choose them by the names of the "
            "inputs: --observations, or Policy(..., observations=...)"
        )


def _reopened(file: str, identity: str) -> OnnxPolicy:
    """Unpickles a policy: reads its file again."""
    policy = OnnxPolicy(file)
    if policy.identity != identity:
        raise InputError(f"{file}: is another network than when the policy was pickled")
    return policy


def _identity(path: Path, content: bytes) -> str:
    digest = hashlib.sha256(content)
    for file in sorted(path.parent.iterdir()):
        if file != path and len(file.name) > 3 and file.name.encode() in content and file.is_file():
            digest.update(file.read_bytes())
    return digest.hexdigest()


def _parse_setting(name: str, value: str) -> Any:
    if name not in _SETTINGS:
        raise ValueError(f"keys allowed: {', '.join('taxelsim.' + key for key in _SETTINGS)}")
    if name in ("observations", "actions"):
        names = tuple(part.strip() for part in value.split(","))
        return names[0] if len(names) == 1 else names
    if name == "normalized":
        if value not in ("true", "false"):
            raise ValueError("true and false allowed")
        return value == "true"
    if name == "history":
        return int(value) if value.isdigit() and int(value) else _refuse("an integer of at least 1 allowed")
    if name.endswith("_scale"):
        try:
            return float(value)
        except ValueError:
            _refuse("a number allowed")
    return value


def _refuse(message: str) -> Any:
    raise ValueError(message)

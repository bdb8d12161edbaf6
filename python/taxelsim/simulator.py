"""Batches of sensor instances: poses or contact points in, tactile images and features out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import checked_names
from ._arrays import Dimension, to_array
from ._core import DeviceTraffic, MemoryPlan, Model, OutputOptions, SimulatorOptions, StepTiming
from ._counts import IMAGE_UNITS, NewtonImage
from ._first_frame import FirstFrame
from ._log import logger
from .device_array import on_device, platform_of
from .errors import InputError
from .frame import Frame
from .gradients import Gradient
from .inputs import NO_OBJECT, Inputs, commit, new_inputs


class Simulator:
    """A batch of sensor instances over one Model.

    A step: set_objects() or set_contacts(), step(), read(); then vjp() if wanted. Threads may share a simulator; calls wait for each other.
    Whatever waits for the device releases the GIL. Inputs may not be set between step() and read().
    """

    def __init__(
        self,
        model: Model,
        num_instances: int = 1,
        *,
        num_slots: int = 1,
        seed: int = 0,
        outputs: OutputOptions | None = None,
        image_unit: str = "counts",
        max_contacts: int = 0,
        max_regions: int = 0,
        contact_band: float = 1e-4,
        device_clock: bool = False,
        memory: str = "host",
    ) -> None:
        """Allocates all device memory. Raises InputError, with the largest size that fits, if the batch does not fit.

        model: sensor and objects.
        num_instances: N, >= 1.
        num_slots: S, objects per instance, 1 to 8.
        seed: key of all random numbers.
        outputs: optional outputs; default OutputOptions().
        image_unit: of frame.tactile_image, "counts", or "newtons" by the nominal curve.
        max_contacts: capacity for contact points of one instance, 0 to 4096. Above 0 the simulator takes contact points, no objects or
            loads; penetration_depth is then not available and must be off.
        max_regions: rows of contact features for regions, 0 to 8.
        contact_band: m, contact points up to this height above the undeformed skin count.
        device_clock: whether `timing` reports seconds; costs about 0.2 ms per step on software Vulkan.
        memory: where the arrays of frames lie. "host": NumPy's. "cuda", or the untested "hip": DeviceArray in the memory of that
            GPU, without a copy; read() then does not wait on the host. "device": NumPy's on software Vulkan, else "cuda".
            Raises DeviceError where the GPU's driver cannot import the memory of the Vulkan device.
        """
        if outputs is None:
            outputs = OutputOptions(penetration_depth=max_contacts == 0)
        checked_names("image_unit", image_unit, IMAGE_UNITS)
        self._model = model
        self._options = SimulatorOptions(
            num_instances=num_instances,
            num_slots=num_slots,
            seed=seed,
            outputs=outputs,
            max_contacts=max_contacts,
            max_regions=max_regions,
            contact_band=contact_band,
            device_clock=device_clock,
        )
        platform = None if memory == "host" else platform_of(memory, model.device, image_unit)
        self._batch = _core.Simulator(model, self._options, platform)
        arrays = on_device(self._batch, self._batch.arrays())
        self._newtons = NewtonImage(arrays["tactile_image"], model.sensor.readout) if image_unit == "newtons" else None
        one_axis = (
            {} if model.sensor.readout.three_axis else {"taxel_counts": f"{model.sensor.name} has one-axis taxels (no readout.three_axis)"}
        )
        self._frame = Frame(arrays if self._newtons is None else {**arrays, "tactile_image": self._newtons.array}, one_axis)
        self._is_on_host = platform is None
        setter = "set_contacts" if max_contacts > 0 else "set_objects"
        self._first: FirstFrame | None = FirstFrame(model.sensor, setter) if self._is_on_host else None
        self._warns_of_loads = self._is_on_host
        self._inputs: Inputs | None = None

    @staticmethod
    def plan(model: Model, options: SimulatorOptions) -> MemoryPlan:
        """Device memory that a simulator with these options would take. Allocates nothing."""
        return _core.plan(model, options)

    @property
    def model(self) -> Model:
        """Sensor and objects."""
        return self._model

    @property
    def options(self) -> SimulatorOptions:
        """The options of this simulator."""
        return self._options

    @property
    def num_instances(self) -> int:
        """N."""
        return self._options.num_instances

    @property
    def num_slots(self) -> int:
        """S, objects per instance."""
        return self._options.num_slots

    @property
    def inputs(self) -> Inputs:
        """Writable arrays of objects and loads, or of contact points. Once they exist, every step() takes them in place of the setters."""
        if self._inputs is None:
            if self._is_on_host:
                self._inputs = new_inputs(self.num_instances, self.num_slots, self._options.max_contacts)
            else:
                self._inputs = Inputs(on_device(self._batch, self._batch.inputs()))
        return self._inputs

    @property
    def _N(self) -> Dimension:
        return (self.num_instances, "N")

    def set_objects(self, ids: npt.ArrayLike, poses: npt.ArrayLike, *, anchor: str | npt.ArrayLike = "origin") -> None:
        """Objects that each instance touches from the next step() on.

        ids: (N,), or (N, S), indices into model.objects, or NO_OBJECT. A single integer stands for all instances.
        poses: (N, 7) position (m) and quaternion (w, x, y, z) of the object in S, or (N, 4, 4) matrices; with slots (N, S, 7) or
            (N, S, 4, 4). Ignored for empty slots, but must be finite.
        anchor: the point of each object that lies at the position of its pose: "origin", of O; "lowest", its lowest point after the
            rotation, as in scenes; or a point (3,) in O, m.

        An object whose bounding box is wholly deeper than the skin of a sensor of one patch is behind it and presses on nothing.

        On a skin with friction, an object that stays in its slot has slid or rolled from its last pose; call reset() after a jump. Raises
        InputError, and changes nothing, for another shape or dtype, an unknown id, NaN, or a rotation that is none.
        """
        one_slot = self.num_slots == 1
        rows: list[Dimension] = [self._N] if one_slot else [self._N, (self.num_slots, "S")]
        if np.ndim(ids) == 0:
            ids = np.full([self.num_instances, self.num_slots], to_array("ids", ids, np.int32, [()], per_instance=False))
        id_array = to_array("ids", ids, np.int32, [rows], drop_slots=one_slot)
        pose_array = to_array("poses", poses, np.float64, [[*rows, 7], [*rows, 4, 4]], drop_slots=one_slot)
        if pose_array.shape[-2:] == (4, 4):
            pose_array = self._from_matrices(pose_array)
        id_array, pose_array = id_array.reshape(-1), pose_array.reshape(-1, 7)
        if isinstance(anchor, str) and anchor not in ("origin", "lowest"):
            raise InputError(f"anchor: {anchor!r} is not allowed: 'origin', 'lowest' or a point (3,)")
        if not isinstance(anchor, str) or anchor == "lowest":
            point = None if isinstance(anchor, str) else to_array("anchor", anchor, np.float64, [[3]], per_instance=False).tolist()
            pose_array = pose_array.copy()
            _core.place_by_anchor(self._model, id_array, pose_array, point)
        self._batch.set_objects(id_array, pose_array)
        if self._first is not None:
            self._first.given(pose_array[id_array != NO_OBJECT, :3])

    def _from_matrices(self, matrices: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        poses = np.empty((self.num_instances * self.num_slots, 7))
        _core.poses_from_matrices(matrices.reshape(-1, 4, 4), poses, self.num_slots)
        return poses

    def set_loads(self, loads: npt.ArrayLike | None, *, where: npt.ArrayLike | None = None) -> None:
        """Force with which the objects of each instance must press along -z of S.

        loads: (N,), N, >= 0, or one number for all instances; None: all instances are driven by pose.
        where: (N,) booleans; instances where it is False are driven by pose. Default: all True.

        The device moves the objects of an instance together along z of S to where the taxels' normal forces, summed as vectors, have that
        component; on a curved skin total_force, the plain sum over the taxels, is larger.
        frame.ground_truth.load_reached says whether the skin could. Raises InputError, and changes nothing, for NaN or negative loads.
        """
        if loads is None:
            self._batch.set_loads(np.full(self.num_instances, np.nan, np.float32))
            return
        if np.ndim(loads) == 0:
            loads = np.full(self.num_instances, loads)
        array = to_array("loads", loads, np.float32, [[self._N]])
        if (array < 0).any():
            first = int(np.argmax(array < 0))
            raise InputError(f"load of instance {first}: {array[first]} is not allowed: N, >= 0")
        if where is not None:
            array = np.where(to_array("where", where, np.bool_, [[self._N]]), array, np.float32(np.nan))
        self._batch.set_loads(array)

    def set_contacts(self, positions: npt.ArrayLike, normal_forces: npt.ArrayLike, offsets: npt.ArrayLike) -> None:
        """Contact points of every instance, until they are set again.

        positions: (C, 3), m, in S. normal_forces: (C,), N, >= 0, the component along z of the patch.
        offsets: (N + 1,), ascending from 0 to C: instance i has the points offsets[i] to offsets[i + 1] - 1.

        Raises InputError, and changes nothing, for other offsets, more than max_contacts of an instance, or values out of range.
        """
        points = to_array("positions", positions, np.float64, [[(-1, "C"), 3]], per_instance=False)
        forces = to_array("normal_forces", normal_forces, np.float64, [[(len(points), "C")]], per_instance=False)
        bounds = to_array("offsets", offsets, np.int32, [[(self.num_instances + 1, "N + 1")]], per_instance=False)
        self._batch.set_contacts(np.column_stack((points, forces)), bounds)
        if self._first is not None:
            self._first.given(points)

    def reset(
        self,
        instances: npt.ArrayLike | None = None,
        episodes: npt.ArrayLike | None = None,
        *,
        gain: float = 1,
        gain_spread: float = 0,
        noise: float = 0,
    ) -> None:
        """Starts an episode on some instances: clears their clocks, the state of the skin and the held frame.

        instances: an index, indices (K,), or a mask of booleans (N,). Default: all.
        episodes: (K,) or one integer, >= 0: keys of the noise. Default: the index of the instance.
        gain, gain_spread, noise: variation of the readout of these instances: factor on every gain, standard deviation of log gain per
            taxel, and counts of noise besides the sensor's own.
        """
        indices = self._indices(instances)
        if episodes is None:
            keys = indices.astype(np.uint64)
        elif np.ndim(episodes) == 0:
            keys = np.full(len(indices), to_array("episodes", episodes, np.uint64, [()], per_instance=False))
        else:
            keys = to_array("episodes", episodes, np.uint64, [[(len(indices), "K")]], per_instance=False)
        self._batch.reset(indices, keys, gain, gain_spread, noise)

    def _indices(self, instances: npt.ArrayLike | None) -> npt.NDArray[np.int32]:
        if instances is None:
            return np.arange(self.num_instances, dtype=np.int32)
        if np.asarray(instances).dtype.kind == "b":
            mask = to_array("instances", instances, np.bool_, [[self._N]])
            return np.flatnonzero(mask).astype(np.int32)
        indices = to_array("instances", np.atleast_1d(instances), np.int32, [[(-1, "K")]], per_instance=False)
        outside = (indices < 0) | (indices >= self.num_instances)
        if outside.any():
            raise InputError(f"instances: {indices[np.argmax(outside)]} is not allowed: 0 to {self.num_instances - 1}")
        return indices

    def prepare(self, *, loads: bool = False) -> None:
        """Compiles all kernels that steps need, so that no step waits for the driver. loads: also those of load-driven instances.

        Call after reset(): random gains and noise need further kernels. Waits.
        """
        self._batch.prepare(loads)

    def step(self, dt: float, instances: npt.ArrayLike | None = None) -> None:
        """Advances every instance by `dt` (s, > 0) and computes its frame. Submits, does not wait.

        instances: an index, indices, or a mask of booleans (N,): computes the first frame of these only, which were reset() since their
            last step. The frames, states and clocks of all others stay as they are. Default: all instances.

        Arrays of earlier frames change from now on. Raises RuntimeError if the last step has not been read, or if one of `instances` has
        taken a step since its last reset().
        """
        if self._inputs is not None and self._is_on_host:
            commit(self._inputs, self)
        if instances is None:
            self._batch.step(dt)
        else:
            mask = np.zeros(self.num_instances, np.uint8)
            mask[self._indices(instances)] = 1
            self._batch.step(dt, mask)
        if self._first is not None:
            self._first.step()

    def read(self) -> Frame:
        """Waits for the last step() and returns its frame: arrays over the memory of the simulator, see taxelsim.Frame.

        In the memory of a GPU, the streams of the libraries that have taken the arrays wait instead, where the driver exports semaphores.
        Every call returns the same object. Before the first step() all arrays are 0, which the log warns of, as of a first frame without
        inputs, or with inputs over a metre away. Raises DeviceError if the device was lost.
        """
        self._batch.read()
        if self._newtons is not None:
            self._newtons.update()
        if self._first is not None and self._first.read(self._frame):
            self._first = None
        if self._warns_of_loads and self._first is None and not self._frame.ground_truth.load_reached.all():
            self._warns_of_loads = False
            self._warn_of_loads(self._frame.ground_truth.load_reached)
        return self._frame

    def _warn_of_loads(self, reached: npt.NDArray[np.bool_]) -> None:
        logger.warning(
            "%d of %d instances did not reach their load, instance %d first (frame.ground_truth.load_reached): the object may not lie on "
            'the taxels, as poses place its origin; set_objects(anchor="lowest") places its lowest point',
            np.count_nonzero(~reached),
            len(reached),
            np.argmin(reached),
        )

    def vjp(self, cotangent: npt.ArrayLike, gain: npt.ArrayLike = 1.0) -> Gradient:
        """Pulls the gradient of a loss by the forces of taxels back to the sensor's pose and to the gains, on the device.

        The forces are gain * tactile_normal_force of the last frame that was read, whether or not that array is an output.

        cotangent: (N, num_rows, num_cols), or (N, num_taxels) for sensors of several patches, per N: the loss's gradient by these forces.
        gain: of each taxel, broadcast to that shape.

        Needs OutputOptions(vjp=True). The derivatives of forces stay on the device; the result is float32 and does not change with later
        frames. Forces are smooth in the pose with DepthSampling.AREA. Submits and waits; frames, states and clocks stay as they are. The
        numbers are those of taxelsim.vjp(), rounded to float32. Raises InputError for another shape, for numbers that are not finite, and
        without the option; RuntimeError between step() and read(), and before the first frame; DeviceError if the device was lost.
        """
        shape = self._frame.tactile_image.shape
        sizes: list[Dimension] = [self._N, *shape[1:]]
        pulled = to_array("cotangent", cotangent, np.float32, [sizes])
        gains = np.empty(0, np.float32)
        if not np.array_equal(gain, 1.0):
            try:
                broadcast = np.broadcast_to(np.asarray(gain), shape)
            except ValueError:
                raise InputError(f"gain: shape {np.shape(gain)} is not allowed: {shape}, or one that broadcasts to it") from None
            gains = to_array("gain", broadcast, np.float32, [sizes]).reshape(-1)
        twist, by_gain = np.empty((self.num_instances, 6), np.float32), np.empty(shape, np.float32)
        self._batch.vjp(pulled.reshape(-1), gains, twist.reshape(-1), by_gain.reshape(-1))
        return Gradient(twist, by_gain)

    @property
    def timing(self) -> StepTiming:
        """Times of the last frame read, s; NaN without device_clock."""
        return self._batch.timing

    @property
    def traffic(self) -> DeviceTraffic:
        """Submissions and bytes since construction, without kernels and constants of the model. A step() counts at once.

        A device whose memory the host cannot read copies all requested outputs; software Vulkan copies none, and bytes_from_device is their
        size.
        """
        return self._batch.traffic

    def __repr__(self) -> str:
        return f"<taxelsim.Simulator of {self.num_instances} instances of {self._model.sensor.name}>"


def split_patches(sensor: _core.Sensor, taxels: npt.NDArray[Any]) -> dict[str, npt.NDArray[Any]]:
    """An array (N, num_taxels, ...) of a sensor with several patches as views (N, num_rows, num_cols, ...), by name of the patch.

    Accepts arrays of sensors with one patch, (N, num_rows, num_cols, ...), too.
    """
    patches: Sequence[_core.GridPatch] = sensor.patches
    if len(patches) == 1:
        return {patches[0].name: taxels}
    if taxels.ndim < 2 or taxels.shape[1] != sensor.num_taxels:
        raise InputError(f"taxels: shape {taxels.shape} is not allowed: (N, {sensor.num_taxels}, ...)")
    images = {}
    first = 0
    for patch in patches:
        last = first + patch.num_rows * patch.num_cols
        images[patch.name] = taxels[:, first:last].reshape(len(taxels), patch.num_rows, patch.num_cols, *taxels.shape[2:])
        first = last
    return images

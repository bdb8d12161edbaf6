"""Sensors on bodies of a Newton model: frames from the state of its worlds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

from .._attached import MAX_SLOTS, AttachedSensors
from .._core import Device, Sensor, load_sensor
from ..errors import InputError
from ..frame import Frame
from .kernels import gather_contacts, place_objects
from .labels import sensor_frames, shape_indices
from .shapes import objects_of


def attach(
    model: Any,
    sensors: Mapping[str, str | PathLike[str] | Sensor],
    shapes: Sequence[str] = (),
    *,
    max_contacts: int = 0,
    device: Device | None = None,
    **options: Any,
) -> Attachment:
    """Sensors on bodies of a newton.Model with N worlds, touched by its shapes, or by the contact points that its solver finds.

    sensors: sensor file, or Sensor, by the label of a body, whose frame is then the sensor frame S, or of a site: z out of the skin.
    shapes: labels of 1 to 8 shapes that touch them by their poses. A shape that all worlds share, such as a ground plane, is allowed.
    max_contacts: in place of shapes, the capacity for contact points of each world: every contact of the body of a sensor counts.
    device, options: of Simulator: seed, outputs, image_unit, max_regions, contact_band; default: the best device.

    Labels may hold the wildcards of fnmatch, as in newton.sensors, and must select one body, site or shape in each world. Where the model
    lies on a CUDA device, the taxelsim device must be that GPU, whose memory then holds inputs and frames.

    Raises InputError for a sensor that is in no world, a label that selects none or several, a shape that taxelsim does not have or that
    differs between worlds, more than 8 shapes, both or none of shapes and max_contacts, a model on another GPU, and a wrong sensor.
    """
    if not sensors:
        raise InputError("sensors: at least one is needed, as {body: sensor file}")
    if bool(shapes) == (max_contacts > 0):
        raise InputError(f"{len(shapes)} shapes and max_contacts {max_contacts} found: shapes or max_contacts is needed, not both")
    if len(shapes) > MAX_SLOTS:
        raise InputError(f"shapes: {len(shapes)} are not allowed: at most {MAX_SLOTS}")
    loaded = {label: source if isinstance(source, Sensor) else load_sensor(source) for label, source in sensors.items()}
    return Attachment(model, loaded, shapes, max_contacts, Device.open() if device is None else device, options)


class Attachment(AttachedSensors):
    """Sensors in the N worlds of one newton.Model. Made by attach(); `simulators` has a Simulator of N instances for each label."""

    def __init__(
        self,
        model: Any,
        sensors: Mapping[str, Sensor],
        shapes: Sequence[str],
        max_contacts: int,
        device: Device,
        options: Mapping[str, Any],
    ) -> None:
        """options: of Simulator."""
        self.model = model
        frames = {label: sensor_frames(model, label) for label in sensors}
        indices = shape_indices(model, shapes) if shapes else np.empty((model.world_count, 0), np.int32)
        objects, rotations = objects_of(model, shapes, indices)
        memory = "device" if model.device.is_cuda else "host"
        sizes = {"num_slots": max(len(shapes), 1), "max_contacts": max_contacts, "memory": memory}
        super().__init__(device, sensors, objects, model.world_count, {**sizes, **options})
        self._inputs: dict[str, Any] = {name: simulator.inputs.tensors("warp") for name, simulator in self.simulators.items()}
        found = next(iter(self._inputs[next(iter(sensors))].as_dict().values())).device
        if found != model.device:
            raise InputError(f"model on {model.device} and inputs of taxelsim on {found} found: both must lie on the CPU, or on one GPU")
        with wp.ScopedDevice(model.device):
            self._frames = {label: wp.array(pairs, dtype=wp.int32) for label, pairs in frames.items()}
            self._shapes = wp.array(indices, dtype=wp.int32)
            self._rotations = wp.array([(x, y, z, w) for w, x, y, z in rotations], dtype=wp.quatd)
            self._worlds = {label: wp.array(self._world_of_shapes(pairs[:, 0]), dtype=wp.int32) for label, pairs in frames.items()}
        for inputs in self._inputs.values() if shapes else ():
            inputs.ids.assign(np.broadcast_to(np.arange(len(shapes), dtype=np.int32), indices.shape).reshape(inputs.ids.shape))

    def _world_of_shapes(self, bodies: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
        """(shapes): the world in which a shape lies on the body (N) of a sensor, or -1."""
        worlds = self.model.shape_world.numpy()
        on_sensor = self.model.shape_body.numpy() == bodies[np.maximum(worlds, 0)]
        return np.where(on_sensor, worlds, -1).astype(np.int32)

    def observe(self, state: Any, dt: float, instances: npt.ArrayLike | None = None, *, observables: Any = None) -> dict[str, Frame]:
        """Frames of all sensors, by label, at the poses body_q of a newton.State. The state is only read; instance i is world i.

        state: after solver.step(state_0, state_1, ...) it is state_1: body_q belongs to the end of that step, so that frames are not a step
            late. A state whose joint_q has been set needs newton.eval_fk() before.
        dt: s, simulated time since the last call, in which the skin has moved.
        instances: as in Simulator.step(): gives the first frames of these worlds after their reset() only.
        observables: with max_contacts, and only then: the Observables of the solver's last step, with contact_f.

        The frames are views of the memory of the simulators, which change with the next call; frame.copy() keeps them, and
        frame.tensors("warp"), taken once, shows every later frame. On a skin with friction, shear follows from the motion between calls;
        call reset() after a jump. On the CPU the call waits for the frames; on a GPU the stream that was current in attach() does.

        Raises InputError for the state of another model, a pose that is not finite, more than max_contacts contacts in a world, and
        observables without contact_f.
        """
        count = 0 if state.body_q is None else len(state.body_q)
        if count != self.model.body_count:
            raise InputError(f"state of another model: {count} bodies found, {self.model.body_count} in the attached model")
        if self._shapes.size:
            self._place(state.body_q)
        else:
            self._gather(state.body_q, observables)
        return self._advance(dt, instances)

    def _place(self, body_q: Any) -> None:
        for label, inputs in self._inputs.items():
            poses = inputs.poses.reshape((*self._shapes.shape, 7))
            known = [body_q, self.model.shape_transform, self.model.shape_body, self._frames[label], self._shapes, self._rotations]
            wp.launch(place_objects, dim=self._shapes.shape, inputs=known, outputs=[poses], device=self.model.device)

    def _gather(self, body_q: Any, observables: Any) -> None:
        forces = getattr(observables, "contact_f", None)
        if forces is None:
            raise InputError("observables without contact_f found: solver.observables({'contact_f'}, contacts=...) is needed")
        found = observables.contacts
        for label, inputs in self._inputs.items():
            inputs.num_contacts.zero_()
            known = [body_q, self.model.shape_transform, self.model.shape_body, self._frames[label], self._worlds[label]]
            known += [found.rigid_contact_count, found.rigid_contact_shape0, found.rigid_contact_shape1]
            known += [
                found.rigid_contact_point0,
                found.rigid_contact_point1,
                found.rigid_contact_offset0,
                found.rigid_contact_offset1,
                forces,
            ]
            written = [inputs.positions, inputs.normal_forces, inputs.num_contacts]
            wp.launch(gather_contacts, dim=found.rigid_contact_max, inputs=known, outputs=written, device=self.model.device)

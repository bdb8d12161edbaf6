"""Objects, poses and loads that lie in the memory of a GPU, against the same from the host, bit by bit. The driver is cuda_standin."""

import ctypes
from typing import Any

import numpy as np
import pytest

import taxelsim

from .cuda_standin import Standin
from .test_device_arrays import assert_equal

N = 6
STEPS = 4


def writable(array: taxelsim.DeviceArray) -> np.ndarray:
    """The memory of an array, which the stand-in has mapped into this process."""
    pointer = ctypes.pythonapi.PyCapsule_GetPointer
    pointer.restype, pointer.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
    capsule = array.__dlpack__(stream=-1)
    data = ctypes.c_void_p.from_address(pointer(capsule, b"dltensor")).value
    assert data is not None
    bytes_ = (ctypes.c_char * int(np.prod(array.shape) * array.dtype.itemsize)).from_address(data)
    return np.frombuffer(bytes_, array.dtype).reshape(array.shape)


def paths(slots: int, seed: int = 3) -> tuple[np.ndarray, np.ndarray]:
    """Objects (STEPS, N, slots) and poses (STEPS, N, slots, 7) of tilted objects that slide and turn, some of them behind the skin."""
    random = np.random.default_rng(seed)
    ids = np.repeat(random.integers(-1, 2, (1, N, slots)), STEPS, 0)
    ids[2, 0] = np.where(ids[2, 0] < 0, -1, 1 - ids[2, 0])
    poses = np.zeros((STEPS, N, slots, 7))
    poses[..., :2] = np.cumsum(random.normal(0, 2e-4, (STEPS, N, slots, 2)), 0) + random.uniform(-0.01, 0.01, (N, slots, 2))
    poses[..., 2] = 0.0094
    poses[:, 1, :, 2] = -0.03
    poses[..., 3:] = np.array([1, 0, 0, 0]) + np.cumsum(random.normal(0, 0.01, (STEPS, N, slots, 4)), 0)
    poses[..., 3:] /= np.linalg.norm(poses[..., 3:], axis=-1, keepdims=True)
    return ids.astype(np.int32), poses


def model_of(device: taxelsim.Device, name: str) -> taxelsim.Model:
    sensor = taxelsim.load_sensor(taxelsim.SCENES / f"sensors/{name}.yaml")
    return taxelsim.Model(device, sensor, [taxelsim.Cylinder(radius=0.01, length=0.02), taxelsim.Sphere(radius=0.01)])


@pytest.mark.parametrize(
    ("name", "slots", "loads"),
    [
        ("wts0614", 1, False),
        ("wts0614", 1, True),
        ("wts0614_soft_cover", 3, True),
        ("wts0614_elastic_layer", 1, True),
        ("uskin_like_4x4", 2, False),
        ("uskin_like_4x4", 1, True),
        ("fingertip_sphere", 2, False),
        ("fingertip_sphere", 2, True),
    ],
)
def test_bits_are_those_of_inputs_from_the_host(standin: Standin, device: taxelsim.Device, name: str, slots: int, loads: bool) -> None:
    model = model_of(device, name)
    ids, poses = paths(slots)
    force = np.where(np.arange(N) % 2, 1.5, np.nan).astype(np.float32) if loads else np.full(N, np.nan, np.float32)
    on_host = taxelsim.Simulator(model, N, num_slots=slots)
    on_device = taxelsim.Simulator(model, N, num_slots=slots, memory="cuda")
    inputs = on_device.inputs
    on_device.prepare(loads=loads)
    arrays = {key: writable(value) for key, value in inputs.as_dict().items()}
    assert (arrays["ids"] == -1).all()
    assert np.isnan(arrays["loads"]).all()
    for step in range(STEPS):
        shape = ids[step].shape if slots > 1 else (N,)
        on_host.set_objects(ids[step].reshape(shape), poses[step].reshape(*shape, 7))
        on_host.set_loads(np.nan_to_num(force), where=~np.isnan(force))
        arrays["ids"][:], arrays["poses"][:], arrays["loads"][:] = ids[step].reshape(shape), poses[step].reshape(*shape, 7), force
        for simulator in (on_host, on_device):
            if step == 3:
                simulator.reset([2])
            simulator.step(0.01)
        assert_equal(on_host.read(), on_device.read().copy())
    assert on_host.read().tactile_image.any()


def test_held_instances_stay(standin: Standin, device: taxelsim.Device) -> None:
    model = model_of(device, "wts0614_soft_cover")
    ids, poses = paths(1)
    frames = []
    for memory in ("host", "cuda"):
        simulator = taxelsim.Simulator(model, N, memory=memory)
        inputs = {key: value if memory == "host" else writable(value) for key, value in simulator.inputs.as_dict().items()}
        for step in range(STEPS):
            inputs["ids"][:], inputs["poses"][:] = ids[step, :, 0], poses[step, :, 0]
            if step == 2:
                simulator.reset([3, 4])
                simulator.step(0.01, instances=[3, 4])
            else:
                simulator.step(0.01)
            simulator.read()
        frames.append(simulator.read().copy())
    assert_equal(*frames)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"ids": 2}, "inputs of instance 4: an object or a pose is not allowed: objects 0 to 1 or -1"),
        ({"ids": -2}, "inputs of instance 4: an object or a pose is not allowed"),
        ({"poses": (2, np.nan)}, "inputs of instance 4: an object or a pose is not allowed"),
        ({"poses": (3, 1.1)}, "inputs of instance 4: .* quaternions of length 1"),
        ({"poses": (4, np.inf)}, "inputs of instance 4: .* quaternions of length 1"),
        ({"loads": 1.0}, r"inputs of instance 4: a load is not allowed: NaN for none, as prepare\(\) was not called with loads"),
    ],
)
def test_what_is_not_allowed_names_the_instance(standin: Standin, device: taxelsim.Device, change: dict[str, object], text: str) -> None:
    simulator = taxelsim.Simulator(model_of(device, "wts0614"), N, memory="cuda")
    arrays = {key: writable(value) for key, value in simulator.inputs.as_dict().items()}
    arrays["ids"][:], arrays["poses"][:, 2] = 1, 0.0095
    ((key, value),) = change.items()
    index = (4, value[0]) if isinstance(value, tuple) else 4
    before = arrays[key][index]
    arrays[key][index] = value[1] if isinstance(value, tuple) else value
    simulator.step(0.01)
    force = simulator.read().total_force
    with pytest.raises(taxelsim.InputError, match=text):
        force.copy()
    arrays[key][index] = before
    simulator.step(0.01)
    assert simulator.read().total_force.copy().all()


@pytest.mark.parametrize("load", [-1.0, np.inf])
def test_wrong_loads(standin: Standin, device: taxelsim.Device, load: float) -> None:
    simulator = taxelsim.Simulator(model_of(device, "wts0614"), N, memory="cuda")
    arrays = {key: writable(value) for key, value in simulator.inputs.as_dict().items()}
    simulator.prepare(loads=True)
    arrays["loads"][2:] = load
    simulator.step(0.01)
    force = simulator.read().total_force
    with pytest.raises(taxelsim.InputError, match="inputs of instance 2: the load is not allowed: N, >= 0, or NaN for none"):
        force.copy()


def test_contact_points_are_those_of_the_host(standin: Standin, device: taxelsim.Device) -> None:
    random = np.random.default_rng(5)
    model = model_of(device, "wts0614")
    on_host, on_device = (taxelsim.Simulator(model, N, max_contacts=3, memory=memory) for memory in ("host", "cuda"))
    arrays = {key: writable(value) for key, value in on_device.inputs.as_dict().items()}
    assert {key: value.shape for key, value in arrays.items()} == {key: value.shape for key, value in on_host.inputs.as_dict().items()}
    for counts in ([3, 0, 1, 2, 3, 1], [0, 1, 0, 3, 3, 2]):
        for inputs in (on_host.inputs.as_dict(), arrays):
            inputs["num_contacts"][:] = counts
        positions, forces = random.uniform(-0.008, 0.008, (N, 3, 3)) * [1, 1, 0], random.uniform(0, 2, (N, 3))
        for simulator, inputs in ((on_host, on_host.inputs.as_dict()), (on_device, arrays)):
            inputs["positions"][:], inputs["normal_forces"][:] = positions, forces
            simulator.step(0.01)
            simulator.read()
        assert_equal(on_host.read(), on_device.read().copy())
        assert on_host.read().tactile_image.any()


@pytest.mark.parametrize(
    "change", [("num_contacts", 2, 4), ("num_contacts", 2, -1), ("normal_forces", (2, 0), -1.0), ("positions", (2, 0, 1), np.nan)]
)
def test_wrong_contact_points(standin: Standin, device: taxelsim.Device, change: tuple[str, Any, float]) -> None:
    simulator = taxelsim.Simulator(model_of(device, "wts0614"), N, max_contacts=3, memory="cuda")
    arrays = {key: writable(value) for key, value in simulator.inputs.as_dict().items()}
    arrays["num_contacts"][:] = 1
    arrays[change[0]][change[1]] = change[2]
    simulator.step(0.01)
    force = simulator.read().total_force
    with pytest.raises(
        taxelsim.InputError, match="inputs of instance 2: contact points are not allowed: 0 to 3 of them, positions of -1e6"
    ):
        force.copy()


def test_setters_and_inputs_exclude_each_other(standin: Standin, device: taxelsim.Device) -> None:
    simulator = taxelsim.Simulator(model_of(device, "wts0614"), N, memory="cuda")
    inputs = simulator.inputs
    assert simulator.inputs is inputs
    for call in (lambda: simulator.set_objects(0, np.tile([0, 0, 0, 1, 0, 0, 0], (N, 1))), lambda: simulator.set_loads(1.0)):
        with pytest.raises(taxelsim.InputError, match="takes its inputs from memory that another interface writes"):
            call()

"""Every array of a frame in libraries of tensors. PyTorch and JAX are skipped if they are missing; the campaign `learn` installs them."""

import inspect
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import taxelsim
from taxelsim.frame import Arrays

N = 3


def flat(arrays: Arrays, prefix: str = "") -> Iterator[tuple[str, np.ndarray]]:
    for name in arrays:
        value = arrays[name]
        yield from flat(value, f"{prefix}{name}.") if isinstance(value, Arrays) else [(prefix + name, value)]


def names_of(kind: type[Arrays], prefix: str = "") -> Iterator[str]:
    """All arrays that a frame can have, from its annotations."""
    for base in kind.__mro__:
        for name in inspect.get_annotations(base):
            if name in kind._nested:
                yield from names_of(kind._nested[name], f"{prefix}{name}.")
            elif not name.startswith("_"):
                yield prefix + name


@pytest.fixture(scope="module")
def frame(device: taxelsim.Device) -> taxelsim.Frame:
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/uskin_like_4x4.yaml")
    layer = taxelsim.ElasticLayer(elastic_modulus=3e5)
    model = taxelsim.Model(device, sensor.replace(skin=sensor.skin.replace(law=layer)), [taxelsim.Sphere(radius=0.01)])
    optional = (
        "taxel_counts",
        "contact_features",
        "clean_contact_features",
        "tactile_jacobian",
        "clean_tactile_jacobian",
        "taxel_jacobian",
    )
    simulator = taxelsim.Simulator(model, N, outputs=taxelsim.OutputOptions(**dict.fromkeys(optional, True)), max_regions=1)
    simulator.set_objects(0, [[0.002 * i, 0, 0.0095 - 0.0001 * i, 1, 0, 0, 0] for i in range(N)])
    simulator.step(0.001)
    return simulator.read()


@pytest.fixture(params=["numpy", "torch", "jax"])
def from_dlpack(request: pytest.FixtureRequest) -> Callable[[Any], Any]:
    module = pytest.importorskip(request.param)
    return module.dlpack.from_dlpack if request.param == "jax" else module.from_dlpack


def test_every_array_computes(frame: taxelsim.Frame, from_dlpack: Callable[[Any], Any]) -> None:
    arrays = dict(flat(frame))
    assert sorted(arrays) == sorted(set(names_of(taxelsim.Frame)))
    assert arrays["tactile_image"].any()
    for name, array in arrays.items():
        tensor = from_dlpack(taxelsim.dlpack(array))
        np.testing.assert_array_equal(np.asarray(tensor), array, err_msg=name)
        np.testing.assert_array_equal(np.asarray(tensor.max()), array.max(), err_msg=name)
        if array.dtype != np.bool_:  # which no library subtracts
            np.testing.assert_array_equal(np.asarray(tensor - tensor.max()), array - array.max(), err_msg=name)
            assert array.size == 1 or (array - array.max()).max() <= 0, name


@pytest.mark.parametrize("library", ["numpy", "torch", "jax", "warp"])
def test_tensors_have_the_names_and_numbers_of_the_frame(frame: taxelsim.Frame, library: str) -> None:
    pytest.importorskip(library)
    arrays, tensors = dict(flat(frame)), dict(flat(frame.tensors(library)))
    assert arrays.keys() == tensors.keys()
    for name, tensor in tensors.items():
        values = tensor.numpy() if hasattr(tensor, "numpy") else np.asarray(tensor)
        np.testing.assert_array_equal(values, arrays[name], err_msg=name)
        if library == "torch":
            assert tensor.data_ptr() == arrays[name].ctypes.data, name
        if library == "warp":
            assert tensor.ptr == arrays[name].ctypes.data, name
    with pytest.raises(taxelsim.InputError, match="library: 'cupy' is not allowed: numpy, torch, jax, warp"):
        frame.tensors("cupy")


@pytest.fixture(params=["numpy", "torch"])
def inputs_of(request: pytest.FixtureRequest) -> Callable[[taxelsim.Simulator], Any]:
    """The inputs of a simulator in a library."""
    pytest.importorskip(request.param)
    return lambda simulator: simulator.inputs.tensors(request.param)


POSES = [[0.002 * i, 0, 0.0095 - 0.0001 * i, 1, 0, 0, 0] for i in range(N)]


def test_inputs_are_taken_at_each_step(model: taxelsim.Model, inputs_of: Callable[[taxelsim.Simulator], Any]) -> None:
    simulator, reference = taxelsim.Simulator(model, N), taxelsim.Simulator(model, N)
    inputs = inputs_of(simulator)
    simulator.step(0.01)
    assert not simulator.read().tactile_image.any()  # no object yet
    inputs.ids[:] = 1
    for load in (np.nan, 1.5):
        for i, pose in enumerate(POSES):
            for k, value in enumerate(pose):
                inputs.poses[i, k] = value
        inputs.loads[1] = load
        simulator.step(0.01)
        reference.set_objects(1, POSES)
        reference.set_loads(np.full(N, 1.5), where=[False, load == load, False])
        reference.step(0.01)
        image = reference.read().tactile_image
        assert image.any()
        np.testing.assert_array_equal(simulator.read().tactile_image, image)


def test_wrong_inputs_name_the_instance_and_change_nothing(model: taxelsim.Model, inputs_of: Callable[[taxelsim.Simulator], Any]) -> None:
    simulator = taxelsim.Simulator(model, N)
    inputs = inputs_of(simulator)
    for array, index, value, text in (
        (inputs.poses, (2, 1), np.nan, "poses: nan of instance 2"),
        (inputs.ids, 1, 7, "instance 1"),
        (inputs.loads, 2, -1.0, "load of instance 2"),
        (inputs.loads, 1, np.inf, "instance 1"),
    ):
        kept = float(array[index])
        array[index] = value
        with pytest.raises(taxelsim.InputError, match=text):
            simulator.step(0.01)
        array[index] = int(kept) if array is inputs.ids else kept
    simulator.step(0.01)
    simulator.read()
    with pytest.raises(taxelsim.InputError, match="'jax' is not allowed for inputs"):
        simulator.inputs.tensors("jax")


def test_inputs_of_slots_and_of_contact_points(model: taxelsim.Model, inputs_of: Callable[[taxelsim.Simulator], Any]) -> None:
    assert taxelsim.Simulator(model, N, num_slots=2).inputs.poses.shape == (N, 2, 7)
    points = taxelsim.Simulator(model, N, max_contacts=2)
    inputs = inputs_of(points)
    inputs.num_contacts[1] = 2
    inputs.normal_forces[1, 0], inputs.normal_forces[1, 1], inputs.normal_forces[1, 1] = 1.0, 5.0, 0.5
    points.step(0.01)
    np.testing.assert_allclose(points.read().ground_truth.total_force, [0, 1.5, 0], rtol=1e-6)
    inputs.num_contacts[2] = 3
    with pytest.raises(taxelsim.InputError, match="num_contacts of instance 2: 3 is not allowed: 0 to 2"):
        points.step(0.01)

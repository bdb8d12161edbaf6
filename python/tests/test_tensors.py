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

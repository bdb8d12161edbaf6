"""Arrays over the memory of a simulator."""

import gc
import pickle

import numpy as np
import pytest

import taxelsim

from .conftest import N


def test_views_outlive_simulator_and_model(device, sensor, poses):
    model = taxelsim.Model(device, sensor, [taxelsim.Cylinder(radius=0.008, length=0.04)])
    simulator = taxelsim.Simulator(model, N)
    simulator.set_objects(0, poses)
    simulator.step(0.001)
    frame = simulator.read()
    image, force = frame.tactile_image, frame.ground_truth.total_force
    expected = image.copy(), force.copy()
    del frame, simulator, model
    gc.collect()
    _ = [np.ones(1 << 16) for _ in range(64)]  # what would overwrite freed memory
    assert (image == expected[0]).all()
    assert (force == expected[1]).all()


def test_views_show_newer_numbers_after_a_step_and_copies_do_not(simulator, poses):
    simulator.set_objects(0, poses)
    simulator.step(0.001)
    frame = simulator.read()
    view, copy, copied_frame = frame.tactile_image, frame.tactile_image.copy(), frame.copy()
    simulator.set_objects(0, poses - [0, 0, 0.0002, 0, 0, 0, 0])
    simulator.step(0.001)
    newer = simulator.read()
    assert newer is frame
    assert (view == newer.tactile_image).all()
    assert (view != copy).any()
    assert (copied_frame.tactile_image == copy).all()
    assert copied_frame.tactile_image.flags.writeable


def test_every_array_stays_in_place(model, poses):
    outputs = taxelsim.OutputOptions(contact_features=True, clean_contact_features=True, tactile_jacobian=True, clean_tactile_jacobian=True)
    simulator = taxelsim.Simulator(model, N, outputs=outputs, max_regions=1)

    def addresses() -> dict[str, int]:
        found = {}

        def visit(prefix: str, arrays: dict) -> None:
            for name, value in arrays.items():
                if isinstance(value, dict):
                    visit(f"{prefix}{name}.", value)
                else:
                    found[prefix + name] = value.ctypes.data

        visit("", simulator._batch.arrays())
        return found

    before = addresses()
    for _ in range(3):
        simulator.set_objects(0, poses)
        simulator.step(0.001)
        simulator.read()
    assert addresses() == before
    assert len(before) > 60


def test_dlpack_shares_the_memory(simulator):
    image = simulator.read().tactile_image
    shared = np.from_dlpack(image)
    assert shared.ctypes.data == image.ctypes.data
    assert not shared.flags.writeable


def test_consumers_without_read_only_arrays_share_the_memory_too(simulator):
    image = simulator.read().tactile_image
    with pytest.raises(BufferError):
        image.__dlpack__()

    class Unversioned:
        """As JAX and older PyTorch ask for it."""

        def __init__(self, array: np.ndarray) -> None:
            self._array = taxelsim.dlpack(array)

        def __dlpack__(self, **_: object) -> object:
            return self._array.__dlpack__()

        def __dlpack_device__(self) -> tuple[int, int]:
            return self._array.__dlpack_device__()

    shared = np.from_dlpack(Unversioned(image))
    assert shared.ctypes.data == image.ctypes.data
    assert shared.shape == image.shape


def test_frames_pickle_as_copies(simulator, poses):
    simulator.set_objects(0, poses)
    simulator.step(0.001)
    frame = simulator.read()
    loaded = pickle.loads(pickle.dumps(frame))
    assert isinstance(loaded.ground_truth, taxelsim.GroundTruth)
    assert (loaded.tactile_image == frame.tactile_image).all()
    assert loaded.tactile_image.base is None or loaded.tactile_image.ctypes.data != frame.tactile_image.ctypes.data


def test_patches_of_a_sensor_are_views(device):
    pad = taxelsim.GridPatch(name="left", num_rows=2, num_cols=3, pitch=(0.003, 0.003), X_SP=taxelsim.Pose(position=(0, -0.01, 0)))
    right = pad.replace(name="right", num_rows=4, X_SP=taxelsim.Pose(position=(0, 0.01, 0)))
    sensor = taxelsim.Sensor(
        name="pair", patches=[pad, right], skin=taxelsim.Skin(thickness=0.002, law=taxelsim.Winkler(normal_contact_stiffness=1e8))
    )
    frame = taxelsim.Simulator(taxelsim.Model(device, sensor, [taxelsim.Sphere(radius=0.01)]), 5).read()
    assert frame.tactile_image.shape == (5, 18)
    images = taxelsim.split_patches(sensor, frame.tactile_image)
    assert {name: image.shape for name, image in images.items()} == {"left": (5, 2, 3), "right": (5, 4, 3)}
    assert np.shares_memory(images["right"], frame.tactile_image)

"""Counts and newtons as arrays."""

import numpy as np
import pytest

import taxelsim
import taxelsim.envs
import taxelsim.mujoco

from ..envs.conftest import write_scene


def pressed(simulator: taxelsim.Simulator, height: float) -> taxelsim.Frame:
    simulator.set_objects(1, [[0, 0, height - 1e-4 * i, 1, 0, 0, 0] for i in range(simulator.num_instances)])
    simulator.step(0.001)
    return simulator.read()


def test_counts_are_signed_and_share_the_memory(simulator):
    frame = pressed(simulator, 0.0099)
    image = frame.tactile_image
    assert image.dtype == np.int32
    assert image.max() > 0
    assert (image - image.max()).min() == -image.max()
    assert np.shares_memory(image, simulator._batch.arrays()["tactile_image"])
    before = image.max()
    pressed(simulator, 0.0095)
    assert image.max() > before
    assert (np.from_dlpack(image) - image.max()).min() < 0


def test_newtons_on_request(model, device):
    counts, newtons = taxelsim.Simulator(model, 2), taxelsim.Simulator(model, 2, image_unit="newtons")
    images = [pressed(simulator, 0.0095).tactile_image for simulator in (counts, newtons)]
    readout = model.sensor.readout
    assert images[1].dtype == np.float32
    assert not images[1].flags.writeable
    np.testing.assert_array_equal(images[1], np.vectorize(lambda c: taxelsim.nominal_force(readout, c), otypes=[np.float32])(images[0]))
    assert pressed(newtons, 0.009).tactile_image is images[1]
    assert images[1].sum(axis=(1, 2)) == pytest.approx(newtons.read().total_force, rel=1e-5)
    with pytest.raises(taxelsim.InputError, match=r"^image_unit: 'N' is not allowed: counts, newtons$"):
        taxelsim.Simulator(model, 1, image_unit="N")


def test_environments_and_windows_have_the_same_counts_and_newtons(device, tmp_path):
    scene = taxelsim.load_scene(write_scene(tmp_path, record="tactile_image"), num_episodes=2)
    taxelsim.generate(scene, tmp_path / "data", device=device)
    data = taxelsim.Dataset(tmp_path / "data")
    names = ["data/tactile_image", "meta/object"]
    counts, newtons = (data.windows(1, columns=names, image_unit=unit)[0] for unit in ("counts", "newtons"))
    frames = []
    for unit in ("counts", "newtons"):
        environment = taxelsim.Environment(device, scene, image_unit=unit)
        environment.reset([True], [0])
        frames.append(environment.observe().tactile_image)
    for window, image, dtype in zip((counts, newtons), frames, (np.int32, np.float32), strict=True):
        assert (window["data/tactile_image"].dtype, image.dtype, window["meta/object"].dtype) == (dtype, dtype, np.int32)
        np.testing.assert_array_equal(window["data/tactile_image"], image)
        assert image.any()
    assert data["data/tactile_image"].dtype == data["data/tactile_image"][:].dtype == np.uint16  # as stored

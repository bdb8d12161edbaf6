"""A data set under the contact law `pasternak`, which was removed, is still read. Its scene is not simulated any more.

data/pasternak was written by version 0.3.0 from data/pasternak_scene.yaml: 3 episodes of 3 frames.
"""

import shutil
from pathlib import Path

import numpy as np
import pytest

import taxelsim
from taxelsim.export import Options, export
from taxelsim.report import summarize
from taxelsim.viewer.source import open_source

from .conftest import FORMAT_1

OLD = FORMAT_1.with_name("pasternak")
SCENE = FORMAT_1.with_name("pasternak_scene.yaml")
REFUSED = r"sensor\.skin\.law: pasternak is not allowed: removed; use elastic_layer, or winkler with depth_sampling: area"
COUNTS_PER_NEWTON, TRIGGER = 2400, 0.02  # of its sensor; N


@pytest.fixture
def data() -> taxelsim.Dataset:
    return taxelsim.Dataset(OLD)


def test_columns_and_windows_are_read(data):
    image = data["data/tactile_image"][:]
    assert image.shape == (9, 6, 14)
    assert (image.reshape(9, -1).max(axis=1) > 0).all()
    window = data.windows(2, columns=["data/tactile_image"], image_unit="newtons")[0]["data/tactile_image"]
    is_felt = image[:2] > 0
    np.testing.assert_allclose(window[is_felt], image[:2][is_felt] / COUNTS_PER_NEWTON + TRIGGER, rtol=1e-3)


@pytest.mark.parametrize("format_name", ["zarr", "robomimic", "mcap", "lerobot"])
def test_it_is_exported(tmp_path, format_name):
    pytest.importorskip({"zarr": "zarr", "robomimic": "h5py", "mcap": "mcap_ros2", "lerobot": "pyarrow"}[format_name])
    options = Options()
    if format_name == "lerobot":
        pytest.importorskip("av")
        options = Options(video=True)  # reads the sensor of the scene
    assert export(OLD, tmp_path / "out", format_name, options).num_frames == 9
    assert (tmp_path / "out").exists()


def test_the_viewer_and_the_report_read_its_scene(data):
    source = open_source(OLD, None, [], None, False, None)
    assert (len(source.episodes), source.missing) == (3, set())
    sensor = summarize(data).scene.sensor
    assert (sensor.num_taxels, sensor.readout.saturation) == (84, 4095)
    assert sensor.skin.law == taxelsim.Winkler(normal_contact_stiffness=5e8)


def test_its_scene_is_not_simulated(tmp_path):
    folder = Path(shutil.copytree(OLD, tmp_path / "data"))
    before = {file.name: file.read_bytes() for file in folder.iterdir()}
    for simulate in (taxelsim.load_scene, lambda scene: taxelsim.generate(scene, folder)):
        with pytest.raises(taxelsim.InputError, match=rf"pasternak_scene\.yaml:13:10: {REFUSED}"):
            simulate(SCENE)
    assert {file.name: file.read_bytes() for file in folder.iterdir()} == before
    assert not hasattr(taxelsim, "Pasternak")

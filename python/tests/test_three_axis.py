"""Three-axis taxels: the shipped sensors, frames, and columns of a data set."""

import h5py
import numpy as np
import pytest

import taxelsim

SENSORS = ("uskin_like_4x4", "papillarray_like_3x3")
ONE_COUNT = 1
SCENE = """format_version: 1
name: sliding
kind: servo
sensor: {sensor}
objects:
  - {{name: ball, sphere: {{radius_mm: 12}}}}
episode: {{num_steps: 4}}
randomization: {{depth_mm: 0.6, trigger_spread: [0.2, 0.5]}}
controller: {{tactile_servo: {{exploration_velocity_mm: 20, total_force: {{kp: 1}}}}}}
record: [tactile_image, taxel_counts, tactile_normal_force, tactile_shear_force]
data_set: {{seed: 3, episodes: 3, episodes_per_shard: 3}}
"""


def sensor_of(name):
    return taxelsim.load_sensor(taxelsim.SCENES / f"sensors/{name}.yaml")


def without_errors(sensor):
    """Counts are then the rounded product of the gain matrix and the force."""
    axes = sensor.readout.three_axis.replace(noise=[0, 0, 0], hysteresis_strength=[0, 0, 0])
    return sensor.replace(readout=sensor.readout.replace(three_axis=axes))


@pytest.mark.parametrize("name", SENSORS)
def test_counts_are_the_gain_matrix_times_the_force(device, name):
    sensor = without_errors(sensor_of(name))
    model = taxelsim.Model(device, sensor, [taxelsim.Sphere(radius=0.012)])
    simulator = taxelsim.Simulator(model, 2, outputs=taxelsim.OutputOptions(taxel_counts=True))
    for x in (0.0, 0.0004, 0.0008):
        simulator.set_objects(0, np.array([[x, 0, 0.011, 1, 0, 0, 0.0]] * 2))
        simulator.step(0.01)
        frame = simulator.read()
    truth = frame.ground_truth
    force = np.concatenate([truth.tactile_shear_force, truth.tactile_normal_force[..., None]], axis=-1).astype(float)
    expected = force @ np.array(sensor.readout.three_axis.gain).T
    rows = sensor.patches[0]
    assert frame.taxel_counts.shape == (2, rows.num_rows, rows.num_cols, 3)
    assert frame.taxel_counts.dtype == np.int32
    assert np.abs(frame.taxel_counts - expected).max() < 0.51
    assert frame.taxel_counts[..., 0].max() > 20
    assert frame.taxel_counts[..., 2].max() > 100


def test_counts_that_were_not_requested_are_missing(device):
    model = taxelsim.Model(device, sensor_of(SENSORS[0]), [taxelsim.Sphere(radius=0.012)])
    simulator = taxelsim.Simulator(model, 1)
    simulator.step(0.01)
    with pytest.raises(AttributeError, match=r"outputs=OutputOptions\(taxel_counts=True\)"):
        _ = simulator.read().taxel_counts


def test_a_sensor_without_the_electronics_is_refused(model):
    with pytest.raises(taxelsim.InputError, match=r"^outputs.taxel_counts: true is not allowed for a sensor without readout.three_axis$"):
        taxelsim.Simulator(model, 1, outputs=taxelsim.OutputOptions(taxel_counts=True))


def test_a_data_set_has_the_counts_and_the_spread_of_the_triggers(tmp_path):
    scene = tmp_path / "sliding.yaml"
    scene.write_text(SCENE.format(sensor=taxelsim.SCENES / f"sensors/{SENSORS[0]}.yaml"))
    taxelsim.generate(scene, tmp_path / "data")
    with h5py.File(next((tmp_path / "data").glob("shard-*.h5"))) as shard:
        counts, normal = shard["data/taxel_counts"], shard["data/ground_truth/tactile_normal_force"][...]
        assert counts.shape == (12, 4, 4, 3)
        assert counts.dtype == np.int32
        assert counts.attrs["unit"] in (b"counts", "counts")
        assert np.corrcoef(counts[..., 2].ravel(), normal.ravel())[0, 1] > 0.99
        spread = shard["meta/trigger_spread"][...]
        assert np.all((spread >= 0.2) & (spread <= 0.5))
        assert len(set(spread.tolist())) == 3

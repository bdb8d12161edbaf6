"""Measurements of real sensors in the viewer."""

import numpy as np
import pytest

import taxelsim
from taxelsim.viewer.measurements import is_measurement

pytest.importorskip("rerun")

MEASUREMENTS = taxelsim.SCENES / "measurements"


def test_images_and_times_are_those_of_the_table(recorded):
    lines = [line for line in (MEASUREMENTS / "stamp_3N.csv").read_text().splitlines() if not line.startswith("#")]
    table = np.genfromtxt(lines, delimiter=",", names=True)
    found = recorded(MEASUREMENTS / "stamp_3N.yaml")
    images = found["episode_0/tactile_image", "DepthImage:buffer"]
    counts = np.array([np.frombuffer(bytes(image), np.uint16) for image in images.reshape(len(table), -1).astype(np.uint8)])
    np.testing.assert_array_equal(counts[:, 15], table["r1_c1"])
    times = found["episode_0/tactile_image", "time"]
    np.testing.assert_allclose([moment / np.timedelta64(1, "s") for moment in times.astype("timedelta64[ns]")], table["time_s"], atol=1e-6)
    forces = found["episode_0/features/total_force", "Scalars:scalars"].ravel()
    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")
    expected = sum(taxelsim.nominal_force(sensor.readout, int(value)) for value in counts[-1])
    assert forces[-1] == pytest.approx(expected, rel=1e-3)


def test_times_in_milliseconds(recorded, tmp_path):
    names = ",".join(f"r{taxel // 14}_c{taxel % 14}" for taxel in range(84))
    (tmp_path / "m.csv").write_text(f"time_ms,{names}\n" + "".join(f"{20 * row}{',5' * 84}\n" for row in range(3)))
    sensor = taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml"
    (tmp_path / "m.yaml").write_text(f'measurement: images\nsensor: "{sensor}"\ntable: m.csv  # ms\n')
    times = recorded(tmp_path / "m.yaml")["episode_0/tactile_image", "time"]
    np.testing.assert_array_equal(times.astype("timedelta64[ms]").astype(int), [0, 20, 40])


def test_a_measurement_without_times_has_frames(recorded):
    found = recorded(MEASUREMENTS / "uniform_press.yaml")
    assert ("episode_0/tactile_image", "time") not in found.columns
    assert len(found["episode_0/tactile_image", "frame"]) > 1


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("measurement: step_response\nsensor: a.yaml\ntable: a.csv\n", "'step_response' has no images to view: images, stamp_images"),
        ("measurement: images\nsensor: {num_rows: 6}\ntable: a.csv\n", "sensor: the name of a file is needed"),
        ("measurement: images\nsensor: a.yaml\n", "table: the name of a file is needed"),
        ("measurement: images\nsensor: {sensor}\ntable: {table}\nsha256: 00\n", "its SHA-256 is not that in"),
        ("measurement: images\nsensor: {sensor}\ntable: {table}\ntaxel_columns: x{taxel}\n", "no column 'x0'"),
    ],
)
def test_measurements_that_cannot_be_shown(tmp_path, content, message):
    file = tmp_path / "bad.yaml"
    names = {"sensor": taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml", "table": MEASUREMENTS / "stamp_3N.csv"}
    for name, value in names.items():
        content = content.replace(f"{{{name}}}", str(value))
    file.write_text(content)
    assert is_measurement(file)
    with pytest.raises(taxelsim.InputError, match=message):
        taxelsim.view(file)


def test_a_scene_is_none():
    assert not is_measurement(taxelsim.SCENES / "edge_servo.yaml")
    with pytest.raises(taxelsim.InputError, match="episodes: not allowed for a measurement"):
        taxelsim.view(MEASUREMENTS / "stamp_3N.yaml", 0)

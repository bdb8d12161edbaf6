"""scripts/make_sensors.py writes the sensor files that are committed."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import taxelsim

ROOT = Path(__file__).resolve().parents[2]
GENERATED = ("fingertip_cylinder.yaml", "fingertip_sphere.yaml", "xhand1_like_fingertip.yaml")
VARIANTS = ("realistic", "calibrated")


def test_the_script_writes_the_committed_files(tmp_path):
    committed = ROOT / "scenes/sensors"
    generated = [*GENERATED, *(file.name for suffix in VARIANTS for file in committed.glob(f"*_{suffix}.yaml"))]
    for file in committed.glob("*.yaml"):
        if file.name not in generated:
            shutil.copy(file, tmp_path)
    subprocess.run([sys.executable, "-B", str(ROOT / "scripts/make_sensors.py"), str(tmp_path)], check=True)
    assert sorted(file.name for file in tmp_path.iterdir()) == sorted(file.name for file in committed.glob("*.yaml"))
    for name in generated:
        assert (tmp_path / name).read_bytes() == (committed / name).read_bytes(), name


PAGE = ROOT / "docs/reference/sensors_like.md"

# Arrays that people own: taxels and the sides in mm that they cover, as published; None for sides that are not published.
LIKE = {
    "flexitac_like_12x32": ((12, 32), (24, 64)),
    "flexitac_like_16x16": ((16, 16), (48, 48)),
    "tekscan_like_44x44": ((44, 44), (55.9, 55.9)),
    "robotis_like_3x3": ((3, 3), None),
    "xhand1_like_fingertip": ((10, 12), None),
    "glove_like_548": ((548,), None),
}


@pytest.mark.parametrize("name", LIKE)
def test_a_sensor_like_a_real_one_has_its_published_numbers_and_weighs_a_ball(device: taxelsim.Device, name: str) -> None:
    shape, sides = LIKE[name]
    sensor = taxelsim.load_sensor(ROOT / f"scenes/sensors/{name}.yaml")
    assert sensor.num_taxels == np.prod(shape)
    assert sensor.depth_sampling == taxelsim.DepthSampling.AREA
    if sides:
        patch = sensor.patches[0]
        covered = [1000 * count * pitch for count, pitch in zip((patch.num_rows, patch.num_cols), patch.pitch, strict=True)]
        assert covered == pytest.approx(sides, abs=0.05)
    simulator = taxelsim.Simulator(taxelsim.Model(device, sensor, [taxelsim.Sphere(0.01)]), 1)
    simulator.set_objects(0, [[0, 0, 0.01, 1, 0, 0, 0]])
    simulator.set_loads([5.0])
    simulator.step(0.001)
    frame = simulator.read()
    assert frame.ground_truth.contact_wrench[0, 2] == pytest.approx(-5, abs=1e-3)
    assert frame.total_force[0] == pytest.approx(5, rel=0.03)  # by counts, of 8 bits on 1936 taxels the coarsest
    row = next(line for line in PAGE.read_text().splitlines() if line.startswith(f"| `{name}.yaml`"))
    cells = [cell.strip() for cell in row.split("|")]
    assert cells[2] == str(sensor.num_taxels)
    assert cells[5:7] == [f"{frame.tactile_image.max()} of {sensor.readout.saturation}", f"{frame.total_force[0]:.2f}"]


@pytest.mark.parametrize("name", LIKE)
def test_the_page_has_a_section_and_each_number_a_source(name: str) -> None:
    assert f"`{name}.yaml`" in PAGE.read_text()
    text = (ROOT / f"scenes/sensors/{name}.yaml").read_text()
    assert "No affiliation; docs/reference/sensors_like.md" in text
    settings = [
        line for line in text.splitlines() if re.match(r"  ?(\w+(_mm)?|curve|gaussian): [\[{\d]", line) and "position_mm" not in line
    ]
    assert len(settings) > 4
    assert [line for line in settings if "#" not in line] == []

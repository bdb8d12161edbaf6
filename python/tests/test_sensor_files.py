"""scripts/make_sensors.py writes the sensor files that are committed."""

import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
GENERATED = ("fingertip_cylinder.yaml", "fingertip_sphere.yaml")
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

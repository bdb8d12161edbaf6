"""Describes an own sensor in Python, writes it as a sensor file, and presses a ball on it at 100 places.

python3 examples/own_sensor.py [FILE]
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import taxelsim


def own_sensor() -> taxelsim.Sensor:
    """An array of 8 x 8 taxels, 2.5 mm apart, under 3 mm of soft rubber, with a 10-bit converter."""
    rubber = taxelsim.Skin(thickness=0.003, law=taxelsim.Winkler(normal_contact_stiffness=6e7))
    electronics = taxelsim.Readout(curve=[400.0], adc_bits=10, saturation=1023, noise=1.5, trigger=0.01)
    grid = taxelsim.GridPatch(name="pad", num_rows=8, num_cols=8, pitch=[0.0025, 0.0025])
    spread = taxelsim.gaussian_psf(0.6, 3)  # sigma in taxels, taxels per side
    return taxelsim.Sensor(name="own_sensor", patches=[grid], skin=rubber, psf=spread, readout=electronics)


def main() -> None:
    sensor = own_sensor()
    taxelsim.check_sensor(sensor)
    file = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(tempfile.mkdtemp()) / "own_sensor.yaml"
    file.write_text(taxelsim.sensor_text(sensor))
    sensor = taxelsim.load_sensor(file)  # the same sensor: scenes name this file
    print(f"{file}: {sensor.num_taxels} taxels")

    places = np.random.default_rng(0).uniform(-0.006, 0.006, (100, 2))
    poses = np.zeros((len(places), 7))
    poses[:, :2] = places
    poses[:, 3] = 1
    model = taxelsim.Model(taxelsim.Device.open(), sensor, [taxelsim.Sphere(radius=0.006)])
    simulator = taxelsim.Simulator(model, len(places))
    simulator.set_objects(0, poses)
    simulator.set_loads(1.5)
    simulator.step(0.01)
    frame = simulator.read()
    errors = np.linalg.norm(frame.center_of_pressure[:, :2] - places, axis=1)
    print(f"distance of the centre of pressure from the ball: median {1e3 * np.median(errors):.2f} mm, largest {1e3 * errors.max():.2f} mm")


if __name__ == "__main__":
    main()

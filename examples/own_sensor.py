"""Describes an own tactile array from its data sheet, writes it as a sensor file, and presses a ball on it at 100 places.

The layout and the electronics are those of a data sheet; the stiffness of the skin follows from the Shore hardness of its rubber. The
centre of pressure then finds the ball far within a taxel. Prints the stiffness and the distance of the centre of pressure from the ball.

python3 examples/own_sensor.py [PICTURE]    writes the sensor file next to the picture
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import taxelsim
from taxelsim.pictures import draw_taxels, save_figure


def own_sensor() -> taxelsim.Sensor:
    """An array of 8 x 8 taxels, 2.5 mm apart, under 3 mm of rubber of Shore A 20, with a 10-bit converter."""
    rubber = taxelsim.KnownModulus(taxelsim.shore_a_modulus(20), match_pin_diameter=0.004)  # Pa; m, size of the contacts that matter
    skins = taxelsim.skins_of(taxelsim.skin_stiffness(taxelsim.SkinData(thickness=0.003, stiffness=rubber)))
    springs = next(skin for skin in skins if isinstance(skin.law, taxelsim.Winkler))
    electronics = taxelsim.Readout(curve=[600.0], adc_bits=10, saturation=1023, noise=1.5, trigger=0.01)  # counts/N; counts; N
    grid = taxelsim.GridPatch(name="pad", num_rows=8, num_cols=8, pitch=0.0025)
    spread = taxelsim.gaussian_psf(0.6, 3)  # sigma in taxels, taxels per side
    return taxelsim.Sensor(name="own_sensor", patches=[grid], skin=springs, psf=spread, readout=electronics)


def main() -> None:
    picture = Path(sys.argv[1] if len(sys.argv) > 1 else "own_sensor.png")
    file = picture.with_suffix(".yaml")
    file.write_text(taxelsim.sensor_text(own_sensor()))
    sensor = taxelsim.load_sensor(file)  # the same sensor: scenes name this file

    places = np.random.default_rng(0).uniform(-0.006, 0.006, (100, 2))  # m
    poses = np.zeros((len(places), 7))
    poses[:, :2], poses[:, 3] = places, 1
    simulator = taxelsim.Simulator(taxelsim.Model(taxelsim.Device.open(), sensor, [taxelsim.Sphere(radius=0.006)]), len(places))
    simulator.set_objects(0, poses, anchor="lowest")
    simulator.set_loads(1.5)  # N
    simulator.step(0.01)
    frame = simulator.read()
    errors = 1e3 * np.linalg.norm(frame.center_of_pressure[:, :2] - places, axis=1)
    stiffness = sensor.skin.law.normal_contact_stiffness
    print(f"{sensor.num_taxels} taxels, {stiffness:.3g} N/m^3; distance from the ball: median {np.median(errors):.2f} mm")

    plt.rcParams["font.size"] = 15
    figure, axes = plt.subplots(1, 2, figsize=(12, 5.6), layout="constrained")
    figure.colorbar(draw_taxels(axes[0], sensor, frame.tactile_image[0]), ax=axes[0], label="counts")
    axes[0].set_title("tactile image of one press")
    axes[1].plot(*(1e3 * places[:, ::-1].T), "o", color="0.6", markersize=11, label="ball")
    axes[1].plot(*(1e3 * frame.center_of_pressure[:, 1::-1].T), ".", color="tab:red", markersize=9, label="centre of pressure")
    axes[1].set(xlabel="y (mm)", xlim=(-10, 10), ylim=(10, -10), aspect="equal", title="100 presses")
    axes[1].legend(loc="upper right", fontsize=12)
    save_figure(picture, figure)


if __name__ == "__main__":
    main()

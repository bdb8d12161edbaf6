#!/usr/bin/env python3
"""Writes our own curved sensors, and a realistic variant of each array, into scenes/sensors/.

Needs the standard library alone; the same bytes on every machine.

Usage: scripts/make_sensors.py [DIRECTORY]
"""
import math
import pathlib
import re
import sys

from make_objects import icosphere

RADIUS = 0.008  # m

REST = """\
samples_per_taxel: 4                 # assumption: samples about 0.6 mm apart
frame_rate: 0                        # assumption: a new frame every step
skin:
  thickness_mm: 2                    # assumption: as wts0614_soft_cover.yaml
  law: winkler
  normal_contact_stiffness: 1.73e8   # assumption: as wts0614_soft_cover.yaml
  normal_exponent: 1                 # assumption: as wts0614_soft_cover.yaml
  normal_damping: 0                  # assumption: as wts0614_soft_cover.yaml
psf:
  skin_gaussian: {sigma_mm: 1.2}     # assumption: half a taxel pitch, as wts0614_soft_cover.yaml
  normalization: per_source          # assumption: conserves the total force
readout:
  curve: {counts_per_newton: 2000}   # assumption: 12 bits over 2 N, which is 350 kPa on one taxel
  output_scale: 1                    # assumption
  trigger: 0.01                      # assumption: half of wts0614_soft_cover.yaml, for taxels of half the area
  adc_bits: 12                       # assumption
  saturation: 4095                   # assumption: 12-bit full scale
  noise: 0                           # assumption: off, so that images are repeatable; scenes can add noise per episode
"""

# Readout of the real arrays of the WTS family. "The recordings": 17 presses of a SCHUNK finger with the manufacturer's matrix
# (docs/validation.md, "A real matrix, predicted"), fitted by `taxelsim characterize`.
WEISS = """\
  trigger: 0.042                     # source: the controller of the recordings subtracts about 100 counts, at 2400 counts/N
  adc_bits: 12                       # source: the manufacturer's headers
  saturation: 4095                   # 12-bit full scale
  noise: 17                          # source: the recordings, standard deviation of a loaded taxel
  gain_spread: 0.4                   # source: 0.31 between the 26 loaded taxels of the recordings, up to 0.6 in other real matrices
  press_gain_spread: 0.085           # source: the recordings, 0.059 to 0.124 between presses
  creep:                             # 63 % more counts after 5 s
    - {fraction: 0.43, time: 0.74}   # source: the recordings, 0.39 to 0.46 and 0.66 to 0.83 s
    - {fraction: 0.44, time: 7.7}    # source: the recordings, 0.42 to 0.46 and 6.5 to 9.1 s
"""

# Arrays of which no recordings are published.
ASSUMED = """\
  trigger: {trigger:<26}# assumption: as {base}.yaml
  adc_bits: 12                       # assumption: as {base}.yaml
  saturation: 4095                   # assumption: as {base}.yaml
  noise: 17                          # assumption: as wts0614_realistic.yaml
  gain_spread: 0.4                   # assumption: as wts0614_realistic.yaml
  press_gain_spread: 0.085           # assumption: as wts0614_realistic.yaml
"""
REALISTIC = {"wts0614": WEISS, "wts0614_soft_cover": WEISS, "weiss_dsa_distal": WEISS}
REALISTIC |= {base: ASSUMED for base in ("cea_list", "digitacts_6x4", "fingertip_cylinder", "fingertip_sphere")}


def numbers(values, digits):
    # Adding 0.0 turns -0 into 0, so that no sign of zero is written.
    return "[" + ", ".join(f"{round(value, digits) + 0.0:.{digits}f}".rstrip("0").rstrip(".") for value in values) + "]"


def write_sensor(directory, name, description, taxels):
    """`taxels`: (position in m, unit normal, sides in m, direction of x or None)."""
    lines = [f"# {line}" for line in description]
    lines += ["format_version: 1", f"name: {name}", "taxels:                              # assumption: all positions and sizes; scripts/make_sensors.py"]
    for position, normal, size, x_axis in taxels:
        text = f"  - {{position_mm: {numbers([1000 * c for c in position], 6)}, normal: {numbers(normal, 9)}, size_mm: {numbers([1000 * c for c in size], 6)}"
        if x_axis:
            text += f", x_axis: {numbers(x_axis, 9)}"
        lines.append(text + "}")
    (directory / f"{name}.yaml").write_text("\n".join(lines) + "\n" + REST, encoding="ascii")


def cylinder(num_around, num_along, pitch_along):
    """Rings of taxels over half a cylinder along y; its skin touches z = 0 from below in the middle of S."""
    step = math.pi / num_around
    for i in range(num_around):
        angle = (i - (num_around - 1) / 2) * step
        normal = (math.sin(angle), 0.0, math.cos(angle))
        for j in range(num_along):
            y = (j - (num_along - 1) / 2) * pitch_along
            position = (RADIUS * normal[0], y, RADIUS * (normal[2] - 1))
            yield position, normal, (RADIUS * step, pitch_along), (math.cos(angle), 0.0, -math.sin(angle))


def sphere(levels, half_angle):
    """A taxel at each vertex of an icosphere within `half_angle` of the apex; all of one size, which together would cover the sphere."""
    vertices, _ = icosphere(levels)
    side = math.sqrt(4 * math.pi * RADIUS**2 / len(vertices))
    cap = [v for v in vertices if v[2] >= math.cos(half_angle)]
    # From the apex down, ring by ring; rounded, so that the last bit of a coordinate does not decide.
    cap.sort(key=lambda v: (-round(v[2], 6), round(math.atan2(v[1], v[0]), 6)))
    for normal in cap:
        yield tuple(RADIUS * (c - (axis == 2)) for axis, c in enumerate(normal)), normal, (side, side), None


def write_realistic(directory, base, readout):
    """The sensor file `base` with another readout from its trigger on, which ends the file."""
    text = (directory / f"{base}.yaml").read_text(encoding="ascii")
    settings, before_trigger = text[text.index("format_version") :], text.index("  trigger:")
    trigger = re.match(r"  trigger: (\S+)", text[before_trigger:])[1]
    settings = settings[: before_trigger - len(text)].replace(f"name: {base}\n", f"name: {base}_realistic\n")
    description = [
        f"# The array of {base}.yaml as a real one is: taxels differ in gain by 40 %, presses by 9 %, and readings are noisy. Gains are",
        "# new in every episode. Generated by scripts/make_sensors.py.",
    ]
    if readout is ASSUMED:
        readout = readout.format(base=base, trigger=trigger)
    text = "\n".join(description) + "\n" + settings + readout
    (directory / f"{base}_realistic.yaml").write_text(text, encoding="ascii")


def main():
    directory = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent / "scenes" / "sensors")
    write_sensor(
        directory,
        "fingertip_cylinder",
        [
            "Generic fingertip: 11 x 8 taxels on half a cylinder of radius 8 mm and length 20 mm; generated by",
            "scripts/make_sensors.py. Sensor frame: origin in the middle of the ridge, x around the finger, y along it, z out of the skin.",
            "Taxel order: by columns along y, from -x to +x. Every number is an assumption.",
        ],
        cylinder(num_around=11, num_along=8, pitch_along=0.0025),
    )
    write_sensor(
        directory,
        "fingertip_sphere",
        [
            "Generic fingertip: a spherical cap of radius 8 mm and half-angle 75 degrees, with a taxel of 2.2 mm at each vertex of an",
            "icosphere of subdivision level 2; generated by scripts/make_sensors.py. Sensor frame: origin at the apex, z out of the skin.",
            "Taxel order: from the apex down. Every number is an assumption.",
        ],
        sphere(levels=2, half_angle=math.radians(75)),
    )
    for base, readout in REALISTIC.items():
        write_realistic(directory, base, readout)


if __name__ == "__main__":
    main()

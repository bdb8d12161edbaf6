#!/usr/bin/env python3
"""Writes our own curved sensors into scenes/sensors/. Needs the standard library alone; the same bytes on every machine.

Usage: scripts/make_sensors.py [DIRECTORY]
"""
import math
import pathlib
import sys

from make_objects import icosphere

RADIUS = 0.008  # m

REST = """\
samples_per_taxel: 4                 # assumption: 0.6 mm between samples
frame_rate: 0                        # assumption: a frame at every step
skin:
  thickness_mm: 2                    # assumption: as wts0614.yaml
  law: winkler
  normal_contact_stiffness: 1.73e8   # assumption: as wts0614.yaml
  normal_exponent: 1                 # assumption: as wts0614.yaml
  normal_damping: 0                  # assumption: as wts0614.yaml
psf:
  skin_gaussian: {sigma_mm: 1.2}     # assumption: half a taxel, as wts0614.yaml
  normalization: per_source          # assumption: keeps the force
readout:
  curve: {counts_per_newton: 2000}   # assumption: 12 bits over the 2 N that a uniform 350 kPa brings to one taxel
  output_scale: 1                    # assumption
  trigger: 0.01                      # assumption: half of what wts0614.yaml has, for taxels of half the area
  adc_bits: 12                       # assumption
  saturation: 4095                   # assumption: full scale
  noise: 0                           # assumption, so that images are repeatable; scenes add it with randomisation.noise
"""


def numbers(values, digits):
    # Adding 0.0 turns -0 into 0, so that no sign of zero is written.
    return "[" + ", ".join(f"{round(value, digits) + 0.0:.{digits}f}".rstrip("0").rstrip(".") for value in values) + "]"


def write_sensor(directory, name, description, taxels):
    """`taxels`: (position in m, unit normal, sides in m, direction of x or None)."""
    lines = [f"# {line}" for line in description]
    lines += ["format_version: 1", f"name: {name}", "taxels:                              # assumption: all places and sizes; scripts/make_sensors.py"]
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


def main():
    directory = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent / "scenes" / "sensors")
    write_sensor(
        directory,
        "fingertip_cylinder",
        [
            "A fingertip of no particular hand: 11 x 8 taxels over half a cylinder of 8 mm radius and 20 mm length, made by",
            "scripts/make_sensors.py. Frame: S lies in the middle of the ridge, x around the finger, y along it, z out of the skin.",
            "Taxels ring by ring from -x to +x, each along y. Every number is an assumption.",
        ],
        cylinder(num_around=11, num_along=8, pitch_along=0.0025),
    )
    write_sensor(
        directory,
        "fingertip_sphere",
        [
            "A fingertip of no particular hand: a cap of a sphere of 8 mm radius, 75 degrees to each side, a taxel of 2.2 mm at each vertex of",
            "an icosahedron cut twice; made by scripts/make_sensors.py. Frame: S lies in the apex, z out of the skin. Taxels from the apex",
            "down. Every number is an assumption.",
        ],
        sphere(levels=2, half_angle=math.radians(75)),
    )


if __name__ == "__main__":
    main()

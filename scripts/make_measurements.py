#!/usr/bin/env python3
"""Writes scenes/measurements/: a bench session with a sensor that is not there, one file for each kind of measurement.

    make_measurements.py [DIRECTORY]

Nothing here is a recording. The formulas are those of docs/measurements.md, written apart from the simulator's, so that what
`taxelsim characterize` makes of the files can be held against TRUTH.
"""

import math
import random
import sys
from pathlib import Path

ROWS, COLS, PITCH = 6, 14, 3.4e-3  # of scenes/sensors/wts0614.yaml
TRUTH = {
    "counts_per_newton": 2310.0,
    "trigger": 0.031,  # N
    "saturation": 3840,
    "noise": 6.0,  # counts
    "gain_spread": 0.06,
    "border_gain": 0.93,
    "dead_taxel": 40,
    "normal_contact_stiffness": 1.61e8,  # N/m^3
    "contact_offset": 0.212e-3,  # m
    "sigma": 0.6,  # taxels
    "creep": [(0.10, 1.0), (0.08, 9.0)],  # fraction, s
}
PIN_RADIUS = 0.5e-3  # m, the paper's
STAMP = (10.5e-3, 10.5e-3)  # m, along x and y

draw = random.Random(20)


def gains():
    values = []
    for row in range(ROWS):
        for col in range(COLS):
            border = row in (0, ROWS - 1) or col in (0, COLS - 1)
            values.append((TRUTH["border_gain"] if border else 1.0) * (1 + draw.gauss(0, TRUTH["gain_spread"])))
    values[TRUTH["dead_taxel"]] = 0.0
    alive = [value for value in values if value > 0]
    mean = sum(alive) / len(alive)
    return [value / mean for value in values]


GAIN = gains()


def kernel():
    weights = {}
    for a in range(-2, 3):
        for b in range(-2, 3):
            weights[a, b] = math.exp(-(a * a + b * b) / (2 * TRUTH["sigma"] ** 2))
    return weights


KERNEL = kernel()


def spread(force):
    """Force per taxel {(row, col): N} to spread force, each source's sum kept."""
    result = [0.0] * (ROWS * COLS)
    for (row, col), value in force.items():
        inside = {(row + a, col + b): w for (a, b), w in KERNEL.items() if 0 <= row + a < ROWS and 0 <= col + b < COLS}
        total = sum(inside.values())
        for (i, j), weight in inside.items():
            result[i * COLS + j] += value * weight / total
    return result


def read(taxel, force):
    counts = TRUTH["counts_per_newton"] * (GAIN[taxel] * force - TRUTH["trigger"]) + draw.gauss(0, TRUTH["noise"])
    if GAIN[taxel] == 0:
        return 0
    return min(max(round(counts), 0), TRUTH["saturation"])


def creep(time):
    return 1 + sum(fraction * (1 - math.exp(-time / tau)) for fraction, tau in TRUTH["creep"])


def overlap(low, high, cell):
    """Length that [low, high] has of a cell, by its number from the middle of the first."""
    return max(0.0, min(high, (cell + 0.5) * PITCH) - max(low, (cell - 0.5) * PITCH))


def stamp_forces(x, y, size, load):
    """Force per taxel under a rectangle with even pressure; x, y of its middle in the frame of the array."""
    force = {}
    for row in range(ROWS):
        length = overlap(x - size[0] / 2 + (ROWS - 1) / 2 * PITCH, x + size[0] / 2 + (ROWS - 1) / 2 * PITCH, row)
        for col in range(COLS):
            width = overlap(y - size[1] / 2 + (COLS - 1) / 2 * PITCH, y + size[1] / 2 + (COLS - 1) / 2 * PITCH, col)
            if length * width > 0:
                force[row, col] = load * length * width / (size[0] * size[1])
    return force


def write(directory, name, settings, heading, rows):
    lines = ["# Simulated by scripts/make_measurements.py, not measured.", heading]
    lines += [",".join(row) for row in rows]
    (directory / f"{name}.csv").write_text("\n".join(lines) + "\n")
    text = "# Simulated by scripts/make_measurements.py, not measured.\nformat_version: 1\n"
    text += f"measurement: {settings.pop('measurement')}\nsensor: ../sensors/wts0614.yaml\ntable: {name}.csv\n"
    text += "".join(f"{key}: {value}\n" for key, value in settings.items())
    (directory / f"{name}.yaml").write_text(text)


def force_curve(directory):
    rows = []
    for taxel in range(ROWS * COLS):
        place = (taxel // COLS, taxel % COLS)
        for k in range(24):
            force = 3.2 * min(k, 23 - k) / 11 + abs(draw.gauss(0, 0.01))
            rows.append((str(taxel), f"{force:.4f}", str(read(taxel, spread({place: force})[taxel]))))
    write(directory, "force_curve", {"measurement": "force_curve"}, "taxel,force_N,counts", rows)


def force_depth(directory):
    rows = []
    area = math.pi * PIN_RADIUS**2
    for k in range(60):
        depth = 0.025e-3 * k
        force = TRUTH["normal_contact_stiffness"] * area * max(0.0, depth - TRUTH["contact_offset"]) + draw.gauss(0, 0.002)
        rows.append((f"{depth * 1e3:.3f}", f"{force:.4f}"))
    write(directory, "force_depth", {"measurement": "force_depth", "indenter": "{flat_pin: {radius_mm: 0.5}}"}, "depth_mm,force_N", rows)


def columns():
    return ",".join(f"r{row}_c{col}" for row in range(ROWS) for col in range(COLS))


def point_images(directory):
    rows = []
    for k in range(40):
        # On the middles of taxels, which a stage with 0.2 mm steps reaches: the pin lies within one of them.
        row, col = draw.randrange(ROWS), draw.randrange(COLS)
        force = draw.uniform(0.6, 1.4)
        image = spread({(row, col): force})
        x, y = (row - (ROWS - 1) / 2) * PITCH, (col - (COLS - 1) / 2) * PITCH
        rows.append([f"{x * 1e3:.3f}", f"{y * 1e3:.3f}", f"{force:.4f}"] + [str(read(t, image[t])) for t in range(ROWS * COLS)])
    write(directory, "point_images", {"measurement": "point_images", "indenter": "{flat_pin: {radius_mm: 0.5}}"},
          "x_mm,y_mm,force_N," + columns(), rows)


def step_response(directory):
    rows, taxel, onset = [], 20, 0.53
    for k in range(600):
        time = k / 30
        force = 0.9 * creep(time - onset) if time >= onset else 0.0
        rows.append((f"{time:.4f}", str(read(taxel, force))))
    write(directory, "step_response", {"measurement": "step_response", "load": 0.9}, "time_s,counts", rows)


def stamp_images(directory):
    for name, x, y, load in (("stamp_3N", 0.4e-3, -3.1e-3, 2.94), ("stamp_6N", -0.9e-3, 2.0e-3, 5.88)):
        image = spread(stamp_forces(x, y, STAMP, load))
        rows = []
        for k in range(120):
            time = k / 10
            pressed = creep(time - 1.03) if time >= 1.03 else 0.0
            rows.append([f"{time:.2f}"] + [str(read(t, image[t] * pressed)) for t in range(ROWS * COLS)])
        write(directory, name, {"measurement": "stamp_images", "indenter": "{stamp: {size_mm: [10.5, 10.5]}}", "load": load},
              "time_s," + columns(), rows)


def main():
    root = Path(__file__).resolve().parent.parent
    directory = Path(sys.argv[1]) if len(sys.argv) > 1 else root / "scenes" / "measurements"
    directory.mkdir(parents=True, exist_ok=True)
    for make in (force_curve, force_depth, point_images, step_response, stamp_images):
        make(directory)


if __name__ == "__main__":
    main()

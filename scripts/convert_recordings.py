#!/usr/bin/env python3
"""Makes measurements for `taxelsim characterize` from public recordings of single resistive taxels, which have no licence to be copied here.

    convert_recordings.py DATA OUT

DATA holds force_vs_adc/tams_*.txt (github.com/TAMS-Group/tams_tactile_sensor_array_hardware, calibration/) and hysteresis/pike1_force_*
(github.com/Lupasic/tactile-sensor-velostat). Both sensors are a voltage divider whose reading falls with force: what is written is how far it
fell from the largest reading, so that it rises.
"""

import bisect
import sys
from pathlib import Path

SENSOR = "{{name: {name}, num_rows: 1, num_cols: 1, pitch_mm: 6, skin: {{thickness_mm: 1, normal_contact_stiffness: 1e8}}, "
SENSOR += "readout: {{curve: {{counts_per_newton: {slope}}}, adc_bits: {bits}}}}}"
TAMS_NEWTONS = 0.160 * 9.81 / (1667333 - 1660130)  # per count of the load cell over 1660130; absolute newtons are uncertain, shapes not
PIKE_STEP = 4  # every fourth reading, 36 Hz


def rows_of(file):
    return [tuple(float(word) for word in line.split()) for line in file.read_text().splitlines() if line.strip()]


def write(out, name, bits, slope, rows):
    """rows: (time or None, force in N, reading that falls with force)."""
    top = max(reading for _, _, reading in rows)
    timed = rows[0][0] is not None
    lines = ["taxel,force_N,counts" + (",time_s" if timed else "")]
    last = None
    for time, force, reading in rows:
        if timed and last is not None and time <= last:
            continue
        last = time
        lines.append(f"0,{force:.6g},{top - reading:.6g}" + (f",{time:.4f}" if timed else ""))
    (out / f"{name}.csv").write_text("\n".join(lines) + "\n")
    sensor = SENSOR.format(name=name, slope=slope, bits=bits)
    (out / f"{name}.yaml").write_text(
        f"format_version: 1\nmeasurement: force_curve\nsensor: {sensor}\ntable: {name}.csv\ndivider: true\n")


def tams(data, out):
    for name in ("tams_nosil", "tams_thinsil"):
        rows = [(None, (cell - 1660130) * TAMS_NEWTONS, adc) for cell, adc in rows_of(data / "force_vs_adc" / f"{name}.txt")]
        write(out, name, 13, 1500, rows)


def pike(data, out):
    for force in (1, 10, 40):
        name = f"pike1_force_{force}"
        cell = rows_of(data / "hysteresis" / f"{name}_futek.txt")
        times = [time for _, time in cell]
        rows = []
        for reading, time in rows_of(data / "hysteresis" / f"{name}_velostat.txt")[::PIKE_STEP]:
            at = bisect.bisect(times, time)
            if not 0 < at < len(times):
                continue
            part = (time - times[at - 1]) / max(times[at] - times[at - 1], 1e-9)
            rows.append((time - times[0], cell[at - 1][0] * (1 - part) + cell[at][0] * part, reading))
        write(out, name, 12, 1000, rows)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    data, out = Path(sys.argv[1]), Path(sys.argv[2])
    out.mkdir(parents=True, exist_ok=True)
    tams(data, out)
    pike(data, out)


if __name__ == "__main__":
    main()

"""Time of an update of the playground at its server: from the receipt of a drag to the sending of the frame, one browser's worth of data.

python play_rate.py [--json FILE]
"""

import argparse
import time
from pathlib import Path
from types import SimpleNamespace

from report import machine, summary, write_json

import taxelsim
from taxelsim.play import Playground
from taxelsim.play.skins import UNITS

NUM_DRAGS, WARM_UP = 200, 10

ARRAY = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614.yaml")
LARGE = ARRAY.replace(patches=[ARRAY.patches[0].replace(num_rows=32, num_cols=32)])
CASES = {  # sensor, object
    "84 taxels, cylinder": (ARRAY, "cylinder:0.008,0.04"),
    "84 taxels, sphere": (ARRAY, "sphere:0.01"),
    "1,024 taxels, sphere": (LARGE, "sphere:0.01"),
}


def drag(playground: Playground, k: int) -> float:
    """Seconds of one update."""
    pose, done = playground.view.pose, playground.num_views
    position = UNITS * (pose[:3] + [1e-5 * (-1) ** k, 0, 0])
    begun = time.perf_counter()
    playground._drag(0, SimpleNamespace(position=position, wxyz=pose[3:]))
    while playground.num_views == done:
        time.sleep(1e-4)
    return time.perf_counter() - begun


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    device = taxelsim.Device.open()
    results = {}
    for name, (sensor, item) in CASES.items():
        playground = Playground(sensor, [item], device=device)
        while playground.view is None:
            time.sleep(0.01)
        times = [drag(playground, k) for k in range(WARM_UP + NUM_DRAGS)][WARM_UP:]
        assert playground.view.truth.total_force > 0
        playground.close()
        results[name] = summary([1e3 * seconds for seconds in times])
        print(f"{name:40} {results[name]['median']:6.1f} ms, at most {results[name]['max']:.1f} ms", flush=True)
    write_json(options.json, {"machine": machine(device), "unit": "ms", "results": results})


main()

#!/usr/bin/env python3
"""Golden values: what `taxelsim generate` and `taxelsim frame` compute must not change unless a change says so.

    golden.py --program TAXELSIM --compiler "GNU 12.2.0" [--only NAME ...] [--renew]

Compares hashes, not files: the `sha256` attribute of each column of thirteen data sets, and the float32 values of all arrays that `frame --json`
prints in forty-two cases. Hashes hold for one driver, compiler and kind of CPU, which make up the key of hashes.json. With an unknown key, columns
and arrays are compared with the stored values of values.npz instead: integers within 1, floats within FLOAT_TOLERANCE of the largest value of
their column, except for the share SILHOUETTE_SHARE of values, where a sample on an object's silhouette may fall to either side of it
(docs/understand/determinism.md).

--renew stores the present values. Name the columns that changed, and why, in CHANGELOG.md.
"""

import argparse
import concurrent.futures
import hashlib
import json
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

import cases

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
# Float32 sums of up to 84 taxels of 16 samples each, after four transforms: tests/simulation/comparison.h derives 1e-5; servo loops feed differences
# back for up to 12 steps.
FLOAT_TOLERANCE = 2e-4
SILHOUETTE_SHARE = 0.03
# Rows of a column that values.npz stores.
STORED_ROWS = 24
# Jacobians and confidences divide by small differences of sums; only hashes compare them.
ILL_CONDITIONED = ("jacobian", "confidence", "angle", "residual", "iterations", "tilt", "eigenvalues", "second_moments", "contact_type")


def machine_key(program, compiler):
    """Driver, compiler and the vector instructions that the driver and the C library select code by."""
    devices = json.loads(subprocess.run([program, "devices", "--json"], check=True, capture_output=True, text=True).stdout)
    flags = set()
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("flags"):
            flags = set(line.split(":", 1)[1].split())
            break
    vectors = "+".join(name for name in ("fma", "avx2", "avx512f") if name in flags)
    return f"{devices[0]['driver']}, {devices[0]['name']}, {compiler}, {vectors}"


def run(arguments):
    result = subprocess.run([str(argument) for argument in arguments], cwd=ROOT, capture_output=True, text=True)
    if result.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, arguments))}: exit code {result.returncode}: {result.stderr.strip()}")
    return result.stdout


def data_set_columns(program, name, directory):
    """Column -> (hash over the shards' `sha256` attributes, its first rows)."""
    scene = pathlib.Path(directory) / f"{name}.yaml"
    scene.write_text(cases.DATA_SETS[name].replace("scenes/", f"{ROOT}/scenes/"))
    output = pathlib.Path(directory) / name
    run([program, "generate", scene, "-o", output])
    columns = {}
    for shard in sorted(output.glob("shard-*.h5")):
        with h5py.File(shard, "r") as file:
            file.visititems(lambda path, node: columns.setdefault(path, []).append((node.attrs["sha256"].decode(), node[:STORED_ROWS].astype(node.dtype.str)))
                            if isinstance(node, h5py.Dataset) else None)
    return {path: (hashlib.sha256("".join(digest for digest, _ in parts).encode()).hexdigest()[:12], parts[0][1]) for path, parts in columns.items()}


def leaves(node, path=""):
    """Arrays of numbers in nested JSON, by their path."""
    if isinstance(node, dict):
        for key, value in node.items():
            yield from leaves(value, f"{path}/{key}" if path else key)
    elif isinstance(node, list) and any(isinstance(item, dict) for item in node):
        for number, item in enumerate(node):
            yield from leaves(item, f"{path}/{number}")
    elif not isinstance(node, str):
        yield path, node


def frame_arrays(program, name):
    """Array -> (hash of its float32 values, the values)."""
    arguments = cases.FRAMES[name]
    printed = json.loads(run([program, "frame", *arguments, "--json"]))
    arrays = {}
    for path, value in leaves(printed):
        values = np.asarray(value, dtype=np.float32)
        arrays[path] = (hashlib.sha256(values.tobytes()).hexdigest()[:12], values)
    return arrays


def close(path, values, stored):
    """None, or how the values differ from the stored ones."""
    if values.shape != stored.shape:
        return f"shape {values.shape}, stored {stored.shape}"
    if values.dtype.kind == "S":  # text
        return None if np.array_equal(values, stored) else f"{values.tolist()}, stored {stored.tolist()}"
    if any(word in path for word in ILL_CONDITIONED) or values.size == 0:
        return None
    integer = stored.dtype.kind in "iub" or path.endswith(("tactile_image", "taxel_counts"))
    scale = float(np.abs(stored).max()) if stored.size else 0.0
    tolerance = 1 if integer else FLOAT_TOLERANCE * scale
    off = np.abs(values.astype(np.float64) - stored.astype(np.float64)) > tolerance
    if values.size < 1 / SILHOUETTE_SHARE:  # scalars of a frame: the largest sample's share of a sum
        off = np.abs(values.astype(np.float64) - stored.astype(np.float64)) > max(tolerance, SILHOUETTE_SHARE * scale)
        return f"{values.tolist()}, stored {stored.tolist()}" if off.any() else None
    return f"{off.sum()} of {off.size} values differ by more than {tolerance:.3g}" if off.mean() > SILHOUETTE_SHARE else None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--compiler", required=True)
    parser.add_argument("--only", nargs="*", default=None)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--renew", action="store_true")
    arguments = parser.parse_args()
    arguments.program = str(pathlib.Path(arguments.program).resolve())

    key = machine_key(arguments.program, arguments.compiler)
    hashes_file, values_file = HERE / "hashes.json", HERE / "values.npz"
    known = json.loads(hashes_file.read_text()) if hashes_file.exists() else {}
    names = [f"data_set/{name}" for name in cases.DATA_SETS] + [f"frame/{name}" for name in cases.FRAMES]
    if arguments.only:
        names = [name for name in names if name in arguments.only]

    with tempfile.TemporaryDirectory() as directory, concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        def compute(name):
            kind, _, case = name.partition("/")
            return data_set_columns(arguments.program, case, directory) if kind == "data_set" else frame_arrays(arguments.program, case)
        found = dict(zip(names, pool.map(compute, names)))

    hashes = {name: {path: digest for path, (digest, _) in found[name].items()} for name in names}
    num_arrays = sum(len(arrays) for arrays in hashes.values())
    values = {f"{name}:{path}": value for name in names for path, (_, value) in found[name].items()}
    if arguments.renew:
        known.setdefault(key, {}).update(hashes)
        hashes_file.write_text(json.dumps(known, indent=0, sort_keys=True) + "\n")
        stored = dict(np.load(values_file)) if values_file.exists() else {}
        if len(known) == 1:  # the stored values are those of the first key
            stored.update(values)
            np.savez_compressed(values_file, **stored)
        print(f"stored {num_arrays} arrays of {len(names)} cases for: {key}")
        return 0

    faults = []
    if key in known:
        for name in names:
            expected, actual = known[key].get(name, {}), hashes[name]
            faults += [f"{name}:{path}: no longer computed" for path in expected.keys() - actual.keys()]
            faults += [f"{name}:{path}: no golden value stored" for path in actual.keys() - expected.keys()]
            faults += [f"{name}:{path}: values changed" for path in expected.keys() & actual.keys() if expected[path] != actual[path]]
    else:
        with np.load(values_file) as stored:
            for name, value in values.items():
                difference = close(name, value, stored[name]) if name in stored else "no golden value stored"
                if difference:
                    faults.append(f"{name}: {difference}")
    for fault in sorted(faults):
        print(fault)
    print(f"{num_arrays} arrays of {len(names)} cases, {len(faults)} faults; compared by {'hashes' if key in known else 'stored values'}: {key}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())

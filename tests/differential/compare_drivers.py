"""Compares the contacts of several drivers, as test_differential wrote them with TAXELSIM_DIFFERENTIAL_OUT.

    python3 compare_drivers.py FIRST.csv OTHER.csv ...

Prints one line for each other driver: how many contacts have the same bits in all outputs, and the median and the largest difference of the
total force, relative to the larger force. Large differences are of samples on silhouettes: the bounds of the twin hold them.
"""

import csv
import pathlib
import statistics
import sys


def read(file: str) -> dict[tuple[str, str], tuple[str, float]]:
    """Digest of the outputs and total force, N, by model and contact."""
    with pathlib.Path(file).open(newline="") as rows:
        return {(model, contact): (digest, float(force)) for model, contact, digest, force in csv.reader(rows)}


def main() -> None:
    """Compares the first file with each other one."""
    first = read(sys.argv[1])
    for file in sys.argv[2:]:
        other = read(file)
        if other.keys() != first.keys():
            sys.exit(f"{file}: other contacts than in {sys.argv[1]}")
        equal = sum(first[key][0] == other[key][0] for key in first)
        differences = [abs(first[key][1] - other[key][1]) / max(first[key][1], other[key][1], 1e-6) for key in first]
        print(
            f"{pathlib.Path(sys.argv[1]).stem} and {pathlib.Path(file).stem}: {equal} of {len(first)} contacts are equal in all bits; "
            f"total force differs by {statistics.median(differences):.1e} (median), {max(differences):.1e} (largest)"
        )


if __name__ == "__main__":
    main()

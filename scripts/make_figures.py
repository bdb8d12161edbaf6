#!/usr/bin/env python3
"""Draws the figures of docs/understand/validation.md from the tables of docs/notes/validation.md.

make_figures.py    writes docs/images/understand_*.png; needs matplotlib
"""

from pathlib import Path

import matplotlib.pyplot as plt

DOCS = Path(__file__).parents[1] / "docs"
OURS, BASELINE, REAL = "#1e918c", "#b8bcc4", "#2d4b87"


def table(heading, header):
    """Rows of the first table after a heading whose first line begins with `header`; a list of dictionaries."""
    lines = (DOCS / "notes/validation.md").read_text().split(f"{heading}\n", 1)[1].splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith(f"| {header} |"))
    names = [cell.strip() for cell in lines[start].strip("|").split("|")]
    rows = []
    for line in lines[start + 2 :]:
        if not line.startswith("|"):
            return rows
        rows.append(dict(zip(names, (cell.strip() for cell in line.strip("|").split("|")), strict=True)))
    return rows


def percent(text):
    """The number of a cell such as 12.0 %."""
    return float(text.split()[0].rstrip("%"))


def save(figure, name):
    """Writes a figure and closes it."""
    figure.tight_layout()
    figure.savefig(DOCS / f"images/understand_{name}.png", dpi=150)
    plt.close(figure)


def small_contacts():
    """Errors of the force by contact, points and areas."""
    rows = table("## Small contacts", "contact")
    figure, axes = plt.subplots(figsize=(8, 3.6))
    places = range(len(rows))
    for shift, column, colour, label in (
        (-0.2, "point: force, %", BASELINE, "depth at points"),
        (0.2, "area: force, %", OURS, "depth over areas"),
    ):
        values = [max(float(row[column]), 0.02) for row in rows]
        axes.bar([place + shift for place in places], values, 0.4, color=colour, label=label)
    axes.set_yscale("log")
    axes.set_ylabel("largest error of the force, %")
    axes.set_xticks(places, [row["contact"] for row in rows], rotation=40, ha="right", fontsize=7)
    axes.legend(frameon=False)
    save(figure, "small_contacts")


def weights():
    """Sums of forces over the weights of objects at rest."""
    rows = table("## Two-way coupling with MuJoCo", "object")
    objects = list(dict.fromkeys(row["object"] for row in rows))
    kinds = (
        ("MuJoCo, tactile, depth x stiffness", BASELINE, "MuJoCo's tactile sensor"),
        ("MuJoCo, 84 boxes with touch sensors", "#dcc36a", "84 boxes with touch sensors"),
        ("taxelsim, true", OURS, "taxelsim"),
    )
    figure, axes = plt.subplots(figsize=(8, 3.2))
    for index, (simulator, colour, label) in enumerate(kinds):
        found = {row["object"]: float(row["sum, N (m g)"]) for row in rows if row["simulator"] == simulator}
        values = [100 * found[name] / float(name.rsplit("(", 1)[1].rstrip(")")) for name in objects]
        axes.bar([place + 0.27 * (index - 1) for place in range(len(objects))], values, 0.27, color=colour, label=label)
    axes.axhline(100, color="black", linewidth=0.8)
    axes.set_ylim(80, 118)
    axes.set_ylabel("sum of forces, % of the weight")
    axes.set_xticks(range(len(objects)), [name.split(",")[0] for name in objects], fontsize=8)
    axes.legend(frameon=False, ncols=3, fontsize=8, loc="upper left")
    save(figure, "weights")


def recordings():
    """Errors of predicted images of a real matrix."""
    rows = table("## A real matrix, predicted", "prediction, medians")
    rows = sorted((row for row in rows if not row["prediction, medians"].startswith("exact")), key=lambda row: -percent(row["M4, all loads"]))
    figure, axes = plt.subplots(figsize=(8, 3.2))
    for place, row in enumerate(rows):
        name, value = row["prediction, medians"], percent(row["M4, all loads"])
        axes.barh(place, value, color=REAL if "real" in name else OURS if name.startswith("fitted") else BASELINE)
        axes.text(value + 1, place, f"{value:g} %", va="center", fontsize=8)
    axes.set_yticks(range(len(rows)), [row["prediction, medians"] for row in rows], fontsize=8)
    axes.set_xlabel("M4: sum of differences over sum of the image, %")
    axes.set_xlim(0, 112)
    save(figure, "recordings")


if __name__ == "__main__":
    plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    small_contacts()
    weights()
    recordings()

"""docs/images/benchmark_curves.png: success on validation episodes over environment steps."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")
from matplotlib import pyplot as plt

from .page import POLICIES, successes_of
from .recipe import TRAINING_CONDITION

COLORS = {
    "servo": "#444444",
    "clone": "#1b7f5c",
    "ppo": "#1f5fbf",
    "image": "#7a4fbf",
    "center": "#bf9a1f",
    "binary": "#999999",
    "blind": "#c2571a",
}


def draw(results: Mapping[str, Mapping[str, Any]], file: Path) -> None:
    """One panel per task. Lines without points: policies that are not trained by environment steps, on the evaluated episodes."""
    figure, axes = plt.subplots(1, len(results), figsize=(4.6 * len(results), 3.6), sharey=True, squeeze=False, layout="constrained")
    for axis, (task, result) in zip(axes[0], results.items(), strict=True):
        for name, curve in result["curves"].items():
            steps = [point["steps"] / 1e6 for point in curve["points"]]
            axis.plot(steps, [100 * point["success"] for point in curve["points"]], "o-", ms=3, color=COLORS[name], label=POLICIES[name])
        for name in ("servo", "clone"):
            rate = successes_of(result["evaluations"][TRAINING_CONDITION][name]).mean()
            axis.axhline(100 * rate, ls="--" if name == "servo" else ":", color=COLORS[name], label=POLICIES[name])
        axis.set(title=task, xlabel="environment steps, millions", ylim=(0, 100))
        axis.grid(alpha=0.3)
    axes[0][0].set_ylabel(f"success, %, condition {TRAINING_CONDITION}")
    axes[0][0].legend(loc="best", fontsize=8)
    figure.savefig(file, dpi=120, metadata={"Software": None})
    plt.close(figure)

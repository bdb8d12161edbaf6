"""Interrupts the generation of a data set, resumes it, and verifies that every byte is as without the interruption.

A data set consists of shards, and complete shards survive Ctrl-C or a power cut: the same call makes the others. Checksums protect all
bytes. Prints when it stopped, whether the files are the same, and the error message for a damaged byte.

python3 examples/resume_and_verify.py [PICTURE]    needs h5py: pip install 'taxelsim[dataset]'
"""

import contextlib
import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

import taxelsim
from taxelsim.pictures import colour_map, save_figure


def main() -> None:
    scene = taxelsim.load_scene(taxelsim.SCENES / "gripper_grasp.yaml", num_episodes=64)
    folder = Path(tempfile.mkdtemp())

    def generate(name: str, stop: int = 65) -> list[tuple[float, int]]:
        curve = []  # s, and number of episodes in the data set

        def watch(progress: taxelsim.Progress) -> None:
            curve.append((progress.seconds, progress.episodes_done))
            if progress.episodes_done >= stop:
                raise KeyboardInterrupt  # as Ctrl-C does

        with contextlib.suppress(KeyboardInterrupt):
            taxelsim.generate(scene, folder / name, on_progress=watch, batch_size=4)
        return curve

    curves = {"without interruption": generate("whole"), "interrupted": generate("resumed", stop=32), "resumed": generate("resumed")}
    files = sorted(file.name for file in (folder / "whole").iterdir())
    same = all((folder / "whole" / name).read_bytes() == (folder / "resumed" / name).read_bytes() for name in files)
    print(f"interrupted after {curves['interrupted'][-1][1]} of 64 episodes; {len(files)} files {'are the same' if same else 'DIFFER'}")

    shard = folder / "resumed" / "shard-000002.h5"
    data = shard.read_bytes()
    shard.write_bytes(data[:-1] + bytes([data[-1] ^ 1]))  # a damaged bit
    try:
        taxelsim.Dataset(folder / "resumed")["data/left/tactile_image"][:]
    except taxelsim.InputError as error:
        print(f"damaged: {str(error).replace(f'{folder}/', '')}")

    plt.rcParams.update({"font.size": 15, "lines.linewidth": 3, "lines.markersize": 10})
    figure, axes = plt.subplots(figsize=(12, 5), layout="constrained")
    for (label, curve), shade in zip(curves.items(), (0.85, 0.2, 0.5), strict=True):
        axes.plot(*zip(*curve, strict=True), "o-", color=colour_map()(shade), label=label)
    axes.set(xlabel="time since the start of the run (s)", ylabel="episodes in the data set", yticks=range(0, 65, scene.episodes_per_shard))
    axes.grid(axis="y")
    axes.legend(title="grid: complete shards")
    save_figure(sys.argv[1] if len(sys.argv) > 1 else "resume_and_verify.png", figure)


if __name__ == "__main__":
    main()

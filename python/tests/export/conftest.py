"""Fixtures: a small data set with a task, and exports of it."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import taxelsim
from taxelsim.export import Options, export

from ..envs.conftest import write_scene

NUM_EPISODES, NUM_FRAMES = 10, 13  # frames of an episode; 4 episodes per shard


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory, device: taxelsim.Device) -> Path:
    """A data set in which some episodes succeed and others do not."""
    root = tmp_path_factory.mktemp("export")
    file = write_scene(root)
    text = file.read_text().replace("episodes: 24", f"episodes: {NUM_EPISODES}, episodes_per_shard: 4, compression: 1, chunk_bytes: 1024")
    text = text.replace("tolerance_deg: 20", "tolerance_deg: 10")
    file.write_text(text.replace("[tactile_image,", "[tactile_image, features, ground_truth,"))
    taxelsim.generate(file, root / "data", device=device)
    return root / "data"


@pytest.fixture
def copied(folder: Path, tmp_path: Path) -> Path:
    """A data set that a test may damage."""
    return Path(shutil.copytree(folder, tmp_path / "copied"))


@pytest.fixture
def exported(folder: Path, tmp_path: Path) -> Callable[..., Path]:
    """Exports with options to a new folder or file."""

    def run(format_name: str, name: str = "out", **options: object) -> Path:
        export(folder, tmp_path / name, format_name, Options(**options))
        return tmp_path / name

    return run


def files_of(folder: Path) -> dict[str, bytes]:
    """Content of all files by name."""
    return {str(file.relative_to(folder)): file.read_bytes() for file in sorted(folder.rglob("*")) if file.is_file()}


@pytest.fixture(scope="session")
def two_sensors(tmp_path_factory: pytest.TempPathFactory, device: taxelsim.Device) -> Path:
    """Two episodes of a pan-tilt platform that carries two sensors."""
    root = tmp_path_factory.mktemp("two_sensors")
    mounts = ", ".join(f"{{link: tilt, mount: {{position_mm: [{x}, 0, 30]}}}}" for x in (0, 4))
    file = write_scene(
        root, robot=f"{{pan_tilt: {{position_step_deg: 0, sensors: [{mounts}]}}}}", record="tactile_image, poses, actions, robot"
    )
    file.write_text(file.read_text().replace("episodes: 24", "episodes: 2"))
    taxelsim.generate(file, root / "data", device=device)
    return root / "data"

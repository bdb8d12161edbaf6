"""Fixtures: small data sets, one uncompressed and one compressed with chunks of a few frames."""

import shutil
from pathlib import Path

import pytest
from taxelsim._core import DatasetReader

import taxelsim

from ..envs.conftest import write_scene

FORMAT_1 = Path(__file__).resolve().parents[3] / "tests/dataset/data/format_1"


@pytest.fixture(scope="session")
def generated(tmp_path_factory: pytest.TempPathFactory, device: taxelsim.Device) -> dict[str, Path]:
    """Folders by name of the storage: 10 episodes of 13 frames, 4 per shard."""
    root = tmp_path_factory.mktemp("data")
    settings = {"raw": "", "compressed": ", compression: 1, chunk_bytes: 1024"}
    for name, storage in settings.items():
        file = write_scene(root)
        text = file.read_text().replace("episodes: 24", f"episodes: 10, episodes_per_shard: 4{storage}")
        file.write_text(text.replace("[tactile_image,", "[tactile_image, features,"))
        taxelsim.generate(file, root / name, device=device)
    return {name: root / name for name in settings}


@pytest.fixture(params=["raw", "compressed"])
def folder(request: pytest.FixtureRequest, generated: dict[str, Path]) -> Path:
    return generated[request.param]


@pytest.fixture(scope="session")
def raw(generated: dict[str, Path]) -> Path:
    return generated["raw"]


@pytest.fixture
def copied(raw: Path, tmp_path: Path) -> Path:
    """A data set that a test may damage."""
    return Path(shutil.copytree(raw, tmp_path / "copied"))


@pytest.fixture
def compared(monkeypatch):
    """Of each shard that is checked, whether it is compared with its SHA-256."""
    found, check = [], DatasetReader.check_shard
    monkeypatch.setattr(DatasetReader, "check_shard", lambda *call, contents: (found.append(contents), check(*call, contents=contents)))
    return found

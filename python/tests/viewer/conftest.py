"""Fixtures: a data set with everything that the viewer shows, and a reader of recordings."""

from collections import defaultdict
from pathlib import Path

import numpy as np
import pytest

import taxelsim

from ..envs.conftest import write_scene

RECORD = "tactile_image, features, ground_truth, tactile_normal_force, tactile_shear_force, poses, actions"


def write_viewed_scene(folder: Path, *, episodes: int = 4, friction: bool = True, **arguments) -> Path:
    """As write_scene(), with shear."""
    file = write_scene(folder, **{"record": RECORD, **arguments})
    text = file.read_text().replace("episodes: 24", f"episodes: {episodes}")
    if friction:
        sensor = folder / "rubber.yaml"
        named = (taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").read_text()
        sensor.write_text(
            named.replace("  normal_exponent: 1 ", "  friction_coefficient: 0.5\n  tangential_stiffness: 1e8\n  normal_exponent: 1 ")
        )
        text = text.replace(str((taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").resolve()), str(sensor))
    file.write_text(text)
    return file


@pytest.fixture(scope="session")
def viewed_scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_viewed_scene(tmp_path_factory.mktemp("viewed"))


@pytest.fixture(scope="session")
def viewed(viewed_scene: Path, device: taxelsim.Device) -> Path:
    """A data set of 4 episodes of 13 frames."""
    taxelsim.generate(viewed_scene, viewed_scene.parent / "data", device=device)
    return viewed_scene.parent / "data"


class Recorded:
    """Columns of a recording by entity and component."""

    def __init__(self, file: Path) -> None:
        chunk = pytest.importorskip("rerun.chunk", reason="rerun-sdk as in python/requirements/test.txt")
        self.reader = chunk.RrdReader(file)
        self.static: dict[tuple[str, str], object] = {}
        self.columns: dict[tuple[str, str], list[object]] = defaultdict(list)
        for part in self.reader.stream() if self.reader.recordings() else ():  # a file may have a layout only
            batch = part.to_record_batch()
            for name in set(batch.schema.names) - {"rerun.controls.RowId"}:
                key = (part.entity_path.lstrip("/"), name)
                values = batch.column(name).to_pylist()
                if part.is_static:
                    self.static[key] = values[-1]
                else:
                    self.columns[key] += values

    def __getitem__(self, key: tuple[str, str]) -> np.ndarray:
        """Values of all frames, or of the static component."""
        return np.array(self.static[key] if key in self.static else self.columns[key])

    @property
    def entities(self) -> set[str]:
        return {entity for entity, _ in [*self.static, *self.columns]}


@pytest.fixture
def recorded(tmp_path):
    """Records what taxelsim.view() gives, as Recorded."""

    def record(*arguments, **options) -> Recorded:
        file = tmp_path / "recorded.rrd"
        file.write_bytes(taxelsim.view(*arguments, **options).memory_recording().drain_as_bytes())
        return Recorded(file)

    return record

"""The tactile image as a video of a LeRobot data set."""

import json
import sys

import numpy as np
import pytest

import taxelsim
from taxelsim.export import Options, export, lerobot
from taxelsim.pictures import TACTILE_IMAGE, range_of, tactile_pictures

from ..test_video import TOLERANCE, read
from .conftest import NUM_EPISODES, NUM_FRAMES, files_of

pq = pytest.importorskip("pyarrow.parquet")

KEY = "observation.images.tactile"
EPISODES_PER_FILE = 4
ROUNDING = 1e-12  # of sums of 1e5 numbers between 0 and 1 in another order


@pytest.fixture
def small_files(monkeypatch):
    monkeypatch.setattr(lerobot, "BLOCK_FRAMES", EPISODES_PER_FILE * NUM_FRAMES)
    monkeypatch.setattr(lerobot, "FILE_BYTES", 1)


@pytest.fixture
def expected(folder) -> np.ndarray:
    """(episodes, frames, height, width, 3)."""
    data, sensor = taxelsim.Dataset(folder), taxelsim.load_scene(folder.parent / "short.yaml").sensor
    found = tactile_pictures(sensor, data[TACTILE_IMAGE][:], range_of(data, TACTILE_IMAGE))
    return found.reshape(NUM_EPISODES, NUM_FRAMES, *found.shape[1:])


def test_a_video_per_file_has_the_pictures_of_its_episodes(exported, small_files, expected):
    root = exported("lerobot", video=True)
    info = json.loads((root / "meta/info.json").read_text())
    feature = info["features"][KEY]
    assert (feature["dtype"], feature["shape"], feature["info"]["video.fps"]) == ("video", list(expected.shape[2:]), 100)
    rows = [row for file in sorted((root / "meta/episodes").rglob("*.parquet")) for row in pq.read_table(file).to_pylist()]
    assert len(rows) == NUM_EPISODES
    assert KEY not in pq.read_schema(root / "data/chunk-000/file-000.parquet").names
    for number, row in enumerate(rows):
        place = {name: row[f"videos/{KEY}/{name}"] for name in ("chunk_index", "file_index", "from_timestamp", "to_timestamp")}
        assert (place["chunk_index"], place["file_index"]) == (0, number // EPISODES_PER_FILE)
        frames, times = read(root / info["video_path"].format(video_key=KEY, chunk_index=0, file_index=place["file_index"]))
        first = number % EPISODES_PER_FILE * NUM_FRAMES
        times = np.array(times[first : first + NUM_FRAMES + 1])
        np.testing.assert_allclose(times, np.linspace(place["from_timestamp"], place["to_timestamp"], NUM_FRAMES + 1), atol=1e-4)
        assert times[0] == pytest.approx(first / 100)
        for found, picture in zip(frames[first : first + NUM_FRAMES], expected[number], strict=True):
            assert np.abs(found.astype(int) - picture).mean() < TOLERANCE


def test_statistics_are_those_of_the_pixels(exported, small_files, expected):
    root = exported("lerobot", video=True)
    rows = [row for file in sorted((root / "meta/episodes").rglob("*.parquet")) for row in pq.read_table(file).to_pylist()]
    for row, episode in zip(rows, expected, strict=True):
        pixels = episode.reshape(-1, 3) / 255
        measures = {"min": pixels.min(0), "max": pixels.max(0), "mean": pixels.mean(0), "std": pixels.std(0)}
        measures |= {f"q{k:02}": np.quantile(pixels, k / 100, axis=0, method="inverted_cdf") for k in (1, 10, 50, 90, 99)}
        for name, values in measures.items():
            np.testing.assert_allclose(row[f"stats/{KEY}/{name}"], values[:, None, None], atol=ROUNDING)
        assert row[f"stats/{KEY}/count"] == [NUM_FRAMES]
    total = json.loads((root / "meta/stats.json").read_text())[KEY]
    for name, values in {"mean": expected.mean((0, 1, 2, 3)), "max": expected.max((0, 1, 2, 3)), "std": expected.std((0, 1, 2, 3))}.items():
        np.testing.assert_allclose(total[name], values[:, None, None] / 255, atol=ROUNDING)
    assert total["count"] == [NUM_EPISODES * NUM_FRAMES]


def test_interrupted_exports_continue_to_the_same_bytes(folder, tmp_path, exported, small_files):
    def stop(done: int, total: int) -> None:
        if done > 6 * NUM_FRAMES:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        export(folder, tmp_path / "out", "lerobot", Options(video=True), stop)
    kept = tmp_path / "out.incomplete/videos" / KEY / "chunk-000/file-000.mp4"
    time = kept.stat().st_mtime_ns
    export(folder, tmp_path / "out", "lerobot", Options(video=True))
    assert (tmp_path / "out/videos" / KEY / "chunk-000/file-000.mp4").stat().st_mtime_ns == time
    assert files_of(tmp_path / "out") == files_of(exported("lerobot", "whole", video=True))


def test_several_sensors_have_a_video_each(two_sensors, tmp_path):
    export(two_sensors, tmp_path / "out", "lerobot", Options(video=True))
    files = [tmp_path / f"out/videos/{KEY}_{sensor}/chunk-000/file-000.mp4" for sensor in range(2)]
    counts = [len(read(file)[0]) for file in files]
    assert counts == [taxelsim.Dataset(two_sensors).num_frames] * 2
    assert files[0].read_bytes() != files[1].read_bytes()


def test_a_missing_encoder_and_other_formats_are_refused(folder, tmp_path, monkeypatch):
    with pytest.raises(taxelsim.InputError, match="video: not an option of format zarr"):
        export(folder, tmp_path / "out", "zarr", Options(video=True))
    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(ImportError, match=r"format lerobot needs the package av: pip install 'taxelsim\[export\]'"):
        export(folder, tmp_path / "out", "lerobot", Options(video=True))
    assert not list(tmp_path.iterdir())

"""LeRobotDataset: the layout that its reader expects, with the numbers of the data set."""

import json

import numpy as np
import pytest

import taxelsim
from taxelsim.export import Options, export, statistics

from .conftest import NUM_EPISODES, NUM_FRAMES, files_of

pq = pytest.importorskip("pyarrow.parquet")
lerobot = pytest.importorskip("taxelsim.export.lerobot")

ROUNDING = 1e-6  # relative, of float32 numbers whose statistics NumPy computes in another order


def table_of(root, name):
    return {key: np.array(values) for key, values in pq.read_table(root / name).to_pydict().items()}


def test_frames_are_those_of_the_data_set(folder, exported):
    data = taxelsim.Dataset(folder)
    frames = table_of(exported("lerobot"), "data/chunk-000/file-000.parquet")
    np.testing.assert_array_equal(frames["observation.tactile"], data["data/tactile_image"][:].reshape(len(frames["index"]), -1))
    np.testing.assert_array_equal(frames["observation.state"], data["data/sensor_pose"][:].astype(np.float32))
    np.testing.assert_array_equal(frames["action"], data["data/action"][:])
    np.testing.assert_array_equal(frames["timestamp"], data["data/time"][:].astype(np.float32))
    np.testing.assert_array_equal(frames["index"], np.arange(NUM_EPISODES * NUM_FRAMES))
    np.testing.assert_array_equal(frames["episode_index"], np.repeat(np.arange(NUM_EPISODES), NUM_FRAMES))
    np.testing.assert_array_equal(frames["frame_index"], np.tile(np.arange(NUM_FRAMES), NUM_EPISODES))


def test_success_is_a_flag_of_the_last_frame(folder, exported):
    success = taxelsim.Dataset(folder)["meta/success"][:]
    assert 0 < success.sum() < NUM_EPISODES
    frames = table_of(exported("lerobot"), "data/chunk-000/file-000.parquet")
    last = frames["frame_index"] == NUM_FRAMES - 1
    np.testing.assert_array_equal(frames["next.done"], last)
    np.testing.assert_array_equal(frames["next.success"][last], success == 1)
    assert not frames["next.success"][~last].any()
    np.testing.assert_array_equal(frames["next.reward"], frames["next.success"])


def test_episodes_have_places_tasks_and_statistics(folder, exported):
    root = exported("lerobot", task="press the {object} of {scene}")
    episodes = pq.read_table(root / "meta/episodes/chunk-000/file-000.parquet").to_pydict()
    assert episodes["dataset_to_index"] == [NUM_FRAMES * (k + 1) for k in range(NUM_EPISODES)]
    assert episodes["dataset_from_index"] == [NUM_FRAMES * k for k in range(NUM_EPISODES)]
    assert episodes["tasks"] == [["press the bar of short"]] * NUM_EPISODES
    images = taxelsim.Dataset(folder)["data/tactile_image"][:].reshape(NUM_EPISODES, NUM_FRAMES, -1).astype(np.float64)
    for measure, values in {"min": images.min(1), "max": images.max(1), "mean": images.mean(1), "std": images.std(1)}.items():
        np.testing.assert_allclose(episodes[f"stats/observation.tactile/{measure}"], values, rtol=ROUNDING)
    total = json.loads((root / "meta/stats.json").read_text())["observation.tactile"]
    for measure, values in {
        "min": images.min((0, 1)),
        "max": images.max((0, 1)),
        "mean": images.mean((0, 1)),
        "std": images.std((0, 1)),
    }.items():
        np.testing.assert_allclose(total[measure], values, rtol=ROUNDING)
    assert total["count"] == [NUM_EPISODES * NUM_FRAMES]
    for measure, part in {"q01": 0.01, "q50": 0.5, "q99": 0.99}.items():
        quantiles = np.quantile(images, part, axis=1)
        np.testing.assert_allclose(episodes[f"stats/observation.tactile/{measure}"], quantiles, rtol=ROUNDING)
        np.testing.assert_allclose(total[measure], quantiles.mean(0), rtol=ROUNDING)


def test_statistics_of_episodes_of_different_lengths():
    values = np.random.default_rng(1).normal(size=(40, 3)).astype(np.float32)
    ends = np.array([1, 8, 23, 30, 40])
    found, total = statistics.of_episodes(values, ends), statistics.Total()
    for part in (slice(0, 2), slice(2, 5)):  # two files
        total.add({name: numbers[part] for name, numbers in found.items()})
    for episode, (first, end) in enumerate(zip([0, *ends[:-1]], ends, strict=True)):
        frames = values[first:end].astype(np.float64)
        expected = {"min": frames.min(0), "max": frames.max(0), "mean": frames.mean(0), "std": frames.std(0), "count": [end - first]}
        expected |= {name: np.quantile(frames, part, axis=0) for name, part in statistics.QUANTILES.items()}
        for name, numbers in expected.items():
            np.testing.assert_allclose(found[name][episode], numbers, atol=ROUNDING)
    np.testing.assert_allclose(total.result()["std"], values.std(0), rtol=ROUNDING)
    np.testing.assert_allclose(total.result()["mean"], values.mean(0), rtol=ROUNDING)


def test_tasks_are_the_index_of_a_pandas_table(exported):
    table = pq.read_table(exported("lerobot") / "meta/tasks.parquet")
    assert table.to_pydict() == {"task_index": [0], "__index_level_0__": ["short: bar"]}
    assert json.loads(table.schema.metadata[b"pandas"])["index_columns"] == ["__index_level_0__"]


def test_features_name_every_number(exported):
    root = exported("lerobot", columns=("data/total_force", "data/ground_truth/contact_wrench"), tactile_in_state=True)
    info = json.loads((root / "meta/info.json").read_text())
    features = info["features"]
    assert features["observation.tactile"]["names"][:15] == [*(f"r0_c{k}" for k in range(14)), "r1_c0"]
    assert features["observation.state"]["shape"] == [7 + 84]
    assert features["observation.state"]["names"][:8] == ["x", "y", "z", "qw", "qx", "qy", "qz", "r0_c0"]
    assert features["action"]["names"] == ["v_x", "v_y", "v_z", "w_x", "w_y", "w_z"]
    assert features["observation.ground_truth.contact_wrench"]["names"] == ["f_x", "f_y", "f_z", "t_x", "t_y", "t_z"]
    assert features["observation.total_force"]["shape"] == [1]
    assert (info["codebase_version"], info["fps"], info["total_episodes"]) == ("v3.0", 100, NUM_EPISODES)
    schema = pq.read_schema(root / "data/chunk-000/file-000.parquet")
    assert schema.names == list(features)
    for name, feature in features.items():
        size = feature["shape"][0]
        assert (
            str(schema.field(name).type) == {"float32": "float", "int64": "int64", "bool": "bool"}[feature["dtype"]] if size == 1 else size
        )


def test_the_tactile_image_has_the_chosen_name(exported):
    features = json.loads((exported("lerobot", tactile_key="observation.environment_state") / "meta/info.json").read_text())["features"]
    assert features["observation.environment_state"]["shape"] == [84]
    assert "observation.tactile" not in features


def test_chosen_episodes_count_from_zero(folder, exported):
    root = exported("lerobot", episodes=(3, 4))
    frames = table_of(root, "data/chunk-000/file-000.parquet")
    np.testing.assert_array_equal(frames["episode_index"], np.repeat([0, 1], NUM_FRAMES))
    expected = taxelsim.Dataset(folder)["data/action"][3 * NUM_FRAMES : 5 * NUM_FRAMES]
    np.testing.assert_array_equal(frames["action"], expected)


def test_an_interrupted_export_continues_to_the_same_bytes(folder, exported, tmp_path, monkeypatch):
    monkeypatch.setattr(lerobot, "FILE_BYTES", 1)
    monkeypatch.setattr(lerobot, "BLOCK_FRAMES", 3 * NUM_FRAMES)
    whole = files_of(exported("lerobot", "whole"))
    assert sum(name.startswith("data/") for name in whole) == 4
    calls = []

    def stop(done, total):
        calls.append(done)
        if done > 6 * NUM_FRAMES:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        export(folder, tmp_path / "resumed", "lerobot", on_progress=stop)
    assert not (tmp_path / "resumed").exists()
    staged = tmp_path / "resumed.incomplete"
    kept = staged / "data/chunk-000/file-001.parquet"
    assert kept.exists()
    assert not (staged / "data/chunk-000/file-002.parquet").exists()
    stamp = kept.stat().st_mtime_ns
    export(folder, tmp_path / "resumed", "lerobot")
    assert (tmp_path / "resumed/data/chunk-000/file-001.parquet").stat().st_mtime_ns == stamp
    assert files_of(tmp_path / "resumed") == whole
    assert not staged.exists()


def test_tasks_need_a_constant_frame_rate(folder, tmp_path, monkeypatch):
    frames = taxelsim.Dataset.frames

    def late(self, indices, columns):
        values = frames(self, indices, columns)
        if len(values["data/time"]) > 2:
            values["data/time"][5] += 0.001
        return values

    monkeypatch.setattr(taxelsim.Dataset, "frames", late)
    with pytest.raises(taxelsim.InputError, match=r"data/time: 0\.051.* s found in frame 5, 0\.05 s expected at 100 frames/s"):
        export(folder, tmp_path / "out", "lerobot", Options())

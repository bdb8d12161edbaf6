"""LeRobot: windows of touch at the rate of the data set, taxels as points, wrenches, and the way back to measurements."""

import json

import numpy as np
import pytest

import taxelsim
from taxelsim.export import Options, export
from taxelsim.recordings import Measurement, read_lerobot, write_measurement

from .conftest import NUM_EPISODES, NUM_FRAMES, files_of
from .test_lerobot import table_of

pytest.importorskip("pyarrow")

RATE, WINDOW = 25, 4  # frames/s of the export; 100 of the data set, 13 frames an episode: three windows, and one frame that no window has
WINDOWS = NUM_FRAMES // WINDOW
SENSOR = taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml"
FRAMES = "data/chunk-000/file-000.parquet"


def in_windows(values):
    """(frames of the export, WINDOW, ...) of a column of the data set."""
    episodes = values.reshape(NUM_EPISODES, NUM_FRAMES, *values.shape[1:])[:, : WINDOWS * WINDOW]
    return episodes.reshape(NUM_EPISODES * WINDOWS, WINDOW, *values.shape[1:])


def test_a_frame_has_the_frames_of_the_data_set_up_to_it(folder, exported):
    data, root = taxelsim.Dataset(folder), exported("lerobot", frame_rate=RATE, wrench=True)
    frames = table_of(root, FRAMES)
    images = in_windows(data["data/tactile_image"][:].reshape(-1, 84))
    np.testing.assert_array_equal(frames["observation.tactile_window"], images)
    np.testing.assert_array_equal(frames["observation.tactile"], images[:, -1])
    np.testing.assert_array_equal(frames["observation.window_time"], in_windows(data["data/time"][:].astype(np.float32)))
    np.testing.assert_array_equal(frames["observation.wrench_window"], in_windows(data["data/ground_truth/contact_wrench"][:]))
    np.testing.assert_array_equal(frames["observation.state"], in_windows(data["data/sensor_pose"][:].astype(np.float32))[:, -1])
    np.testing.assert_array_equal(frames["timestamp"], np.tile(np.float32(np.arange(WINDOWS) / RATE), NUM_EPISODES))
    np.testing.assert_array_equal(frames["episode_index"], np.repeat(np.arange(NUM_EPISODES), WINDOWS))
    np.testing.assert_array_equal(frames["next.done"], frames["frame_index"] == WINDOWS - 1)
    info = json.loads((root / "meta/info.json").read_text())
    assert (info["fps"], info["total_frames"]) == (RATE, NUM_EPISODES * WINDOWS)
    assert info["features"]["observation.tactile_window"]["shape"] == [WINDOW, 84]
    stats = json.loads((root / "meta/stats.json").read_text())["observation.tactile_window"]
    np.testing.assert_allclose(stats["mean"], images.mean(0), rtol=1e-6)


def test_what_was_exported_is_stated(folder, exported):
    about = json.loads((exported("lerobot", frame_rate=RATE, layout="points") / "meta/taxelsim.json").read_text())
    windows = ["observation.tactile_window", "observation.window_time"]
    assert about["windows"] == {"features": windows, "frames": WINDOW, "rate": 100, "left_out": NUM_EPISODES}
    assert about["points"]["version"] == 1
    assert about["units"]["observation.tactile_window"] == "counts"
    met = int(taxelsim.Dataset(folder)["meta/success"][:].sum())
    assert about["success"] == {"episodes": NUM_EPISODES, "successes": met, "rate": met / NUM_EPISODES}


def test_points_have_place_normal_and_force(folder, exported):
    """Their forces add up to the total force, which the program computes from the same counts."""
    data = taxelsim.Dataset(folder)
    points = table_of(exported("lerobot", layout="points"), FRAMES)["observation.tactile_points"]
    assert points.shape == (data.num_frames, 84, 7)
    sensor = taxelsim.load_sensor(SENSOR)
    np.testing.assert_array_equal(points[0, :, :3], sensor.taxel_positions.astype(np.float32))
    np.testing.assert_array_equal(points[-1, :, 3:6], sensor.taxel_normals.astype(np.float32))
    np.testing.assert_allclose(points[..., 6].sum(1), data["data/total_force"][:], rtol=1e-5)


def test_each_of_several_sensors_has_its_windows(tmp_path, device):
    taxelsim.generate(taxelsim.SCENES / "gripper_grasp.yaml", tmp_path / "data", episodes=range(1), device=device)
    export(tmp_path / "data", tmp_path / "out", "lerobot", Options(frame_rate=10, layout="points", wrench=True))
    frames, data = table_of(tmp_path / "out", FRAMES), taxelsim.Dataset(tmp_path / "data")
    for name in ("left", "right", "below"):
        images = data[f"data/{name}/tactile_image"][:].reshape(15, 10, -1)
        np.testing.assert_array_equal(frames[f"observation.tactile_window.{name}"], images)
        np.testing.assert_array_equal(frames[f"observation.wrench.{name}"], data[f"data/{name}/ground_truth/contact_wrench"][9::10])
        assert frames[f"observation.tactile_points.{name}"].shape == (15, images.shape[2], 7)


def test_an_interrupted_export_of_windows_continues_to_the_same_bytes(folder, exported, tmp_path, monkeypatch):
    lerobot = pytest.importorskip("taxelsim.export.lerobot")
    monkeypatch.setattr(lerobot, "BLOCK_FRAMES", 2 * WINDOW * WINDOWS)
    monkeypatch.setattr(lerobot, "FILE_BYTES", 1)
    whole = files_of(exported("lerobot", "whole", frame_rate=RATE))
    assert f"data/chunk-000/file-{NUM_EPISODES * WINDOWS // (2 * WINDOW * WINDOWS):03d}.parquet" in whole

    def stop(done, total):
        assert total == NUM_EPISODES * WINDOWS
        if done > 12:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        export(folder, tmp_path / "resumed", "lerobot", Options(frame_rate=RATE), stop)
    export(folder, tmp_path / "resumed", "lerobot", Options(frame_rate=RATE))
    assert files_of(tmp_path / "resumed") == whole


def test_pictures_have_the_rate_of_the_frames(exported):
    av = pytest.importorskip("av")
    root = exported("lerobot", frame_rate=RATE, video=True)
    with av.open(str(root / "videos/observation.images.tactile/chunk-000/file-000.mp4")) as film:
        assert (film.streams.video[0].average_rate, sum(1 for _ in film.decode(video=0))) == (RATE, NUM_EPISODES * WINDOWS)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"frame_rate": 30}, r"frame_rate: 30 is not allowed: 100 frames/s of the data set by an integer, such as 50, 25, 20, 10"),
        ({"frame_rate": 200}, "frame_rate: 200 is not allowed"),
        ({"frame_rate": np.nan}, "frame_rate: nan is not allowed"),
        ({"frame_rate": 5}, "episode 0 has less than the 20 frames of a window"),
        ({"layout": "cloud"}, "layout: 'cloud' is not allowed: image, points"),
    ],
)
def test_wrong_options(folder, tmp_path, options, message):
    with pytest.raises(taxelsim.InputError, match=message):
        export(folder, tmp_path / "out", "lerobot", Options(**options))
    assert not list(tmp_path.iterdir())


def test_sensors_without_a_wrench_or_points(two_sensors, tmp_path):
    with pytest.raises(taxelsim.InputError, match="wrench: no column data/ground_truth/contact_wrench: record ground_truth"):
        export(two_sensors, tmp_path / "out", "lerobot", Options(wrench=True))
    with pytest.raises(taxelsim.InputError, match="layout: points is not allowed: several sensors share the column"):
        export(two_sensors, tmp_path / "out", "lerobot", Options(layout="points"))


def test_windows_come_back_at_the_rate_of_touch(folder, exported, tmp_path):
    """Each frame of a window is a row again; its unit and that of its time are those of the export."""
    root = exported("lerobot", frame_rate=RATE)
    names = ("observation.tactile_window", "observation.window_time")
    what = Measurement("images", SENSOR, "observation.tactile_window.r{row}_c{col}", time="observation.window_time")
    table = write_measurement(read_lerobot(root, 3, names), what, tmp_path / "out.yaml")
    rows, data = np.loadtxt(table, delimiter=",", skiprows=1), taxelsim.Dataset(folder).episode(3)
    np.testing.assert_allclose(rows[:, 0], data["data/time"][: WINDOWS * WINDOW], rtol=1e-6)
    np.testing.assert_array_equal(rows[:, 1:], data["data/tactile_image"][: WINDOWS * WINDOW].reshape(-1, 84))
    with pytest.raises(taxelsim.InputError, match=r"no feature 'observation\.touch'; it has"):
        read_lerobot(root, 3, ("observation.touch",))
    with pytest.raises(taxelsim.InputError, match=r"windows: \{.*\} is not allowed: one length"):
        read_lerobot(root, 3, (*names, "observation.state"))

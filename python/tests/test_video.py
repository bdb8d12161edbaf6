"""Videos: pictures written as MP4 and GIF, read back; and `taxelsim render` of an episode."""

import io
import subprocess
import sys
from pathlib import Path

import av
import numpy as np
import pytest
from taxelsim._pictures import EpisodePictures

import taxelsim
from taxelsim.commands.render import main
from taxelsim.pictures import range_of
from taxelsim.video import grid_of, mp4_encoder, save_video

from .envs.conftest import write_scene

# Of a grey level. Both formats quantize: x264 at this quality by a few levels, a palette of 256 colours by less.
TOLERANCE = 6
EPISODE, NUM_FRAMES = 2, 13


def read(file: Path) -> tuple[list[np.ndarray], list[float]]:
    """Pictures, and the times in s at which each begins and the last one ends."""
    with av.open(file) as container:
        frames = list(container.decode(video=0))
        times = [float(frame.time) for frame in frames]
        return [frame.to_ndarray(format="rgb24") for frame in frames], [*times, container.duration / av.time_base]


def steps(count: int) -> list[np.ndarray]:
    """Grey pictures of 31 x 20 pixels with a white square that moves by 4 pixels."""
    pictures = [np.full((31, 20, 3), 40 * k, np.uint8) for k in range(count)]
    for k, picture in enumerate(pictures):
        picture[8:16, 4 * k : 4 * k + 4] = 255
    return pictures


@pytest.mark.parametrize("suffix", [".mp4", ".gif"])
@pytest.mark.parametrize("rate", [20, 12.5])
def test_pictures_and_times_are_kept(tmp_path, suffix, rate):
    pictures = steps(5)
    assert save_video(tmp_path / f"a{suffix}", iter(pictures), rate) == 5
    found, times = read(tmp_path / f"a{suffix}")
    assert np.allclose(times, np.arange(6) / rate, rtol=0, atol=1e-4)
    assert len(found) == 5
    for expected, picture in zip(pictures, found, strict=True):
        assert picture.shape == ((32, 20, 3) if suffix == ".mp4" else (31, 20, 3))
        assert np.abs(picture[:31].astype(int) - expected).mean() < TOLERANCE
    assert [path.name for path in tmp_path.iterdir()] == [f"a{suffix}"]


def test_the_same_pictures_give_the_same_bytes():
    """With x264's lookahead about 1 file in 100 had other bytes if other memory was used between its pictures."""
    random = np.random.default_rng(0)
    pictures = random.integers(0, 256, (26, 6, 14, 3)).astype(np.uint8).repeat(12, 1).repeat(12, 2)
    contents = set()
    for _ in range(300):
        content, memory = io.BytesIO(), []
        with mp4_encoder(content, 100, {"crf": "18", "preset": "veryfast", "g": "2", "bf": "0", "threads": "1"}) as add:
            for picture in pictures:
                memory = [*memory[-4:], np.full(random.integers(1, 60_000), random.integers(256), np.uint8)]
                add(picture)
        contents.add(content.getvalue())
    assert len(contents) == 1


@pytest.mark.parametrize(
    ("name", "pictures", "rate", "message"),
    [
        ("a.avi", steps(2), 10, "must end in .mp4 or .gif"),
        ("a.mp4", [], 10, "no picture found"),
        ("a.gif", [], 10, "no picture found"),
        ("a.mp4", [np.zeros((4, 4), np.uint8)], 10, r"picture 0: \(4, 4\) of uint8 is not allowed: \(height, width, 3\) of uint8"),
        ("a.gif", [*steps(1), np.zeros((4, 4, 3), np.uint8)], 10, r"picture 1: shape \(4, 4, 3\) is not allowed: \(31, 20, 3\)"),
        ("a.gif", steps(2), 101, "101 pictures per second are not allowed: at least 0.01 and at most 100"),
        ("a.mp4", steps(2), float("nan"), "rate: nan pictures"),
        ("a.mp4", steps(2), 0.009, "rate: 0.009 pictures"),
    ],
)
def test_bad_input_is_refused_and_leaves_no_file(tmp_path, name, pictures, rate, message):
    with pytest.raises(taxelsim.InputError, match=message):
        save_video(tmp_path / name, pictures, rate)
    assert list(tmp_path.iterdir()) == []


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory, device: taxelsim.Device) -> Path:
    """Episodes of 13 frames, 0.01 s apart."""
    root = tmp_path_factory.mktemp("video")
    taxelsim.generate(write_scene(root), root / "data", device=device, episodes=range(3))
    return root / "data"


def run(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "taxelsim", "render", *map(str, arguments)], capture_output=True, text=True)


@pytest.mark.parametrize(("suffix", "speed", "num_pictures"), [(".mp4", 1, 7), (".mp4", 0.5, 13), (".gif", 0.25, 13), (".gif", 1, 4)])
def test_render_writes_a_video_of_an_episode(data, tmp_path, suffix, speed, num_pictures):
    step = float(np.diff(taxelsim.Dataset(data).episode(EPISODE)["data/time"])[0])
    done = run(data, "-o", tmp_path / f"a{suffix}", "--episode", EPISODE, "--speed", speed)
    assert done.returncode == 0, done.stderr
    pictures, times = read(tmp_path / f"a{suffix}")
    assert len(pictures) == num_pictures
    stride = -(-NUM_FRAMES // num_pictures)
    assert np.allclose(np.diff(times), stride * step / speed, rtol=0, atol=0.005)
    # The pictures that are drawn, with sides of even numbers.
    drawn = EpisodePictures(str(data), EPISODE)
    assert drawn.times()[::stride][1] == stride * step
    for picture, frame in zip(pictures, range(0, NUM_FRAMES, stride), strict=True):
        expected = drawn.draw(frame)
        height, width, _ = expected.shape
        assert np.abs(picture[:height, :width].astype(int) - expected).mean() < TOLERANCE
    assert any((picture != pictures[0]).any() for picture in pictures[1:])


def test_a_video_shows_the_object_where_its_pose_and_features_are_recorded(data, tmp_path, device):
    scene = write_scene(tmp_path, record="tactile_image, features, poses")
    taxelsim.generate(scene, tmp_path / "data", device=device, episodes=range(1))
    pictures = EpisodePictures(str(tmp_path / "data"), 0)
    assert pictures.without_view == ""
    assert pictures.draw(0).shape == (768, 900, 3)
    assert (pictures.draw(0) != pictures.draw(1)).any()
    plain = EpisodePictures(str(data), EPISODE)
    assert plain.without_view.startswith(f"{data}: no column data/total_force")
    done = run(data, "-o", tmp_path / "a.gif", "--episode", EPISODE)
    assert done.returncode == 0
    assert f"shows the tactile image alone: {plain.without_view}" in done.stderr


def test_a_grid_has_pictures_by_rows_and_white_cells():
    pictures = [np.full((4, 6, 3), 40 * k, np.uint8) for k in range(5)]
    grid = grid_of(pictures, 18)
    assert grid.shape == (8, 18, 3)
    assert grid[::4, ::6, 0].tolist() == [[0, 40, 80], [120, 160, 255]]
    pictures[0][0, 0] = 100  # the mean of four pixels
    small = grid_of(pictures, 17)
    assert small.shape == (4, 9, 3)
    assert small[0, 0].tolist() == [25, 25, 25]
    np.testing.assert_array_equal(grid_of(pictures[:1], 6), pictures[0])


def test_render_draws_all_sensors_of_a_hand_with_one_scale_from_a_data_set_or_a_scene(tmp_path, device):
    scene = taxelsim.SCENES / "gripper_grasp.yaml"
    taxelsim.generate(scene, tmp_path / "data", device=device, episodes=[1])
    for source, file in ((tmp_path / "data", "data.gif"), (scene, "scene.gif")):
        done = run(source, "-o", tmp_path / file, "--episode", 1, "--speed", 8)
        assert done.returncode == 0, done.stderr
        assert done.stderr == ""
    assert (tmp_path / "data.gif").read_bytes() == (tmp_path / "scene.gif").read_bytes()
    last = read(tmp_path / "data.gif")[0][-1]
    assert last.shape == (2 * 768, 2 * 900, 3)
    parts = [taxelsim.Dataset(tmp_path / "data", sensor=name) for name in ("left", "right", "below")]
    brightest = max(range_of(part, "data/tactile_image") for part in parts)
    for place, name in (((0, 0), "left"), ((0, 900), "right"), ((768, 0), "below")):
        common, own = (EpisodePictures(str(tmp_path / "data"), 1, scale, [str(taxelsim.SCENES)], name) for scale in (brightest, 0.0))
        frame = range(0, len(common.times()), 32)[-1]  # 8 times as fast: every 32nd frame is shown for 1 / 25 s
        cell = last[place[0] : place[0] + 768, place[1] : place[1] + 900].astype(int)
        errors = [np.abs(cell - pictures.draw(frame)) for pictures in (common, own)]
        assert errors[0].mean() < TOLERANCE
        assert errors[1].sum() > 2 * errors[0].sum() or name == "right"  # which has the largest counts
    assert (last[768:, 900:] == 255).all()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["{tmp}", "-o", "{tmp}/a.mp4", "--episode", "0"], "{tmp}"),
        (["{data}", "-o", "{tmp}/a.mp4", "--episode", "0", "--sensor", "thumb"], "--sensor: its columns are not grouped by sensor"),
        (["{data}", "-o", "{tmp}/a.mp4", "--episode", "3"], "--episode 3: {data} has episodes 0 to 2"),
        (["{tmp}/none", "-o", "{tmp}/a.gif", "--episode", "0"], "none"),
        (["{data}", "-o", "{tmp}/a.gif", "--episode", "0", "--speed", "0"], "--speed: 0.0 is not allowed"),
        (["{data}", "-o", "{tmp}/a.gif", "--episode", "0", "--speed", "1e-9"], "at least 0.01"),
        (["{data}", "-o", "{tmp}/a.gif"], "--episode"),
    ],
)
def test_render_refuses_in_one_line(data, tmp_path, arguments, message):
    done = run(*(argument.format(data=data, tmp=tmp_path) for argument in arguments))
    assert done.returncode == 2, done.stderr
    assert message.format(data=data, tmp=tmp_path) in done.stderr.splitlines()[-1]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("suffix", "package"), [(".mp4", "av"), (".gif", "PIL.Image")])
def test_a_missing_package_is_one_line(data, tmp_path, capfd, monkeypatch, suffix, package):
    monkeypatch.setitem(sys.modules, package, None)
    assert main([str(data), "-o", str(tmp_path / f"a{suffix}"), "--episode", "0"]) == 2
    assert capfd.readouterr().err == "taxelsim render: videos need PyAV and Pillow: pip install 'taxelsim[video]'\n"

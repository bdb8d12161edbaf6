"""Pictures and videos."""

import json
import subprocess
from pathlib import Path

import av
import h5py
import matplotlib.pyplot as plt
import numpy as np
import pytest
from PIL import Image
from taxelsim._pictures import EpisodePictures

import taxelsim
import taxelsim.envs
import taxelsim.mujoco
from taxelsim.envs import TactileEnv
from taxelsim.export import FORMATS, Options, export
from taxelsim.pictures import TAXEL_COUNTS, colour_map, colours_of, draw_taxels, range_of, save_figure, tactile_pictures
from taxelsim.program import PROGRAM
from taxelsim.report import summarize

from ..envs.conftest import write_scene
from ..viewer.conftest import Recorded

USKIN = taxelsim.SCENES / "sensors/uskin_like_4x4.yaml"


@pytest.fixture(scope="module")
def pressed_scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The shipped three-axis sensor under 3 N, two episodes."""
    file = write_scene(tmp_path_factory.mktemp("pressed"), record="tactile_image, taxel_counts, poses, actions")
    plain = str((taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").resolve())
    text = file.read_text().replace(plain, str(USKIN.resolve())).replace("noise: [0, 20]", "noise: 0")
    file.write_text(text.replace("load: [1, 3]", "load: 3").replace("episodes: 24", "episodes: 2"))
    return file


@pytest.fixture(scope="module")
def pressed_set(pressed_scene: Path, device: taxelsim.Device) -> taxelsim.Dataset:
    taxelsim.generate(pressed_scene, pressed_scene.parent / "data", device=device)
    return taxelsim.Dataset(pressed_scene.parent / "data")


def test_the_video_of_a_light_press_is_bright_and_shows_shear(pressed_set: taxelsim.Dataset, tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    export(pressed_set.folder, tmp_path / "out", "lerobot", Options(video=True))
    with av.open(tmp_path / "out/videos/observation.images.tactile/chunk-000/file-000.mp4") as film:
        pictures = [frame.to_ndarray(format="rgb24").astype(int) for frame in film.decode(video=0)]
    assert 150 < min(picture.max() for picture in pictures) < 230 < max(picture.max() for picture in pictures)
    info, about = (json.loads((tmp_path / f"out/meta/{name}.json").read_text()) for name in ("info", "taxelsim"))
    assert info["features"]["observation.taxel_counts"]["names"][:3] == ["r0_c0_x", "r0_c0_y", "r0_c0_normal"]
    assert about["video"] == {"column": TAXEL_COUNTS, "range": range_of(pressed_set, TAXEL_COUNTS)}
    counts, sensor = pressed_set[TAXEL_COUNTS][:], taxelsim.load_sensor(USKIN)
    with_arrows, without = (tactile_pictures(sensor, shown, about["video"]["range"]) for shown in (counts, counts[..., 2]))
    is_arrow = (with_arrows != without).any(-1)
    assert is_arrow[-1].sum() > 50  # pixels
    errors = [np.abs(np.array(pictures) - drawn)[is_arrow].mean() for drawn in (with_arrows, without)]
    assert errors[0] < 0.5 * errors[1]


def test_every_export_has_the_counts_of_three_axis_taxels(pressed_set: taxelsim.Dataset, tmp_path: Path) -> None:
    counts = pressed_set[TAXEL_COUNTS][:]
    for name in ("zarr", "robomimic", "mcap"):
        pytest.importorskip(FORMATS[name].packages[0])
        export(pressed_set.folder, tmp_path / name, name)
    zarr, read = pytest.importorskip("zarr"), pytest.importorskip("mcap_ros2.reader").read_ros2_messages
    flat = zarr.open_group(tmp_path / "zarr", mode="r")["data/taxel_counts"]
    np.testing.assert_array_equal(flat[:], counts.reshape(len(counts), -1))
    with h5py.File(tmp_path / "robomimic") as file:
        np.testing.assert_array_equal(file["data/demo_1/obs/taxel_counts"][:], flat[13:])
    messages = list(read(str(tmp_path / "mcap/episode-000001.mcap"), topics=["/tactile/taxel_counts"]))
    image = messages[0].ros_msg
    assert (image.height, image.width, image.step, image.encoding) == (4, 4, 48, "32SC3")
    np.testing.assert_array_equal(np.frombuffer(image.data, "<i4").reshape(4, 4, 3), counts[13])


def test_all_pictures_of_a_data_set_have_one_scale(pressed_set: taxelsim.Dataset, tmp_path: Path) -> None:
    normal = pressed_set[TAXEL_COUNTS][:][..., 2]
    expected = range_of(pressed_set, TAXEL_COUNTS)
    assert expected == np.quantile(normal[normal > 30], 0.999, method="inverted_cdf")  # 30: ten standard deviations of the noise

    pictures = [EpisodePictures(str(pressed_set.folder), 1, counts).draw(0) for counts in (0, expected, 2 * expected)]
    assert (pictures[0] == pictures[1]).all()
    assert (pictures[0] != pictures[2]).any()
    files = [tmp_path / name for name in ("default.png", "same.png", "other.png")]
    for file, options in zip(files, ([], ["--range", expected], ["--range", 2 * expected]), strict=True):
        subprocess.run([PROGRAM, "render", pressed_set.folder, "-o", file, *map(str, options)], check=True, capture_output=True)
    contents = [file.read_bytes() for file in files]
    assert contents[0] == contents[1] != contents[2]
    assert [summarize(pressed_set, range=given).range for given in (None, 5)] == [expected, 5]
    for given in (None, 5):
        (tmp_path / "view.rrd").write_bytes(taxelsim.view(pressed_set.folder, 0, range=given).memory_recording().drain_as_bytes())
        limits = Recorded(tmp_path / "view.rrd")["episode_0/taxel_counts/normal", "DepthImage:depth_range"].ravel()
        assert list(limits) == [0, given or expected]
    for options, message in (
        ({"range": 1}, "range: needs video"),
        ({"video": True, "range": 0}, "range: 0 is not allowed: a finite number above 0"),
    ):
        with pytest.raises(taxelsim.InputError, match=message):
            export(pressed_set.folder, tmp_path / "refused", "lerobot", Options(**options))


def test_pictures_of_an_environment_are_bright_and_do_not_flicker(pressed_scene: Path, device: taxelsim.Device) -> None:
    counts, pictures = [], []
    env = TactileEnv(
        pressed_scene, render_mode="rgb_array", observations="taxel_counts", actions=("v_x", "v_z"), linear_scale=0.02, device=device
    )
    counts.append(env.reset(seed=0)[0])
    for step in range(6):  # presses, then lifts
        pictures.append(env.render())
        counts.append(env.step(np.array([1, 1 if step < 3 else -1], np.float32))[0])
    assert min(picture.max() for picture in pictures) > 150
    largest = np.maximum.accumulate([shown[..., 2].max() for shown in counts])
    assert largest[0] < largest[3] == largest[5]
    sensor = taxelsim.load_sensor(USKIN)
    for shown, picture, scale in zip(counts, pictures, largest, strict=False):
        np.testing.assert_array_equal(picture, tactile_pictures(sensor, shown[None], float(scale))[0])
    fixed = TactileEnv(pressed_scene, render_mode="rgb_array", range=2e5, device=device)
    fixed.reset(seed=0)
    assert fixed.render()[..., 1].max() < 30  # green, which rises with the level: the counts are a hundredth of this range


def test_noise_is_no_bright_picture() -> None:
    sensor = taxelsim.load_sensor(USKIN)
    noise = np.random.default_rng(0).normal(0, 3, (100, 16, 3)).round()
    pictures = tactile_pictures(sensor, noise)
    assert pictures[..., 0].max() < 80  # neither yellow nor red
    assert pictures[..., 1].max() < 160  # green, which rises with the level


def test_figures_of_matplotlib_have_the_colours_of_pictures(tmp_path: Path) -> None:
    levels = np.linspace(0, 1, 256)
    np.testing.assert_array_equal(np.rint(255 * colour_map()(levels)[:, :3]), colours_of(levels))

    sensor = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")
    counts = np.zeros((6, 14))
    counts[0, 13] = 100
    figure, axes = plt.subplots(figsize=(4, 2))
    image = draw_taxels(axes, sensor, counts)
    x, y = 1e3 * sensor.taxel_positions.reshape(6, 14, 3)[0, 13, :2]
    left, right, bottom, top = image.get_extent()
    rows, cols = image.get_array().shape
    assert image.get_array()[int((x - top) / (bottom - top) * rows), int((y - left) / (right - left) * cols)] == 100
    assert image.get_array().sum() == 100 * rows * cols / 84
    assert image.get_clim() == (0, 100)

    save_figure(tmp_path / "figure.png", figure)
    plt.close(figure)
    with Image.open(tmp_path / "figure.png") as saved:
        assert saved.mode == "P"
        assert saved.size == (400, 200)
        assert (253, 231, 37) in {colour for _, colour in saved.convert("RGB").getcolors()}

"""Recordings as measurements: tables with the numbers of the recording, which the program reads."""

import csv
import importlib
import json
import subprocess

import numpy as np
import pytest

import taxelsim
from taxelsim.program import PROGRAM
from taxelsim.recordings import Measurement, read_csv, read_lerobot, read_robomimic, write_measurement
from taxelsim.recordings import measurement as measurement_module

SENSOR = taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml"
FINGERTIP = taxelsim.SCENES / "sensors/fingertip_sphere.yaml"
TACTILE = "observation.tactile.r{row}_c{col}"
MEASUREMENTS = taxelsim.SCENES / "measurements"


def measured(*arguments, **options):
    """A measurement whose readings are counts."""
    return Measurement(*arguments, **{"unit": "counts", **options})


def table_of(file):
    rows = list(csv.reader(file.read_text().splitlines()))
    return dict(zip(rows[0], np.array(rows[1:], np.float64).T, strict=True))


def compared(*sides, options=()):
    found = subprocess.run([PROGRAM, "compare", *map(str, sides), *options, "--json"], capture_output=True, text=True)
    assert found.returncode == 0, found.stderr
    return json.loads(found.stdout)


@pytest.fixture
def dataset(tmp_path):
    """A LeRobotDataset of two episodes with 3 and 2 frames: images of a 6 x 14 array, a force, a scalar."""
    pa, pq = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    root = tmp_path / "recorded"
    (root / "meta").mkdir(parents=True)
    features = {
        "observation.tactile": {"dtype": "float32", "shape": [84], "names": [f"r{k // 14}_c{k % 14}" for k in range(84)]},
        "observation.pad": {"dtype": "float32", "shape": [2, 3], "names": None},
        "observation.wrench": {"dtype": "float32", "shape": [3], "names": {"axes": ["f_x", "f_y", "f_z"]}},
        "observation.depth": {"dtype": "float32", "shape": [1], "names": None},
        "observation.image": {"dtype": "video", "shape": [3, 8, 8], "names": None},
        "timestamp": {"dtype": "float32", "shape": [1], "names": None},
        "episode_index": {"dtype": "int64", "shape": [1], "names": None},
    }
    (root / "meta/info.json").write_text(json.dumps({"codebase_version": "v3.0", "features": features}))
    first = 0
    for number, rows in enumerate((3, 2)):
        frames = np.arange(first, first + rows, dtype=np.float32)
        table = {
            "observation.tactile": (frames[:, None] * 100 + np.arange(84)).tolist(),
            "observation.pad": (frames[:, None, None] + np.arange(6.0).reshape(2, 3)).tolist(),
            "observation.wrench": (frames[:, None] + [0.1, 0.2, 0.5]).tolist(),
            "observation.depth": frames.tolist(),
            "timestamp": (np.arange(rows) / 4).tolist(),
            "episode_index": [number] * rows,
        }
        folder = root / "data/chunk-000"
        folder.mkdir(parents=True, exist_ok=True)
        pq.write_table(pa.table(table), folder / f"file-{number:03d}.parquet")
        first += rows
    return root


def test_all_episodes_of_a_lerobot_dataset_as_images(dataset, tmp_path):
    write_measurement(read_lerobot(dataset), measured("images", SENSOR, TACTILE), tmp_path / "images.yaml")
    table = table_of(tmp_path / "images.csv")
    assert list(table) == [f"r{k // 14}_c{k % 14}" for k in range(84)]
    np.testing.assert_array_equal(np.stack(list(table.values())).T, np.arange(5)[:, None] * 100 + np.arange(84))


def test_one_episode_with_time(dataset, tmp_path):
    what = measured("stamp_images", SENSOR, TACTILE, time="timestamp", keys={"indenter": "{stamp: {size_mm: [10, 10]}}", "load": "3"})
    write_measurement(read_lerobot(dataset, episode=1), what, tmp_path / "stamp.yaml")
    table = table_of(tmp_path / "stamp.csv")
    np.testing.assert_array_equal(table["time_s"], [0, 0.25])
    np.testing.assert_array_equal(table["r0_c1"], [301, 401])
    assert (tmp_path / "stamp.yaml").read_text().endswith('table: "stamp.csv"\nindenter: {stamp: {size_mm: [10, 10]}}\nload: 3\n')


def test_components_of_features_have_names(dataset):
    recording = read_lerobot(dataset)
    np.testing.assert_allclose(recording.column("observation.wrench.f_z"), np.arange(5) + 0.5)
    assert recording.full_name("f_z") == "observation.wrench.f_z"
    np.testing.assert_array_equal(recording.column("observation.pad.r1_c2"), np.arange(5) + 5)
    with pytest.raises(taxelsim.InputError, match="no column 'r0_c0'; did you mean"):  # two features have it
        recording.full_name("r0_c0")
    assert not any(name.startswith("observation.image") for name in recording.names)


def test_kinds_of_tables(dataset, tmp_path):
    recording = read_lerobot(dataset)
    force = measured("force_curve", SENSOR, TACTILE, quantities={"force_N": "f_z"}, taxel=15)
    table = table_of(write_measurement(recording, force, tmp_path / "force.yaml"))
    np.testing.assert_allclose(table["force_N"], np.arange(5) + 0.5)
    np.testing.assert_array_equal(table["taxel"], 15)
    np.testing.assert_array_equal(table["counts"], np.arange(5) * 100 + 15)
    air = measured("uniform_press", SENSOR, TACTILE, quantities={"pressure_kPa": "f_z"})
    table = table_of(write_measurement(recording, air, tmp_path / "air.yaml"))
    np.testing.assert_allclose(table["pressure_kPa"], np.arange(5) + 0.5)
    np.testing.assert_array_equal(table["r0_c1"], np.arange(5) * 100 + 1)
    step = table_of(write_measurement(recording, measured("step_response", SENSOR, TACTILE), tmp_path / "step.yaml"))
    np.testing.assert_array_equal(step["counts"], np.arange(5) * 8400 + 83 * 42)
    point = measured("point_images", SENSOR, TACTILE, quantities={"x_mm": "observation.depth", "y_mm": "f_x"})
    assert list(table_of(write_measurement(recording, point, tmp_path / "point.yaml")))[:3] == ["x_mm", "y_mm", "r0_c0"]


def test_a_csv_file_in_other_units_and_order(tmp_path):
    lines = ["# recorded", "stamp;note;" + ";".join(f"m_{col:02d}_{row}" for col in range(14) for row in range(6))]
    lines += [f"{5000 + 20 * k};a;" + ";".join(str(900 - k * row - col) for col in range(14) for row in range(6)) for k in range(3)]
    (tmp_path / "raw.csv").write_text("\n".join(lines) + "\n")
    what = measured("images", SENSOR, "m_{col:02d}_{row}", time="stamp", time_unit="ms", falling=True, scale=4)
    table = table_of(write_measurement(read_csv(tmp_path / "raw.csv", ";"), what, tmp_path / "out.yaml"))
    np.testing.assert_allclose(table["time_s"], [0, 0.02, 0.04])
    np.testing.assert_array_equal(table["r5_c13"], [0, 20, 40])


def test_taxels_without_a_grid_are_numbered(tmp_path):
    (tmp_path / "raw.csv").write_text(",".join(f"a{k}" for k in range(65)) + "\n" + ",".join(str(k) for k in range(65)) + "\n")
    write_measurement(read_csv(tmp_path / "raw.csv"), measured("images", FINGERTIP, "a{taxel}"), tmp_path / "out.yaml")
    assert 'taxel_columns: "t{taxel}"\n' in (tmp_path / "out.yaml").read_text()
    (pair,) = compared(tmp_path / "out.yaml", tmp_path / "out.yaml")["pairs"]
    assert pair["M4_relative_l1"] == 0


def test_the_program_reads_what_was_imported(tmp_path):
    recording = read_csv(MEASUREMENTS / "stamp_3N.csv")
    what = measured("stamp_images", SENSOR, time="time_s", keys={"indenter": "{stamp: {size_mm: [10.5, 10.5]}}", "load": "2.94"})
    write_measurement(recording, what, tmp_path / "out.yaml")
    (pair,) = compared(tmp_path / "out.yaml", MEASUREMENTS / "stamp_3N.yaml", options=["--at", "5"])["pairs"]
    assert pair["M4_relative_l1"] == 0
    arguments = ["characterize", tmp_path / "out.yaml", "-o", tmp_path / "sensor.yaml"]
    assert subprocess.run([PROGRAM, *arguments], capture_output=True).returncode == 0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a,b\n", "a line of names and at least one row expected"),
        ("a,a\n1,2\n", "column 'a' found twice"),
        ("a,b\n1,2\n# note\n3\n", r"raw\.csv:4: 1 values are not allowed: 2"),
        ("a,b\n1,2\n3,x\n", r"raw\.csv:3: b: 'x' is not allowed: a number"),
        ("a,b\n1,nan\n", r"raw\.csv:2: b: 'nan' is not allowed: a finite number"),
    ],
)
def test_damaged_tables(tmp_path, text, message):
    (tmp_path / "raw.csv").write_text(text)
    with pytest.raises(taxelsim.InputError, match=message):
        read_csv(tmp_path / "raw.csv").column("b")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"kind": "photos"}, "measurement: 'photos' is not allowed: images"),
        ({"taxels": "taxel"}, r"taxels: 'taxel' found; it names one column: use \{row\}"),
        ({"taxels": "{finger}"}, r"taxels: '\{finger\}' is not allowed: \{row\}, \{col\}, \{taxel\}"),
        ({"taxels": "x{taxel}"}, "no column 'x0'; it has observation.tactile.r0_c0"),
        ({"taxels": "r{row}_c{col}"}, "no column 'r0_c0'; did you mean observation.tactile.r0_c0 or observation.pad.r0_c0"),
        ({"taxels": "observation.tactil.r{row}_c{col}"}, "did you mean observation.tactile.r0_c0"),
        ({"time": "timestamp"}, "timestamp: row 3 is not later than the row before; choose one episode"),
        ({"quantities": {"force": "f_z"}}, "column: 'force' is not allowed: x_m"),
        ({"kind": "force_curve"}, "taxel: None is not allowed: 0 to 83 for force_curve"),
        ({"scale": np.nan}, "scale: nan is not allowed"),
        ({"time": "observation.depth", "time_unit": "h"}, "time_unit: 'h' is not allowed: s"),
        ({"keys": {"load": "3\nsensor: x"}}, "load: .* is not allowed: one line"),
    ],
)
def test_wrong_measurements(dataset, tmp_path, changes, message):
    with pytest.raises(taxelsim.InputError, match=message):
        write_measurement(
            read_lerobot(dataset), measured(**{"kind": "images", "sensor": SENSOR, "taxels": TACTILE, **changes}), tmp_path / "out.yaml"
        )
    assert not list(tmp_path.glob("out.*"))


def test_wrong_folders_and_outputs(dataset, tmp_path):
    with pytest.raises(taxelsim.InputError, match=r"no LeRobotDataset: meta/info\.json"):
        read_lerobot(tmp_path)
    with pytest.raises(taxelsim.InputError, match="no frames of episode 7"):
        read_lerobot(dataset, episode=7).column("timestamp")
    (tmp_path / "out.csv").touch()
    with pytest.raises(taxelsim.InputError, match=r"out\.csv: exists"):
        write_measurement(read_lerobot(dataset), measured("images", SENSOR), tmp_path / "out.yaml")
    with pytest.raises(taxelsim.InputError, match=r"a file NAME\.yaml expected"):
        write_measurement(read_lerobot(dataset), measured("images", SENSOR), tmp_path / "out.txt")


def test_command(tmp_path, capfd):

    main = importlib.import_module("taxelsim.commands.import").main
    out = tmp_path / "out.yaml"
    arguments = [str(MEASUREMENTS / "stamp_3N.csv"), "--sensor", str(SENSOR), "--measurement", "images", "-o", str(out), "--unit", "counts"]
    assert main([*arguments, "--time", "time_s"]) == 0
    assert capfd.readouterr().out == f"wrote {out} and {tmp_path / 'out.csv'}\n"
    assert main([*arguments, "--episode", "3"]) == 2
    assert capfd.readouterr().err == "taxelsim import: --episode: not for CSV files\n"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"unit": ""}, "the unit of observation.tactile.r0_c0 is not stated: --unit counts, or another one with --scale"),
        ({"unit": "N"}, "observation.tactile.r0_c0 is in N: --scale, counts per N, is needed"),
        ({"time": "observation.depth"}, "the unit of observation.depth is not stated: --time-unit s, ms, us, ns"),
    ],
)
def test_units_are_asked_for(dataset, tmp_path, changes, message):
    with pytest.raises(taxelsim.InputError, match=message):
        write_measurement(read_lerobot(dataset, episode=0), measured("images", SENSOR, TACTILE, **changes), tmp_path / "out.yaml")
    assert not list(tmp_path.glob("out.*"))


def test_units_of_readings_and_of_a_name(dataset, tmp_path):
    what = Measurement("images", SENSOR, TACTILE, unit="N", scale=2, time="timestamp")
    table = table_of(write_measurement(read_lerobot(dataset, episode=0), what, tmp_path / "out.yaml"))
    np.testing.assert_array_equal(table["r0_c1"], [2, 202, 402])
    (tmp_path / "raw.csv").write_text("clock_ms,a0\n10,1\n30,2\n")
    assert measurement_module._time_unit(read_csv(tmp_path / "raw.csv"), Measurement("images", SENSOR, time="clock_ms")) == "ms"


def test_a_recording_is_read_in_blocks(tmp_path, monkeypatch):
    """Blocks of two rows give the table of one block; a time that falls between blocks, and falling readings, see all rows."""
    monkeypatch.setattr("taxelsim.recordings.tables.BLOCK_ROWS", 2)
    lines = ["time_s," + ",".join(f"a{k}" for k in range(84))]
    lines += [f"{row}," + ",".join(str(100 - row * k) for k in range(84)) for row in range(5)]
    (tmp_path / "raw.csv").write_text("\n".join(lines) + "\n")
    what = measured("images", SENSOR, "a{taxel}", time="time_s", falling=True)
    table = table_of(write_measurement(read_csv(tmp_path / "raw.csv"), what, tmp_path / "out.yaml"))
    np.testing.assert_array_equal(table["r0_c7"], 7 * np.arange(5))
    lines[3] = lines[3].replace("2,", "1,", 1)
    (tmp_path / "raw.csv").write_text("\n".join(lines) + "\n")
    with pytest.raises(taxelsim.InputError, match="time_s: row 2 is not later than the row before"):
        write_measurement(read_csv(tmp_path / "raw.csv"), what, tmp_path / "again.yaml")
    assert not list(tmp_path.glob("again.*"))


def test_a_file_of_robomimic(tmp_path):
    """Episodes in the order of their numbers; observations with names, where the file has none by place."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "demos.hdf5", "w") as file:
        for number, rows in ((10, 2), (2, 3)):
            group = file.create_group(f"data/demo_{number}")
            group["obs/pad"] = np.full((rows, 6, 14), number, np.float32) + np.arange(84).reshape(6, 14)
            group["obs/force"] = np.full((rows, 1), number, np.float64)
            group["actions"] = np.zeros((rows, 2))
    recording = read_robomimic(tmp_path / "demos.hdf5")
    assert {"pad.r5_c13", "force", "actions.1"} <= set(recording.names)
    np.testing.assert_array_equal(recording.column("force"), [2, 2, 2, 10, 10])
    what = measured("images", SENSOR, "pad.r{row}_c{col}", quantities={"force_N": "force"})
    rows = table_of(write_measurement(read_robomimic(tmp_path / "demos.hdf5", 10), what, tmp_path / "out.yaml"))
    np.testing.assert_array_equal(rows["r5_c13"], [93, 93])
    with pytest.raises(taxelsim.InputError, match="no frames of episode 3"):
        read_robomimic(tmp_path / "demos.hdf5", 3)
    with h5py.File(tmp_path / "demos.hdf5", "r+") as file:
        del file["data/demo_10/obs/pad"]
        file["data/demo_10/obs/pad"] = np.zeros((2, 4, 4), np.float32)
    with pytest.raises(taxelsim.InputError, match=r"demo_10: pad: \(2, 4, 4\) found, \(T, \(6, 14\)\) as in the first"):
        recording.column("pad.r0_c0")
    (tmp_path / "demos.hdf5").write_bytes(b"no HDF5")
    with pytest.raises(taxelsim.InputError, match=r"demos\.hdf5: no file of robomimic: "):
        read_robomimic(tmp_path / "demos.hdf5")

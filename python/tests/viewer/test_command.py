"""`taxelsim view`: files, warnings and refusals."""

import re
import shutil
import subprocess
import sys

import pytest

import taxelsim
from taxelsim.commands.view import main

from .conftest import Recorded, write_viewed_scene

CUBE = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
FACES = ["1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"]


def write_box(file, half):
    """An OBJ file of a cube of half side `half`, in the unit of the file."""
    lines = [f"v {x * half} {y * half} {z * half}" for x, y, z in CUBE]
    file.write_text("\n".join([*lines, *[f"f {face}" for face in FACES], ""]))


def write_mesh_scene(folder, half, **arguments):
    """A scene that touches a cube of a mesh file."""
    write_box(folder / "cube.obj", half)
    file = write_viewed_scene(folder, friction=False, episodes=2, **arguments)
    text = file.read_text().replace(
        "{name: bar, cylinder: {radius_mm: 4, length_mm: 100}, orientation: {rpy_deg: [90, 0, 0]}, edge: [0, 0, 1]}",
        "{name: cube, mesh: cube.obj, edge: [0, 0, 1]}",
    )
    file.write_text(text)
    return file


def test_saves_a_recording(viewed, tmp_path):
    file = tmp_path / "out.rrd"
    file.write_bytes(b"old")
    command = [sys.executable, "-m", "taxelsim", "view", viewed, "--episode", "3", "--episode", "1", "--save", file]
    done = subprocess.run(command, capture_output=True, text=True)  # a process without a device, whose copies for each read are cheap
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert {entity.partition("/")[0] for entity in Recorded(file).entities if "/world" in entity} == {"episode_1", "episode_3"}
    assert [path.name for path in tmp_path.iterdir()] == ["out.rrd"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["{data}", "--episode", "9"], "episode 9 is not in the data set, whose episodes are 0 to 3"),
        (["{data}", "--episode", "-1"], "episodes: -1 is not allowed: different numbers from 0"),
        (["{data}", "--episode", "1", "1"], "episodes: 1, 1 is not allowed: different numbers from 0"),
        (["{tmp}"], "no data set: it has no dataset.yaml"),
        (["{tmp}/none.yaml"], "none.yaml"),
        (["{data}", "--episode", "0", "--assets", "{tmp}/none"], "none: not a folder; assets names a folder with meshes of the scene"),
        (["{data}", "--save", "{tmp}/out.png"], "out.png: the name of a file that ends in .rrd is needed"),
    ],
)
def test_bad_input_gives_one_line(viewed, tmp_path, capsys, arguments, message):
    words = [argument.format(data=viewed, tmp=tmp_path) for argument in arguments]
    assert main([*words, *([] if "--save" in words else ["--save", str(tmp_path / "out.rrd")])]) == 2
    error = capsys.readouterr().err
    assert error.startswith("taxelsim view: ")
    assert message in error
    assert len(error.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


def test_without_a_display_it_says_what_to_do(viewed, capsys, monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert main([str(viewed)]) == 2
    assert "--save FILE.rrd writes a file, --web serves a page for a browser" in capsys.readouterr().err


def test_a_file_that_cannot_be_written(viewed, tmp_path, capsys):
    assert main([str(viewed), "--save", str(tmp_path / "none/out.rrd")]) == 1
    assert capsys.readouterr().err == f"taxelsim view: {tmp_path}/none/out.rrd: No such file or directory\n"


def test_without_the_package_it_says_how_to_install_it(viewed, tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "rerun", None)
    assert main([str(viewed), "--save", str(tmp_path / "out.rrd")]) == 2
    assert "pip install 'taxelsim[view]'" in capsys.readouterr().err


def test_importing_taxelsim_does_not_import_rerun():
    command = "import sys, taxelsim; sys.exit('rerun' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", command]).returncode == 0


@pytest.mark.parametrize(
    ("half", "message"),
    [
        (10, "object cube is 34.6 m long, 728 times the sensor's 0.0476 m; a mesh in millimetres needs `scale: 0.001`"),
        (1e-5, "object cube is 3.46e-05 m long, 1/1,374 of the sensor's 0.0476 m; is its `scale` right?"),
        (0.01, None),
    ],
)
def test_warns_about_objects_of_a_wrong_size(device, tmp_path, caplog, half, message):
    taxelsim.view(write_mesh_scene(tmp_path, half), [0], device=device)
    found = [record.getMessage() for record in caplog.records if re.match("object cube is .* m long", record.getMessage())]
    assert found == ([message] if message else [])


def test_meshes_are_found_by_name_and_checksum(device, tmp_path, caplog, recorded):
    data, meshes = tmp_path / "data", tmp_path / "meshes/of/mine"
    taxelsim.generate(write_mesh_scene(tmp_path, 0.01), data, device=device)
    meshes.mkdir(parents=True)
    shutil.move(tmp_path / "cube.obj", meshes / "cube.obj")
    entity = ("episode_0/world/sensor/object", "Mesh3D:vertex_positions")
    assert entity not in recorded(data).static
    assert "meshes of cube are not found and not drawn; assets names the folder that holds them" in caplog.text
    caplog.clear()
    assert len(recorded(data, assets=[tmp_path / "meshes"])[entity]) == 36
    assert caplog.text == ""
    write_box(meshes / "cube.obj", 0.02)
    assert entity not in recorded(data, assets=[tmp_path / "meshes"]).static

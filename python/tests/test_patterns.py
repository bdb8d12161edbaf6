"""Patterns of taxels: places and normals from arrays, and on shapes."""

import math

import numpy as np
import pytest
import yaml
from PIL import Image

import taxelsim
from taxelsim import patterns
from taxelsim.commands import sensor as sensor_command
from taxelsim.patterns.taxels import nearest_distances

UP = (0, 0, 1)
SHAPES = {  # shape, largest distance from the surface at a point, area
    "sphere": (taxelsim.Sphere(0.01), lambda p: np.linalg.norm(p, axis=1) - 0.01, 4 * math.pi * 0.01**2),
    "capsule": (
        taxelsim.Capsule(radius=0.008, length=0.02),
        lambda p: np.linalg.norm(p - np.clip(p, -0.01, 0.01) * UP, axis=1) - 0.008,
        2 * math.pi * 0.008 * (0.02 + 2 * 0.008),
    ),
    "cylinder": (
        taxelsim.Cylinder(radius=0.01, length=0.02),
        lambda p: np.maximum(np.hypot(p[:, 0], p[:, 1]) - 0.01, np.abs(p[:, 2]) - 0.01),
        2 * math.pi * 0.01 * (0.02 + 0.01),
    ),
    "box": (taxelsim.Box([0.02, 0.03, 0.01]), lambda p: (np.abs(p) - [0.01, 0.015, 0.005]).max(axis=1), 2 * (6e-4 + 2e-4 + 3e-4)),
}


@pytest.mark.parametrize("name", SHAPES)
def test_a_cover_lies_on_the_surface_and_has_its_area(name: str) -> None:
    shape, distance, area = SHAPES[name]
    placed = patterns.cover_shape(shape, 0.002, raised=0.001)
    positions, normals = np.asarray(placed.sensor.taxel_positions), np.asarray(placed.sensor.taxel_normals)
    assert taxelsim.Pose() == placed.X_BS
    assert np.abs(distance(positions - 0.001 * normals)).max() < 2e-5  # in the tangent plane of a sample at most 0.3 mm away
    rise = distance(positions + 1e-4 * normals) - distance(positions - 1e-4 * normals)
    assert rise.min() > 0
    sizes = np.array([patch.pitch for patch in placed.sensor.patches])
    assert sizes.prod(axis=1).sum() == pytest.approx(area, rel=1e-3)
    spacing = nearest_distances(positions - 0.001 * normals)[0] / 0.002
    assert spacing.min() > 0.5
    assert spacing.max() < 1.3


def test_a_direction_covers_a_cap_with_its_frame_on_top() -> None:
    """Half of a sphere: the area is exact, the apex is the origin, and z of S looks along the direction."""
    placed = patterns.cover_shape(taxelsim.Sphere(0.01), 0.001, direction=(0, -2, 0))
    assert placed.sensor.num_taxels == round(2 * math.pi * 0.01**2 / 0.001**2)
    np.testing.assert_allclose(placed.X_BS.position, (0, -0.01, 0), atol=1e-6)
    np.testing.assert_allclose(placed.X_BS.transform((0, 0, 0.005)), (0, -0.015, 0), atol=1e-6)
    assert np.asarray(placed.sensor.taxel_normals)[:, 2].min() > -1e-6
    half = patterns.cover_shape(taxelsim.Sphere(0.01), 0.001, region=((-1, -1, 0.005), (1, 1, 1)))
    assert half.sensor.num_taxels == pytest.approx(2 * math.pi * 0.01 * 0.005 / 0.001**2, abs=3)
    assert np.asarray(half.sensor.taxel_positions)[:, 2].min() > 0.005 - 1e-4


@pytest.mark.parametrize("flip", [False, True])
def test_a_mesh_is_covered_outside_whatever_its_winding(flip: bool) -> None:
    cube = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * 0.01 + [0.1, 0, 0]
    faces = [
        [0, 1, 3],
        [0, 3, 2],
        [4, 6, 7],
        [4, 7, 5],
        [0, 4, 5],
        [0, 5, 1],
        [2, 3, 7],
        [2, 7, 6],
        [0, 2, 6],
        [0, 6, 4],
        [1, 5, 7],
        [1, 7, 3],
    ]
    mesh = taxelsim.Mesh(cube, [face[::-1] if flip else face for face in faces])
    sensor = patterns.cover_shape(mesh, 0.0025).sensor
    offsets = np.asarray(sensor.taxel_positions) - [0.1, 0, 0]
    np.testing.assert_allclose((offsets * np.asarray(sensor.taxel_normals)).sum(axis=1), 0.01, atol=1e-8)
    assert sensor.num_taxels == 6 * 64
    grid = patterns.grid_on_shape(mesh, 4, 5, 0.002, direction=(0, 0, -1))
    np.testing.assert_allclose(grid.X_BS.position, (0.1, 0, -0.01), atol=1e-8)
    assert (grid.sensor.patches[0].num_rows, grid.sensor.patches[0].num_cols) == (4, 5)


def test_a_picture_shows_each_taxel_in_its_view() -> None:
    """One taxel that looks at +z, off the middle: visible from +z alone, grey elsewhere or edge-on."""
    sensor = patterns.sensor_of([[0, 0, 0], [0.01, 0, 0]], [[0, 0, 1], [0, 0, -1]], 0.004)
    picture = patterns.draw(sensor, 120)
    top = picture[:, -picture.shape[1] // 2 :]
    colours = {tuple(int(c) for c in colour) for colour in top.reshape(-1, 3)}
    assert (60, 60, 60) in colours  # the one that looks away
    assert len(colours - {(255, 255, 255), (60, 60, 60)}) == 1


PAIR = [[0, 0, 0], [0, 0.003, 0]]
KNOB = str(taxelsim.SCENES / "objects/knob_5k.obj")


def run_command(capsys, *arguments: object) -> tuple[int, str]:
    """Status, and what `taxelsim sensor` says."""
    status = sensor_command.main([str(argument) for argument in arguments])
    said = capsys.readouterr()
    return status, said.err or said.out


@pytest.mark.parametrize("grid", [(), ("--grid", 2, 3)])
def test_the_command_writes_what_the_function_makes(tmp_path, capsys, grid) -> None:
    out = tmp_path / "knob.yaml"
    status, said = run_command(capsys, "from-mesh", KNOB, "--unit", "mm", "--pitch", 4e-6, "--direction", 0, 0, 1, *grid, "-o", out)
    mesh = taxelsim.load_mesh(KNOB, scale=0.001)
    options = {"direction": (0, 0, 1), "name": "knob"}
    placed = patterns.grid_on_shape(mesh, 2, 3, 4e-6, **options) if grid else patterns.cover_shape(mesh, 4e-6, **options)
    assert status == 0
    assert taxelsim.load_sensor(out) == placed.sensor
    mount = yaml.safe_load(said.splitlines()[1])["mount on the mesh"]
    np.testing.assert_allclose(mount["position"], placed.X_BS.position, rtol=1e-8)
    np.testing.assert_array_equal(Image.open(out.with_suffix(".png")), patterns.draw(placed.sensor))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["from-mesh", KNOB, "--unit", "m", "--pitch", "-1"], "--pitch: -1.0 is not allowed: a finite number above 0"),
        (["from-mesh", KNOB, "--unit", "m", "--pitch", "0.003", "--region", *"111222"], "it makes 0 taxels, 1 to 4096 are possible"),
        (["from-mesh", KNOB, "--unit", "m", "--pitch", "0.003", "--region", *"111222", "--grid", *"22"], "--region: not for a --grid"),
        (["from-mesh", KNOB, "--unit", "m", "--pitch", "0.003", "--like", "no.yaml"], "no.yaml: no such file"),
        (["from-pattern", "no.csv", "--unit", "mm"], "no.csv: No such file"),
        (["from-pattern", KNOB, "--unit", "mm"], "ending '.obj' is not allowed: .csv or .npz"),
    ],
)
def test_a_command_that_fails_writes_nothing(tmp_path, capsys, arguments: list[str], message: str) -> None:
    status, said = run_command(capsys, *arguments, "-o", tmp_path / "a.yaml")
    assert status > 0
    assert said.count("\n") == 1
    assert message in said
    assert not list(tmp_path.iterdir())


def test_the_command_keeps_files_and_asks_for_the_unit(tmp_path, capsys) -> None:
    (tmp_path / "a.png").touch()
    write_pattern(tmp_path / "a.npz", np.array(PAIR) * 1e3, [UP, UP])
    arguments = ["from-pattern", tmp_path / "a.npz", "--unit", "mm", "-o"]
    assert run_command(capsys, *arguments, tmp_path / "a.yaml") == (
        2,
        f"taxelsim sensor: {tmp_path}/a.png: exists; choose another output or remove it\n",
    )
    assert run_command(capsys, *arguments, tmp_path / "b.yaml")[0] == 0
    np.testing.assert_array_equal(taxelsim.load_sensor(tmp_path / "b.yaml").taxel_positions, PAIR)
    with pytest.raises(SystemExit):
        run_command(capsys, *arguments[:2], "-o", tmp_path / "c.yaml")
    assert "required: --unit" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("positions", "normals", "size", "message"),
    [
        (
            [[0, 0, 0], [0, 24, 0]],
            [UP, UP],
            None,
            "positions: a span of 24 m is not allowed: at most 1 m; other units than metres must be named",
        ),
        (PAIR, [UP, (0, 0, 0)], None, "normals: length 0 of taxel 1 is not allowed: a direction out of the skin"),
        ([PAIR[0], PAIR[1], PAIR[0]], [UP] * 3, None, "positions: taxels 0 and 2 at one place are not allowed: at least 1 um apart"),
        (PAIR, [UP], None, "normals: shape (1, 3) is not allowed: (T, 3) = (2, 3)"),
        (PAIR[:1], [UP], None, "size: None is not allowed for one taxel: its side in m"),
        (PAIR, [UP, UP], -1.0, "pitch"),
        ([PAIR[0], (0, np.nan, 0)], [UP, UP], None, "is not finite"),
    ],
)
def test_bad_arrays_are_one_line(positions, normals, size, message: str) -> None:
    with pytest.raises(taxelsim.InputError) as error:
        patterns.sensor_of(positions, normals, size)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('<link name="a"/>', "link 'tip' is not there; it has 'a'"),
        ('<link name="tip"/>', "link 'tip' has 0 <collision>, 1 allowed without the argument collision"),
        (
            '<link name="tip"><collision><geometry><box size="1 x 1"/></geometry></collision></link>',
            "size of <box>: '1 x 1' is not allowed",
        ),
        ('<link name="tip"><collision><geometry><cone/></geometry></collision></link>', "<cone> is not allowed: <box>"),
        (
            '<link name="tip"><collision><geometry><mesh filename="package://p/a.stl"/></geometry></collision></link>',
            "package://p/a.stl is not found",
        ),
        ("<link", "not well-formed"),
    ],
)
def test_bad_links_are_one_line(tmp_path, text: str, message: str) -> None:
    (tmp_path / "r.urdf").write_text(f'<robot name="r">{text}</robot>')
    with pytest.raises(taxelsim.InputError) as error:
        patterns.cover_link(tmp_path / "r.urdf", "tip", 0.002)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_a_mesh_of_a_package_is_found_above_the_file(tmp_path) -> None:
    folder = tmp_path / "hand_description"
    (folder / "urdf").mkdir(parents=True)
    (folder / "tip.obj").write_bytes((taxelsim.SCENES / "objects/edge_bar.obj").read_bytes())
    mesh = '<mesh filename="package://hand_description/tip.obj" scale=".5 .5 .5"/>'
    (folder / "urdf/r.urdf").write_text(f'<robot><link name="tip"><collision><geometry>{mesh}</geometry></collision></link></robot>')
    placed = patterns.cover_link(folder / "urdf/r.urdf", "tip", 0.004)
    again = patterns.cover_shape(taxelsim.load_mesh(folder / "tip.obj", scale=0.5), 0.004)
    assert placed.sensor == again.sensor


def write_pattern(file, positions, normals) -> None:
    if file.suffix == ".npz":
        np.savez(file, positions=positions, normals=normals)
    else:
        rows = [",".join(map(str, (*p, *n))) for p, n in zip(positions, normals, strict=True)]
        file.write_text("\n".join(["# places in mm", "x,y,z,nx,ny,nz", *rows]))


@pytest.mark.parametrize("ending", ["csv", "npz"])
def test_a_file_is_its_arrays_in_the_unit_that_is_named(tmp_path, ending: str) -> None:
    positions, normals = [[0, 0, 0], [3, 0, 0], [3, 4, 0.5]], [UP, (0, 0.6, 0.8), (0, 2, 0)]
    write_pattern(tmp_path / f"tip.{ending}", positions, normals)
    sensor = patterns.load_pattern(tmp_path / f"tip.{ending}", unit="mm", like=taxelsim.SCENES / "sensors/wts0614.yaml")
    expected = patterns.sensor_of(np.array(positions) * 1e-3, normals, name="tip", like=taxelsim.SCENES / "sensors/wts0614.yaml")
    assert sensor == expected
    np.testing.assert_allclose(sensor.taxel_positions, np.array(positions) * 1e-3)
    np.testing.assert_allclose(np.asarray(sensor.taxel_normals)[2], (0, 1, 0), atol=1e-12)
    assert sensor.patches[0].pitch == pytest.approx([0.003, 0.003])  # the median of 3, 3 and 4.03 mm


@pytest.mark.parametrize(
    ("name", "content", "unit", "message"),
    [
        ("a.csv", "x,y,z,nx,ny,nz\n0,0,0,0,0,1\n0,24,0,0,0,1\n", "m", "a span of 24 m is not allowed: at most 1 m"),
        ("a.csv", "x,y,z,nx,ny,nz\n0,0,0,0,0,1\n0,24,0,0,0,0\n", "mm", "normals: length 0 of taxel 1"),
        ("a.csv", "x,y,z,nx,ny,nz\n1,2,3,0,0,1\n1,2,3,0,0,1\n", "mm", "positions: taxels 0 and 1 at one place"),
        ("a.csv", "x,y,z,nx,ny\n0,0,0,0,0\n", "m", "column 'nz' is missing"),
        ("a.csv", "x,y,z,nx,ny,nz\n0,0,0,0,0,1\n0,a,0,0,0,1\n", "m", "a.csv:3: y: 'a' is not allowed: a number"),
        ("a.csv", "", "m", "a line of names and at least one row expected"),
        ("a.csv", "x,y,z,nx,ny,nz\n0,0,0,0,0,1\n", "furlong", "unit: 'furlong' is not allowed: m, mm, cm, um, in"),
        ("a.npz", "not a zip", "m", "is not allowed: an NPZ file of numbers"),
        ("a.txt", "", "m", "ending '.txt' is not allowed: .csv or .npz"),
    ],
)
def test_bad_files_are_one_line(tmp_path, name: str, content: str, unit: str, message: str) -> None:
    (tmp_path / name).write_text(content)
    with pytest.raises(taxelsim.InputError) as error:
        patterns.load_pattern(tmp_path / name, unit=unit)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"positions": PAIR}, "array 'normals' is missing; it has positions"),
        ({"positions": PAIR, "normals": [UP]}, "normals: shape (1, 3) is not allowed"),
        (
            {"positions": np.array(PAIR).T, "normals": [UP, UP]},
            "positions: float64 of shape (3, 2) is not allowed: numbers of shape (T, 3)",
        ),
        ({"positions": [["a"] * 3] * 2, "normals": [UP, UP]}, "of shape (2, 3) is not allowed: numbers of shape (T, 3)"),
    ],
)
def test_bad_archives_are_one_line(tmp_path, arrays, message: str) -> None:
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(taxelsim.InputError, match=r"a\.npz") as error:
        patterns.load_pattern(tmp_path / "a.npz")
    assert message in str(error.value)


def test_a_missing_file_is_an_io_error(tmp_path) -> None:
    with pytest.raises(taxelsim.IoError, match="No such file"):
        patterns.load_pattern(tmp_path / "a.csv")

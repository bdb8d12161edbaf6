"""Shapes of geoms: every kind presses as the same shape without MuJoCo."""

import mujoco
import numpy as np
import pytest

import taxelsim
import taxelsim.mujoco

from .models import WTS, direct, place, scene

POSE = (0.003, -0.004, 0.0095, 0.99, 0.03, -0.05, 0.1)
# Poses in the site are composed in double precision twice; heights are then rounded to float32.
POSITION_ERROR = 1e-9  # m


def force_error(frame: taxelsim.Frame) -> float:
    """Force of a shift of all samples of the contact by POSITION_ERROR."""
    return float(frame.contact_area[0] * 1.73e8 * POSITION_ERROR)


@pytest.mark.parametrize(
    ("geom", "shape"),
    [
        ('type="sphere" size=".01"', taxelsim.Sphere(radius=0.01)),
        ('type="capsule" size=".01 .02"', taxelsim.Capsule(radius=0.01, length=0.04)),
        ('type="cylinder" size=".012 .0095"', taxelsim.Cylinder(radius=0.012, length=0.019)),
        ('type="box" size=".008 .012 .0095"', taxelsim.Box(size=(0.016, 0.024, 0.019))),
    ],
)
def test_solids(device: taxelsim.Device, geom: str, shape: taxelsim.mujoco.geoms.Shape) -> None:
    model = scene(f'<geom name="object" {geom}/>')
    data = mujoco.MjData(model)
    place(model, data, POSE)
    frame = taxelsim.mujoco.attach(model, {"palm": WTS}, ["object"], device=device).observe(data)["palm"]
    expected = direct(device, shape, POSE)
    assert expected.total_force > 0.1
    truth, expected_truth = frame.ground_truth, expected.ground_truth
    np.testing.assert_allclose(truth.contact_wrench, expected_truth.contact_wrench, rtol=1e-6, atol=force_error(expected))
    np.testing.assert_allclose(truth.penetration_depth, expected_truth.penetration_depth, atol=POSITION_ERROR)


def test_mesh_in_the_frame_of_its_file(device: taxelsim.Device) -> None:
    """MuJoCo moves a mesh to its centre of mass and principal axes. The adapter must undo this: the tip is the origin of the body."""
    model = scene('<geom name="object" type="mesh" mesh="tip"/>')
    assert np.linalg.norm(model.geom_pos[model.geom("object").id]) > 0.005
    data = mujoco.MjData(model)
    pose = (0.003, -0.004, -0.0015, *POSE[3:])
    place(model, data, pose)
    frame = taxelsim.mujoco.attach(model, {"palm": WTS}, ["object"], device=device).observe(data)["palm"]
    vertices = np.array([[0, 0, 0], [0.02, 0, 0.01], [0, 0.02, 0.01], [-0.02, -0.02, 0.01]])
    expected = direct(device, taxelsim.Mesh(vertices, [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 2, 3]]), pose)
    assert expected.total_force > 0.1
    # MuJoCo keeps vertices in float32: 20 mm rounds by 1e-9 m; the lattice of a mesh, a 65,536th of its 40 mm, by 3e-7 m.
    np.testing.assert_allclose(frame.ground_truth.penetration_depth, expected.ground_truth.penetration_depth, atol=1e-6)


def test_plane_is_solid_below(device: taxelsim.Device) -> None:
    model = scene(world='<geom name="floor" type="plane" size="1 1 1" pos=".1 .2 .3"/>')
    data = mujoco.MjData(model)
    tactile = taxelsim.mujoco.attach(model, {"palm": WTS}, ["floor"], device=device)
    # The pad looks down: z of the site is -z of the world.
    mujoco.mju_mulQuat(data.joint(0).qpos[3:], np.array([0.0, 1, 0, 0]), model.site("palm").quat * (1, -1, -1, -1))
    mujoco.mj_kinematics(model, data)
    data.joint(0).qpos[2] += 0.3 - 0.0005 - data.site("palm").xpos[2]
    depth = tactile.observe(data)["palm"].ground_truth.penetration_depth
    np.testing.assert_allclose(depth, 0.0005, atol=POSITION_ERROR)
    data.joint(0).qpos[2] += 0.001
    assert tactile.observe(data)["palm"].ground_truth.penetration_depth.max() == 0


def test_ellipsoid_is_within_its_bound(device: taxelsim.Device) -> None:
    model = scene('<geom name="object" type="ellipsoid" size=".012 .02 .009"/>')
    mesh, _ = taxelsim.mujoco.shape_of(model, model.geom("object").id)
    assert isinstance(mesh, taxelsim.Mesh)
    corners = np.asarray(mesh.vertices, np.float64)[mesh.triangles] / (0.012, 0.02, 0.009)
    middles = np.linalg.norm(corners.mean(axis=1), axis=1)  # in units of the sphere
    assert 0.02 * (1 - middles.min()) < 1e-5
    np.testing.assert_allclose(np.linalg.norm(corners, axis=2), 1, rtol=1e-6)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert ((normals * corners[:, 0]).sum(axis=1) > 0).all()
    data = mujoco.MjData(model)
    place(model, data, (0, 0, 0.009 - 0.0008, 1, 0, 0, 0))
    depth = taxelsim.mujoco.attach(model, {"palm": WTS}, ["object"], device=device).observe(data)["palm"].ground_truth.penetration_depth
    grid = taxelsim.load_sensor(WTS).patches[0]
    x, y = ((np.arange(4 * n) - (4 * n - 1) / 2) * grid.pitch[0] / 4 for n in (grid.num_rows, grid.num_cols))
    surface = 0.009 * np.sqrt(np.maximum(1 - (x[:, np.newaxis] / 0.012) ** 2 - (y / 0.02) ** 2, 0))
    expected = np.maximum(surface - (0.009 - 0.0008), 0).reshape(grid.num_rows, 4, grid.num_cols, 4).mean(axis=(1, 3))
    assert expected.max() > 0.0005
    # Along z the bound grows with the slope of the surface, here less than 45 degrees: 5 mm of contact half-width on 12^2 / 9 mm.
    np.testing.assert_allclose(depth[0], expected, atol=2**0.5 * 1e-5)


def test_refused_geoms(device: taxelsim.Device) -> None:
    field = mujoco.MjModel.from_xml_string("""<mujoco>
      <asset><hfield name="h" nrow="2" ncol="2" size="1 1 1 .1"/></asset>
      <worldbody><site name="palm"/><geom name="hills" type="hfield" hfield="h"/></worldbody></mujoco>""")
    with pytest.raises(taxelsim.InputError, match=r"^geom 'hills' is of type hfield, which cannot touch a sensor: sphere, .* are allowed$"):
        taxelsim.mujoco.attach(field, {"palm": WTS}, ["hills"], device=device)
    big = scene('<geom name="moon" type="ellipsoid" size="1 1 2"/>')
    with pytest.raises(taxelsim.InputError, match=r"^geom 'moon' is an ellipsoid with a semi-axis of 2 m, too large"):
        taxelsim.mujoco.attach(big, {"palm": WTS}, device=device)

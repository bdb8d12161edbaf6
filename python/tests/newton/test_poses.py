"""Frames from the poses of Newton's worlds: poses, shapes, step order, refused input."""

import importlib
import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import taxelsim

from .worlds import BALL, RADIUS, SITE, WTS, N, add_ball, direct, newton, transform, world, worlds

adapter = pytest.importorskip("taxelsim.newton")
Rotation = pytest.importorskip("scipy.spatial.transform").Rotation

POSE_ERROR = 1e-14  # of positions within a metre (m) and of unit quaternions: some 20 roundings of float64, 1.1e-16 each
HEIGHT_ERROR = 1e-9  # m: heights of samples, some mm, are rounded to float32
FLOAT_ERROR = 2e-6  # m: 20 steps of Newton in float32 at positions below 1 m, 6e-8 m each


def pose_in_site(state: Any) -> np.ndarray:
    """X_SO (N, 7), w first, of the body `object` in the site `palm`, by SciPy in double precision."""
    q = state.body_q.numpy().astype(np.float64).reshape(-1, 2, 7)
    R_WB, R_WO = (Rotation.from_quat(q[:, k, 3:]) for k in (0, 1))
    site = np.float32(SITE).astype(np.float64)
    R_WS = R_WB * Rotation.from_quat(site[3:])
    p_WS = q[:, 0, :3] + R_WB.apply(site[:3])
    R_SO = R_WS.inv() * R_WO
    return np.hstack((R_WS.inv().apply(q[:, 1, :3] - p_WS), np.roll(R_SO.as_quat(), 1, axis=1)))


def set_poses(state: Any, X_SO: np.ndarray, seed: int = 1) -> None:
    """Moves each pad to a pose of its own, and the object of its world to a pose (N, 7), w first, in the site."""
    random = np.random.default_rng(seed)
    R_WB = Rotation.random(len(X_SO), rng=random)
    p_WB = random.uniform(-0.3, 0.3, (len(X_SO), 3))
    R_WS = R_WB * Rotation.from_quat(SITE[3:])
    p_WO = p_WB + R_WB.apply(SITE[:3]) + R_WS.apply(X_SO[:, :3])
    R_WO = R_WS * Rotation.from_quat(np.roll(X_SO[:, 3:], -1, axis=1))
    poses = np.stack((np.hstack((p_WB, R_WB.as_quat())), np.hstack((p_WO, R_WO.as_quat()))), axis=1)
    state.body_q.assign(poses.reshape(-1, 7).astype(np.float32))


def pressed(height: float) -> np.ndarray:
    """Poses (N, 7) of objects in the skin, each at another place and turned by another angle."""
    angles = np.linspace(0, 0.1, N)
    poses = np.zeros((N, 7))
    poses[:, 0], poses[:, 1], poses[:, 2] = np.linspace(-0.004, 0.004, N), 0.002, height - 1e-4 * np.arange(N)
    poses[:, 3], poses[:, 5] = np.cos(angles / 2), np.sin(angles / 2)
    return poses


def test_poses_and_images_of_all_worlds(device: taxelsim.Device) -> None:
    model = worlds(world())
    state = model.state()
    set_poses(state, pressed(0.0095))
    tactile = adapter.attach(model, {"palm": WTS}, [BALL], device=device)
    frame = tactile.observe(state, 0.01)["palm"]
    expected = pose_in_site(state)
    found = tactile.simulators["palm"].inputs.poses
    sign = np.sign((found[:, 3:] * expected[:, 3:]).sum(axis=1, keepdims=True))  # q and -q are one rotation
    np.testing.assert_allclose(found[:, :3], expected[:, :3], rtol=0, atol=POSE_ERROR)
    np.testing.assert_allclose(sign * found[:, 3:], expected[:, 3:], rtol=0, atol=POSE_ERROR)
    by_hand = direct(device, taxelsim.Sphere(RADIUS), expected)
    np.testing.assert_array_equal(frame.tactile_image, by_hand.tactile_image)
    depth = frame.ground_truth.penetration_depth
    np.testing.assert_allclose(depth, by_hand.ground_truth.penetration_depth, rtol=0, atol=HEIGHT_ERROR)
    assert len(np.unique(frame.tactile_image.reshape(N, -1), axis=0)) == N
    assert frame.tensors("warp").tactile_image.ptr == frame.tactile_image.ctypes.data


def test_a_body_of_its_own_is_the_sensor_frame(device: taxelsim.Device) -> None:
    model = worlds(world())
    state = model.state()
    poses = np.tile([0, 0, 0, 0, 0, 0, 1], (2 * N, 1))
    poses = poses.astype(np.float32)
    poses[1::2, 2] = 0.0095
    state.body_q.assign(poses)
    tactile = adapter.attach(model, {"pad": WTS}, [BALL], device=device)
    depth = tactile.observe(state, 0.01)["pad"].ground_truth.penetration_depth
    expected = direct(device, taxelsim.Sphere(RADIUS), [[0, 0, np.float32(0.0095), 1, 0, 0, 0]] * N)
    np.testing.assert_array_equal(depth, expected.ground_truth.penetration_depth)


DENTED = taxelsim.Box(size=(0.016, 0.024, 0.019))
CORNERS = np.array([[x, y, z] for x in (-0.008, 0.008) for y in (-0.012, 0.012) for z in (-0.0095, 0.0095)])
SIDES = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [1, 5, 7], [1, 7, 3]]
# The face that presses has a dent of 2 mm in its middle, which the convex hull closes.
VERTICES, TRIANGLES = np.vstack((CORNERS, [0, 0, -0.0075])), [*SIDES, [0, 2, 8], [2, 6, 8], [6, 4, 8], [4, 0, 8]]


@pytest.mark.parametrize(
    ("add", "shape"),
    [
        (lambda b, body: b.add_shape_capsule(body, radius=0.0095, half_height=0.02, label="it"), taxelsim.Capsule(0.0095, length=0.04)),
        (lambda b, body: b.add_shape_cylinder(body, radius=0.012, half_height=0.0095, label="it"), taxelsim.Cylinder(0.012, length=0.019)),
        (lambda b, body: b.add_shape_box(body, hx=0.008, hy=0.012, hz=0.0095, label="it"), DENTED),
        (lambda b, body: b.add_shape_mesh(body, mesh=newton.Mesh(VERTICES, np.ravel(TRIANGLES)), label="it"), None),
        (
            lambda b, body: b.add_shape_mesh(body, mesh=newton.Mesh(-VERTICES / 2, np.ravel(TRIANGLES)), scale=(-2, -2, -2), label="it"),
            None,
        ),
        (lambda b, body: b.add_shape_convex_hull(body, mesh=newton.Mesh(VERTICES, np.ravel(TRIANGLES)), label="it"), DENTED),
    ],
    ids=["capsule", "cylinder", "box", "mesh", "mirrored mesh", "convex hull"],
)
def test_shapes(device: taxelsim.Device, add: Any, shape: Any) -> None:
    model = worlds(world(add))
    state = model.state()
    set_poses(state, pressed(0.0093))
    frame = adapter.attach(model, {"palm": WTS}, ["it"], device=device).observe(state, 0.01)["palm"]
    expected = direct(device, taxelsim.Mesh(VERTICES, TRIANGLES) if shape is None else shape, pose_in_site(state))
    assert (expected.ground_truth.total_force > 0.1).all()
    depth = frame.ground_truth.penetration_depth
    # Newton has sizes and vertices in float32. The lattice of a mesh is a 65,536th of its 30 mm.
    np.testing.assert_allclose(depth, expected.ground_truth.penetration_depth, rtol=0, atol=1e-6)


def test_a_plane_that_all_worlds_share(device: taxelsim.Device) -> None:
    """The pads look down on the ground plane, each a tenth of a millimetre deeper."""
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    builder.replicate(world(), N)
    builder.add_ground_plane(label="ground")
    model = builder.finalize(device="cpu")
    state = model.state()
    poses = np.zeros((N, 2, 7), np.float32)
    poses[:, :, 3] = 1  # a half turn about x
    poses[:, 0, 2] = -1e-4 * np.arange(N)
    poses[:, 1, 2] = 0.5
    state.body_q.assign(poses.reshape(-1, 7))
    tactile = adapter.attach(model, {"pad": WTS}, [BALL, "ground"], device=device)
    depth = tactile.observe(state, 0.01)["pad"].ground_truth.penetration_depth
    expected = np.broadcast_to(1e-4 * np.arange(N)[:, np.newaxis, np.newaxis], depth.shape)
    np.testing.assert_allclose(depth, expected, rtol=0, atol=HEIGHT_ERROR)


@pytest.mark.parametrize("kind", ["SolverSemiImplicit", "SolverMuJoCo"])
def test_frames_are_not_a_step_late(device: taxelsim.Device, kind: str) -> None:
    """A box moves into the skin at a known velocity: the frame after step k has the depth at the end of step k."""
    speed, dt, gap, half = 0.02, 0.002, 2e-4, 0.0095

    def add(builder: Any, body: int) -> None:
        free = newton.ModelBuilder.ShapeConfig(has_shape_collision=False)
        builder.add_shape_box(body, hx=0.05, hy=0.05, hz=half, cfg=free, label="box")

    model = worlds(world(add), 2)
    state, following = model.state(), model.state()
    q = state.joint_q.numpy().reshape(2, 2, 7)
    q[:, 0], q[:, 1] = [0, 0, 0, 0, 0, 0, 1], [0, 0, half + gap, 0, 0, 0, 1]
    velocities = np.zeros((2, 2, 6), np.float32)
    velocities[:, 1, 2] = [-speed, -2 * speed]
    state.joint_q.assign(q.ravel())
    state.joint_qd.assign(velocities.ravel())
    newton.eval_fk(model, state.joint_q, state.joint_qd, state)
    tactile = adapter.attach(model, {"pad": WTS}, ["box"], device=device)
    solver = getattr(newton.solvers, kind)(model)
    assert speed * dt > 10 * FLOAT_ERROR  # a step late would be visible
    for k in range(20):
        state.clear_forces()
        solver.step(state, following, None, None, dt)
        state, following = following, state
        depth = tactile.observe(state, dt)["pad"].ground_truth.penetration_depth
        for found, velocity in zip(depth, (speed, 2 * speed), strict=True):
            np.testing.assert_allclose(found, max(velocity * dt * (k + 1) - gap, 0), rtol=0, atol=FLOAT_ERROR)


def test_shear_from_relative_motion_until_reset(device: taxelsim.Device) -> None:
    model = worlds(world())
    state = model.state()
    sensor = taxelsim.load_sensor(WTS)
    skin = sensor.skin.replace(friction=taxelsim.Friction(tangential_stiffness=5e7, friction_coefficient=0.8))
    tactile = adapter.attach(model, {"palm": sensor.replace(skin=skin)}, [BALL], device=device)
    poses = pressed(0.0095)
    for shift in (0, 5e-5):
        poses[:, 0] += shift
        set_poses(state, poses)
        shear = tactile.observe(state, 0.01)["palm"].ground_truth.contact_wrench[:, 0].copy()
        assert ((shear > 0.01) == (shift > 0)).all()
    tactile.reset([1])
    tactile.observe(state, 0.01, [1])
    shear = tactile.simulators["palm"].read().ground_truth.contact_wrench[:, 0]
    np.testing.assert_array_equal(shear > 0.01, np.arange(N) != 1)


def test_refused_models(device: taxelsim.Device) -> None:
    model = worlds(world(add_ball, lambda b, body: b.add_shape_cone(body, radius=0.01, half_height=0.01, label="cone")))

    def message(*arguments: Any, source: Any = model, **keywords: Any) -> str:
        with pytest.raises(taxelsim.InputError) as caught:
            adapter.attach(source, *arguments, device=device, **keywords)
        return str(caught.value)

    assert message({"plam": WTS}, [BALL]) == "body or site 'plam' is not in the model; it has 'pad', 'object', 'palm'"
    assert message({"p*": WTS}, [BALL]) == "body or site 'p*': 2 found in world 0, 1 allowed"
    assert message({"palm": WTS}, ["bal"]) == "shape 'bal' is not in the model; it has 'palm', 'ball', 'cone'"
    assert message({"palm": WTS}, [BALL, "ball*"]) == "shapes: shape 'ball*' is listed twice"
    assert message({"palm": WTS}, ["cone"]).startswith("shape 'cone' is of type cone, which cannot touch a sensor: sphere, capsule,")
    assert message({"palm": WTS}, [BALL] * 9) == "shapes: 9 are not allowed: at most 8"
    assert message({"palm": WTS}) == "0 shapes and max_contacts 0 found: shapes or max_contacts is needed, not both"
    assert message({"palm": WTS}, [BALL], max_contacts=4).startswith("1 shapes and max_contacts 4 found")
    assert message({}, [BALL]) == "sensors: at least one is needed, as {body: sensor file}"
    assert "missing.yaml" in message({"palm": "missing.yaml"}, [BALL])
    alone = world().finalize(device="cpu")
    assert message({"palm": WTS}, [BALL], source=alone).startswith("body or site 'palm' is in no world: add its builder with")
    sizes = newton.ModelBuilder()
    for radius in (0.01, 0.02):
        sizes.add_world(world(lambda b, body, r=radius: b.add_shape_sphere(body, radius=r, label=BALL)))
    expected = "shape 'ball' of world 1 differs from that of world 0: type, size and mesh must be equal"
    assert message({"palm": WTS}, [BALL], source=sizes.finalize(device="cpu")) == expected


def test_a_model_in_other_memory_is_refused(device: taxelsim.Device) -> None:
    """A model that says that it lies on a GPU, where the taxelsim device is software Vulkan."""
    model = worlds(world())

    class OnGpu(SimpleNamespace):
        def __getattr__(self, name: str) -> Any:
            return getattr(model, name)

    gpu = SimpleNamespace(is_cuda=True)
    with pytest.raises(
        taxelsim.InputError, match=r"^model on namespace.* and inputs of taxelsim on cpu found: both must lie on the CPU, or"
    ):
        adapter.attach(OnGpu(device=gpu), {"palm": WTS}, [BALL], device=device)


@pytest.mark.parametrize(
    ("add", "expected"),
    [
        (lambda b, body: b.add_shape_plane(body=body, width=1.0, length=2.0, label="it"), "shape 'it' is a plane of 1 m by 2 m, which"),
        (
            lambda b, body: b.add_shape(body=body, type=newton.GeoType.CYLINDER, scale=(0.01, 0.02, 0.05), label="it"),
            "shape 'it' is a barrel, a cylinder with a barrel radius of 0.05 m, which cannot touch a sensor",
        ),
    ],
)
def test_refused_shapes(device: taxelsim.Device, add: Any, expected: str) -> None:
    with pytest.raises(taxelsim.InputError, match=f"^{expected}"):
        adapter.attach(worlds(world(add)), {"palm": WTS}, ["it"], device=device)


def test_refused_states_leave_the_sensors_usable(device: taxelsim.Device) -> None:
    builder = world()
    builder.add_site(1, xform=transform(SITE), label="other")
    model = worlds(builder)
    tactile = adapter.attach(model, {"palm": WTS, "other": WTS}, [BALL], device=device)
    other = worlds(world(), 2).state()
    with pytest.raises(taxelsim.InputError, match=rf"^state of another model: 4 bodies found, {2 * N} in the attached model$"):
        tactile.observe(other, 0.01)
    state = model.state()
    poses = state.body_q.numpy().copy()
    poses[4, 0] = np.nan  # the pad of world 2: the sensor on the ball itself stays finite
    state.body_q.assign(poses)
    with pytest.raises(taxelsim.InputError, match=r"^poses: nan of instance 2 is not finite$"):
        tactile.observe(state, 0.01)
    with pytest.raises(taxelsim.InputError):
        tactile.observe(model.state(), 0)
    frames = tactile.observe(model.state(), 0.01)
    assert all(np.isfinite(frame.total_force).all() for frame in frames.values())


def test_labels_of_worlds_with_prefixes(device: taxelsim.Device) -> None:
    builder = newton.ModelBuilder()
    for k in range(2):
        builder.add_world(world(), label_prefix=f"env_{k}")
    tactile = adapter.attach(builder.finalize(device="cpu"), {"*/palm": WTS}, ["*/ball"], device=device)
    assert tactile.simulators["*/palm"].num_instances == 2


def test_without_newton(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.startswith("taxelsim.newton")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "newton", None)
    with pytest.raises(ImportError, match=r"^taxelsim.newton needs Newton 1.8 or newer: pip install 'taxelsim\[newton\]'$"):
        importlib.import_module("taxelsim.newton")

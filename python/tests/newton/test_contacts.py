"""Newton's contacts as contact points: forces compared with the weight and with Newton's own sensor of contacts."""

from typing import Any

import numpy as np
import pytest

import taxelsim

from .worlds import WTS, newton, transform, wp

adapter = pytest.importorskip("taxelsim.newton")

GRAVITY, MASSES = 9.81, (0.05, 0.1, 0.2)  # m/s^2, kg
SOLVED = 2e-3  # relative: forces of the last of NUM_STEPS time steps, in which a body comes to rest
NUM_STEPS, DT = 500, 0.002
CENTER = np.array([0.006, -0.008])  # m, of the box in the site
DRIFT = 5e-5  # m: a body at rest on four points creeps by less
YAW = (0.0, 0.0, np.sin(0.35), np.cos(0.35))  # rotation of the pad, (x, y, z, w)


def add_pad(builder: Any) -> None:
    pad = builder.add_link(label="pad", mass=1.0, inertia=wp.mat33(np.eye(3)))
    builder.add_articulation([builder.add_joint_fixed(-1, pad, parent_xform=transform((0.1, 0.2, 0.3, *YAW)))])
    builder.add_shape_box(pad, xform=transform((0, 0, -0.01, 0, 0, 0, 1)), hx=0.02, hy=0.03, hz=0.01, label="base")
    builder.add_site(pad, label="palm")


def add_static_pad(builder: Any) -> None:
    pose = transform((0.1, 0.2, 0.3, *YAW))
    builder.add_shape_box(-1, xform=pose * transform((0, 0, -0.01, 0, 0, 0, 1)), hx=0.02, hy=0.03, hz=0.01, label="base")
    builder.add_site(-1, xform=pose, label="palm")


def add_box(builder: Any) -> None:
    pose = transform((0.1, 0.2, 0.3, *YAW)) * transform((*CENTER, 0.01, 0, 0, 0, 1))
    box = builder.add_body(xform=pose, label="box")
    builder.add_shape_box(box, hx=0.003, hy=0.004, hz=0.01, label="box_shape")


class Scene:
    """Boxes of different masses on pads, at rest."""

    def __init__(self, *parts: Any, pad: str = "pad") -> None:
        builder = newton.ModelBuilder()
        for mass in MASSES:
            one = newton.ModelBuilder()
            one.default_shape_cfg.density = mass / (0.006 * 0.008 * 0.02)
            for part in parts:
                part(one)
            builder.add_world(one)
        self.model = builder.finalize(device="cpu")
        self.model.set_gravity((0.0, 0.0, -GRAVITY))
        self.solver = newton.solvers.SolverMuJoCo(self.model)
        kinds = {"sensing_bodies": "pad"} if pad == "pad" else {"sensing_shapes": "base"}
        self.oracle = newton.sensors.SensorContact(self.model, **kinds, request_contact_attributes=False)
        pipeline = newton.CollisionPipeline(self.model, rigid_contact_max=self.solver.get_max_contact_count(), soft_contact_max=0)
        self.contacts = pipeline.contacts()
        self.observables = self.solver.observables(kinds=self.oracle.solver_observable_kinds, contacts=self.contacts)
        self.state = self.model.state()

    def step(self, count: int = NUM_STEPS) -> None:
        for _ in range(count):
            self.solver.step(self.state, self.state, None, self.contacts, DT, observables=self.observables)
        self.oracle.update(self.state, self.contacts, observables=self.observables)


@pytest.mark.parametrize(
    "parts", [(add_pad, add_box), (add_box, add_pad), (add_static_pad, add_box)], ids=["pad first", "box first", "static"]
)
def test_forces_are_newtons_contacts(device: taxelsim.Device, parts: Any) -> None:
    scene = Scene(*parts, pad="base" if add_static_pad in parts else "pad")
    tactile = adapter.attach(scene.model, {"palm": WTS}, max_contacts=8, device=device)
    scene.step()
    frame = tactile.observe(scene.state, DT, observables=scene.observables)["palm"]
    truth = frame.ground_truth
    np.testing.assert_array_equal(truth.off_array_contacts, 0)
    np.testing.assert_allclose(truth.total_force, -scene.oracle.total_force.numpy()[:, 2], rtol=1e-5)
    np.testing.assert_allclose(truth.total_force, np.array(MASSES) * GRAVITY, rtol=SOLVED)
    inputs = tactile.simulators["palm"].inputs
    np.testing.assert_array_equal(inputs.num_contacts, 4)  # corners of the box
    corners = CENTER + [(x, y) for x in (-0.003, 0.003) for y in (-0.004, 0.004)]
    for points in inputs.positions[:, :4, :2]:
        np.testing.assert_allclose(sorted(points.round(4).tolist()), corners, atol=DRIFT)


def test_refused_contacts(device: taxelsim.Device) -> None:
    scene = Scene(add_pad, add_box)
    scene.step(20)
    tactile = adapter.attach(scene.model, {"palm": WTS}, max_contacts=3, device=device)
    with pytest.raises(taxelsim.InputError, match=r"^num_contacts of instance 0: 4 is not allowed: 0 to 3$"):
        tactile.observe(scene.state, DT, observables=scene.observables)
    with pytest.raises(taxelsim.InputError, match=r"^observables without contact_f found: solver.observables\("):
        tactile.observe(scene.state, DT)

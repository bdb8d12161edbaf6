"""The feature ridge_edge_angle against a fit in NumPy, and on arrays whose gains differ."""

import numpy as np

import taxelsim

PITCH, SHAPE = 0.0034, (6, 14)  # m
NUM_STRIPS = 96
ROUNDING = 2e-4  # rad: float32 sums and two rounds of a fit with a condition number of some hundreds
SCATTER = 0.3  # of the gains of real arrays


def turned(degrees):
    """Quaternion of a cylinder along y, turned about z."""
    half = np.radians(degrees) / 2
    return np.sqrt(0.5) * np.stack([np.cos(half), np.cos(half), np.sin(half), np.sin(half)], axis=1)


def receptive_fields():
    """Mean place (pitches) and sum of what the shipped kernel brings to each taxel under an even pressure."""
    i, j = (axis.ravel() for axis in np.indices(SHAPE))
    steps = np.maximum(np.abs(i[:, None] - i), np.abs(j[:, None] - j))
    kernel = np.where(steps <= 1, np.exp(-2.0 * ((i[:, None] - i) ** 2 + (j[:, None] - j) ** 2)), 0)  # sigma of 0.5 pitches
    spread = kernel / kernel.sum(axis=0)
    sums = spread.sum(axis=1)
    return np.stack([i - 2.5, j - 6.5], axis=1), (spread @ np.stack([i - 2.5, j - 6.5], axis=1)) / sums[:, None], sums


def fitted_angle(force, gain, noise, trigger):
    """Ridge of exp(quadratic) fitted to the forces (N) of one image, rad; weighted least squares by numpy.linalg.lstsq."""
    places, fields, sums = receptive_fields()
    center = force @ places / force.sum()
    second = np.cov(places.T, aweights=force, ddof=0)
    values, axes = np.linalg.eigh(second)
    unit = np.maximum(np.sqrt(values[::-1]), 0.5)
    u, v = ((fields - center) @ axes[:, ::-1] / unit).T
    monomials = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], axis=1)
    over, peak = sums * gain, force.max()
    f = force / over
    prior, prior_target = np.sqrt(0.1) * np.eye(6)[1:], np.sqrt(0.1) * np.array([0, 0, -0.5, 0, -0.5])
    b = np.array([0, 0, 0, -0.5, 0, -0.5])
    for _ in range(2):
        log = np.clip(monomials @ b, -20, 1)
        expected = peak * np.exp(log)
        excess = np.clip(f / expected - 1, -1, 1)
        error = np.hypot(noise / over, 0.03 * peak) / 0.2
        weight = expected**2 / (expected**2 + error**2)
        weight = np.where(f > 0, weight, weight * np.maximum(1 - trigger / (over * expected), 0))
        root = np.sqrt(weight)[:, None]
        b = np.linalg.lstsq(np.vstack([root * monomials, prior]), np.append(root[:, 0] * (log + excess), prior_target), rcond=None)[0]
    to_xy = axes[:, ::-1] / unit
    curvature = to_xy @ np.array([[b[3], b[4] / 2], [b[4] / 2, b[5]]]) @ to_xy.T
    x, y = np.linalg.eigh(curvature)[1][:, 1]
    return np.arctan2(y, x)


def apart(a, b):
    """Absolute difference of angles modulo pi."""
    return np.abs((a - b + np.pi / 2) % np.pi - np.pi / 2)


def press(device, readout_changes, seed):
    """Counts, contact features and true angles (rad) of strips on an array, and its sensor."""
    random = np.random.default_rng(seed)
    base = taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")
    sensor = base.replace(readout=base.readout.replace(**readout_changes))
    model = taxelsim.Model(device, sensor, [taxelsim.Cylinder(radius=0.006, length=0.12)])
    simulator = taxelsim.Simulator(model, NUM_STRIPS, seed=seed, outputs=taxelsim.OutputOptions(contact_features=True))
    yaw = random.uniform(-85, 85, NUM_STRIPS)
    places = np.column_stack([random.uniform(-0.005, 0.005, (NUM_STRIPS, 2)), np.full(NUM_STRIPS, 0.006)])
    simulator.set_objects(0, np.hstack([places, turned(yaw)]))
    simulator.set_loads(random.uniform(1, 4, NUM_STRIPS))
    simulator.step(0.01)
    frame = simulator.read().copy()
    return frame.tactile_image.reshape(NUM_STRIPS, -1), frame.contact, np.radians(90 + yaw), sensor


def gains(seed):
    return np.exp(SCATTER * np.random.default_rng(seed).standard_normal(SHAPE[0] * SHAPE[1]))


def test_the_device_fits_what_numpy_fits(device):
    known = gains(1)
    counts, contact, _, sensor = press(device, {"taxel_gain": list(known), "calibrated_gain": list(known), "noise": 17.0}, 1)
    force = np.where(counts > 0, counts / sensor.readout.curve[0] + sensor.readout.trigger, 0)
    fits = np.array([fitted_angle(image, known, 17 / sensor.readout.curve[0], sensor.readout.trigger) for image in force])
    assert np.max(apart(contact.ridge_edge_angle[:, 0], fits)) < ROUNDING


def test_scattered_gains_turn_the_ridge_less_than_the_window(device):
    errors = {}
    for name in ("unknown", "known"):
        parts = []
        for array in range(4):
            scattered = list(gains(10 + array))
            changes = {"taxel_gain": scattered, "calibrated_gain": scattered if name == "known" else [], "noise": 17.0}
            _, contact, angles, _ = press(device, changes, 20 + array)
            window = np.degrees(apart(contact.windowed_edge_angle[:, 0], angles))
            parts.append((np.degrees(apart(contact.ridge_edge_angle[:, 0], angles)), window))
        errors[name] = tuple(np.median(np.concatenate(both)) for both in zip(*parts, strict=True))
    assert errors["unknown"][0] < 1.3 < errors["unknown"][1]  # deg, what a servo needs
    assert errors["known"][0] < 0.7

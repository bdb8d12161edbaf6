"""The cases of the golden test: thirteen scenes for `taxelsim generate` and forty-two calls of `taxelsim frame`.

Scenes are made from the sensors that ship, on small changes of their own, so that every contact law, every form of sensor and every kind of
object is computed at least once.
"""

SENSORS = "scenes/sensors/"
OBJECTS = "scenes/objects/"
LIE_ALONG_Y = "orientation: {rpy_deg: [0, 0, 90]}"
CYLINDER = "{cylinder: {radius_mm: 8, length_mm: 60}, orientation: {rpy_deg: [90, 0, 0]}, edge: [0, 0, 1]}"
MIXED = [
    CYLINDER,
    "{mesh: %shex_prism.obj, %s}" % (OBJECTS, LIE_ALONG_Y),
    "{mesh: %sknob_5k.obj, %s}" % (OBJECTS, LIE_ALONG_Y),
    "{mesh: %sbunny.obj, scale: 0.005, up_axis: y}" % OBJECTS,
]
SOLIDS = [
    "{sphere: {radius_mm: 10}}",
    "{capsule: {radius_mm: 4, length_mm: 15}, orientation: {rpy_deg: [90, 0, 0]}}",
    "{box: {size_mm: [12, 20, 10]}}",
    "{cone: {radius_mm: 12, height_mm: 4}}",
    "{torus: {major_radius_mm: 8, minor_radius_mm: 2.5}}",
]
SERVO = """
  tactile_servo:
    edge_angle: {reference_deg: 90, kp: 0.78}
    total_force: {kp: 2}
    center_across: {kp: 1}
    exploration_velocity_mm: 5"""
FORCE_SERVO = """
  tactile_servo:
    total_force: {kp: 2}"""
IMAGES = ["tactile_image", "features", "ground_truth", "tactile_normal_force", "poses"]
NOISY = ["gain: [0.9, 1.1]", "gain_spread: 0.05", "noise: [0, 17]"]


def sensor_in_place(text):
    """A sensor block for a scene, its lines indented by two."""
    return "\n" + "\n".join("  " + line for line in text.strip().splitlines())


def pad(skin, readout=(), psf="gaussian: {sigma: 0.5, size: 3}", shape="num_rows: 4\nnum_cols: 5\npitch_mm: 3.4", samples=4):
    """A small sensor with the given lines of its skin and readout."""
    lines = ["name: pad", *shape.splitlines(), f"samples_per_taxel: {samples}", "skin:", "  thickness_mm: 2"]
    lines += ["  " + line for line in skin]
    lines += ["psf:", "  " + psf, "readout:", "  curve: {counts_per_newton: 2400}", "  trigger: 0.02"]
    lines += ["  " + line for line in readout]
    return sensor_in_place("\n".join(lines))


def servo(sensor, objects, randomization, controller=SERVO, record=(), steps=12, robot="", more=""):
    return scene(sensor, objects, randomization, record or IMAGES + ["actions"], "servo", steps, "controller:" + controller + "\n" + more, robot)


def contacts(sensor, objects, randomization, record=()):
    return scene(sensor, objects, randomization, record or IMAGES, "contacts", 0, "", "")


def scene(sensor, objects, randomization, record, kind, steps, controller, robot):
    lines = ["format_version: 1", "name: golden", f"kind: {kind}", f"sensor: {sensor}"]
    if robot:
        lines.append(f"robot: {robot}")
    lines += ["objects:"] + ["  - " + item for item in objects]
    if steps:
        lines += ["episode:", f"  num_steps: {steps}", "  simulation_rate: 100"]
    place = ["x_mm: [-3, 3]", "y_mm: [-6, 6]", "yaw_deg: [-60, 60]", "tilt_deg: [0, 3]"]
    lines += ["randomization:"] + ["  " + line for line in place + randomization]
    if controller:
        lines.append(controller.rstrip("\n"))
    lines += ["record: [%s]" % ", ".join(record), "data_set: {episodes: 24, seed: 5, episodes_per_shard: 16, compression: 1}"]
    return "\n".join(lines) + "\n"


DATA_SETS = {
    "winkler_servo": servo(SENSORS + "wts0614_soft_cover.yaml", MIXED, ["load: [0.5, 5]", *NOISY]),
    "winkler_loads": contacts(SENSORS + "wts0614_soft_cover.yaml", MIXED + SOLIDS, ["load: [0.2, 3]", *NOISY]),
    "mass_spring_damper": servo(SENSORS + "wts0614_mass_spring_damper.yaml", MIXED, ["load: [0.5, 3]"]),
    "deformation_mask": contacts(SENSORS + "wts0614_deformation_mask.yaml", MIXED, ["load: [0.5, 3]"]),
    "proximity": contacts(SENSORS + "wts0614_proximity.yaml", MIXED + SOLIDS, ["depth_mm: [0.1, 1]"], IMAGES + ["penetration_depth"]),
    "lugre": servo(SENSORS + "wts0614_lugre.yaml", MIXED, ["load: [1, 4]"], record=IMAGES + ["tactile_shear_force", "actions"]),
    "elastic_layer": servo(
        pad(["law: elastic_layer", "elastic_modulus: 1e6", "poisson_ratio: 0.49", "margin_mm: 3", "friction_coefficient: 0.8",
             "tangential_stiffness: 1e8", "relaxation: [{fraction: 0.3, time: 0.05}]"]),
        MIXED[:3], ["load: [1, 3]"], FORCE_SERVO, IMAGES + ["tactile_shear_force", "tactile_jacobian", "clean_tactile_jacobian"], steps=6),
    "patches": contacts(SENSORS + "digitacts_6x4.yaml", MIXED, ["load: [1, 6]", *NOISY],
                        IMAGES + ["contact_features", "clean_contact_features", "tactile_jacobian"]),
    "taxel_list": contacts(SENSORS + "fingertip_sphere.yaml", SOLIDS[:3] + [MIXED[1]], ["load: [0.1, 0.8]", *NOISY],
                           IMAGES + ["contact_features"]),
    "friction": servo(
        pad(["law: winkler", "normal_contact_stiffness: 1.73e8", "normal_exponent: 1.5", "friction_coefficient: 0.8", "tangential_stiffness: 1e8"]),
        MIXED, ["load: [1, 3]"], record=IMAGES + ["tactile_shear_force", "tactile_jacobian", "contact_features", "actions"]),
    "three_axis": servo(SENSORS + "uskin_like_4x4.yaml", MIXED[:2] + SOLIDS[:1], ["load: [1, 3]", *NOISY],
                        record=["tactile_image", "taxel_counts", "tactile_shear_force", "actions"]),
    "relaxation": servo(
        pad(["law: winkler", "normal_contact_stiffness: 1.73e8", "relaxation: [{fraction: 0.3, time: 0.05}, {fraction: 0.1, time: 0.5}]"],
            ["hysteresis_strength: [0.1, 0.05]", "hysteresis_width: [0.02, 0.1]", "creep: [{fraction: 0.1, time: 0.2}]", "low_pass_time: 0.01",
             "delay: 0.02", "bias: 3", "random_walk: 5", "gain_spread: 0.1", "dead_taxel_probability: 0.05", "noise: 4"]),
        MIXED, ["load: [1, 3]"]),
    "robot": servo(SENSORS + "wts0614_soft_cover.yaml",
                   [CYLINDER.replace("edge:", "motion: {hand_held: {drift_mm: 0.3, drift_angle_deg: 1, tremor_mm: 0.02}}, edge:")],
                   ["load: [1, 4]", "exploration_velocity_mm: [0, 8]", "linear_action_noise_mm: [0, 2]"], record=IMAGES + ["actions", "robot"],
                   robot="scenes/robots/pan_tilt.yaml", controller="""
  tactile_servo:
    edge_angle: {reference_deg: 90, kp: 3}
    total_force: {kp: 2}"""),
}

UPRIGHT = "1 0 0 0"
ALONG_Y = "0.70710678 0.70710678 0 0"
TURNED = "0.6532815 0.6532815 0.2705981 0.2705981"


def pressed(sensor, shape, pose, *more):
    return ["--sensor", f"{SENSORS}{sensor}.yaml", "--object", shape, "--pose", pose, *more]


def frames():
    """Name to arguments of `taxelsim frame --json`."""
    cases = {}
    laws = ["wts0614", "wts0614_soft_cover", "wts0614_pin", "wts0614_mass_spring_damper", "wts0614_deformation_mask", "wts0614_proximity",
            "wts0614_lugre", "wts0614_elastic_layer", "cea_list", "digitacts_6x4", "fingertip_sphere", "fingertip_cylinder", "weiss_dsa_distal"]
    for sensor in laws:
        cases[f"{sensor}_sphere"] = pressed(sensor, "sphere:0.01", f"0.001 0.0005 0.0094 {UPRIGHT}")
    for sensor in ["wts0614_soft_cover", "wts0614_deformation_mask", "wts0614_elastic_layer", "digitacts_6x4", "fingertip_sphere", "weiss_dsa_distal"]:
        cases[f"{sensor}_load"] = pressed(sensor, "sphere:0.006", f"0 0.0003 0.02 {UPRIGHT}", "--load", "0.7")
        cases[f"{sensor}_prism"] = pressed(sensor, OBJECTS + "hex_prism.obj", f"0.001 0 0.0082 {TURNED}")
    shapes = {
        "cylinder": ("cylinder:0.008,0.04", f"0 0 0.0075 {TURNED}"),
        "capsule": ("capsule:0.004,0.015", f"0.002 0.001 0.0036 {ALONG_Y}"),
        "box": ("box:0.012,0.02,0.01", f"0.0013 0.0021 0.0046 {UPRIGHT}"),
        "cone": ("cone:0.012,0.004", f"0.0013 0.0021 -0.0008 {UPRIGHT}"),
        "torus": ("torus:0.008,0.0025", f"0.0013 0.0021 0.0021 {UPRIGHT}"),
        "half_space": ("half_space", f"0 0 -0.0003 {UPRIGHT}"),
        "knob": (OBJECTS + "knob_5k.obj", f"0 0 0.0095 {UPRIGHT}"),
        "saddle": (OBJECTS + "saddle.obj", f"0 0 -0.0005 {UPRIGHT}"),
        "bar": (OBJECTS + "edge_bar.obj", f"0.002 0 0.0045 {TURNED}"),
        "clover": (OBJECTS + "ridge_clover.obj", f"0.01 0.004 -0.0005 {UPRIGHT}"),
        "drill": (OBJECTS + "YcbPowerDrill.obj", f"0 0 0.025 {UPRIGHT}"),
        "banana": (OBJECTS + "YcbBanana.obj", f"0 0 0.017 {UPRIGHT}"),
    }
    for name, (shape, pose) in shapes.items():
        cases[f"wts0614_soft_cover_{name}"] = pressed("wts0614_soft_cover", shape, pose)
    cases["wts0614_soft_cover_two_objects"] = pressed("wts0614_soft_cover", "sphere:0.005", f"0 0.01 0.0045 {UPRIGHT}") + [
        "--object", "sphere:0.006", "--pose", f"0.002 -0.01 0.0054 {UPRIGHT}"]
    cases["papillarray_like_3x3_slide"] = pressed("papillarray_like_3x3", "sphere:0.01", f"0.001 0.0005 0.0095 {UPRIGHT}", "--slide", "0.0005 0.0002")
    cases["wts0614_soft_cover_contacts"] = ["--sensor", SENSORS + "wts0614_soft_cover.yaml", "--contacts", "tests/golden/contacts.csv"]
    cases["digitacts_contacts"] = ["--sensor", SENSORS + "digitacts_6x4.yaml", "--contacts", "tests/golden/contacts.csv"]
    cases["wts0614_soft_cover_banana_load"] = pressed("wts0614_soft_cover", OBJECTS + "YcbBanana.obj", f"0 0 0.05 {UPRIGHT}", "--load", "3")
    return cases


FRAMES = frames()

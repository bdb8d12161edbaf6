"""Parts of the MuJoCo models: a pad with an elastic cover, and joints that follow a position.

MuJoCo's contacts have no tangential elasticity: an object that sticks does not move against the pad, and a skin that only observes would
show no shear. The cover is therefore a plate on three springs. An object presses it back and drags it along, and the sensor at the site,
which does not move with the plate, sees this displacement as depth and shear.
"""

from __future__ import annotations

SITE = "skin"
"""Site of the sensor in every model."""

SOFT_STIFFNESS = 1.73e8
"""N/m^3, of wts0614_soft_cover.yaml: the springs below belong to it. Other sensors have them in proportion."""

NORMAL_STIFFNESS = 1.2e4
"""N/m: the line contact of a cylinder of 15 mm, 20 mm long and 0.25 mm deep: (2/3) 1.73e8 N/m^3 x 5.5 mm x 20 mm."""

TANGENTIAL_RATIO = 0.3
"""Tangential over normal stiffness of the skin per area: rubber on a rigid base is stiffer in compression."""

SERVO = 4000  # N/m, of a position servo
COVER_MASS = 0.05  # kg: with the springs, 80 Hz


def pad(stiffness: float, extra: str = "", normal: float = NORMAL_STIFFNESS, ratio: float = 1.5) -> str:
    """Contents of a body whose frame is the sensor frame: site, and cover of the size of the WTS 0614 with its face at z = 0.

    stiffness: N/m^3, of the skin. extra: attributes of the geom `cover`. normal: N/m, of a skin of SOFT_STIFFNESS under the object.
    ratio: greatest over mean depth of the contact: a shift d gives k_t A d, an indentation d gives k A d / ratio.
    """
    scaled = normal * stiffness / SOFT_STIFFNESS
    return f"""<site name="{SITE}"/>{cover("cover", scaled, scaled * TANGENTIAL_RATIO * ratio, extra)}"""


def cover(name: str, normal: float, tangential: float, extra: str = "") -> str:
    """A plate on springs, N/m, with its face at z = 0."""
    joints = "".join(
        f'<joint name="{name}_{axis}" type="slide" axis="{direction}" stiffness="{k:.9g}" damping="{(k * COVER_MASS) ** 0.5:.9g}"/>'
        for axis, direction, k in (("x", "1 0 0", tangential), ("y", "0 1 0", tangential), ("z", "0 0 1", normal))
    )
    return (
        f'<body name="{name}" gravcomp="1">{joints}<geom name="{name}" type="box" size=".0102 .0238 .003" pos="0 0 -.003" '
        f'mass="{COVER_MASS}" {extra}/></body>'
    )


def document(body: str, actuators: str, options: str = "") -> str:
    """A model with a time step of 1 ms and stiff contacts. Friction is that of each geom."""
    return f"""<mujoco>
  <option timestep="0.001" integrator="implicitfast" cone="elliptic" impratio="20" {options}><flag sensor="disable"/></option>
  <default><geom solref="0.004 1" solimp="0.95 0.99 0.0005" condim="4"/><position kp="{SERVO}" dampratio="1"/></default>
  <worldbody>{body}</worldbody>
  <actuator>{actuators}</actuator>
</mujoco>"""

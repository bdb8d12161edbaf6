"""Settings that replace those of a sensor."""

from __future__ import annotations

from dataclasses import dataclass

from .._core import AreaStiffness, DepthSampling, Sensor, Skin, SkinData, foundation_of, gaussian_psf, skin_stiffness, skins_of
from ..errors import InputError


@dataclass(frozen=True)
class Changes:
    """Settings that replace those of the sensor; None keeps the sensor's."""

    law: str | None = None
    friction_coefficient: float | None = None
    noise: float | None = None  #: Counts.
    sigma: float | None = None  #: Taxels, width of a Gaussian point spread function, > 0.
    depth_sampling: str | None = None  #: A DepthSampling, in lower case.


def law_name(skin: Skin) -> str:
    """Name of a skin's contact law without the underscores that it has in files: "elasticlayer"."""
    return type(skin.law).__name__.lower()


def skin_under(skin: Skin, law: str, friction: float) -> Skin:
    """A skin of the same thickness and area stiffness under another contact law, by its name in files. Raises InputError."""
    stiffness = AreaStiffness(foundation_of(skin).normal_contact_stiffness)
    skins = skins_of(skin_stiffness(SkinData(thickness=skin.thickness, stiffness=stiffness)), friction)
    found = [each for each in skins if law_name(each) == law.replace("_", "")]
    if not found:
        raise InputError(f"law: {law!r} is not allowed: {', '.join(map(law_name, skins))}")
    return found[0]


def changed_sensor(sensor: Sensor, changes: Changes) -> Sensor:
    """The sensor with changes, in the steady state that a single frame shows. Raises InputError."""
    skin, readout = sensor.skin, sensor.readout.replace(delay=0.0, low_pass_time=0.0)
    own = skin.friction.friction_coefficient
    friction = own if changes.friction_coefficient is None else changes.friction_coefficient
    if changes.law is not None and changes.law.replace("_", "") != law_name(skin):
        skin = skin_under(skin, changes.law, friction)
    elif friction != own:
        skin = skin.replace(friction=skin_under(skin, law_name(skin), friction).friction)
    if changes.noise is not None:
        readout = readout.replace(noise=changes.noise)
    sensor = sensor.replace(skin=skin, readout=readout)
    if changes.sigma is not None:
        sensor = sensor.replace(psf=gaussian_psf(changes.sigma, 5, sensor.psf.normalization))
    if changes.depth_sampling is not None:
        sensor = sensor.replace(depth_sampling=DepthSampling[changes.depth_sampling.upper()])
    return sensor

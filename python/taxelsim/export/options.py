"""Options of an export."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Options:
    """Options of an export. Formats ignore none of them: `export` refuses an option that a format does not have."""

    episodes: tuple[int, int] | None = None  #: First and last episode, both included. None: all.
    sensor: str | None = None  #: Exports only this sensor of a data set of kind grasp. None: all sensors.
    state: tuple[str, ...] = ()  #: Columns of the state. Empty: joint positions and pose of the sensor, where recorded.
    columns: tuple[str, ...] = ()  #: Further columns of data/.
    tactile_in_state: bool = False  #: Appends the tactile image to the state, for policies that read the state only.
    task: str = "{scene}: {object}"  #: LeRobot, oxt: text of the task. {scene}, {object}: names of the scene and of the episode's object.
    tactile_key: str = "observation.tactile"  #: LeRobot: name of the tactile image.
    video: bool = False  #: LeRobot: the tactile image as a video as well.
    range: float | None = None  #: LeRobot, oxt: counts of the brightest colour. None: from the data set, as `taxelsim render` draws it.
    frame_rate: float | None = (
        None  #: LeRobot: frames/s; touch at the rate of the data set becomes a window of each frame. None: that rate.
    )
    layout: str = "image"  #: LeRobot: "points" adds place, normal and force of each taxel.
    wrench: bool = False  #: LeRobot: adds the wrench of contact.
    assets: tuple[str, ...] = ()  #: LeRobot, oxt: folders that are searched for a taxel mesh or URDF of the scene, which pictures need.
    place: tuple[str, ...] = ()  #: oxt: SENSOR=AREA or SENSOR=SIDE:AREA, the functional areas of sensors.
    joints: tuple[str, ...] = ()  #: oxt: [SIDE:]NAME of joints of the arm, [SIDE:]NAME=SLOT of the hand. ("none",): no joints.
    wrist: tuple[str, ...] = ()  #: oxt: names of the sensors whose poses stand for the wrists. Empty: the only one of a side.
    camera: str = "arrays"  #: oxt: RGB stream, "arrays" or "scene" (slow; one sensor).
    zarr_format: int = 2  #: Zarr: 2 or 3. 3 packs chunks into shards.
    next_observations: bool = False  #: robomimic: next_obs as well, for offline reinforcement learning.

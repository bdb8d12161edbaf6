"""taxelsim.view(): a recording of episodes."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from .._core import Device
from .source import open_source, warn

if TYPE_CHECKING:
    import rerun


def view(
    path: str | os.PathLike[str],
    episodes: int | Sequence[int] | None = None,
    *,
    assets: Sequence[str | os.PathLike[str]] = (),
    device: Device | None = None,
    isolated: bool = False,
    range: float | None = None,
) -> rerun.RecordingStream:
    """A recording for the viewer Rerun: objects, taxels coloured by force, shear, tactile images and time series of episodes.

    >>> taxelsim.view("out", [3, 17]).notebook_show()  # in a notebook; needs rerun-sdk[notebook]
    >>> taxelsim.view("scene.yaml").spawn()  # a window

    path: a data set, or a scene file, whose episodes are simulated and not kept.
    episodes: numbers of the episodes; default: the first three.
    assets: folders with meshes and other files of the scene of a data set; those of the package are found by themselves.
    device: simulates a scene; default Device.open().
    isolated: for data sets from strangers, as in Dataset().
    range: counts of the brightest colour; default: from the data set, as `taxelsim render` draws it.

    Logs a warning for an object that is 100 times larger or smaller than the sensor, away from it, or behind its skin.
    Raises InputError for a data set, scene or episode that cannot be shown, ImportError without rerun-sdk.
    """
    try:
        import rerun
    except ImportError as error:
        raise ImportError("the viewer needs rerun-sdk: pip install 'taxelsim[view]'") from error
    from .checks import place_warnings
    from .layout import blueprint_of
    from .recording import EpisodeWriter

    numbers = [episodes] if isinstance(episodes, int) else episodes
    source = open_source(Path(path), numbers, [Path(folder) for folder in assets], device, isolated, range)
    warn(place_warnings(source))
    recording = rerun.RecordingStream("taxelsim")
    recording.send_recording_name(source.scene.name)
    writers = [EpisodeWriter(recording, episode, source.ranges) for episode in source.episodes]
    for writer, episode in zip(writers, source.episodes, strict=True):
        index = episode.object_index
        writer.write(None if index is None or index in source.missing else source.scene.objects[index])
        if episode.name == source.episodes[0].name:
            writer.write_objects([None if i in source.missing else item for i, item in enumerate(source.scene.objects)])
    recording.send_blueprint(blueprint_of(writers))
    return recording

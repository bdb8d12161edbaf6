"""taxelsim.view(): a recording of episodes."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from .._core import Device, Object
from ..errors import InputError
from .source import open_source, warn

if TYPE_CHECKING:
    import rerun

    from .recording import EpisodeWriter


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

    path: a data set; a scene file, whose episodes are simulated and not kept; or a measurement file with images of a real sensor.
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
    from .measurements import is_measurement, open_measurement
    from .recording import EpisodeWriter

    if is_measurement(Path(path)):
        if episodes is not None:
            raise InputError(f"{path}: episodes: not allowed for a measurement")
        episode, ranges = open_measurement(Path(path), range)
        stream = rerun.RecordingStream("taxelsim")
        return _recorded(stream, Path(path).stem, [(EpisodeWriter(stream, episode, ranges), None, ())])
    numbers = [episodes] if isinstance(episodes, int) else episodes
    source = open_source(Path(path), numbers, [Path(folder) for folder in assets], device, isolated, range)
    warn(place_warnings(source))
    recording = rerun.RecordingStream("taxelsim")
    objects = [None if i in source.missing else item for i, item in enumerate(source.scene.objects)]
    parts = []
    for episode in source.episodes:
        index, writer = episode.object_index, EpisodeWriter(recording, episode, source.ranges)
        parts.append((writer, None if index is None else objects[index], objects if episode.name == source.episodes[0].name else ()))
    return _recorded(recording, source.scene.name, parts)


def _recorded(
    recording: rerun.RecordingStream, name: str, parts: Sequence[tuple[EpisodeWriter, Object | None, Sequence[Object | None]]]
) -> rerun.RecordingStream:
    """Writes episodes, each with the object that is touched and the objects in the world."""
    from .layout import blueprint_of

    recording.send_recording_name(name)
    for writer, item, objects in parts:
        writer.write(item)
        writer.write_objects(objects)
    recording.send_blueprint(blueprint_of([writer for writer, _, _ in parts]))
    return recording

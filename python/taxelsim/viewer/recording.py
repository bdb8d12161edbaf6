"""An episode as entities of a recording."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from .._core import Object, nominal_force
from ..pictures import ARROW_TAXELS, TACTILE_IMAGE, TAXEL_COUNTS, colours_of, taxel_axes, taxel_chart, taxel_map
from .checks import extent_of
from .episode_text import summary_of
from .series import series_of
from .shapes import flat_shaded, taxel_quads, triangles_of
from .source import Episode

OBJECT_COLOUR = (190, 190, 200)
ARROW_COLOUR = (230, 60, 60)
COUNTS_ARROW_COLOUR = (240, 160, 30)
COUNT_AXES = ("x", "y", "normal")


class EpisodeWriter:
    """Writes one episode below the entity `episode_<number>`, on the timelines `time` (s) and `frame`."""

    def __init__(self, recording: rr.RecordingStream, episode: Episode, ranges: Mapping[str, float]) -> None:
        """ranges: counts of the brightest colour by column."""
        self._recording = recording
        self._episode = episode
        self._ranges = ranges
        readout = episode.sensor.readout
        force = nominal_force(readout, min(ranges[TACTILE_IMAGE], readout.saturation))
        self._largest_force = force if force > 0 else 1.0  # N; a taxel that reads without a load has no force there
        self.root = f"episode_{episode.number}"
        self.num_sensors = episode.num_sensors
        self.series = series_of(episode)
        self.name = episode.name
        self._frames = np.arange(len(episode))

    def write(self, item: Object | None) -> None:
        """item: the object that is touched; None if it is not known."""
        self._static("summary", rr.TextDocument(summary_of(self._episode, self._largest_force), media_type="text/markdown"))
        self._static("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        for k in range(self.num_sensors):
            self._write_sensor(k)
        if item is not None and "data/pose" in self._episode.columns:
            vertices, normals = flat_shaded(*triangles_of(item.shape, 2 * extent_of(self._episode.sensor)))
            mesh = rr.Mesh3D(vertex_positions=vertices, vertex_normals=normals, albedo_factor=OBJECT_COLOUR)
            self._static(f"{self.sensor_path(0)}/object", mesh)
        for series in self.series:
            self._static(series.path, rr.SeriesLines(names=list(series.names)))
            self._columns(series.path, rr.Scalars.columns(scalars=series.values), series.frames)

    def write_objects(self, objects: Sequence[Object | None]) -> None:
        """Objects whose poses in the world are recorded. objects: of the scene; None where a mesh is not known."""
        poses = self._episode.columns.get("data/object_pose")
        if poses is None:
            return
        for i, item in enumerate(objects):
            entity, X_WO = f"world/object_{i}", np.asarray(poses)[:, i]
            self._columns(entity, rr.Transform3D.columns(translation=X_WO[:, :3], quaternion=X_WO[:, [4, 5, 6, 3]]))
            if item is not None:
                vertices, normals = flat_shaded(*triangles_of(item.shape, 2 * extent_of(self._episode.sensor)))
                self._static(entity, rr.Mesh3D(vertex_positions=vertices, vertex_normals=normals, albedo_factor=OBJECT_COLOUR))

    def sensor_path(self, k: int) -> str:
        """Entity of sensor k, whose frame is S."""
        if self.name:
            return f"world/{self.name}"
        return "world/sensor" if self.num_sensors == 1 else f"world/sensor_{k}"

    def image_path(self, k: int) -> str:
        """Entity of the tactile image of sensor k."""
        if self.name:
            return f"tactile_image/{self.name}"
        return "tactile_image" if self.num_sensors == 1 else f"tactile_image_{k}"

    def _write_sensor(self, k: int) -> None:
        episode, path = self._episode, self.sensor_path(k)
        for name, entity in (("data/sensor_pose", path), ("data/pose", f"{path}/object")):
            poses = episode.per_sensor(name, (7,))
            if poses is not None and not (k and name == "data/pose"):
                position, rotation = poses[:, k, :3], poses[:, k, [4, 5, 6, 3]]  # x, y, z, w
                self._columns(entity, rr.Transform3D.columns(translation=position, quaternion=rotation))
        vertices, triangles = taxel_quads(episode.sensor)
        self._static(f"{path}/taxels", rr.Mesh3D(vertex_positions=vertices, triangle_indices=triangles))
        colours = _packed(np.repeat(colours_of(episode.forces[:, k] / self._largest_force), 4, axis=1))
        self._columns(f"{path}/taxels", rr.Mesh3D.columns(vertex_colors=colours.ravel()).partition([len(vertices)] * len(episode)))
        self._write_shear(k)
        self._write_image(k)

    def _write_shear(self, k: int) -> None:
        sensor = self._episode.sensor
        shear = self._episode.per_sensor("data/ground_truth/tactile_shear_force", (sensor.num_taxels, 2))
        if shear is not None:
            self._write_arrows(k, "shear", shear / self._largest_force, ARROW_COLOUR)
        if self.has_taxel_counts:
            self._write_arrows(k, "shear_counts", self._taxel_counts()[..., :2] / self._ranges[TAXEL_COUNTS], COUNTS_ARROW_COLOUR)

    def _write_arrows(self, k: int, name: str, values: NDArray[Any], colour: tuple[int, int, int]) -> None:
        """Arrows of sensor k along x and y of the taxels. values: (F, num_sensors, num_taxels, 2), 1 at the brightest colour."""
        sensor = self._episode.sensor
        pitch = max(sensor.patches[0].pitch)
        vectors = np.einsum("fta,tas->fts", values[:, k], taxel_axes(sensor)) * (ARROW_TAXELS * pitch)
        entity = f"{self.sensor_path(k)}/{name}"
        fixed = rr.Arrows3D.from_fields(origins=sensor.taxel_positions, colors=[colour], radii=[pitch / 20])
        self._static(entity, fixed)
        self._columns(entity, rr.Arrows3D.columns(vectors=vectors.reshape(-1, 3)).partition([sensor.num_taxels] * len(vectors)))

    @property
    def has_taxel_counts(self) -> bool:
        """Whether counts of three-axis taxels are recorded."""
        return TAXEL_COUNTS in self._episode.columns

    def _taxel_counts(self) -> NDArray[np.int32]:
        """(F, num_sensors, num_taxels, 3)."""
        counts = self._episode.per_sensor(TAXEL_COUNTS, (self._episode.sensor.num_taxels, 3))
        return np.asarray(counts, np.int32)

    def _write_image(self, k: int) -> None:
        episode, entity = self._episode, self.image_path(k)
        counts = episode.image.astype(np.uint16, copy=False).reshape(len(episode), episode.num_sensors, episode.sensor.num_taxels)[:, k]
        self._write_images(entity, counts, "viridis", [0, self._ranges[TACTILE_IMAGE]])
        if not self.has_taxel_counts:
            return
        largest = self._ranges[TAXEL_COUNTS]
        for axis, name in enumerate(COUNT_AXES):
            colormap, limits = ("viridis", [0, largest]) if name == "normal" else ("cyantoyellow", [-largest, largest])
            self._write_images(self.counts_path(k, name), self._taxel_counts()[:, k, :, axis], colormap, limits)

    def counts_path(self, k: int, axis: str) -> str:
        """Entity of the counts of three-axis taxels of sensor k along an axis out of COUNT_AXES."""
        if self.name:
            return f"taxel_counts/{self.name}/{axis}"
        return f"taxel_counts/{axis}" if self.num_sensors == 1 else f"taxel_counts_{k}/{axis}"

    def _write_images(self, entity: str, counts: NDArray[Any], colormap: str, limits: list[float]) -> None:
        """Images of one sensor. counts: (F, num_taxels)."""
        sensor = self._episode.sensor
        if len(sensor.patches) == 1:
            images = counts.reshape(len(counts), sensor.patches[0].num_rows, sensor.patches[0].num_cols)
        else:
            images = counts[:, taxel_map(taxel_chart(sensor)[0])]
        self._static(entity, _image_format(images, colormap, limits))
        rows = np.ascontiguousarray(images).reshape(len(counts), -1)
        self._columns(entity, rr.DepthImage.columns(buffer=rows.view(np.uint8)))

    def _static(self, path: str, archetype: Any) -> None:
        self._recording.log(f"{self.root}/{path}", archetype, static=True)

    def _columns(self, path: str, columns: Any, frames: NDArray[np.intp] | None = None) -> None:
        chosen = self._frames if frames is None else frames
        indexes = [rr.TimeColumn("frame", sequence=chosen)]
        if "data/time" in self._episode.columns:  # which a measurement may lack
            nanoseconds = np.rint(1e9 * np.asarray(self._episode.columns["data/time"])[chosen])  # Rerun truncates seconds
            indexes.insert(0, rr.TimeColumn("time", duration=nanoseconds.astype("timedelta64[ns]")))
        self._recording.send_columns(f"{self.root}/{path}", indexes, columns)


def _packed(colours: NDArray[np.uint8]) -> NDArray[np.uint32]:
    """0xRRGGBBAA of opaque colours (..., 3)."""
    red, green, blue = np.moveaxis(colours.astype(np.uint32), -1, 0)
    return np.asarray(red << 24 | green << 16 | blue << 8 | 0xFF, np.uint32)


def _image_format(images: NDArray[Any], colormap: str, limits: list[float]) -> rr.DepthImage:
    """What all images (F, height, width) have in common. An image of counts, so that the viewer shows the counts below the cursor."""
    datatype = {"uint16": "U16", "int32": "I32"}[images.dtype.name]
    size = rr.components.ImageFormat(width=images.shape[2], height=images.shape[1], channel_datatype=datatype)
    return rr.DepthImage.from_fields(format=size, meter=1.0, colormap=colormap, depth_range=limits)

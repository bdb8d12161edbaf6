"""Pictures as a video: MP4 (H.264, by PyAV) or GIF (by Pillow)."""

from __future__ import annotations

import io
import itertools
import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._files import require_folder, write_whole
from .errors import InputError

Picture = NDArray[np.uint8]  # (height, width, 3)

MAX_RATES = {".mp4": 50, ".gif": 25}
"""Pictures per second by suffix, beyond which players leave some out."""

_MP4_TICKS = 90_000  # per second: the unit of a picture's time
_MP4_OPTIONS = {"crf": "18"}  # of x264; visually lossless
# The lookahead of x264 makes about 1 file in 100 differ if the width of its pictures is not a multiple of 16.
_SAME_BYTES = {"rc-lookahead": "0"}
_GIF_TICKS = 100  # defined by the format
_MIN_RATE = 0.01  # a GIF counts up to 2^16 ticks for one picture


@dataclass
class _Counted:
    """Checks pictures while they pass, and counts them."""

    pictures: Iterable[NDArray[Any]]
    count: int = 0

    def __iter__(self) -> Iterator[Picture]:
        shape: tuple[int, ...] = ()
        for picture in self.pictures:
            if picture.ndim != 3 or picture.shape[2] != 3 or picture.dtype != np.uint8:
                raise InputError(f"picture {self.count}: {picture.shape} of {picture.dtype} is not allowed: (height, width, 3) of uint8")
            shape = shape or picture.shape
            if picture.shape != shape:
                raise InputError(f"picture {self.count}: shape {picture.shape} is not allowed: {shape}, that of the first one")
            self.count += 1
            yield picture
        if self.count == 0:
            raise InputError("video: no picture found, at least 1 needed")


def _import(suffix: str) -> Any:
    try:
        if suffix == ".mp4":
            import av

            return av
        import PIL.Image

        return PIL.Image
    except ImportError as error:
        raise ImportError("videos need PyAV and Pillow: pip install 'taxelsim[video]'") from error


def check_video(file: Path) -> None:
    """Whether a video of that name can be written: before a long computation. Raises InputError, ImportError or IoError."""
    if file.suffix not in MAX_RATES:
        raise InputError(f"{file}: the name of a video must end in {' or '.join(MAX_RATES)}")
    _import(file.suffix)
    require_folder(file)


@contextmanager
def mp4_encoder(target: Any, rate: float, options: Mapping[str, str]) -> Iterator[Callable[[Picture], None]]:
    """A function that appends a picture to an MP4 file, which is complete at the end. All pictures have the size of the first.

    target: name, or stream of bytes. rate: pictures per second. options: of x264. A picture with an odd side is one pixel larger.
    """
    av = _import(".mp4")
    with av.open(target, "w", format="mp4") as container:
        # The rate gives the last picture its duration; the times of pictures are theirs.
        stream = container.add_stream("libx264", rate=Fraction(rate).limit_denominator(1000), options={**_SAME_BYTES, **options})
        stream.pix_fmt, stream.codec_context.time_base = "yuv420p", Fraction(1, _MP4_TICKS)
        count = 0

        def add(picture: Picture) -> None:
            nonlocal count
            height, width, _ = picture.shape
            # Colours have half the resolution, therefore even sides: repeats the last row and column.
            even = np.pad(picture, ((0, height % 2), (0, width % 2), (0, 0)), mode="edge")
            if count == 0:
                stream.height, stream.width, _ = even.shape
            frame = av.VideoFrame.from_ndarray(even, format="rgb24")
            frame.time_base, frame.pts = Fraction(1, _MP4_TICKS), round(count * _MP4_TICKS / rate)
            container.mux(stream.encode(frame))
            count += 1

        yield add
        container.mux(stream.encode())


def _mp4_of(pictures: Iterable[Picture], rate: float) -> bytes:
    content = io.BytesIO()
    with mp4_encoder(content, rate, _MP4_OPTIONS) as add:
        for picture in pictures:
            add(picture)
    return content.getvalue()


def _gif_of(pictures: Iterable[Picture], rate: float) -> bytes:
    image, content = _import(".gif"), io.BytesIO()
    # A palette for each picture, without dithering, which would flicker.
    frames = [image.fromarray(picture).quantize(256, dither=image.Dither.NONE) for picture in pictures]
    ends = [round(number * _GIF_TICKS / rate) for number in range(len(frames) + 1)]
    durations = [(end - begin) * 1000 // _GIF_TICKS for begin, end in itertools.pairwise(ends)]  # ms
    frames[0].save(content, "GIF", save_all=True, append_images=frames[1:], duration=durations, loop=0)
    return content.getvalue()


def grid_of(pictures: Sequence[Picture], max_width: int) -> Picture:
    """Pictures of one size as the cells of a nearly square grid, by rows; cells without a picture are white.

    max_width: pixels. Cells of a wider grid become smaller by a whole factor, each pixel the mean of a square.
    """
    height, width, _ = pictures[0].shape
    num_columns = math.ceil(math.sqrt(len(pictures)))
    num_rows = -(-len(pictures) // num_columns)
    factor = -(-num_columns * width // max_width)
    height, width = height // factor, width // factor
    grid = np.full((num_rows, height, num_columns, width, 3), 255, np.uint8)
    for k, picture in enumerate(pictures):
        squares = picture[: height * factor, : width * factor].reshape(height, factor, width, factor, 3)
        grid[k // num_columns, :, k % num_columns] = np.rint(squares.mean((1, 3)))
    return grid.reshape(num_rows * height, num_columns * width, 3)


def save_video(file: str | os.PathLike[str], pictures: Iterable[NDArray[Any]], rate: float) -> int:
    """Writes pictures (height, width, 3) of uint8, all of one size, as .mp4 or .gif. Returns their number.

    rate: pictures per second, at least 0.01; of a GIF at most 100, since its pictures last whole hundredths of a second.
    The file appears when it is complete. In an MP4 a picture with an odd side is one pixel larger.

    Raises InputError for another suffix, rate or pictures, or none; ImportError without PyAV and Pillow; IoError.
    """
    file, counted = Path(file), _Counted(pictures)
    check_video(file)
    limit = _GIF_TICKS if file.suffix == ".gif" else _MP4_TICKS
    if not _MIN_RATE <= rate <= limit:
        raise InputError(f"rate: {rate:g} pictures per second are not allowed: at least {_MIN_RATE} and at most {limit}")
    write_whole(file, (_gif_of if file.suffix == ".gif" else _mp4_of)(counted, rate))
    return counted.count

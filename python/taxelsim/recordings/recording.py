"""Tables of a recording, read in blocks of rows: a recording may be larger than the memory."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError

Block = dict[str, NDArray[np.float64]]  # columns (R) by name
BLOCK_ROWS = 1 << 12  # that are in memory at once, where a reader can choose


@dataclass(frozen=True)
class Recording:
    """Named columns of numbers, all with the same number of rows."""

    source: str  #: File or folder, for messages.
    names: tuple[str, ...]  #: Components of a feature are called FEATURE.NAME.
    read: Callable[[Sequence[str]], Iterator[Block]]  #: Blocks of these columns in the order of rows.
    units: Mapping[str, str] = field(default_factory=dict)  #: Unit of each column or feature that the recording states.
    describe_row: Callable[[int], str] = "row {}".format  #: A row, counted from 0, for messages.

    @cached_property
    def _aliases(self) -> dict[str, str]:
        """Full names by the part after the last point, where no two names have it."""
        short: dict[str, list[str]] = {}
        for name in self.names:
            short.setdefault(name.rsplit(".", 1)[-1], []).append(name)
        return {part: full[0] for part, full in short.items() if len(full) == 1} | {name: name for name in self.names}

    def full_name(self, name: str) -> str:
        """The column FEATURE.NAME or NAME that `name` stands for; NAME alone where no two features have it. Throws InputError."""
        if name not in self._aliases:
            near = [other for other in self.names if other.endswith(f".{name}")] or difflib.get_close_matches(name, self._aliases, n=2)
            hint = f"; did you mean {' or '.join(near)}" if near else f"; it has {', '.join(self.names[:8])}, ..."
            raise InputError(f"{self.source}: no column {name!r}{hint}")
        return self._aliases[name]

    def unit_of(self, name: str) -> str:
        """The unit of a column, as the recording states it; "" if it states none."""
        full = self.full_name(name)
        return self.units.get(full) or self.units.get(full.rsplit(".", 1)[0], "")

    def blocks(self, names: Sequence[str]) -> Iterator[Block]:
        """Blocks of rows, by the names that are asked for. Throws InputError for a number that is not finite, and for no rows."""
        full = [self.full_name(name) for name in names]
        first = 0
        for block in self.read(tuple(dict.fromkeys(full))):
            for name, values in block.items():
                if not np.isfinite(values).all():
                    row = int(np.argmin(np.isfinite(values)))
                    raise InputError(f"{self.source}: {name}: {values[row]} in {self.describe_row(first + row)} is not a finite number")
            found = {name: block[other] for name, other in zip(names, full, strict=True)}
            first += len(next(iter(found.values())))
            yield found
        if not first:
            raise InputError(f"{self.source}: no rows")

    def column(self, name: str) -> NDArray[np.float64]:
        """(R), all rows. Throws InputError."""
        return np.concatenate([block[name] for block in self.blocks([name])])


def component_names(feature: str, shape: Sequence[int], names: Any = None) -> list[str]:
    """Names of the numbers of a feature: those that it has, else r0_c0, ... of two axes, r0_c0_0, ... of three, 0, 1, ... of one."""
    size = int(np.prod(shape)) if shape else 1
    if isinstance(names, dict):  # as some recorders write them: {"motors": [...]}
        names = next(iter(names.values()), None)
    if size == 1 and len(shape) < 2:
        return [feature]
    if isinstance(names, list) and len(names) == size:
        return [f"{feature}.{name}" for name in names]
    indices = list(np.ndindex(*shape))
    patterns = {2: "r{}_c{}", 3: "r{}_c{}_{}"}
    return [f"{feature}.{patterns.get(len(shape), '_'.join(['{}'] * len(shape))).format(*index)}" for index in indices]

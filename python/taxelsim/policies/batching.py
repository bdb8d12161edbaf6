"""Whether the rows of a policy depend on the batch that they are computed in."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError

Policy = Callable[[Any], Any]

_CHUNK_SIZES = (64, 16, 4, 1)


def num_rows(observation: Any) -> int:
    """Rows of a batched observation."""
    return len(next(iter(observation.values())) if isinstance(observation, dict) else observation)


def take(observation: Any, rows: Any) -> Any:
    """Rows of a batched observation, as contiguous copies."""
    if isinstance(observation, dict):
        return {name: np.ascontiguousarray(values[rows]) for name, values in observation.items()}
    return np.ascontiguousarray(observation[rows])


def rows_depend_on_batch(policy: Policy, observation: Any) -> bool:
    """Whether an action depends on the number, the order or the content of the other rows, bit for bit.

    Calls `policy` with parts of `observation`: growing batches, all rows, all rows in reverse order, and single rows.
    """
    n = num_rows(observation)
    whole = np.asarray(policy(take(observation, slice(None))))

    def differs(rows: NDArray[np.intp]) -> bool:
        return np.asarray(policy(take(observation, rows))).tobytes() != np.ascontiguousarray(whole[rows]).tobytes()

    everything = np.arange(n)
    parts = [everything, everything[::-1], everything[1:]]
    parts += [everything[:size] for size in (1, 2, 3, 5, 8, 13, 16, 31, 64, 100, 256) if size < n]
    parts += [everything[i : i + 1] for i in range(0, n, max(1, n // 8))]
    return any(differs(part) for part in parts if len(part))


class PaddedPolicy:
    """Calls a policy with exactly `chunk` rows each time, repeating the last row where there are fewer."""

    def __init__(self, policy: Policy, chunk: int) -> None:
        self._policy, self.chunk = policy, chunk

    def __call__(self, observation: Any) -> NDArray[Any]:
        """Actions of all rows of `observation`."""
        n = num_rows(observation)
        results = []
        for first in range(0, n, self.chunk):
            rows = np.minimum(np.arange(first, first + self.chunk), n - 1)
            results.append(np.asarray(self._policy(take(observation, rows)))[: min(self.chunk, n - first)])
        return np.concatenate(results)


def independent_of_batch(policy: Policy, observation: Any) -> tuple[Policy, str | None]:
    """`policy`, or a version of it whose rows do not depend on the batch, and then a line that says so.

    Raises InputError if even single rows differ from call to call.
    """
    if not rows_depend_on_batch(policy, observation):
        return policy, None
    for chunk in _CHUNK_SIZES:
        padded = PaddedPolicy(policy, chunk)
        if not rows_depend_on_batch(padded, observation):
            return padded, f"actions of this policy depend on the batch: it is called with exactly {chunk} rows at a time"
    raise InputError(
        "policy: the same observation gives different actions from call to call; a policy must be a function of its observation"
    )

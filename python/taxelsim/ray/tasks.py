"""Runs tasks on a cluster that loses nodes: retries with back-off, and nodes that are refused."""

from __future__ import annotations

import heapq
import itertools
import logging
import math
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

import ray
import ray.exceptions

from ..errors import InputError, IoError
from .cluster import Workers, slots
from .node import Outcome
from .storage import one_line

T = TypeVar("T")
OnProgress = Callable[[int, int], object]

MAX_RETRIES = 10  # of one task
FIRST_DELAY = 0.5  # s, doubled after each retry of a task
MAX_DELAY = 30.0  # s
NODE_PATIENCE = 300.0  # s without a node that may run tasks
TASK_SECONDS = 10.0
SETUP_SHARE = 0.03  # of a task, at most: a scene whose setup is slow gets longer tasks
_POLL = 1.0  # s
_TASKS_PER_SLOT = 2  # sent to the cluster at once: nodes need not wait for this process

_log = logging.getLogger("taxelsim")


def check_tasks(task_seconds: float | None, max_retries: int, batch_size: int, num_slices: int) -> None:
    """Raises InputError for arguments out of range."""
    if task_seconds is not None and not 0 < task_seconds < math.inf:
        raise InputError(f"task_seconds: {task_seconds} is not allowed: a finite number above 0")
    for name, value, least in (("max_retries", max_retries, 0), ("batch_size", batch_size, 1), ("num_slices", num_slices, 1)):
        if value < least:
            raise InputError(f"{name}: {value} is not allowed: at least {least}")


def task_length(task_seconds: float | None, setup_seconds: float) -> float:
    """Simulation in a task whose setup takes `setup_seconds`, in s."""
    return task_seconds or max(TASK_SECONDS, setup_seconds / SETUP_SHARE)


@dataclass
class Tasks(Generic[T]):
    """Tasks of one run. run() may be called several times; refused nodes stay refused."""

    function: Callable[[Any, T], Outcome]
    workers: Workers
    max_retries: int = MAX_RETRIES
    node_patience: float = NODE_PATIENCE
    refused: dict[str, str] = field(default_factory=dict)  #: Reasons by node.
    num_retries: int = 0

    def run(self, job: Any, items: Sequence[T], on_done: Callable[[T, Any], None]) -> None:
        """Calls function(job, item) on the cluster for all items, and on_done(item, value) here as each ends. Waits for all.

        A task that is lost or fails is sent again, with back-off. One that a node refuses is sent to others. Raises InputError if all
        nodes refuse or an item is bad, IoError after `max_retries` of one task or `node_patience` seconds without a node; an exception of
        another type that the function raised continues. Tasks that run are cancelled then.
        """
        _Run(self, ray.put(job), on_done).all(items)


class _Run(Generic[T]):
    def __init__(self, tasks: Tasks[T], job: Any, on_done: Callable[[T, Any], None]) -> None:
        self._tasks = tasks
        self._job = job
        self._on_done = on_done
        self._remote = ray.remote(tasks.function)
        self._waiting: deque[tuple[T, int]] = deque()  # item, number of its retries
        self._delayed: list[tuple[float, int, T, int]] = []  # when, tie, item, retries
        self._running: dict[Any, tuple[T, int]] = {}
        self._ties = itertools.count()
        self._slots = 0
        self._counted = self._alive = time.monotonic()

    def all(self, items: Sequence[T]) -> None:
        self._waiting.extend((item, 0) for item in items)
        self._count_slots()
        try:
            while self._waiting or self._delayed or self._running:
                self._step()
        finally:
            for task in self._running:
                ray.cancel(task, force=False)

    def _step(self) -> None:
        now = time.monotonic()
        if now - self._counted > _POLL:
            self._count_slots()
        while self._delayed and self._delayed[0][0] <= now:
            self._waiting.append(heapq.heappop(self._delayed)[2:])
        while self._waiting and len(self._running) < max(1, _TASKS_PER_SLOT * self._slots):
            item, retries = self._waiting.popleft()
            task = self._remote.options(**self._tasks.workers.options(self._tasks.refused)).remote(self._job, item)
            self._running[task] = item, retries
        if not self._running:
            time.sleep(min(_POLL, max(0.0, self._delayed[0][0] - now)))
            return
        sent = list(self._running)
        if ray.wait(sent, num_returns=1, timeout=_POLL)[0]:
            for task in ray.wait(sent, num_returns=len(sent), timeout=0)[0]:  # all at once: a wait costs time per task that runs
                self._end(*self._running.pop(task), self._outcome(task))

    def _outcome(self, task: Any) -> Outcome:
        try:
            outcome: Outcome = ray.get(task)
        except ray.exceptions.RayTaskError as error:
            raise error.as_instanceof_cause() from None
        except ray.exceptions.RayError as error:  # lost with its process or its node
            return Outcome(node="", failure=one_line(error))
        return outcome

    def _end(self, item: T, retries: int, outcome: Outcome) -> None:
        tasks = self._tasks
        if outcome.error:
            raise InputError(outcome.error)
        if outcome.refusal:
            if outcome.node not in tasks.refused:
                tasks.refused[outcome.node] = outcome.refusal
                _log.warning("node %s is refused: %s", outcome.node[:8], outcome.refusal)
                self._count_slots()
            self._waiting.append((item, retries))
        elif outcome.failure:
            if retries == tasks.max_retries:
                raise IoError(f"a task failed {retries + 1} times, lastly: {outcome.failure}")
            tasks.num_retries += 1
            delay = min(FIRST_DELAY * 2**retries, MAX_DELAY)
            _log.warning("a task is sent again in %.1f s: %s", delay, outcome.failure)
            heapq.heappush(self._delayed, (time.monotonic() + delay, next(self._ties), item, retries + 1))
        else:
            self._on_done(item, outcome.value)

    def _count_slots(self) -> None:
        """Raises if no node may run the tasks, and none has come for a long time."""
        tasks = self._tasks
        self._counted = time.monotonic()
        self._slots = slots(tasks.workers, tasks.refused)
        if self._slots > 0:
            self._alive = self._counted
        elif tasks.refused and slots(tasks.workers, {}) > 0:
            raise InputError(f"{next(iter(tasks.refused.values()))} (all {len(tasks.refused)} nodes are refused)")
        elif self._counted - self._alive > tasks.node_patience:
            raise IoError(f"no node has room for a task for {tasks.node_patience:.0f} s: a task needs {_text(tasks.workers.needs())}")


def _text(needs: Mapping[str, float]) -> str:
    return ", ".join(f"{amount:g} {name}" for name, amount in needs.items())

"""Touch for environments of other packages: Gymnasium, Gymnasium-Robotics and robosuite. Needs pip install 'taxelsim[envs,mujoco]'.

>>> tips = lambda model: {tip: taxelsim.mujoco.cover_geom(model, f"robot0:C_{tip}distal", 0.002) for tip in ("ff", "th")}
>>> env = TactileObservation(gymnasium.make("HandManipulateBlock-v1"), tips, ["object"])
>>> env.reset()[0]["th/tactile_image"]  # (taxels), counts
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, TypedDict

import gymnasium
from gymnasium import spaces
from numpy.typing import NDArray

from .._arguments import checked_names
from .._core import Device
from ..environment import NO_OUTPUTS
from ..envs.dynamics.observations import TACTILE, space, tactile
from ..errors import InputError
from .attachment import Attachment, attach
from .mounts import SensorSource

if TYPE_CHECKING:
    from typing_extensions import Unpack

__all__ = ["TactileObservation", "Touch", "TouchOptions", "add_observables"]

Sensors = Mapping[str, SensorSource] | Callable[[Any], Mapping[str, SensorSource]]
"""`sensors` of attach(), or a function of the mujoco.MjModel that returns them, for environments that make new models."""


class TouchOptions(TypedDict, total=False):
    """Options of the adapters."""

    observations: str | Sequence[str]
    """A name, or names, out of envs.dynamics.observations.TACTILE; default "tactile_image"."""
    forces: str
    """As for Attachment.observe(); default "skin"."""
    device: Device
    """Default: the best one."""
    seed: int
    """Of the noise of the readout, default 0."""


class Touch:
    """What sensors feel on the present model of an environment. `tactile` is the Attachment."""

    def __init__(
        self,
        model: Any,
        sensors: Sensors,
        geoms: Sequence[str | int] | None,
        *,
        observations: str | Sequence[str] = "tactile_image",
        forces: str = "skin",
        device: Device | None = None,
        seed: int = 0,
    ) -> None:
        """Options: see TouchOptions."""
        self._names = checked_names("observations", observations, TACTILE)
        self._sensors, self._geoms, self._forces = sensors, geoms, forces
        self._device, self._seed = device or Device.open(), seed
        self.tactile = self._attach(model)

    def _attach(self, model: Any) -> Attachment:
        sensors = self._sensors(model) if callable(self._sensors) else self._sensors
        outputs = NO_OUTPUTS.replace(tactile_shear_force="shear_image" in self._names)
        return attach(model, sensors, self._geoms, device=self._device, seed=self._seed, outputs=outputs)

    def start(self, model: Any) -> None:
        """Starts an episode. Attaches the sensors to a model that is new. Raises what attach() raises."""
        if model is self.tactile.model:
            self.tactile.reset()
        else:
            self.tactile = self._attach(model)

    def spaces(self, taken: Iterable[str]) -> dict[str, spaces.Box]:
        """Spaces of the observations, by `<sensor>/<observation>`. Raises InputError for a name out of `taken`."""
        found = {f"{key}/{name}": space(name, sensor, 0, 0) for key, sensor in self.tactile.sensors.items() for name in self._names}
        for name in sorted(found.keys() & set(taken)):
            raise InputError(f"sensors: {name!r} is an observation of the environment already")
        return found

    def observe(self, data: Any, dt: float | None) -> dict[str, NDArray[Any]]:
        """Observations of a mujoco.MjData, dt (s) after the last ones; copies. Raises what Attachment.observe() raises."""
        frames = self.tactile.observe(data, dt, forces=self._forces)
        return {f"{key}/{name}": tactile(name, frame)[0] for key, frame in frames.items() for name in self._names}


class TactileObservation(gymnasium.Wrapper[dict[str, Any], Any, Any, Any]):
    """Adds `<sensor>/<observation>` to the observations of an environment whose `unwrapped` has `model`, `data` and `dt`.

    sensors: see Sensors. geoms: as for attach(). Observations that are no dict become `observation`. `touch.tactile` is the Attachment.
    Raises InputError for another environment, a name that an observation has, and what attach() and Attachment.observe() refuse.
    """

    def __init__(self, env: Any, sensors: Sensors, geoms: Sequence[str | int] | None = None, **options: Unpack[TouchOptions]) -> None:
        super().__init__(env)
        self._robot: Any = env.unwrapped
        for name in ("model", "data", "dt"):
            if not hasattr(self._robot, name):
                raise InputError(f"env: {type(self._robot).__name__} without {name!r} is not allowed: environments of MuJoCo")
        self.touch = Touch(self._robot.model, sensors, geoms, **options)
        own = env.observation_space
        self._is_dict = isinstance(own, spaces.Dict)
        named: dict[str, Any] = dict(own.spaces) if isinstance(own, spaces.Dict) else {"observation": own}
        self.observation_space = spaces.Dict(named | self.touch.spaces(named))

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[dict[str, Any], dict[str, Any]]:
        observation, info = self.env.reset(seed=seed, options=options)
        self.touch.start(self._robot.model)
        return self._added(observation), info

    def step(self, action: Any) -> tuple[dict[str, Any], Any, bool, bool, dict[str, Any]]:
        observation, reward, terminated, truncated, info = self.env.step(action)
        return self._added(observation), reward, terminated, truncated, info

    def _added(self, observation: Any) -> dict[str, Any]:
        own = observation if self._is_dict else {"observation": observation}
        return {**own, **self.touch.observe(self._robot.data, self._robot.dt)}


def add_observables(env: Any, sensors: Sensors, geoms: Sequence[str | int] | None = None, **options: Unpack[TouchOptions]) -> Touch:
    """Adds an Observable `<sensor>/<observation>` for each sensor to an environment of robosuite.

    sensors: see Sensors; a function serves all models of an environment with hard resets. geoms: as for attach(). An observable has a
    modality of its own, because robosuite joins those of one modality. robosuite samples observables at control_freq, after the first time
    step of each control step; env._get_observations(force_update=True) gives the present ones.

    Raises InputError for a name that an observable has, and what attach() and Attachment.observe() refuse.
    """
    from robosuite.utils.observables import Observable, sensor

    touch = Touch(env.sim.model._model, sensors, geoms, **options)
    touch.observe(env.sim.data._data, None)  # robosuite replaces the errors of its sensors by one of its own
    frame = _ObservedFrame(env, touch)
    for name in touch.spaces(env.observation_names):
        env.add_observable(Observable(name, sensor(modality=name)(partial(frame.read, name)), sampling_rate=env.control_freq))
    return touch


class _ObservedFrame:
    """The frame that the observables of an environment of robosuite read: one for all that are sampled together."""

    def __init__(self, env: Any, touch: Touch) -> None:
        self._env, self._touch = env, touch
        self._unread: dict[str, NDArray[Any]] = {}
        self._cache: Any = None
        self._time = 0.0

    def read(self, name: str, cache: Any) -> NDArray[Any]:
        """Value of an observable. cache: of the environment, which makes a new one at each reset."""
        sim = self._env.sim
        elapsed = sim.data.time - self._time
        if name not in self._unread or elapsed != 0 or cache is not self._cache:
            if cache is not self._cache:
                self._touch.start(sim.model._model)
            self._unread = self._touch.observe(sim.data._data, elapsed if elapsed > 0 else None)
            self._cache, self._time = cache, sim.data.time
        return self._unread.pop(name)

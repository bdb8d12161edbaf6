"""Environments whose images lie in the memory of a GPU, against those of the host. The driver is cuda_standin."""

from typing import Any

import numpy as np
import pytest

import taxelsim
from taxelsim.environment import Environment
from taxelsim.envs import TactileVectorEnv
from taxelsim.policies.observations import ObservationBuilder
from taxelsim.policies.values import NumpyValues, TorchValues

from .cuda_standin import Standin
from .test_device_inputs import writable

SCENE = taxelsim.SCENES / "tasks/follow_edge.yaml"
N = 4


class MappedValues(NumpyValues):
    """The operations of NumPy on the memory that the stand-in has mapped."""

    def live(self, array: Any) -> Any:
        return writable(array) if isinstance(array, taxelsim.DeviceArray) else array


class MappedTorchValues(TorchValues):
    """PyTorch without CUDA."""

    def live(self, array: Any) -> Any:
        array.__dlpack__(stream=7)
        return self._torch.from_numpy(writable(array))


def rollout(device: taxelsim.Device, memory: str, images: NumpyValues | None, **options: Any) -> list[np.ndarray]:
    """Observations of some steps, in the middle of which two episodes begin anew."""
    environment = Environment(device, taxelsim.load_scene(SCENE), N, memory=memory)
    builder = ObservationBuilder(environment.layout, "tactile_image", images=images, **options)
    observations = []
    for step in range(6):
        mask = np.isin(np.arange(N), [1, 2]) if step == 3 else np.full(N, step == 0)
        if mask.any():
            environment.reset(mask, 10 * step + np.arange(N))
            builder.update(environment.observe(), started=mask, rows=mask)
        else:
            environment.step(np.tile([0.002, 0, -0.001, 0, 0, 0.1], (N, 1)))
            kept = np.arange(N) == 3 if step == 4 and options.get("history", 1) == 1 else None
            if kept is not None:
                builder.detach()
            builder.update(environment.observe(), kept=kept)
        observation = builder.observation()
        observations.append(observation if isinstance(observation, np.ndarray) else observation.numpy())
    return observations


@pytest.mark.parametrize("library", ["numpy", "torch"])
@pytest.mark.parametrize("options", [{}, {"normalized": True}, {"image_unit": "newtons"}, {"history": 3, "normalized": True}])
def test_observations_are_those_of_the_host(standin: Standin, device: taxelsim.Device, library: str, options: dict[str, Any]) -> None:
    if library == "torch":
        pytest.importorskip("torch")
    expected = rollout(device, "host", None, **options)
    found = rollout(device, "cuda", MappedValues() if library == "numpy" else MappedTorchValues(), **options)
    assert expected[-1].any()
    assert all(a.dtype == b.dtype and np.array_equal(a, b) for a, b in zip(expected, found, strict=True))


def test_frames_have_images_on_the_gpu_and_the_rest_on_the_host(standin: Standin, device: taxelsim.Device) -> None:
    environment = Environment(device, taxelsim.load_scene(SCENE), N, memory="cuda")
    environment.reset(np.ones(N, bool), np.arange(N))
    frame = environment.observe()
    assert isinstance(frame.tactile_image, taxelsim.DeviceArray)
    assert frame.tactile_image.shape == (N, *environment.layout.image_shape)
    assert isinstance(frame.total_force, np.ndarray)
    assert frame.tactile_image.copy().any()


def test_steps_wait_for_the_stream_of_the_policy(standin: Standin, device: taxelsim.Device) -> None:
    environment = Environment(device, taxelsim.load_scene(SCENE), N, memory="cuda")
    environment.reset(np.ones(N, bool), np.arange(N))
    environment.observe().tactile_image.__dlpack__(stream=5)
    standin.events()
    environment.step(np.zeros((N, 6)))
    assert standin.events() == ["synchronize 0 5"]


def test_trajectories_are_those_of_numpy(standin: Standin, monkeypatch: pytest.MonkeyPatch) -> None:
    torch = pytest.importorskip("torch")
    monkeypatch.setattr("taxelsim.envs.vector_env.TorchValues", MappedTorchValues)
    options: dict[str, Any] = {"observations": ["contact", "tactile_image"], "normalized": True, "history": 2}
    on_host, on_gpu = TactileVectorEnv(SCENE, N, **options), TactileVectorEnv(SCENE, N, **options, backend="torch", memory="cuda")
    observations = on_host.reset(seed=3)[0], on_gpu.reset(seed=3)[0]
    random = np.random.default_rng(1)
    for _ in range(5):
        for name, expected in observations[0].items():
            assert isinstance(observations[1][name], torch.Tensor)
            assert np.array_equal(expected, observations[1][name].numpy())
        actions = random.uniform(-1, 1, on_host.action_space.shape).astype(np.float32)
        expected, found = on_host.step(actions), on_gpu.step(torch.from_numpy(actions))
        observations = expected[0], found[0]
        for a, b in zip(expected[1:4], found[1:4], strict=True):
            assert np.array_equal(a, b.numpy())


def test_another_backend_is_refused() -> None:
    with pytest.raises(taxelsim.InputError, match="backend: 'numpy' is not allowed where memory is 'cuda': 'torch'"):
        TactileVectorEnv(SCENE, N, memory="cuda")

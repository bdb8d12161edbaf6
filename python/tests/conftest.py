"""Fixtures: one device, and models of a small sensor."""

import logging
import math
import signal
from collections.abc import Iterator

import numpy as np
import pytest

import taxelsim

from . import cuda_standin

N = 6


@pytest.fixture(autouse=True)
def logger_as_new() -> None:
    """Other packages switch loggers off when they configure their own (logging.config, disable_existing_loggers)."""
    logger = logging.getLogger("taxelsim")
    logger.disabled, logger.propagate = False, True
    logger.setLevel(logging.NOTSET)


@pytest.fixture
def interruptible() -> Iterator[None]:
    """SIGINT raises KeyboardInterrupt, also where the shell that started the tests ignores it, as it does for jobs in the background."""
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, handler)


@pytest.fixture(scope="session")
def device() -> taxelsim.Device:
    return taxelsim.Device.open()


@pytest.fixture(scope="session")
def sensor() -> taxelsim.Sensor:
    return taxelsim.load_sensor(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml")


@pytest.fixture(scope="session")
def model(device: taxelsim.Device, sensor: taxelsim.Sensor) -> taxelsim.Model:
    return taxelsim.Model(device, sensor, [taxelsim.Cylinder(radius=0.008, length=0.04), taxelsim.Sphere(radius=0.01)])


@pytest.fixture
def simulator(model: taxelsim.Model) -> taxelsim.Simulator:
    return taxelsim.Simulator(model, N)


@pytest.fixture
def poses() -> np.ndarray:
    """(N, 7): a cylinder along y, each instance 0.1 mm deeper than the last."""
    half = math.sqrt(0.5)
    poses = np.tile([0, 0, 0, half, half, 0, 0], (N, 1))
    poses[:, 2] = 0.0079 - 0.0001 * np.arange(N)
    return poses


@pytest.fixture(scope="session")
def cuda_library(tmp_path_factory: pytest.TempPathFactory) -> cuda_standin.Standin:
    return cuda_standin.build(tmp_path_factory.mktemp("standin"))


@pytest.fixture
def standin(cuda_library: cuda_standin.Standin, device: taxelsim.Device) -> Iterator[cuda_standin.Standin]:
    """The driver, which shows two devices, the second of them that of the tests. What it handed out must have come back."""
    cuda_library.set_devices("00" * 16, device.info.uuid)
    cuda_library.fail()
    cuda_library.events()
    yield cuda_library
    cuda_library.fail()
    assert cuda_library.num_held == 0

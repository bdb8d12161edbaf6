"""Arrays in the memory of a GPU. A stand-in for CUDA's driver, tests/interop/cuda_standin.cpp, maps what software Vulkan exports."""

import os
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import taxelsim

from .cuda_standin import Standin
from .test_tensors import flat

N = 5
ORDINAL = 1
CUDA = 2  # type of the device in DLPack
NUM_SIMULATORS = int(os.environ.get("TAXELSIM_SIMULATORS", "200"))
"""Made one after the other; a campaign makes more."""
ALL = dict.fromkeys(("contact_features", "clean_contact_features", "tactile_jacobian", "clean_tactile_jacobian", "taxel_jacobian"), True)


def descriptors() -> int:
    return len(list(Path("/proc/self/fd").iterdir()))


def pressed(model: taxelsim.Model, memory: str, steps: int = 3, **options: object) -> taxelsim.Simulator:
    """A simulator after some steps. With memory="cuda" the host has not waited for their frames."""
    simulator = taxelsim.Simulator(model, N, memory=memory, **options)
    poses = np.tile([0, 0, 0.0095, 1.0, 0, 0, 0], (N, 1))
    for step in range(steps):
        poses[:, 0] = 0.0005 * step + 0.001 * np.arange(N)
        simulator.set_objects(1, poses)
        simulator.step(0.01)
        simulator.read()
    return simulator


def assert_equal(expected: taxelsim.Frame, found: taxelsim.Frame) -> None:
    arrays = dict(flat(found))
    for name, array in flat(expected):
        assert arrays[name].dtype == array.dtype, name
        assert np.array_equal(arrays[name], array), name
    assert len(arrays) == len(list(flat(expected)))


@pytest.mark.parametrize("name", ["wts0614", "uskin_like_4x4", "fingertip_sphere", "wts0614_soft_cover"])
def test_numbers_are_those_of_the_host(standin: Standin, device: taxelsim.Device, name: str) -> None:
    sensor = taxelsim.load_sensor(taxelsim.SCENES / f"sensors/{name}.yaml")
    model = taxelsim.Model(device, sensor, [taxelsim.Box(size=(0.01, 0.01, 0.01)), taxelsim.Sphere(radius=0.01)])
    outputs = taxelsim.OutputOptions(taxel_counts=sensor.readout.three_axis is not None, **ALL)
    expected = pressed(model, "host", outputs=outputs, max_regions=2).read()
    frame = pressed(model, "cuda", outputs=outputs, max_regions=2).read()
    assert expected.tactile_image.any()
    assert expected.contact.num_regions.any()
    assert_equal(expected, frame.copy())


def test_arrays_of_dlpack(standin: Standin, model: taxelsim.Model) -> None:
    frame = pressed(model, "cuda").read()
    for name, array in flat(frame):
        assert isinstance(array, taxelsim.DeviceArray), name
        assert array.__dlpack_device__() == (CUDA, ORDINAL)
    assert "DeviceArray int32(5, 6, 14)" in repr(frame.tactile_image)
    assert "tactile_image(5, 6, 14)" in repr(frame)
    capsule = frame.tactile_image.__dlpack__(max_version=(1, 0), stream=-1)
    assert "dltensor_versioned" in repr(capsule)
    with pytest.raises(taxelsim.InputError, match="memory of a GPU is not allowed here"):
        np.asarray(frame.tactile_image)


@pytest.mark.parametrize(("stream", "number"), [(None, 1), (1, 1), (2, 2), (0x7F00, 0x7F00)])
def test_a_stream_is_waited_for(standin: Standin, model: taxelsim.Model, stream: int | None, number: int) -> None:
    simulator = pressed(model, "cuda")
    simulator.read().total_force.__dlpack__(stream=stream)
    assert standin.events() == []  # without a timeline semaphore the host has waited for the step
    simulator.step(0.01)
    assert standin.events() == [f"synchronize 0 {number}"]
    del simulator
    assert standin.events() == [f"synchronize 0 {number}"]  # before the memory goes


def test_no_stream_and_wrong_streams(standin: Standin, model: taxelsim.Model) -> None:
    simulator = pressed(model, "cuda")
    simulator.read().total_force.__dlpack__(stream=-1)
    simulator.step(0.01)
    assert standin.events() == []
    for wrong in (0, -2):
        with pytest.raises(taxelsim.InputError, match=f"stream: {wrong} is not allowed: None, -1, 1, 2 or the pointer"):
            simulator.read().total_force.__dlpack__(stream=wrong)


def test_arrays_outlive_their_simulator_and_show_newer_frames(standin: Standin, model: taxelsim.Model) -> None:
    simulator = pressed(model, "cuda")
    force = simulator.read().total_force
    before = force.copy()
    simulator.set_objects(1, np.tile([0, 0, 0.0091, 1.0, 0, 0, 0], (N, 1)))
    simulator.step(0.01)
    assert (force.copy() > before).all()  # also without read()
    expected = force.copy()
    del simulator
    assert np.array_equal(force.copy(), expected)
    assert standin.num_held > 0


def test_what_is_set_waits_for_the_running_frame(standin: Standin, model: taxelsim.Model) -> None:
    """Loads and resets change memory that the device reads."""
    frames = []
    for memory in ("host", "cuda"):
        simulator = pressed(model, memory)
        for load in (0.5, 1.0):
            simulator.set_loads(load)
            simulator.step(0.01)
            simulator.read()
        simulator.reset([0], 3, gain_spread=0.2)
        simulator.step(0.01)
        frames.append(simulator.read().copy())
    assert_equal(*frames)


def test_many_simulators_leak_nothing(standin: Standin, model: taxelsim.Model) -> None:
    pressed(model, "cuda")
    before = descriptors()
    for _ in range(NUM_SIMULATORS):
        taxelsim.Simulator(model, 2, memory="cuda").read().total_force.__dlpack__()
        assert standin.num_held == 0
        assert descriptors() == before


@pytest.mark.parametrize("call", ["countDevices", "uuid", "retainContext", "pushContext", "importMemory", "mapMemory"])
def test_a_failing_driver_is_an_error(standin: Standin, model: taxelsim.Model, call: str) -> None:
    before = descriptors()
    standin.fail(call)
    with pytest.raises(taxelsim.DeviceError, match="failed with 1: as the test wished"):
        taxelsim.Simulator(model, N, memory="cuda")
    standin.fail()
    assert descriptors() == before


@pytest.mark.parametrize("call", ["synchronize", "copyToHost"])
def test_a_device_that_vanishes_is_an_error(standin: Standin, model: taxelsim.Model, call: str) -> None:
    simulator = pressed(model, "cuda")
    force = simulator.read().total_force
    force.__dlpack__()
    standin.fail(call)
    with pytest.raises(taxelsim.DeviceError, match="sharing memory with the GPU's driver"):
        _ = simulator.step(0.01) if call == "synchronize" else force.copy()
    standin.fail()
    simulator.step(0.01)
    assert force.copy().all()


def test_another_device_is_an_error(standin: Standin, model: taxelsim.Model) -> None:
    standin.set_devices("11" * 16)
    with pytest.raises(taxelsim.DeviceError, match=r"none of those that CUDA .* shows: 1111"):
        taxelsim.Simulator(model, N, memory="cuda")


def test_fork_after_import(standin: Standin, model: taxelsim.Model) -> None:
    simulator = pressed(model, "cuda")
    force = simulator.read().total_force
    held = standin.num_held
    child = os.fork()
    if child == 0:
        try:
            force.copy()
        except taxelsim.DeviceError as error:
            del simulator, force
            os._exit(0 if "does not survive fork" in str(error) and standin.num_held == held else 1)
        os._exit(2)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    assert force.copy().all()
    assert standin.num_held == held


def test_simulators_in_threads(standin: Standin, model: taxelsim.Model) -> None:
    expected = pressed(model, "host").read().copy()
    found: list[taxelsim.Frame] = []
    threads = [threading.Thread(target=lambda: found.append(pressed(model, "cuda").read().copy())) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4
    for frame in found:
        assert_equal(expected, frame)


def test_device_memory_of_software_vulkan_is_the_hosts(model: taxelsim.Model) -> None:
    assert_equal(pressed(model, "host").read(), pressed(model, "device").read())
    assert isinstance(pressed(model, "device").read().tactile_image, np.ndarray)


def test_wrong_arguments(model: taxelsim.Model) -> None:
    with pytest.raises(taxelsim.InputError, match="memory: 'gpu' is not allowed: host, device, cuda, hip"):
        taxelsim.Simulator(model, N, memory="gpu")
    with pytest.raises(taxelsim.InputError, match="image_unit: 'newtons' is not allowed where memory is 'cuda'"):
        taxelsim.Simulator(model, N, memory="cuda", image_unit="newtons")


def test_without_the_driver() -> None:
    """In a process of its own, which has no stand-in. On a machine with the driver, the driver does not show software Vulkan."""
    code = """
import taxelsim
model = taxelsim.Model(taxelsim.Device.open("cpu"), taxelsim.SCENES / "sensors/wts0614.yaml", [taxelsim.Sphere(radius=0.01)])
try:
    taxelsim.Simulator(model, 2, memory="cuda")
except taxelsim.DeviceError as error:
    print(error)
"""
    result = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert "libcuda.so.1, which the driver of the GPU installs, was not found" in result.stdout or "CUDA_VISIBLE_DEVICES" in result.stdout

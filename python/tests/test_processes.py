"""Threads, memory, child processes, the command line."""

import gc
import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import taxelsim


def memory() -> int:
    """Bytes of resident memory of this process."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def test_other_threads_run_while_read_waits(model, poses):
    num_instances = 16384
    simulator = taxelsim.Simulator(model, num_instances)
    simulator.set_objects(0, np.tile(poses[-1], (num_instances, 1)))
    simulator.prepare()
    counted = []
    stop = threading.Event()

    def count() -> None:
        while not stop.is_set():
            counted.append(time.perf_counter())
            time.sleep(0)

    thread = threading.Thread(target=count)
    thread.start()
    waits = []
    try:
        for _ in range(20):
            simulator.step(0.001)
            before = time.perf_counter()
            simulator.read()
            waits.append((before, time.perf_counter()))
    finally:
        stop.set()
        thread.join()
    # At the ends of a wait the other thread runs in any case; in the middle only without the GIL of the waiting one.
    moments = np.array(counted)
    middles = [(0.75 * before + 0.25 * after, 0.25 * before + 0.75 * after) for before, after in waits if after - before > 0.005]
    assert len(middles) > 10
    assert sum(((moments > first) & (moments < last)).any() for first, last in middles) > len(middles) / 2


def test_simulators_in_two_threads_give_the_results_of_one(model, poses):
    def run(results: list[np.ndarray]) -> None:
        simulator = taxelsim.Simulator(model, len(poses))
        for k in range(20):
            simulator.set_objects(0, poses - [0, 0, 1e-5 * k, 0, 0, 0, 0])
            simulator.step(0.001)
            results.append(simulator.read().tactile_image.copy())

    expected: list[np.ndarray] = []
    run(expected)
    found: list[list[np.ndarray]] = [[], []]
    threads = [threading.Thread(target=run, args=(results,)) for results in found]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for results in found:
        assert all((a == b).all() for a, b in zip(results, expected, strict=True))


def test_one_simulator_in_two_threads_is_safe(simulator, poses):
    """Calls wait for each other; one that comes between step() and read() raises."""
    unexpected = []

    def run() -> None:
        for _ in range(50):
            try:
                simulator.set_objects(0, poses)
                simulator.step(0.001)
            except RuntimeError:
                pass
            except BaseException as error:
                unexpected.append(error)
            simulator.read()

    threads = [threading.Thread(target=run) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not unexpected


def test_a_thousand_simulators_leave_no_memory_behind(model, poses):
    def use(count: int) -> None:
        for _ in range(count):
            simulator = taxelsim.Simulator(model, len(poses))
            simulator.set_objects(0, poses)
            simulator.step(0.001)
            assert simulator.read().tactile_image.any()
        del simulator
        gc.collect()

    use(100)
    before = memory()
    use(1000)
    assert memory() - before < 5 << 20


def test_frames_leave_no_memory_behind(simulator, poses):
    def use(count: int) -> None:
        for _ in range(count):
            simulator.set_objects(0, poses)
            simulator.step(0.001)
            simulator.read().copy()
        gc.collect()

    use(50)
    before = memory()
    use(500)
    assert memory() - before < 2 << 20


def test_a_device_after_fork_is_refused_without_a_hang(simulator, device):
    def in_child() -> int:
        """Bits of the uses that were refused."""
        refused = 0
        for bit, use in enumerate([lambda: simulator.step(0.001), lambda: device.info, lambda: taxelsim.Simulator(simulator.model)]):
            try:
                use()
            except taxelsim.DeviceError as error:
                refused |= ("fork" in str(error)) << bit
        return refused

    child = os.fork()
    if child == 0:
        status = 127
        try:
            status = in_child()
        finally:
            os._exit(status)
    deadline = time.monotonic() + 20
    while True:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            break
        if time.monotonic() > deadline:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            pytest.fail("the child process hangs")
        time.sleep(0.01)
    assert os.waitstatus_to_exitcode(status) == 0b111
    simulator.step(0.001)
    simulator.read()


def test_importing_loads_no_optional_package():
    script = "import sys, taxelsim; print(*sys.modules)"
    modules = subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True).stdout.split()
    assert not {"fsspec", "gymnasium", "h5py", "mujoco", "onnxruntime", "pyarrow", "ray", "rerun", "torch", "zarr"} & set(modules)


def test_the_program_of_the_package_runs():
    version = subprocess.run([sys.executable, "-m", "taxelsim", "--version"], check=True, capture_output=True, text=True).stdout
    assert version.strip() == f"taxelsim {taxelsim.__version__}"
    wrong = subprocess.run([sys.executable, "-m", "taxelsim", "frame", "--sensor", "nowhere"], capture_output=True, text=True)
    assert wrong.returncode == 2
    assert wrong.stderr.startswith("taxelsim: ")
    assert wrong.stderr.count("\n") == 1


def test_a_frame_equals_that_of_the_program_to_the_bit(device, sensor):
    pose = [0.0, 0.001, 0.0075, *taxelsim.axis_angle((1, 0, 0), 1.5)]
    arguments = [
        "--sensor",
        taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml",
        "--object",
        "cylinder:0.008,0.04",
        "--pose",
        " ".join(map(repr, pose)),
    ]
    text = subprocess.run(
        [sys.executable, "-m", "taxelsim", "frame", *arguments, "--json"], check=True, capture_output=True, text=True
    ).stdout
    expected = json.loads(text)
    model = taxelsim.Model(device, sensor, [taxelsim.Cylinder(radius=0.008, length=0.04)])
    simulator = taxelsim.Simulator(model, 3)
    simulator.set_objects(0, np.tile(pose, (3, 1)))
    simulator.step(0.001)
    frame = simulator.read()
    compared = compare(frame, expected) + compare(frame.ground_truth, expected["ground_truth"])
    assert compared > 20


def compare(arrays: taxelsim.Features, expected: dict) -> int:
    """Asserts equal bits for all arrays that both have; returns their number."""
    names = [name for name in arrays if name in expected and isinstance(arrays[name], np.ndarray)]
    for name in names:
        assert (arrays[name][1] == np.array(expected[name], dtype=arrays[name].dtype)).all(), name
    return len(names)


def test_no_driver_names_the_package_to_install():
    environment = {**os.environ, "VK_ICD_FILENAMES": "/nowhere.json", "VK_DRIVER_FILES": "/nowhere.json"}
    script = "import taxelsim\ntry: taxelsim.Device.open()\nexcept taxelsim.DeviceError as error: print(error)"
    found = subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True, env=environment).stdout
    assert "mesa-vulkan-drivers" in found
    assert found.count("\n") == 1

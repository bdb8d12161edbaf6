"""The stand-in for CUDA's driver, tests/interop/cuda_standin.cpp, in this process. The fixture is in conftest.py."""

import ctypes
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[2]


class Standin:
    """The driver's stand-in in this process."""

    def __init__(self, file: Path) -> None:
        self._library = ctypes.CDLL(str(file))
        self._library.standinEvents.restype = ctypes.c_char_p

    def set_devices(self, *uuids: str) -> None:
        self._library.standinSetDevices(bytes.fromhex("".join(uuids)), len(uuids))

    def fail(self, call: str = "") -> None:
        self._library.standinFail(call.encode())

    @property
    def num_held(self) -> int:
        return int(self._library.standinNumHeld())

    def events(self) -> list[str]:
        return str(self._library.standinEvents().decode()).splitlines()


def build(folder: Path) -> Standin:
    """Compiles and loads it. Once per process: the first library of this name is the driver."""
    file = folder / "libcuda.so.1"
    options = ["-std=c++20", "-O1", "-shared", "-fPIC", f"-I{ROOT / 'src'}", "-Wl,-soname,libcuda.so.1"]
    subprocess.run(["c++", *options, str(ROOT / "tests/interop/cuda_standin.cpp"), "-o", str(file)], check=True)
    return Standin(file)

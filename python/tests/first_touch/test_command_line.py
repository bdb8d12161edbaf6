"""How the command line starts and ends: no code of the current folder runs, and Ctrl-C prints no traceback."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import taxelsim
import taxelsim.envs
import taxelsim.mujoco
from taxelsim.program import PROGRAM

from .tools import FORMAT_1, THIS_PYTHON

PACKAGES = ("taxelsim", "numpy", "h5py", "rerun", "rerun_cli", "pyarrow", "av", "PIL", "onnxruntime")
IN_THE_FOLDER = {
    "report": ([], 0),
    "export": (["--format", "zarr", "-o", "out"], 0),
    "view": (["--save", "a.rrd"], 0),
    "import": (["--sensor", "a.yaml", "--measurement", "stamp", "-o", "b.yaml"], 2),
    "finish": (["--card"], 2),
    "render": (["--episode", "0", "-o", "a.mp4"], 2),
    "robot": (["--view"], 2),
    "evaluate": (["--policy", "a.onnx"], 2),
}


@pytest.fixture
def trapped(tmp_path):
    """A data set next to a Python file of the name of every module; their code writes the file `ran`."""
    folder = Path(shutil.copytree(FORMAT_1, tmp_path / "data"))
    for name in (*sys.stdlib_module_names, *PACKAGES, "sitecustomize", "usercustomize"):
        (folder / f"{name}.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'a').write({name!r})\nraise SystemExit(97)\n")
    return folder


def run_trapped(folder, command, **environment):
    # The empty entry of PYTHONPATH is the current folder, too.
    variables = {**THIS_PYTHON, "PYTHONPATH": f"{Path(taxelsim.__file__).parents[1]}:", **environment}
    done = subprocess.run(command, cwd=folder, env=variables, capture_output=True, text=True)
    assert not (folder.parent / "ran").exists(), (folder.parent / "ran").read_text()
    return done


@pytest.mark.parametrize("name", IN_THE_FOLDER)
def test_no_subcommand_runs_python_files_of_the_current_folder(trapped, name):
    words, status = IN_THE_FOLDER[name]
    done = run_trapped(trapped, [PROGRAM, name, ".", *words])
    assert done.returncode == status, done.stderr


def test_the_web_viewer_is_not_taken_from_the_current_folder(trapped):
    done = run_trapped(trapped, [PROGRAM, "view", ".", "--web"], RERUN_CLI_PATH="/bin/true")
    assert (done.returncode, "Ctrl-C ends" in done.stderr) == (0, True), done.stderr


def test_modules_that_the_package_imports_are_not_taken_from_the_current_folder(trapped):
    for file in trapped.glob("*.py"):
        if file.stem not in PACKAGES[1:]:  # what Python imports before the package, and the package, cannot be protected
            file.unlink()
    command = [sys.executable, "-m", "taxelsim", "view", ".", "--save", "a.rrd"]
    done = run_trapped(trapped, command, PYTHONPATH=str(Path(taxelsim.__file__).parents[1]))
    assert done.returncode == 0, done.stderr


# == Ctrl-C prints no traceback ==


def wait_for(process, text):
    """Until the process has mapped a file whose name has the text."""
    deadline = time.monotonic() + 60
    while text not in Path(f"/proc/{process.pid}/maps").read_text():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.002)


@pytest.mark.parametrize("command", [[PROGRAM], [sys.executable, "-m", "taxelsim"]], ids=["program", "package"])
@pytest.mark.parametrize("moment", ["python3", "_multiarray_umath", "rerun_bindings", "viewer"])
def test_ctrl_c_prints_no_traceback(interruptible, tmp_path, command, moment):
    pytest.importorskip("rerun")
    if (moment, len(command)) == ("python3", 3):
        moment = "/_core."  # before, Python answers by itself
    viewer = tmp_path / "viewer"
    viewer.write_text("#!/bin/sh\nexec sleep 60\n")
    viewer.chmod(0o755)
    environment = {**THIS_PYTHON, "RERUN_CLI_PATH": os.fspath(viewer)}
    with subprocess.Popen(
        [*command, "view", FORMAT_1, "--web"], stderr=subprocess.PIPE, text=True, env=environment, start_new_session=True
    ) as process:
        assert process.stderr is not None
        if moment == "viewer":
            assert any("Using overridden" in line for line in iter(process.stderr.readline, ""))
        else:
            wait_for(process, moment)
        os.killpg(process.pid, signal.SIGINT)
        assert (process.stderr.read(), process.wait(60)) == ("", 130)

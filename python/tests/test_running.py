"""How subcommands end."""

import subprocess
import sys

import pytest

import taxelsim
from taxelsim.commands.running import run_command


@pytest.mark.parametrize(
    ("error", "status", "text"),
    [
        (taxelsim.InputError("scene: bad"), 2, "taxelsim view: scene: bad\n"),
        (ImportError("needs x: pip install x"), 2, "taxelsim view: needs x: pip install x\n"),
        (taxelsim.IoError("disk full"), 1, "taxelsim view: disk full\n"),
        (taxelsim.DeviceError("no device"), 1, "taxelsim view: no device\n"),
        (BrokenPipeError("pipe"), 1, "taxelsim view: pipe\n"),
        (KeyboardInterrupt(), 130, ""),
    ],
)
def test_an_error_is_one_line_and_a_status(capsys, error, status, text):
    def fail() -> None:
        raise error

    assert run_command("view", fail) == status
    assert capsys.readouterr().err == text


@pytest.mark.parametrize(("result", "status"), [(None, 0), (0, 0), (130, 130)])
def test_a_result_is_the_status(result, status):
    assert run_command("view", lambda: result) == status


PACKAGES = {
    "evaluate": ("onnxruntime", ["{scene}", "--policy", "{scene}"]),
    "view": ("rerun", ["{data}", "--save", "{data}/a.rrd"]),
    "export": ("h5py", ["{data}", "--format", "lerobot", "-o", "{data}/out"]),
    "import": ("pyarrow", ["{data}", "--sensor", "{scene}", "--measurement", "stamp", "-o", "{data}/a.yaml"]),
    "render": ("av", ["{data}", "--episode", "0", "-o", "{data}/a.mp4"]),
}


@pytest.mark.parametrize("name", PACKAGES)
def test_a_missing_package_is_bad_input_for_every_subcommand_that_needs_one(tmp_path, name):
    package, arguments = PACKAGES[name]
    (tmp_path / "p.onnx").write_bytes(b"")
    words = [argument.format(data=tmp_path, scene=tmp_path / "p.onnx") for argument in arguments]
    code = f"import sys; sys.modules[{package!r}] = None; sys.argv = {['taxelsim', name, *words]!r}; import taxelsim.__main__"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, len(done.stderr.splitlines())) == (2, 1), done.stderr
    assert done.stderr.startswith(f"taxelsim {name}: ")
    assert "pip install" in done.stderr

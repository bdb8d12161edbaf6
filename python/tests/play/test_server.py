"""The server refuses other hosts, other pages and requests without the token; callbacks survive any input; Ctrl-C ends it."""

import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("viser", reason="viser as in python/requirements/test.txt")

import taxelsim
from taxelsim.play import Playground

PATIENCE = 60.0  # s


@pytest.fixture(scope="module")
def playground(device):
    playground = Playground(objects=["cylinder:0.008,0.04", "sphere:0.01"], device=device)
    yield playground
    playground.close()


def wait_until(condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


def answer(playground, *, token=None, host=None, headers=(), websocket=False):
    """The first line of the server's answer to a request on a plain socket."""
    port = int(playground.url.split(":")[2].partition("/")[0])
    own = playground.url.split("/")[3]
    lines = [f"GET /{own if token is None else token}/ HTTP/1.1", f"Host: {host or f'127.0.0.1:{port}'}"]
    if websocket:
        lines += ["Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Version: 13", "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA=="]
    lines += [header.format(port=port) for header in headers]
    with socket.create_connection(("127.0.0.1", port), timeout=10) as connection:
        connection.sendall("\r\n".join([*lines, "", ""]).encode())
        return connection.recv(4096).split(b"\r\n")[0].decode()


@pytest.mark.parametrize(
    ("request_", "status"),
    [
        ({}, "200"),
        ({"host": "localhost:1234"}, "200"),  # through a tunnel
        ({"headers": ["Origin: http://127.0.0.1:{port}"]}, "200"),
        ({"websocket": True, "headers": ["Origin: http://127.0.0.1:{port}"]}, "101"),
        ({"token": ""}, "403"),
        ({"token": "0" * 32}, "403"),
        ({"host": "evil.example"}, "403"),
        ({"host": "127.0.0.1.evil.example"}, "403"),
        ({"headers": ["Host: localhost"]}, "403"),
        ({"headers": ["Origin: http://evil.example"]}, "403"),
        ({"websocket": True}, "403"),
        ({"websocket": True, "headers": ["Origin: null"]}, "403"),
        ({"websocket": True, "headers": ["Origin: http://localhost:{port}"]}, "403"),
        ({"websocket": True, "token": "x", "headers": ["Origin: http://127.0.0.1:{port}"]}, "403"),
    ],
)
def test_requests(playground, request_, status):
    assert answer(playground, **request_).split(" ")[1] == status


def test_a_drag_moves_the_object_and_stale_poses_are_dropped(playground):
    wait_until(lambda: playground.view is not None)
    for k in range(50):
        playground._scene._handles[0].position = (0.1, 0.02 * k, 0.79)
        playground._drag(0, playground._scene._handles[0])
    wait_until(lambda: abs(playground.view.pose[1] - 0.0098) < 1e-12)
    assert playground.view.counts.any()
    assert "iframe" in playground._repr_html_()


def test_random_inputs_leave_it_alive_and_finite(playground):
    random = np.random.default_rng(5)
    wait_until(lambda: playground.view is not None)
    values = [0.0, 1e-3, 0.5, 1.0, -3.0, 1e12, np.nan, np.inf]
    for _ in range(1000):
        kind = random.integers(4)
        if kind == 0:
            playground._scene._handles[0].position = tuple(random.choice(values, 3))
            playground._scene._handles[0].wxyz = tuple(random.choice(values, 4))
            playground._drag(0, playground._scene._handles[0])
        elif kind == 1:
            playground._set_depth(float(random.choice(values)))
        elif kind == 2:
            playground._set_load(float(random.choice(values)))
        else:
            playground._object._impl.value = str(random.choice(["0: x", "1: x", "7: x", "-1", "..", ""]))
            playground._choose_object()
    playground.change(lambda _: taxelsim.play.state.Settings(load=2.0))
    wait_until(lambda: playground.view.settings.load == 2.0 and playground.view.settings.x == 0.0)
    assert np.isfinite(playground.view.pose).all()
    assert playground.view.features["total_force"] > 0


def test_ctrl_c_ends_it(tmp_path):
    program = "import sys; from taxelsim.commands.play import main; sys.exit(main(sys.argv[1:]))"
    command = [sys.executable, "-c", program]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True, cwd=tmp_path) as process:
        assert "open http://127.0.0.1:" in process.stdout.readline()
        os.kill(process.pid, signal.SIGINT)
        try:
            assert process.wait(PATIENCE / 3) == 130, Path(f"/proc/{process.pid}/status").read_text()
        finally:
            process.kill()
    with pytest.raises(ProcessLookupError):
        os.killpg(process.pid, 0)

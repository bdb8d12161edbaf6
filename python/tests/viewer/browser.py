"""Pages in Chromium without a display: a report, and an episode in the web viewer.

Not collected by default: needs the packages chromium and chromium-driver, and minutes, since WebGL runs on SwiftShader.
TAXELSIM_CHROMEDRIVER and TAXELSIM_CHROMIUM name the programs; scripts/campaign view runs this.
"""

import base64
import contextlib
import io
import json
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from taxelsim.commands.view import GRPC_PORT, LOOPBACK, WEB_PORT

PATIENCE = 300.0  # s, until the web viewer has drawn
OPTIONS = ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle", "--use-angle=swiftshader"]
OPTIONS += ["--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--window-size=1400,900"]

TAXEL = NO_COUNTS = (68, 1, 84)  # without force: the lower end of Viridis
MAX_DIFFERENCE = 4  # of 255, of the rounding of the colour scale
ENOUGH_PIXELS = 500


class Browser:
    """A session of chromedriver, by the protocol WebDriver."""

    def __init__(self, port: int) -> None:
        self._address = f"http://{LOOPBACK}:{port}"
        binary = os.environ.get("TAXELSIM_CHROMIUM")
        chrome: dict[str, Any] = {"args": OPTIONS, **({"binary": binary} if binary else {})}
        session = self._call("POST", "/session", {"capabilities": {"alwaysMatch": {"goog:chromeOptions": chrome}}})
        self._session = f"/session/{session['sessionId']}"

    def _call(self, method: str, path: str, body: dict[str, Any] | None = None) -> Any:
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self._address + path, data, {"Content-Type": "application/json"}, method=method)
        with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
            return json.load(answer)["value"]

    def open(self, url: str) -> None:
        self._call("POST", f"{self._session}/url", {"url": url})

    def run(self, script: str) -> Any:
        return self._call("POST", f"{self._session}/execute/sync", {"script": script, "args": []})

    def picture(self) -> np.ndarray:
        """(height, width, 3)."""
        data = base64.b64decode(self._call("GET", f"{self._session}/screenshot"))
        return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"))

    def type_into(self, selector: str, text: str) -> None:
        """Sends keys to the first element of a CSS selector; a file name to an input of files."""
        element = self._call("POST", f"{self._session}/element", {"using": "css selector", "value": selector})
        self._call("POST", f"{self._session}/element/{next(iter(element.values()))}/value", {"text": text})

    def drag(self, start: tuple[int, int], end: tuple[int, int], num_steps: int = 10) -> None:
        """Moves the mouse from one pixel to another with its button down."""
        points = [[round(a + (b - a) * k / num_steps) for a, b in zip(start, end, strict=True)] for k in range(1, num_steps + 1)]
        moves = [{"type": "pointerMove", "x": x, "y": y, "duration": 50} for x, y in points]
        hover = [{"type": "pointerMove", "x": x, "y": start[1], "duration": 50} for x in (start[0] - 3, start[0])]
        actions = [
            *hover,
            {"type": "pause", "duration": 500},
            {"type": "pointerDown", "button": 0},
            *moves,
            {"type": "pointerUp", "button": 0},
        ]
        body = {"actions": [{"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": actions}]}
        self._call("POST", f"{self._session}/actions", body)

    def close(self) -> None:
        self._call("DELETE", self._session)


def wait_for(port: int) -> None:
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        with socket.socket() as probe:
            if probe.connect_ex((LOOPBACK, port)) == 0:
                return
        time.sleep(0.2)
    raise TimeoutError(f"nothing listens on port {port}")


@contextlib.contextmanager
def driven() -> Iterator[Browser]:
    """A browser with its own chromedriver."""
    with socket.socket() as free:
        free.bind((LOOPBACK, 0))
        port = free.getsockname()[1]
    driver = subprocess.Popen([os.environ.get("TAXELSIM_CHROMEDRIVER", "chromedriver"), f"--port={port}"], stdout=subprocess.DEVNULL)
    try:
        wait_for(port)
        session = Browser(port)
        yield session
        session.close()
    finally:
        driver.terminate()
        driver.wait()


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with driven() as session:
        yield session


@pytest.fixture(scope="module")
def second_browser() -> Iterator[Browser]:
    with driven() as session:
        yield session


def test_a_report_shows_all_its_pictures_and_loads_nothing(browser, viewed, tmp_path):
    page = tmp_path / "report.html"
    subprocess.run([sys.executable, "-m", "taxelsim", "report", viewed, "-o", page], check=True)
    browser.open(page.as_uri())
    assert browser.run("return document.title") == "Data set data"
    widths = browser.run("return [...document.images].map(image => image.naturalWidth)")
    assert len(widths) == 4
    assert min(widths) > 0
    assert (
        browser.run("return [...document.querySelectorAll('svg rect')].filter(bar => bar.getBoundingClientRect().height > 0).length") > 100
    )
    assert (
        browser.run("return performance.getEntriesByType('resource').map(entry => entry.name).filter(name => !name.startsWith('data:'))")
        == []
    )


def test_an_episode_is_drawn_by_the_web_viewer(browser, viewed):
    command = [sys.executable, "-m", "taxelsim", "view", os.fspath(viewed), "--episode", "1", "--web"]
    program = subprocess.Popen(command, env={**os.environ, "DISPLAY": "", "WAYLAND_DISPLAY": ""}, start_new_session=True)
    try:
        wait_for(WEB_PORT)
        wait_for(GRPC_PORT)
        browser.open(f"http://{LOOPBACK}:{WEB_PORT}/?url=rerun%2Bhttp://{LOOPBACK}:{GRPC_PORT}/proxy")
        end, found = time.monotonic() + PATIENCE, {}
        while time.monotonic() < end and not (found and min(found.values()) > ENOUGH_PIXELS):
            time.sleep(2)
            picture = browser.picture()
            found = {colour: int((np.abs(picture.astype(int) - colour).max(-1) <= MAX_DIFFERENCE).sum()) for colour in (TAXEL, NO_COUNTS)}
        Image.fromarray(picture).save(Path(os.environ.get("TAXELSIM_PICTURE", os.devnull)), "png")
        assert min(found.values()) > ENOUGH_PIXELS, found
    finally:
        os.killpg(program.pid, signal.SIGINT)
        program.wait()

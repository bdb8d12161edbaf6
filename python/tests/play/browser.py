"""The playground in Chromium without a display: a drag, a good and a bad upload, two browsers. scripts/campaign view playground runs this.

TAXELSIM_SCREENSHOT names a PNG file for a picture of the page.
"""

import os
import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from taxelsim.play import Playground
from taxelsim.play.state import Settings

from ..viewer.browser import PATIENCE, Browser, browser, second_browser  # noqa: F401, fixtures
from .test_uploads import stl_of, tetrahedron

NUM_TAXEL_PIXELS = 2000  # at least, of the scene
LEAST_CHANGE = 500  # pixels of the scene that a drag changes


@pytest.fixture(scope="module")
def playground() -> Iterator[Playground]:
    playground = Playground("wts0614_soft_cover", ["cylinder:0.008,0.04"])
    yield playground
    playground.close()


def wait_until(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.2)


def scene_of(browser: Browser) -> np.ndarray:  # noqa: F811
    """The picture without the side panel, (height, width, 3)."""
    return browser.picture()[:, :900].astype(int)


def coloured(picture: np.ndarray) -> np.ndarray:
    """Pixels that are not grey, (height, width)."""
    return np.ptp(picture, axis=2) > 40


def open_page(browser: Browser, playground: Playground) -> None:  # noqa: F811
    browser.open(playground.url)
    wait_until(lambda: int(coloured(scene_of(browser)).sum()) > NUM_TAXEL_PIXELS)
    wait_until(lambda: browser.run("return document.querySelectorAll('.uplot canvas').length") == 2)


def arrow_of(browser: Browser) -> tuple[int, int]:  # noqa: F811
    """A pixel (x, y) of the handle along z: the uppermost of the blue ones."""
    red, green, blue = np.moveaxis(scene_of(browser), 2, 0)
    rows, columns = np.nonzero((blue > 200) & (red < 110) & (green < 160))
    return int(np.median(columns)), int(rows.min()) + 5


def save_picture(browser: Browser, playground: Playground, file: str) -> None:  # noqa: F811
    """Slides and turns the object, and saves the page."""
    playground._changed(friction_coefficient=0.5)
    for k in range(80):
        angle = 0.3 * np.sin(k / 25)
        half = np.sqrt(0.5)
        turned = (half * np.cos(angle), half * np.cos(angle), half * np.sin(angle), half * np.sin(angle))
        playground.change(lambda s, k=k, turned=turned: replace(s, x=4e-3 * np.sin(k / 15), depth=1e-4 + 2e-6 * k, rotation=turned))
        time.sleep(0.1)
    browser.run("document.querySelectorAll('.mantine-Notification-closeButton').forEach(button => button.click())")
    time.sleep(3)
    Image.fromarray(browser.picture()).save(file, optimize=True)
    playground.change(lambda _: Settings(rotation=(half, half, 0, 0), depth=1e-4))


def test_a_drag_moves_the_object_in_both_browsers(browser, second_browser, playground):  # noqa: F811
    for each in (browser, second_browser):
        open_page(each, playground)
    if file := os.environ.get("TAXELSIM_SCREENSHOT"):
        save_picture(browser, playground, file)
    before, pose = [scene_of(each) for each in (browser, second_browser)], playground.view.pose
    x, y = arrow_of(browser)
    browser.drag((x, y), (x, y - 60))
    wait_until(lambda: playground.view.pose[2] != pose[2])
    assert playground.view.pose[2] > pose[2]  # up
    np.testing.assert_allclose(playground.view.pose[:2], pose[:2], atol=1e-9)
    wait_until(lambda: all((scene_of(b) != a).any(2).sum() > LEAST_CHANGE for a, b in zip(before, (browser, second_browser), strict=True)))


def test_uploads(browser, playground, tmp_path):  # noqa: F811
    open_page(browser, playground)
    bad, good = tmp_path / "bad.stl", tmp_path / "good.stl"
    bad.write_bytes(b"no mesh")
    good.write_bytes(stl_of(tetrahedron(20.0)))
    browser.type_into("input[type=file]", str(bad))
    wait_until(lambda: playground._status.value.startswith("bad.stl: "))
    browser.type_into("input[type=file]", str(good))
    wait_until(lambda: "Which unit has good.stl?" in browser.run("return document.body.innerText"))
    browser.run("[...document.querySelectorAll('button')].find(b => b.innerText == 'use it').click()")
    wait_until(lambda: playground.view.settings.object_index == 1)
    np.testing.assert_allclose(np.ptp(playground._press.items[1].object.shape.vertices, axis=0), 0.02, rtol=1e-6)
    assert playground._press.items[1].scale == 1e-3


def test_what_the_page_loads_is_its_own(browser, playground):  # noqa: F811
    open_page(browser, playground)
    names = browser.run("return performance.getEntriesByType('resource').map(entry => entry.name)")
    own = playground.url.rsplit("/", 2)[0]
    assert [name for name in names if not name.startswith((own, "data:", "blob:"))] == []

"""The documentation site in Chromium: no page is wider than a phone. scripts/docs builds it first; scripts/campaign view runs this."""

import functools
import http.server
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from .browser import LOOPBACK, Browser, browser  # noqa: F401, a fixture

SITE = Path(__file__).resolve().parents[3] / "build/docs/html"
PHONE = 390  # pixels, width of a phone
# Loads a page into a frame of this width, and gives the width that it needs.
MEASURE = """const frame = document.createElement('iframe');
frame.style.cssText = 'width: %dpx; height: 800px; border: 0';
document.body.replaceChildren(frame);
return new Promise(done => {
  frame.onload = () => done(frame.contentDocument.documentElement.scrollWidth);
  frame.src = '%s';
});"""


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, format: str, *args: object) -> None:
        pass


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    server = http.server.ThreadingHTTPServer((LOOPBACK, 0), functools.partial(Quiet, directory=str(SITE)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://{LOOPBACK}:{server.server_address[1]}"
    server.shutdown()


def test_no_page_is_wider_than_a_phone(browser: Browser, address: str) -> None:  # noqa: F811
    pages = sorted(file.relative_to(SITE).as_posix() for file in SITE.rglob("*.html"))
    assert len(pages) > 50
    browser.open(f"{address}/index.html")
    widths = {page: browser.run(MEASURE % (PHONE, f"/{page}")) for page in pages}
    assert {page: width for page, width in widths.items() if width > PHONE} == {}


def test_the_search_finds_a_page_without_a_server_of_its_own(browser: Browser, address: str) -> None:  # noqa: F811
    browser.open(f"{address}/search.html?q=stiffness")
    found = browser.run("""return new Promise(done => { const look = () => {
      const links = document.querySelectorAll('#search-results li a');
      if (links.length) done(links.length); else setTimeout(look, 100); }; look(); });""")
    assert found > 0

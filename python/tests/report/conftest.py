"""Fixtures: a data set with gaps, loads out of reach and names that HTML must escape."""

from html.parser import HTMLParser
from pathlib import Path

import pytest

import taxelsim

from ..envs.conftest import write_scene

NASTY = """<b>"bar"&'"""
NUM_EPISODES = 20


@pytest.fixture(scope="session")
def reported(tmp_path_factory: pytest.TempPathFactory, device: taxelsim.Device) -> Path:
    """20 episodes of 13 frames. Some loads are out of reach, one object has no episode."""
    root = tmp_path_factory.mktemp("report")
    file = write_scene(root, record="tactile_image, features, ground_truth, poses, actions")
    text = file.read_text().replace("name: short", "name: '<i>short</i>'").replace("episodes: 24", f"episodes: {NUM_EPISODES}")
    text = text.replace("load: [1, 3]", "load: [1, 400]").replace("{name: bar,", "{name: '" + NASTY.replace("'", "''") + "',")
    text = text.replace("edge: [0, 0, 1]}\n", "edge: [0, 0, 1]}\n  - {name: ghost, weight: 0, sphere: {radius_mm: 4}, edge: [0, 0, 1]}\n")
    file.write_text(text)
    taxelsim.generate(file, root / '"data" & <set>', device=device)
    return root / '"data" & <set>'


class Page(HTMLParser):
    """A page as tables by id, rows of (text, value); histograms by label; pictures; and items of lists by id."""

    VOID = ("meta", "img", "br")

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tables: dict[str, list[list[tuple[str, str | None]]]] = {}
        self.histograms: dict[str, list[int]] = {}
        self.pictures: list[dict[str, str]] = []
        self.items: dict[str, list[str]] = {}
        self.tags: list[tuple[str, dict[str, str]]] = []
        self.texts: dict[str, str] = {}
        self._open: list[str] = []
        self.feed(text)
        self.close()
        assert self._open == []

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        self.tags.append((tag, attributes))
        if tag not in self.VOID:
            self._open.append(tag)
        if tag == "table":
            self._rows = self.tables.setdefault(attributes["id"], [])
        elif tag == "tr":
            self._rows.append([])
        elif tag in ("td", "th"):
            self._rows[-1].append(("", attributes.get("data-value")))
        elif tag == "svg":
            self._bars = self.histograms.setdefault(attributes["aria-label"], [])
        elif tag == "rect":
            self._bars.append(int(attributes["data-count"]))
        elif tag == "img":
            self.pictures.append(attributes)
        elif tag == "ul":
            self._list = self.items.setdefault(attributes["id"], [])
        elif tag == "li":
            self._list.append("")

    def handle_endtag(self, tag):
        assert self._open.pop() == tag

    def handle_data(self, data):
        tag = self._open[-1] if self._open else ""
        if tag in ("td", "th"):
            text, value = self._rows[-1][-1]
            self._rows[-1][-1] = (text + data, value)
        elif tag == "li":
            self._list[-1] += data
        else:
            self.texts[tag] = self.texts.get(tag, "") + data

    def row(self, table: str, name: str) -> list[tuple[str, str | None]]:
        return next(row for row in self.tables[table] if row[0][0] == name)

    def values(self, table: str, name: str) -> list[float]:
        """Numbers of a row, with all digits."""
        return [float(value) for _, value in self.row(table, name) if value is not None]

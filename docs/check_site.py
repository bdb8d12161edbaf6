#!/usr/bin/env python3
"""Checks the built site: pages need no network, links and anchors lead somewhere, pictures have a text, and phones get their own width.

check_site.py FOLDER    prints one line per fault, exits with 1 if there is any
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADED = {"img": "src", "script": "src", "iframe": "src", "source": "src", "video": "src"}  # attributes that a browser loads by itself


class Page(HTMLParser):
    """Links, ids and pictures of a page."""

    def __init__(self, file: Path) -> None:
        super().__init__()
        self.ids: set[str] = set()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.faults: list[str] = []
        self.has_viewport = False
        self.feed(file.read_text())

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Notes what a tag links, loads or names."""
        values = {name: value or "" for name, value in attrs}
        self.ids.update(values[name] for name in ("id", "name") if name in values)
        if tag == "a" and "href" in values:
            self.links.append(values["href"])
        if tag == "link" and values.get("rel") in ("stylesheet", "icon", "shortcut icon"):
            self.loads.append(values["href"])
        if tag in LOADED and LOADED[tag] in values:
            self.loads.append(values[LOADED[tag]])
        if tag == "img" and not values.get("alt"):
            self.faults.append(f"picture {values.get('src')} has no text")
        self.has_viewport |= tag == "meta" and values.get("name") == "viewport"


def faults_of(root: Path) -> list[str]:
    """One line per fault of the site in a folder."""
    pages = {file.resolve(): Page(file) for file in sorted(root.rglob("*.html"))}
    faults = [] if pages else [f"{root}: no pages"]
    for file, page in pages.items():
        found = list(page.faults)
        if not page.has_viewport:
            found.append("no viewport: a phone would show it small")
        found += [f"loads {address} from the network" for address in page.loads if urlsplit(address).netloc]
        for address in (*page.links, *page.loads):
            parts = urlsplit(address)
            if parts.scheme or parts.netloc:
                continue
            target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            if not target.exists():
                found.append(f"dead link {address}")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].ids:
                found.append(f"dead anchor {address}")
        faults += [f"{file.relative_to(root.resolve())}: {fault}" for fault in dict.fromkeys(found)]
    return faults


if __name__ == "__main__":
    lines = faults_of(Path(sys.argv[1]))
    print(*lines, sep="\n", end="\n" if lines else "")
    sys.exit(bool(lines))

#!/usr/bin/env python3
"""Writes the tables of keys of docs/reference/sensor_file.md and scene_file.md, which `taxelsim schema --markdown` prints.

make_key_tables.py [--check] PROGRAM. Tables are between lines <!-- keys NAME --> and <!-- end -->.
--check: compares only, and exits with 1 if a table differs.
"""

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

PAGES = [Path(__file__).parents[1] / f"docs/reference/{name}_file.md" for name in ("sensor", "scene")]
KINDS = "sensor", "scene", "robot"


def tables(program: str) -> dict[str, str]:
    """Markdown tables by the name of their block."""
    found = {}
    for kind in KINDS:
        text = subprocess.run([program, "schema", kind, "--markdown"], check=True, capture_output=True, text=True).stdout
        for block in text.split("## ")[1:]:
            name, table = block.split("\n\n", 1)
            found[name] = table.rstrip("\n") + "\n"
    return found


def main() -> int:
    """Runs the program."""
    *options, program = sys.argv[1:]
    known = tables(program)
    shown = {name: page.name for page in PAGES for name in re.findall(r"<!-- keys (\w+) -->", page.read_text())}
    differs = False
    for page in PAGES:
        text = page.read_text()

        def link(found: re.Match[str], page: Path = page) -> str:
            file = shown.get(found[1])
            return found[1] if file is None else f"[{found[1]}]({'' if file == page.name else file}#{found[1]})"

        def section(found: re.Match[str], link: Callable[[re.Match[str]], str] = link) -> str:
            table = re.sub(r"\[(\w+)\]\(#\1\)", link, known[found[2]])
            return f"{found[1]}### `{found[2]}`\n\n{table}{found[3]}"

        written = re.sub(r"(<!-- keys (\w+) -->\n).*?(<!-- end -->)", section, text, flags=re.DOTALL)
        if written == text:
            continue
        if options == ["--check"]:
            print(f"{page.name}: its tables are not those of the program; run scripts/make_key_tables.py {program}", file=sys.stderr)
            differs = True
        else:
            page.write_text(written)
    return int(differs)


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Writes the tables of keys of docs/file_formats.md, which `taxelsim schema --markdown` prints.

make_key_tables.py [--check] PROGRAM. Tables are between lines <!-- keys NAME --> and <!-- end -->.
--check: compares only, and exits with 1 if a table differs.
"""

import re
import subprocess
import sys
from pathlib import Path

PAGE = Path(__file__).parents[1] / "docs/file_formats.md"
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
    page = PAGE.read_text()
    shown = set(re.findall(r"<!-- keys (\w+) -->", page))

    def section(place: re.Match[str]) -> str:
        table = re.sub(r"\[(\w+)\]\(#\1\)", lambda link: link[0] if link[1] in shown else link[1], known[place[2]])
        return f"{place[1]}#### `{place[2]}`\n\n{table}{place[3]}"

    written = re.sub(r"(<!-- keys (\w+) -->\n).*?(<!-- end -->)", section, page, flags=re.DOTALL)
    if options == ["--check"]:
        if written != page:
            print(f"{PAGE.name}: its tables are not those of the program; run scripts/make_key_tables.py {program}", file=sys.stderr)
        return int(written != page)
    PAGE.write_text(written)
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""Compares the limits that docs/notes/threat_model.md lists with the constants of the code.

    python3 check_limits.py ROOT
"""

import pathlib
import re
import sys

ROW = re.compile(r"^\|[^|]*\|[^|]*\| ([0-9*^ ]+) \| `(\w+)` in (\S+) \|$", re.MULTILINE)


def value(text: str) -> int:
    """A product of whole numbers, shifts and powers in C++ or in the document's notation."""
    text = re.sub(r"std::\w+\{(\d+)\}", r"\1", text).replace("'", "").replace("^", "**")
    if not re.fullmatch(r"[0-9*<() ]+", text):
        raise ValueError(text)
    return int(eval(text))  # digits and operators only


def problems(root: pathlib.Path) -> list[str]:
    """One line for each row that the code contradicts."""
    found = []
    rows = ROW.findall((root / "docs/notes/threat_model.md").read_text())
    if not rows:
        found.append("docs/notes/threat_model.md: no row of the table of limits found")
    for listed, name, file in rows:
        constant = re.search(rf"constexpr [\w:]+ {name} = ([^;]+);", (root / file).read_text())
        if constant is None:
            found.append(f"docs/notes/threat_model.md: {file} has no constant {name}")
        elif value(constant[1]) != value(listed):
            found.append(f"docs/notes/threat_model.md: {name} is {listed}, but {constant[1]} in {file}")
    return found


if __name__ == "__main__":
    lines = problems(pathlib.Path(sys.argv[1]))
    print("\n".join(lines))
    sys.exit(bool(lines))

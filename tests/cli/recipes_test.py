#!/usr/bin/env python3
"""Runs the recipes of docs/how_to/: writes the files that it shows, runs its commands and its Python, in its order.

    recipes_test.py TAXELSIM [PAGE ...]

A block of code whose first line is a comment with a file name becomes that file, `sh` blocks are commands, `python` blocks run in this
interpreter. Fails at the first command that fails or prints a warning, and if a file that a command should write is missing.
"""

import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
RECIPES = "own_sensor", "own_mesh", "labelled_data", "press_hold_slide", "characterise"


def blocks(text):
    """(language, content) of each block of code."""
    return [(match[1], match[2]) for match in re.finditer(r"^```(\w+)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)]


def written_by(command):
    """Files and directories that the options -o, --png and --report name."""
    return re.findall(r"(?:-o|--png|--report) (\S+)", command)


def run_command(line, program, folder):
    assert line.startswith("taxelsim "), line
    # A shell, because the recipes use its patterns and quotes.
    done = subprocess.run(line.replace("taxelsim", str(program), 1), shell=True, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, f"{line}: exit status {done.returncode}: {done.stderr}"
    assert "warning" not in done.stderr, f"{line}: {done.stderr}"
    for name in written_by(line):
        assert (folder / name).exists(), f"{line}: {name} is missing"


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    pages = [pathlib.Path(word) for word in sys.argv[2:]] or [ROOT / f"docs/how_to/{name}.md" for name in RECIPES]
    num_commands = 0
    with tempfile.TemporaryDirectory() as directory:
        folder = pathlib.Path(directory)
        (folder / "scenes").symlink_to(ROOT / "scenes")
        for language, content in blocks("\n".join(page.read_text() for page in pages)):
            if language == "sh":
                for line in content.splitlines():
                    if line.startswith("taxelsim sensor "):
                        continue  # needs the Python package: python/tests/test_patterns.py runs it
                    run_command(line, program, folder)
                    num_commands += 1
            elif language == "python":
                if "import taxelsim" in content:
                    continue  # python/tests/first_touch/test_documents.py runs it
                subprocess.run([sys.executable, "-c", content], cwd=folder, check=True, stdout=subprocess.DEVNULL)
            else:
                name = re.match(r"# (\S+)\n", content)
                assert name, f"a block of {language} without a file name: {content[:60]}"
                body = content if language != "csv" else content.split("\n", 1)[1]
                (folder / name[1]).write_text(body)
    assert num_commands >= 10, f"only {num_commands} commands found"
    print(f"{num_commands} commands")


if __name__ == "__main__":
    main()

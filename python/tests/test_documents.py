"""The programs in the documents run."""

import re
from pathlib import Path

import numpy as np
import pytest

import taxelsim

ROOT = Path(__file__).resolve().parents[2]


def first_program(document: str, heading: str) -> str:
    text = (ROOT / document).read_text()
    return re.search(r"```python\n(.*?)```", text[text.index(heading) :], re.DOTALL).group(1)


@pytest.mark.parametrize(
    ("document", "heading"), [("README.md", "## Ten lines of Python"), ("docs/reference/python.md", "## A first batch")]
)
def test_the_first_batch_runs(document, heading, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    exec(first_program(document, heading), names)
    frame = names["frame"]
    assert frame.tactile_image.shape == (4096, 6, 14)
    assert frame.ground_truth.load_reached.all()
    assert frame.ground_truth.total_force[-1] == pytest.approx(5, rel=1e-3)


def test_the_tour_runs_and_makes_its_pictures(monkeypatch, tmp_path, capsys):
    text = (ROOT / "docs/start/tour.md").read_text()
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert len(blocks) == 7
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(Path(taxelsim.__file__).parents[1]))  # of the program that it starts
    names: dict = {}
    for block in blocks:
        exec(block, names)
    assert names["frame"].ground_truth.load_reached.all()
    assert np.degrees(np.median(abs(names["error"]))) < 15
    assert np.median(names["errors"][-1]) < 0.2 * np.median(names["errors"][0])
    assert 0 < names["mine"].mean() < 1  # so there are failures to draw
    output = capsys.readouterr().out
    assert "(4, 6, 14)" in output
    assert "align - principal_axis: " in output
    shown = re.findall(r"\(\.\./images/(\w+\.png)\)", text)
    assert sorted(file.name for file in tmp_path.glob("*.png")) == sorted(shown)
    for name in shown:
        assert (ROOT / "docs/images" / name).read_bytes().startswith(b"\x89PNG")


def test_the_readme_is_short_and_shows_code_early():
    text = (ROOT / "README.md").read_text()
    assert len(text.encode()) <= 6000
    assert text[: text.index("```")].count("\n") < 25
    for picture in re.findall(r"\]\((docs/images/[\w/.]+)\)", text):
        assert (ROOT / picture).stat().st_size < 2_000_000


def test_links_of_pages_outside_the_site_exist():
    for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "THIRD_PARTY.md", "bench/README.md", "deploy/README.md"):
        page = ROOT / name
        for target in re.findall(r"\]\(([^)#\s:]+)(?:#[^)]*)?\)", page.read_text()):
            assert (page.parent / target).exists(), f"{name}: {target}"


def test_the_skill_for_agents_runs():
    text = (Path(taxelsim.__file__).parent / "SKILL.md").read_text()
    assert text.startswith("---\nname: taxelsim\n")
    names: dict = {}
    exec(re.search(r"```python\n(.*?)```", text, re.DOTALL).group(1), names)
    assert names["frame"].tactile_image.any()

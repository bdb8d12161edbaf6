"""`taxelsim report`: files, the card, and refusals."""

import json
import subprocess
import sys

import pytest

import taxelsim
from taxelsim.commands.report import main
from taxelsim.program import PROGRAM
from taxelsim.report import card_of, summarize
from taxelsim.report.card import size_category

from .conftest import NUM_EPISODES, Page

CONTACTS = """
format_version: 1
name: contacts
kind: contacts
sensor: {sensor}
objects: [{{sphere: {{radius_mm: 5}}}}]
randomization: {{load: [1, 3]}}
data_set: {{episodes: 4}}
"""


def test_writes_page_and_card(reported, tmp_path):
    page, card = tmp_path / "report.html", tmp_path / "README.md"
    page.write_text("old")
    command = [sys.executable, "-m", "taxelsim", "report", reported, "-o", page, "--card", card, "--license", "cc-by-4.0"]
    done = subprocess.run(command, capture_output=True, text=True)  # a process without a device, whose copies for each read are cheap
    assert (done.returncode, done.stdout, done.stderr) == (0, "", f"wrote {page}\nwrote {card}\n")
    assert Page(page.read_text()).values("overview", "episodes") == [NUM_EPISODES]
    assert card.read_text().startswith('---\nlicense: "cc-by-4.0"\n')
    assert sorted(path.name for path in tmp_path.iterdir()) == ["README.md", "report.html"]


@pytest.mark.parametrize(
    ("arguments", "status", "message"),
    [
        (["{tmp}"], 2, "no data set: it has no dataset.yaml"),
        (["{data}", "--max-frames", "0"], 2, "--max-frames: 0 is not allowed: at least 1"),
        (["{data}", "--license", "my license"], 2, "license: 'my license' is not allowed: an identifier such as cc-by-4.0"),
        (["{data}", "-o", "{tmp}/none/report.html"], 1, "none/report.html: No such file or directory"),
    ],
)
def test_bad_input_gives_one_line(reported, tmp_path, capsys, monkeypatch, arguments, status, message):
    monkeypatch.chdir(tmp_path)
    assert main([argument.format(data=reported, tmp=tmp_path) for argument in arguments]) == status
    error = capsys.readouterr().err
    assert message in error
    assert len(error.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


@pytest.fixture(scope="module")
def card(reported):
    return card_of(summarize(taxelsim.Dataset(reported)), "unknown")


def test_front_matter(card, reported):
    _, matter, _ = card.split("---\n", 2)
    lines = matter.splitlines()
    assert f"pretty_name: {json.dumps(reported.name)}" in lines
    assert lines[lines.index("size_categories:") + 1] == "- n<1K"
    assert lines[lines.index("task_categories:") + 1] == "- robotics"
    assert "- tactile" in lines
    assert "viewer: false" in lines  # frames and episodes have different numbers of rows


def test_one_frame_per_episode_can_be_loaded_by_the_hub(device, tmp_path):
    scene = tmp_path / "contacts.yaml"
    scene.write_text(CONTACTS.format(sensor=(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").resolve()))
    taxelsim.generate(scene, tmp_path / "data", device=device)
    card = card_of(summarize(taxelsim.Dataset(tmp_path / "data")), "unknown")
    configs = 'configs:\n- config_name: default\n  data_files:\n  - split: train\n    path: "shard-*.h5"\n---\n'
    assert configs in card
    assert "viewer: false" not in card


def test_texts_are_escaped_in_the_card(card):
    assert "\\<i\\>short\\</i\\>" in card
    assert "<i>" not in card


@pytest.mark.parametrize(
    ("num_frames", "category"),
    [(999, "n<1K"), (1000, "1K<n<10K"), (10**9 - 1, "100M<n<1B"), (10**9, "1B<n<10B"), (10**12, "n>1T")],
)
def test_size_categories(num_frames, category):
    assert size_category(num_frames) == category


@pytest.fixture
def in_parts(device, tmp_path):
    """A data set whose shards are there, and which is not finished."""
    scene = tmp_path / "contacts.yaml"
    scene.write_text(CONTACTS.format(sensor=(taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml").resolve()))
    taxelsim.generate(scene, tmp_path / "data", device=device, shards=range(1))
    return tmp_path / "data"


def contents(folder):
    return {file.name: file.read_bytes() for file in folder.iterdir()}


def test_finish_writes_the_card_and_changes_no_other_file(in_parts):
    taxelsim.finish(in_parts)
    plain = contents(in_parts)
    taxelsim.finish(in_parts, card=True, license_id="cc-by-4.0")
    carded = contents(in_parts)
    card = carded.pop("README.md").decode()
    assert carded == plain
    assert card == card_of(summarize(taxelsim.Dataset(in_parts, isolated=True)), "cc-by-4.0")
    # The program reads a folder with a card, and extends the data set in it.
    assert subprocess.run([PROGRAM, "inspect", in_parts, "--verify"], capture_output=True).returncode == 0
    (in_parts / "README.md").write_text("edited")
    taxelsim.finish(in_parts, card=True)
    assert contents(in_parts) == {**plain, "README.md": b"edited"}


def test_finish_card_on_the_command_line(in_parts, tmp_path):
    command = [sys.executable, "-m", "taxelsim", "finish", in_parts, "--card", "--license"]
    refused = subprocess.run([*command, "my license"], capture_output=True, text=True)
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert not (in_parts / "dataset.h5").exists()
    done = subprocess.run([*command, "mit"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == f"{in_parts / 'README.md'}: written"
    assert (in_parts / "README.md").read_text().startswith('---\nlicense: "mit"\n')
    (in_parts / "shard-000000.h5").unlink()
    broken = subprocess.run([*command, "mit"], capture_output=True, text=True)
    assert (broken.returncode, broken.stderr.count("\n")) == (2, 1)
    assert "shard-000000.h5 is missing" in broken.stderr

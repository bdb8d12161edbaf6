"""Numbers of the page against NumPy on the columns, as h5py reads them."""

import base64

import h5py
import numpy as np
import pytest

import taxelsim
from taxelsim.report import page_of, summarize

from .conftest import NASTY, NUM_EPISODES, Page


@pytest.fixture(scope="module")
def columns(reported):
    with h5py.File(reported / "dataset.h5") as file:
        names = []
        file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
        return {name: file[name][...] for name in names}


@pytest.fixture(scope="module")
def page(reported):
    return Page(page_of(summarize(taxelsim.Dataset(reported))))


@pytest.mark.parametrize(
    ("table", "name"),
    [
        ("force", "data/total_force"),
        ("force", "data/ground_truth/total_force"),
        ("angle", "data/edge_angle"),
        ("saturation", "data/saturated"),
        ("episode", "meta/load"),
        ("episode", "meta/gain"),
    ],
)
def test_distributions(page, columns, table, name):
    values = columns[name].astype(np.float64)
    expected = [values.size, values.mean(), *np.percentile(values, (0, 5, 50, 95, 100))]
    assert page.values(table, name) == pytest.approx(expected, rel=1e-15)
    np.testing.assert_array_equal(page.histograms[f"Histogram of {name}"], np.histogram(values, 40)[0])


def test_positions_are_of_frames_with_contact(page, columns):
    centres = columns["data/center_of_pressure"].astype(np.float64)
    touched = centres[centres.any(1)]
    for k, axis in enumerate("xyz"):
        count, mean = page.values("position", f"data/center_of_pressure {axis}")[:2]
        assert count == len(touched)
        assert mean == pytest.approx(touched[:, k].mean(), rel=1e-14)


def test_counts(page, columns):
    images = columns["data/tactile_image"].reshape(-1, 84)
    assert page.values("overview", "episodes") == [NUM_EPISODES]
    assert page.values("overview", "frames") == [len(images)]
    assert page.values("overview", "frames with contact") == [(images > 0).any(1).sum()]
    saturated = (images == 4095).any(1).sum()
    assert 0 < saturated < len(images)
    assert page.values("overview", "frames with a saturated taxel") == [saturated]
    unreached = (columns["meta/load_reached"] == 0).sum()
    assert 0 < unreached < NUM_EPISODES
    assert page.values("overview", "episodes whose load is out of reach") == [unreached]
    assert page.values("overview", "episodes that met the task") == [columns["meta/success"].sum()]
    assert page.values("objects", NASTY) == [NUM_EPISODES, unreached]
    assert page.values("objects", "ghost") == [0, 0]


def test_gaps(page, columns):
    gaps = page.items["gaps"]
    assert "Object ghost has no episode." in gaps
    untouched = (columns["data/tactile_image"].reshape(-1, 84) == 0).all(0).sum()
    assert (f"{untouched} of 84 taxels are 0 in every frame." in gaps) == bool(untouched)
    counts, edges = np.histogram(columns["meta/noise"], 10, (0, 20))
    noise = [gap for gap in gaps if gap.startswith("No episode has a noise of")]
    assert len(noise) == bool((counts == 0).any())
    for first in np.flatnonzero((counts[:-1] > 0) & (counts[1:] == 0)):
        assert f"{edges[first + 1]:.4g} to " in noise[0]
    assert any(gap.startswith("No frame has an edge angle of") for gap in gaps)


def test_examples_are_frames_of_the_data_set(page):
    assert len(page.pictures) == 3 + 1  # levels of force of one object, and the coverage
    for picture in page.pictures:
        assert base64.b64decode(picture["src"].removeprefix("data:image/png;base64,"))[:8] == b"\x89PNG\r\n\x1a\n"
    assert page.pictures[0]["alt"].startswith(f"{NASTY}, 10 % of forces below: ")


def test_texts_of_the_data_set_are_escaped(page, reported):
    assert page.texts["h1"] == f"Data set {reported.name}"
    assert page.row("provenance", "scene")[1][0] == "<i>short</i>"
    assert "<i>short</i>" in page.texts["pre"]
    assert {tag for tag, _ in page.tags} & {"script", "link", "iframe", "object", "b", "i", "a"} == set()


def test_nothing_is_loaded_from_elsewhere(page):
    sources = [value for _, attributes in page.tags for name, value in attributes.items() if name in ("src", "href", "srcset", "action")]
    assert all(source.startswith("data:image/png;base64,") for source in sources)
    assert "default-src 'none'" in next(a["content"] for tag, a in page.tags if tag == "meta" and "content" in a)
    assert "url(" not in page.texts["style"]


def test_provenance(page, reported):
    data = taxelsim.Dataset(reported)
    assert page.row("provenance", "SHA-256 of the scene")[1][0] == data.attributes["scene_sha256"]
    assert page.row("provenance", "seed")[1][0] == "5"
    assert page.row("provenance", "program")[1][0] == f"taxelsim {taxelsim.__version__}"
    assert [row[0][0] for row in page.tables["columns"][1:]] == list(data.columns)


def test_a_sample_says_so(reported, columns):
    summary = summarize(taxelsim.Dataset(reported), 100)
    assert summary.num_sampled_frames == 100
    page = Page(page_of(summary))
    assert "of a sample of 100 frames" in page.texts["p"]
    assert page.values("overview", "frames") == [NUM_EPISODES * 13]
    assert page.values("force", "data/total_force")[0] == 100

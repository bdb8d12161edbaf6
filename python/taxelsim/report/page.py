"""The report as one file of HTML: no script, and nothing that is loaded from elsewhere."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

import numpy as np

from .._core import version
from ..pictures import TactilePictures, noise_of, tactile_pictures
from .summary import QUANTILES, Distribution, Summary
from .svg import histogram, image_tag, number

_STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; color: #1c2430; background: #fff }
h1 { font-size: 1.7rem } h2 { font-size: 1.25rem; margin-top: 2.2rem; border-bottom: 1px solid #d5dae2 }
table { border-collapse: collapse; margin: .6rem 0 } th, td { text-align: left; padding: .15rem .8rem .15rem 0; vertical-align: top }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums } pre { overflow-x: auto; background: #f4f6f9; padding: .8rem }
.row { display: flex; flex-wrap: wrap; gap: 1.2rem } figure { margin: 0; max-width: 320px } figcaption { font-size: .85rem; color: #4c5a6b }
svg rect { fill: #2d7d8c } svg text { font-size: 11px; fill: #4c5a6b } img { image-rendering: pixelated; max-width: 240px; height: auto }
"""

_GROUPS = {
    "force": "Forces",
    "angle": "Angles",
    "position": "Positions",
    "saturation": "Saturation",
    "episode": "Episodes",
}


def _cell(value: object) -> str:
    """Numbers have all digits in data-value."""
    if isinstance(value, float | np.floating):
        return f'<td class="n" data-value="{float(value)!r}">{number(float(value))}</td>'
    if isinstance(value, int | np.integer):
        return f'<td class="n" data-value="{int(value)}">{int(value):,}</td>'
    return f"<td>{escape(str(value))}</td>"


def _table(name: str, heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    head = "".join(f"<th>{escape(text)}</th>" for text in heads)
    body = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in rows)
    return f'<table id="{escape(name)}"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>'


def _share(part: int, whole: int) -> str:
    return f"{100 * part / whole:.2f} %" if whole else "-"


def _overview(summary: Summary) -> str:
    frames = summary.num_sampled_frames
    rows: list[Sequence[object]] = [
        ("episodes", summary.num_episodes, ""),
        ("frames", summary.num_frames, ""),
        ("frames with contact", summary.contact_frames, _share(summary.contact_frames, frames)),
        ("frames with a saturated taxel", summary.saturated_frames, _share(summary.saturated_frames, frames)),
        (
            "episodes whose load is out of reach",
            sum(summary.out_of_reach.values()),
            _share(sum(summary.out_of_reach.values()), summary.num_sampled_episodes),
        ),
    ]
    if summary.successes is not None:
        rows.append(("episodes that met the task", summary.successes, _share(summary.successes, summary.num_sampled_episodes)))
    note = ""
    if summary.num_sampled_frames < summary.num_frames:
        note = (
            f"<p>All numbers but the first two are of a sample of {summary.num_sampled_frames:,} frames of "
            f"{summary.num_sampled_episodes:,} episodes, in blocks that are evenly spaced over the data set.</p>"
        )
    return note + _table("overview", ("", "count", "share"), rows)


def _figure(distribution: Distribution) -> str:
    return f"<figure>{histogram(distribution)}<figcaption>{escape(distribution.name)}</figcaption></figure>"


def _distributions(summary: Summary) -> str:
    parts = []
    for group, title in _GROUPS.items():
        chosen = [distribution for distribution in summary.distributions if distribution.group == group]
        if not chosen:
            continue
        heads = ("column", "unit", "count", "mean", *(f"{q} %" for q in QUANTILES))
        rows = [(d.name, d.unit, d.count, d.mean, *d.quantiles) for d in chosen]
        figures = "".join(_figure(d) for d in chosen if not d.is_constant)
        parts.append(f'<h2>{title}</h2><div class="row">{figures}</div>{_table(group, heads, rows)}')
    return "".join(parts)


def _objects(summary: Summary) -> str:
    rows = [(name, count, summary.out_of_reach[name]) for name, count in summary.objects.items()]
    return _table("objects", ("object", "episodes", "load out of reach"), rows)


def _images(summary: Summary) -> str:
    sensor, figures = summary.sensor, []
    readout, has_axes = sensor.readout, any(example.image.ndim == 2 for example in summary.examples)
    saturation = float(readout.three_axis.saturation if has_axes and readout.three_axis else readout.saturation)
    pictures = TactilePictures(sensor, summary.range, noise_of(summary.scene))
    for example in summary.examples:
        largest = float((example.image[:, 2] if has_axes else example.image).max())
        text = f"{example.stratum}: {number(example.force)} {example.unit}, at most {number(largest)} counts"
        picture = image_tag(pictures.draw(example.image[None])[0], text)
        figures.append(f"<figure>{picture}<figcaption>{escape(text)}</figcaption></figure>")
    contacts = tactile_pictures(sensor, summary.taxel_contacts[None], max(1.0, float(summary.taxel_contacts.max())))[0]
    coverage = image_tag(contacts, "frames in which each taxel is above 0")
    words = f"Frames in which each taxel is above 0: {summary.taxel_contacts.min():,} to {summary.taxel_contacts.max():,}"
    shear = " Arrows show shear: two taxels long where it has as many counts." if has_axes else ""
    note = f"<p>The brightest colour is at {number(summary.range)} counts, saturation at {saturation:,.0f} counts.{shear}</p>"
    shown = f'<h2>Example images</h2>{note}<div class="row">{"".join(figures)}</div>'
    return f"{shown}<h2>Coverage</h2><figure>{coverage}<figcaption>{escape(words)}</figcaption></figure>"


def provenance_rows(summary: Summary) -> list[tuple[str, str]]:
    """Name and value."""
    source = summary.provenance
    return [
        ("scene", summary.scene.name),
        ("SHA-256 of the scene", source.scene_sha256),
        ("seed", str(source.seed)),
        ("sensor", f"{summary.sensor_name}, {summary.sensor.num_taxels} taxels"),
        ("program", f"taxelsim {source.program_version}"),
        ("device", source.device),
        ("policy", source.policy or "controllers of the scene"),
        ("format", f"{source.format_version}, {source.num_shards} shards"),
    ]


def page_of(summary: Summary) -> str:
    """The page."""
    title = escape(f"Data set {summary.folder.name}")
    gaps = "".join(f"<li>{escape(gap)}</li>" for gap in summary.gaps) or "<li>None found.</li>"
    columns = [(name, kind, str(list(shape)), unit, text) for name, kind, shape, unit, text in summary.columns]
    parts = [
        f"<h1>{title}</h1>",
        _overview(summary),
        f"<h2>Objects</h2>{_objects(summary)}",
        _distributions(summary),
        _images(summary),
        f'<h2>Gaps</h2><ul id="gaps">{gaps}</ul>',
        f"<h2>Provenance</h2>{_table('provenance', ('', ''), provenance_rows(summary))}",
        f"<details><summary>The scene, with all defaults</summary><pre>{escape(summary.provenance.scene)}</pre></details>",
        f"<h2>Columns</h2>{_table('columns', ('column', 'type', 'shape of a row', 'unit', 'meaning'), columns)}",
        f"<footer><p>Written by taxelsim {escape(version)}.</p></footer>",
    ]
    policy = "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'\">"
    head = f'<meta charset="utf-8">{policy}<title>{title}</title><style>{_STYLE}</style>'
    return f'<!DOCTYPE html>\n<html lang="en"><head>{head}</head><body>{"".join(parts)}</body></html>\n'

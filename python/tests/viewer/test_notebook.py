"""A recording as a notebook shows it: what a kernel without a display sends to the page."""

import sys
from collections import defaultdict

import pytest

from .conftest import Recorded

WIDGET = "application/vnd.jupyter.widget-view+json"


@pytest.fixture
def messages(monkeypatch):
    """What the widget of Rerun sends to the page once that is ready: (content, buffers)."""
    rerun_notebook = pytest.importorskip("rerun_notebook", reason="rerun-notebook as in python/requirements/test.txt")
    sent: list[tuple[dict[str, str], list[bytes]]] = []
    monkeypatch.setattr(rerun_notebook.Viewer, "send", lambda widget, content, buffers=None: sent.append((content, buffers or [])))
    return sent


def test_a_notebook_gets_a_widget_and_the_whole_recording(messages, viewed, recorded, tmp_path, monkeypatch):
    from IPython.core.interactiveshell import InteractiveShell
    from IPython.utils.capture import capture_output

    monkeypatch.setattr(sys, "displayhook", sys.displayhook)  # the shell replaces it
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    shell = InteractiveShell.instance()
    try:
        shell.push({"folder": str(viewed)})
        with capture_output() as captured:
            result = shell.run_cell("import taxelsim\ntaxelsim.view(folder, [1, 2]).notebook_show()")
        result.raise_error()
    finally:
        InteractiveShell.clear_instance()
    shown = [output.data for output in captured.outputs if WIDGET in output.data]
    assert shown, captured.outputs
    assert shown[-1][WIDGET]["model_id"]

    # Each message is a complete recording.
    columns: dict[tuple[str, str], list[object]] = defaultdict(list)
    static: dict[tuple[str, str], object] = {}
    for number, part in enumerate(part for content, parts in messages if content["type"] == "rrd" for part in parts):
        file = tmp_path / f"{number}.rrd"
        file.write_bytes(part)
        found = Recorded(file)
        static |= found.static
        for key, values in found.columns.items():
            columns[key] += values
    expected = recorded(viewed, [1, 2])
    assert len(expected.columns) > 20
    assert columns == expected.columns
    assert static.keys() == expected.static.keys()

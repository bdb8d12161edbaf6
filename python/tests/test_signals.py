"""Signals that come while a mesh is loaded. Seconds are those of the processor: a busy machine changes nothing."""

import signal
import time

import numpy as np
import pytest

import taxelsim

MAX_SECONDS = 0.5


def write_waves(file, n):
    """A torus with waves: n x n quads of two triangles, a binary STL."""
    u, v = np.meshgrid(*[2 * np.pi * np.arange(n) / n] * 2, indexing="ij")
    tube = 0.004 * (1 + 0.1 * np.cos(7 * u) * np.cos(5 * v))
    radius = 0.012 + tube * np.cos(v)
    a = np.stack([radius * np.cos(u), radius * np.sin(u), tube * np.sin(v)], axis=-1)
    b, d = np.roll(a, -1, axis=0), np.roll(a, -1, axis=1)
    c = np.roll(b, -1, axis=1)
    facets = np.zeros(2 * n * n, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]))
    facets["corners"] = np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)]).reshape(-1, 3, 3)
    file.write_bytes(bytes(80) + np.uint32(len(facets)).tobytes() + facets.tobytes())


def test_load_mesh_hears_them(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    write_waves(tmp_path / "waves.stl", 120)  # 28,800 triangles, 2.5 s

    def interrupt(*_):
        raise KeyboardInterrupt

    handler = signal.signal(signal.SIGPROF, interrupt)
    start = time.process_time()
    signal.setitimer(signal.ITIMER_PROF, 0.5)
    try:
        with pytest.raises(KeyboardInterrupt):
            taxelsim.load_mesh(tmp_path / "waves.stl")
        assert time.process_time() - start < 0.5 + MAX_SECONDS
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, handler)
    assert not (tmp_path / "cache" / "taxelsim").exists(), "a result that is not complete is not stored"

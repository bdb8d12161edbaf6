"""generate() and evaluate()."""

import os
import signal
import threading

import numpy as np
import pytest

import taxelsim

SCENE = taxelsim.SCENES / "edge_servo.yaml"


def test_generate_writes_a_data_set_and_reports_progress(device, tmp_path):
    seen: list[taxelsim.Progress] = []
    threads = set()

    def on_progress(progress: taxelsim.Progress) -> None:
        seen.append(progress)
        threads.add(threading.current_thread())

    scene = taxelsim.load_scene(SCENE, num_episodes=4)
    result = taxelsim.generate(scene, tmp_path / "out", device=device, batch_size=4, on_progress=on_progress)
    assert result.complete
    assert result.progress.frames_done == 4 * scene.num_steps
    assert result.progress.num_frames == 4 * scene.num_steps
    assert sum(misses.num_episodes for misses in result.load_misses) == 4
    assert len(result.load_misses) == len(scene.objects)
    assert (tmp_path / "out" / "dataset.h5").exists()
    assert seen[-1].episodes_done == 4
    assert threads == {threading.main_thread()}
    again = taxelsim.generate(scene, tmp_path / "out", device=device)
    assert again.progress.episodes_resumed == 4
    with pytest.raises(taxelsim.InputError, match="seed"):
        taxelsim.generate(taxelsim.load_scene(SCENE, num_episodes=4, seed=99), tmp_path / "out", device=device)


def test_an_exception_in_the_progress_callback_ends_the_run(device, tmp_path):
    def on_progress(progress: taxelsim.Progress) -> None:
        raise ZeroDivisionError("enough")

    with pytest.raises(ZeroDivisionError, match="enough"):
        taxelsim.generate(
            taxelsim.load_scene(SCENE, num_episodes=100000), tmp_path / "out", device=device, batch_size=64, on_progress=on_progress
        )


@pytest.mark.usefixtures("interruptible")
def test_ctrl_c_stops_a_run(device, tmp_path):
    """Without a callback, too: the signal arrives while the main thread waits without the GIL."""
    scene = taxelsim.load_scene(SCENE, num_episodes=1000000)
    timer = threading.Timer(1, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            taxelsim.generate(scene, tmp_path / "out", device=device, batch_size=64)
    finally:
        timer.cancel()
    assert not (tmp_path / "out" / "dataset.h5").exists()


def test_evaluate_judges_the_same_episodes_for_each_controller(device):
    scene = taxelsim.load_scene(taxelsim.SCENES / "tasks/hold_force.yaml", num_episodes=6)
    evaluations = taxelsim.evaluate(scene, device=device, batch_size=6)
    assert [evaluation.controller for evaluation in evaluations] == scene.controllers
    for evaluation in evaluations:
        verdicts = evaluation.verdicts
        assert verdicts["episode"].tolist() == list(range(6))
        assert verdicts["success"].sum() == evaluation.total.num_successes
        assert verdicts["steady_error"].shape == (6, len(taxelsim.TASK_MEASURES))
        assert 0 <= evaluation.total.success_low <= evaluation.total.success_rate <= evaluation.total.success_high <= 1
    again = taxelsim.evaluate(scene, [scene.controllers[0]], device=device, batch_size=2)[0].verdicts
    assert all(np.array_equal(again[name], evaluations[0].verdicts[name], equal_nan=True) for name in again)


def test_wrong_runs_are_refused(device, tmp_path):
    with pytest.raises(taxelsim.InputError, match="no such controller"):
        taxelsim.evaluate(taxelsim.SCENES / "tasks/hold_force.yaml", ["no such controller"], device=device)
    with pytest.raises(taxelsim.InputError, match="batch size: 0 is not allowed"):
        taxelsim.generate(SCENE, tmp_path / "out", device=device, batch_size=0)
    with pytest.raises(taxelsim.InputError, match=r"nowhere\.yaml"):
        taxelsim.generate("nowhere.yaml", tmp_path / "out", device=device)

"""Whether rows depend on the batch."""

import numpy as np
import pytest

import taxelsim
from taxelsim.policies import OnnxPolicy, PaddedPolicy, independent_of_batch, rows_depend_on_batch

from .networks import write_mlp

OBSERVATION = np.random.default_rng(0).normal(size=(150, 6)).astype(np.float32)


def test_network_with_independent_rows_is_used_as_it_is(tmp_path):
    policy = OnnxPolicy(write_mlp(tmp_path / "p.onnx"))
    assert independent_of_batch(policy, OBSERVATION) == (policy, None)


def test_network_that_mixes_rows_is_called_with_fixed_chunks(tmp_path):
    policy = OnnxPolicy(write_mlp(tmp_path / "p.onnx", mix_rows=True))
    assert rows_depend_on_batch(policy, OBSERVATION)
    padded, note = independent_of_batch(policy, OBSERVATION)
    assert note == "actions of this policy depend on the batch: it is called with exactly 1 rows at a time"
    assert not rows_depend_on_batch(padded, OBSERVATION)


def test_policy_that_depends_on_the_number_of_rows_only_keeps_large_chunks():
    padded, note = independent_of_batch(lambda rows: rows + len(rows), OBSERVATION)
    assert "exactly 64 rows" in note
    assert np.array_equal(padded(OBSERVATION), OBSERVATION + 64)
    assert np.array_equal(padded({"x": OBSERVATION}["x"][:3]), OBSERVATION[:3] + 64)


def test_order_of_rows_is_noticed():
    assert rows_depend_on_batch(lambda rows: rows * np.arange(len(rows))[:, np.newaxis], OBSERVATION)


def test_dicts_of_observations_are_split_by_rows():
    policy = PaddedPolicy(lambda observation: observation["a"] + observation["b"], 64)
    assert np.array_equal(policy({"a": OBSERVATION, "b": OBSERVATION}), 2 * OBSERVATION)


def test_policy_with_random_actions_is_refused():
    random = np.random.default_rng(0)
    with pytest.raises(taxelsim.InputError, match="must be a function of its observation"):
        independent_of_batch(lambda rows: random.normal(size=rows.shape), OBSERVATION)

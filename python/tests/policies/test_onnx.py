"""Policies from ONNX files."""

import hashlib

import numpy as np
import pytest

import taxelsim
from taxelsim.policies import OnnxPolicy
from taxelsim.policies.policy import as_policy

from .networks import write_mlp

OBSERVATION = np.random.default_rng(0).normal(size=(20, 6)).astype(np.float32)


def test_identity_is_the_hash_of_the_file(tmp_path):
    file = write_mlp(tmp_path / "p.onnx")
    assert OnnxPolicy(file).identity == hashlib.sha256(file.read_bytes()).hexdigest()


def test_fixed_batch_size_is_filled_up(tmp_path):
    dynamic, fixed = OnnxPolicy(write_mlp(tmp_path / "d.onnx")), OnnxPolicy(write_mlp(tmp_path / "f.onnx", batch=7))
    assert fixed.batch_size == 7
    assert np.array_equal(fixed(OBSERVATION), dynamic(OBSERVATION))


def test_observations_are_flattened_and_joined(tmp_path):
    policy = OnnxPolicy(write_mlp(tmp_path / "p.onnx", 12))
    joined = policy(np.concatenate([OBSERVATION, 2 * OBSERVATION], axis=1))
    assert np.array_equal(policy({"contact": OBSERVATION, "features": 2 * OBSERVATION}), joined)
    assert np.array_equal(policy(np.stack([OBSERVATION, 2 * OBSERVATION], axis=1)), joined)


def test_settings_are_read_from_the_file_and_arguments_replace_them(tmp_path):
    settings = {"observations": "contact, proprioception", "actions": "v_x", "history": "3", "normalized": "true", "linear_scale": "0.02"}
    file = write_mlp(tmp_path / "p.onnx", settings=settings)
    policy = as_policy(file, history=2, actions=None)
    assert policy.observations == ("contact", "proprioception")
    assert (policy.actions, policy.history, policy.normalized, policy.linear_scale) == ("v_x", 2, True, 0.02)
    assert policy.name == "p"


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"history": "0"}, "metadata taxelsim.history: '0' found, an integer of at least 1"),
        ({"normalized": "yes"}, "true and false allowed"),
        ({"linear_scale": "fast"}, "a number allowed"),
        ({"motion": "v_x"}, "keys allowed: taxelsim.observations"),
    ],
)
def test_refuses_bad_settings(tmp_path, settings, message):
    with pytest.raises(taxelsim.InputError, match=message):
        OnnxPolicy(write_mlp(tmp_path / "p.onnx", settings=settings))


def test_refuses_observations_of_another_shape(tmp_path):
    with pytest.raises(taxelsim.InputError, match=r"p.onnx: input 'obs' has shape \['batch', 6\], the observation \['batch', 5\]"):
        OnnxPolicy(write_mlp(tmp_path / "p.onnx"))(OBSERVATION[:, :5])


def test_refuses_files_that_are_no_networks(tmp_path):
    with pytest.raises(taxelsim.InputError, match=r"missing.onnx: No such file"):
        OnnxPolicy(tmp_path / "missing.onnx")
    (tmp_path / "text.onnx").write_text("text")
    with pytest.raises(taxelsim.InputError, match=r"text.onnx: not a network"):
        OnnxPolicy(tmp_path / "text.onnx")


def test_refuses_what_is_no_policy():
    with pytest.raises(taxelsim.InputError, match="int is not allowed: a callable or the name of an ONNX file"):
        as_policy(3)

"""One side of rates.py: frames/s of VectorEnv.step() over whole episodes. Prints JSON.

python environment_rate.py SCENE NUM_ENVS servo|mlp NUM_EPISODES

servo: a NumPy policy that holds force and centre. mlp: a network 6-64-64-4 by onnxruntime; its actions are close to zero, so that the
contact lasts. The episodes of all environments end in the same step, in which they are reset. The time of an episode includes one reset.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import onnx
from numpy.typing import NDArray

import taxelsim

ACTIONS = ("v_x", "v_y", "v_z", "w_z")
LINEAR_SCALE, ANGULAR_SCALE = 0.06, 1.0  # m/s, rad/s
FORCE, FORCE_GAIN, CENTER_GAIN = 3.0, 0.02, 4.0  # N, m/(s N), 1/s
WIDTH = 64  # of both hidden layers

Policy = Callable[[Any], NDArray[Any]]


def servo(observation: NDArray[np.float32]) -> NDArray[np.float64]:
    """Follows the centre of pressure and holds the force. Without contact it approaches."""
    velocity = np.zeros((len(observation), len(ACTIONS)))
    velocity[:, :2] = CENTER_GAIN * observation[:, :2]
    velocity[:, 2] = FORCE_GAIN * (FORCE + observation[:, 5])
    return np.clip(velocity / LINEAR_SCALE, -1, 1)


def mlp() -> Policy:
    """A network with random weights."""
    random = np.random.default_rng(1)
    sizes = (6, WIDTH, WIDTH, len(ACTIONS))
    nodes, weights, value = [], [], "observation"
    for i in range(3):
        scale = (1 if i < 2 else 1e-3) / np.sqrt(sizes[i])
        weight = (scale * random.standard_normal((sizes[i], sizes[i + 1]))).astype(np.float32)
        weights += [
            onnx.numpy_helper.from_array(weight, f"w{i}"),
            onnx.numpy_helper.from_array(np.zeros(sizes[i + 1], np.float32), f"b{i}"),
        ]
        nodes += [onnx.helper.make_node("Gemm", [value, f"w{i}", f"b{i}"], [f"g{i}"]), onnx.helper.make_node("Tanh", [f"g{i}"], [f"t{i}"])]
        value = f"t{i}"
    tensors = [
        onnx.helper.make_tensor_value_info(name, onnx.TensorProto.FLOAT, ["batch", size])
        for name, size in (("observation", sizes[0]), (value, sizes[-1]))
    ]
    graph = onnx.helper.make_graph(nodes, "mlp", tensors[:1], tensors[1:], weights)
    model = onnx.helper.make_model(graph, opset_imports=[onnx.helper.make_opsetid("", 17)], ir_version=8)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "mlp.onnx"
        onnx.save(model, str(file))
        return taxelsim.OnnxPolicy(file)


def main() -> None:
    """Prints frames/s, the share of the policy in the time, and the number of episodes that ended early."""
    scene, num_envs, name, num_episodes = sys.argv[1], int(sys.argv[2]), sys.argv[3], int(sys.argv[4])
    policy: Policy = servo if name == "servo" else mlp()
    envs = taxelsim.make_vec(scene, num_envs, actions=ACTIONS, linear_scale=LINEAR_SCALE, angular_scale=ANGULAR_SCALE)
    observation, _ = envs.reset(seed=1)
    for _ in range(3):  # compiles kernels
        observation, *_ = envs.step(policy(observation))
    observation, _ = envs.reset(seed=1)
    in_contact = np.mean(observation[:, 5] < 0)
    num_steps = envs.max_episode_steps * num_episodes
    num_early, policy_seconds = 0, 0.0
    start = time.perf_counter()
    for _ in range(num_steps):
        before = time.perf_counter()
        actions = policy(observation)
        policy_seconds += time.perf_counter() - before
        observation, _, terminated, _, _ = envs.step(actions)
        num_early += int(terminated.sum())
    seconds = time.perf_counter() - start
    period = round(envs.step_time * envs.scene.simulation_rate)  # frames per step
    num_frames = num_envs * (num_steps * period + num_episodes)  # with the first frames, which reset() computes
    print(
        json.dumps(
            {
                "frames_per_second": num_frames / seconds,
                "policy_fraction": policy_seconds / seconds,
                "num_early_ends": num_early,
                "start_contact_fraction": float(in_contact),
            }
        )
    )


if __name__ == "__main__":
    main()

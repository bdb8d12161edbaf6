"""Trains PPO on a benchmark task and evaluates it. Needs stable-baselines3, which the package does not install.

python3 examples/train_ppo.py [TASK] [NUM_STEPS] [FILE]    EdgeAlign, 2000000, ppo.zip
"""

import sys

import gymnasium
import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecMonitor

import taxelsim
from taxelsim.envs import TASKS, Reward
from taxelsim.envs.sb3 import StableBaselinesVecEnv
from taxelsim.policies import Policy

NUM_EPISODES = 200  # of the evaluation


def main() -> None:
    task, steps, file = (*sys.argv[1:], *("EdgeAlign", "2000000", "ppo.zip")[len(sys.argv) - 1 :])
    torch.set_num_threads(1)  # faster than more for networks of this size, next to the simulator
    # start_contact: the force to hold is that of the start.
    settings = {"observations": ("features", "start_contact", "proprioception"), "normalized": True, "history": 4}
    # The wide terms of the reward lead to the tolerance, the narrow one into it.
    envs = gymnasium.make_vec(f"taxelsim/{task}-v0", num_envs=256, condition="randomized", reward=Reward(widths=(1, 4, 16)), **settings)
    model = PPO(
        "MultiInputPolicy",
        VecMonitor(StableBaselinesVecEnv(envs)),
        n_steps=16,
        batch_size=512,
        n_epochs=5,
        learning_rate=lambda left: 1e-3 * left,
        gamma=0.95,
        gae_lambda=0.9,
        policy_kwargs={"net_arch": [64, 64], "log_std_init": -2},
        device="cpu",
        seed=1,
        verbose=1,
    )
    model.learn(int(steps))
    model.save(file)
    print(f"{file}: written")

    def act(observation: dict[str, np.ndarray]) -> np.ndarray:
        return model.predict(observation, deterministic=True)[0]

    scene = taxelsim.load_scene(taxelsim.SCENES / TASKS[task].scene, num_episodes=NUM_EPISODES, condition="unseen")
    # Unchecked: the last bits of a row may depend on the batch.
    policy = Policy(act, name="ppo", actions=TASKS[task].actions, check_batch=False, **settings)
    for evaluation in taxelsim.evaluate(scene, [scene.controllers[0]], policy=policy):
        print(f"{evaluation.controller:8s} success in {evaluation.total.success_rate:6.1%} of {NUM_EPISODES} episodes, unseen sensor")


if __name__ == "__main__":
    main()

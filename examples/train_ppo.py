"""Trains PPO on a benchmark task and evaluates it with a sensor that it has not seen.

The policy sees features of the last four frames, the contact at the start, whose force it holds, and the sensor's own motion. The reward
has wide terms that lead to the tolerance, and a narrow one that leads into it. Prints the success rates of the policy and of a servo.

python3 examples/train_ppo.py [TASK] [NUM_STEPS] [FILE]    needs stable-baselines3

Defaults: EdgeAlign, 2000000, train_ppo.zip. The picture is FILE with the suffix .png.
"""

import sys
from pathlib import Path

import gymnasium
import matplotlib.pyplot as plt
import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecMonitor

import taxelsim
from taxelsim.envs import TASKS, Reward
from taxelsim.envs.sb3 import StableBaselinesVecEnv
from taxelsim.pictures import colour_map, save_figure
from taxelsim.policies import Policy


def main() -> None:
    task, steps, file = (*sys.argv[1:], *("EdgeAlign", "2000000", "train_ppo.zip")[len(sys.argv) - 1 :])
    torch.set_num_threads(1)  # faster than more for networks of this size, next to the simulator
    settings = {"observations": ("features", "start_contact", "proprioception"), "normalized": True, "history": 4}
    envs = gymnasium.make_vec(f"taxelsim/{task}-v0", num_envs=256, condition="randomized", reward=Reward(widths=(1, 4, 16)), **settings)
    network = {"net_arch": [64, 64], "log_std_init": -2}
    rates = {"n_steps": 16, "batch_size": 512, "n_epochs": 5, "learning_rate": lambda left: 1e-3 * left, "gamma": 0.95, "gae_lambda": 0.9}
    model = PPO("MultiInputPolicy", VecMonitor(StableBaselinesVecEnv(envs)), policy_kwargs=network, device="cpu", seed=1, **rates)
    rewards = []  # (steps, mean reward of the last episodes)

    def record(*_: object) -> bool:
        if model.ep_info_buffer:
            rewards.append((model.num_timesteps, np.mean([episode["r"] for episode in model.ep_info_buffer])))
        return True

    model.learn(int(steps), callback=record)
    model.save(file)

    scene = taxelsim.load_scene(taxelsim.SCENES / TASKS[task].scene, num_episodes=200, condition="unseen")
    settings |= {"actions": TASKS[task].actions, "check_batch": False}  # the last bits of a row may depend on the batch
    policy = Policy(lambda seen: model.predict(seen, deterministic=True)[0], name="ppo", **settings)
    for evaluation in taxelsim.evaluate(scene, [scene.controllers[0]], policy=policy):
        print(f"{evaluation.controller:8s} success in {evaluation.total.success_rate:6.1%} of {scene.num_episodes} episodes, unseen sensor")

    plt.rcParams.update({"font.size": 15, "lines.linewidth": 3})
    figure, axes = plt.subplots(figsize=(12, 5), layout="constrained")
    axes.plot(*zip(*rewards, strict=True), color=colour_map()(0.4))
    axes.set(xlabel="steps of all environments", ylabel="reward of an episode", title=task)
    save_figure(Path(file).with_suffix(".png"), figure)


if __name__ == "__main__":
    main()

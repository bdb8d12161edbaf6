"""Trains PPO on a benchmark task. Needs stable-baselines3, which the package does not install.

python3 examples/train_ppo.py [TASK] [NUM_STEPS] [FILE]    EdgeFollow, 2000000, ppo.zip
"""

import sys

import gymnasium
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecMonitor

from taxelsim.envs.sb3 import StableBaselinesVecEnv


def main() -> None:
    task, steps, file = (*sys.argv[1:], *("EdgeFollow", "2000000", "ppo.zip")[len(sys.argv) - 1 :])
    envs = gymnasium.make_vec(f"taxelsim/{task}-v0", num_envs=256, condition="randomized", normalized=True, history=4)
    model = PPO(
        "MlpPolicy",
        VecMonitor(StableBaselinesVecEnv(envs)),
        n_steps=64,
        batch_size=2048,
        n_epochs=5,
        learning_rate=5e-4,
        gamma=0.98,
        policy_kwargs={"net_arch": [64, 64]},
        device="cpu",
        verbose=1,
    )
    model.learn(int(steps))
    model.save(file)
    print(f"{file}: written")


if __name__ == "__main__":
    main()

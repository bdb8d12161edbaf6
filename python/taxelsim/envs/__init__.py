"""Gymnasium environments over batches of tactile sensors. Importing this module registers the benchmark tasks.

>>> import gymnasium, taxelsim.envs
>>> envs = gymnasium.make_vec("taxelsim/EdgeFollow-v0", num_envs=4096)
>>> envs = taxelsim.make_vec("scenes/tasks/follow_edge.yaml", num_envs=4096)
"""

from ..policies.actions import ACTIONS
from ..policies.observations import FEATURES, OBSERVATIONS, SCALES
from ..tasks import DYNAMIC_TASKS, TASKS, TaskSpec, register_envs
from .dynamics import make_vec as make_dynamic_vec
from .env import EpisodicEnv, TactileEnv
from .episodic import EpisodicVectorEnv
from .rewards import Reward
from .tasks import CONDITIONS
from .touch_classify import TouchClassifyVectorEnv
from .vector_env import TactileVectorEnv

__all__ = [
    "ACTIONS",
    "CONDITIONS",
    "DYNAMIC_TASKS",
    "FEATURES",
    "OBSERVATIONS",
    "SCALES",
    "TASKS",
    "EpisodicEnv",
    "EpisodicVectorEnv",
    "Reward",
    "TactileEnv",
    "TactileVectorEnv",
    "TaskSpec",
    "TouchClassifyVectorEnv",
    "make_dynamic_vec",
]

register_envs()

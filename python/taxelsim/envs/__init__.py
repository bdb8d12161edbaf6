"""Gymnasium environments over batches of tactile sensors. Importing this module registers the benchmark tasks.

>>> import gymnasium, taxelsim.envs
>>> envs = gymnasium.make_vec("taxelsim/EdgeFollow-v0", num_envs=4096)
>>> envs = taxelsim.make_vec("scenes/tasks/follow_edge.yaml", num_envs=4096)
"""

from ..policies.actions import ACTIONS
from ..policies.observations import FEATURES, OBSERVATIONS, SCALES
from .dynamics import DYNAMIC_TASKS, make_dynamic_vec, register_dynamics
from .env import TactileEnv
from .episodic import EpisodicVectorEnv
from .rewards import Reward
from .tasks import CONDITIONS, TASKS, TaskSpec, register_tasks
from .touch_classify import TouchClassifyVectorEnv, register_touch_classify
from .vector_env import TactileVectorEnv

__all__ = [
    "ACTIONS",
    "CONDITIONS",
    "DYNAMIC_TASKS",
    "FEATURES",
    "OBSERVATIONS",
    "SCALES",
    "TASKS",
    "EpisodicVectorEnv",
    "Reward",
    "TactileEnv",
    "TactileVectorEnv",
    "TaskSpec",
    "TouchClassifyVectorEnv",
    "make_dynamic_vec",
]

register_tasks()
register_touch_classify()
register_dynamics()

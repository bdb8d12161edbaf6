"""Ray: data sets from one machine or a cluster, in tasks that may be lost. Needs Ray: pip install 'taxelsim[ray]'; s3fs for `s3://`.

>>> import taxelsim, taxelsim.ray
>>> taxelsim.ray.generate(taxelsim.SCENES / "edge_servo.yaml", "out")  # a local cluster of its own, on loopback, without a dashboard
>>> taxelsim.ray.generate("/nfs/scene.yaml", "s3://bucket/set", address="auto", kind="h100")  # joins a cluster

docs/how_to/clusters.md has the guarantees, and the ports that Ray listens on.
"""

try:
    import fsspec  # noqa: F401
    import ray  # noqa: F401
except ImportError as error:
    raise ImportError("taxelsim.ray needs Ray and fsspec: pip install 'taxelsim[ray]'") from error

from .cluster import Workers
from .data_set import Summary, generate
from .evaluation import evaluate, evaluate_grasp

__all__ = ["Summary", "Workers", "evaluate", "evaluate_grasp", "generate"]

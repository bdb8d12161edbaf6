"""MuJoCo: tactile arrays at the sites and on the geoms of a model, touched by its geoms: pip install 'taxelsim[mujoco]'.

Needs MuJoCo 3.3 or newer; couple() and batches need MuJoCo 4.

>>> import mujoco, taxelsim.mujoco
>>> model = mujoco.MjModel.from_xml_path("hand.xml")
>>> batch = mujoco.batch.Batch(model, nsim=1024)
>>> tactile = taxelsim.mujoco.attach(model, {"palm": taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml"}, ["cube"], num_instances=1024)
>>> batch.step(nstep=10)
>>> frames = tactile.observe(batch, dt=0.01)
>>> frames["palm"].tactile_image  # (1024, 6, 14), counts
"""

try:
    import mujoco

    if tuple(map(int, mujoco.__version__.split(".")[:2])) < (3, 3):
        raise ImportError(f"MuJoCo {mujoco.__version__} found")
except ImportError as error:
    raise ImportError("taxelsim.mujoco needs MuJoCo 3.3 or newer: pip install 'taxelsim[mujoco]'") from error

from .attachment import Attachment, Sources, attach
from .coupling import Coupling, couple
from .geoms import shape_of
from .mounts import GeomSensor, cover_geom, grid_on_geom
from .points import points_of

__all__ = ["Attachment", "Coupling", "GeomSensor", "Sources", "attach", "couple", "cover_geom", "grid_on_geom", "points_of", "shape_of"]

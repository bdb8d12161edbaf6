"""Newton: tactile arrays on the bodies of all worlds of a model, touched by its shapes. Needs Newton 1.8: pip install 'taxelsim[newton]'.

>>> import newton, taxelsim.newton
>>> worlds = newton.ModelBuilder()
>>> worlds.replicate(hand, 256)
>>> model = worlds.finalize()
>>> tactile = taxelsim.newton.attach(model, {"tip": taxelsim.SCENES / "sensors/wts0614_soft_cover.yaml"}, ["cube"])
>>> solver.step(state_0, state_1, control, contacts, 0.002)
>>> frames = tactile.observe(state_1, dt=0.002)
>>> frames["tip"].tactile_image  # (256, 6, 14), counts
"""

try:
    import newton  # noqa: F401
except ImportError as error:
    raise ImportError("taxelsim.newton needs Newton 1.8 or newer: pip install 'taxelsim[newton]'") from error

from .attachment import Attachment, attach
from .shapes import shape_of

__all__ = ["Attachment", "attach", "shape_of"]

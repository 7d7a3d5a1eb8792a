"""Where the feet are: offsets while the body moves on, and footholds chosen for the support polygon."""

from gaitforge.footfall.placement.offsets import offset_at, stance_offsets, step_rate

__all__ = ["offset_at", "stance_offsets", "step_rate"]

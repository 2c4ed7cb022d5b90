"""Other programs on the scenes of Pliant, each at its own best settings: markers beside the chart's rows."""

from .measure import measure
from .peer_rows import PeerRow

__all__ = ["PeerRow", "measure"]

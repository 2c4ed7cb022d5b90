"""Linear descriptions: time-invariant, time-varying, piecewise, second order; modes, Magnus transition matrices."""

from .lti import LinearModel
from .ltv import LTVModel
from .modal_analysis import Mode
from .piecewise_ltv import PiecewiseLTV
from .second_order import SecondOrderModel

__all__ = ["LTVModel", "LinearModel", "Mode", "PiecewiseLTV", "SecondOrderModel"]

"""Models of flexible machines and their linear descriptions."""

if __name__ != "pliant.plants":
    raise ImportError("this folder is installed as pliant.plants: write `import pliant.plants`")

from . import beams
from .beams import Beam, Material, Payload
from .errors import (
    EquilibriumError,
    InfeasibleError,
    IntegrationError,
    MassMatrixError,
    PliantError,
    StabilityLimitError,
    UncontrollableError,
)
from .integrate import step_limit
from .lagrange import LagrangianPlant
from .large_beam import LargeDeflectionBeam
from .linear import LinearModel
from .ltv import LTVModel
from .plant import Plant
from .signals import Signal
from .single_link import SingleLinkArm
from .slider_crank import SliderCrank
from .spacecraft import (
    Appendage,
    Environment,
    FlexibleSpacecraft,
    Hinge,
    Hub,
    ModalData,
    Orbit,
    Sun,
    Surface,
    Thruster,
    Wheel,
)
from .trajectory import Trajectory
from .transfer import TransferMatrices
from .two_link import TwoLinkArm
from .two_link_terms import Terms, paper_terms

__all__ = [
    "Appendage",
    "Beam",
    "Environment",
    "EquilibriumError",
    "FlexibleSpacecraft",
    "Hinge",
    "Hub",
    "InfeasibleError",
    "IntegrationError",
    "LTVModel",
    "LagrangianPlant",
    "LargeDeflectionBeam",
    "LinearModel",
    "MassMatrixError",
    "Material",
    "ModalData",
    "Orbit",
    "Payload",
    "Plant",
    "PliantError",
    "Signal",
    "SingleLinkArm",
    "SliderCrank",
    "StabilityLimitError",
    "Sun",
    "Surface",
    "Terms",
    "Thruster",
    "Trajectory",
    "TransferMatrices",
    "TwoLinkArm",
    "UncontrollableError",
    "Wheel",
    "beams",
    "paper_terms",
    "step_limit",
]

"""Models of flexible machines and their linear descriptions."""

if __name__ != "pliant.plants":
    raise ImportError("this folder is installed as pliant.plants: write `import pliant.plants`")

from typing import TYPE_CHECKING

from pliant.plants.core import imports

if TYPE_CHECKING:  # imported when they are first asked for: see below
    from pliant.plants import beams
    from pliant.plants.arms.single_link import SingleLinkArm
    from pliant.plants.arms.two_link import TwoLinkArm
    from pliant.plants.arms.two_link_paper_terms import Terms, paper_terms
    from pliant.plants.beams.payload import Payload
    from pliant.plants.beams.section import Beam, Material
    from pliant.plants.contract.check import check
    from pliant.plants.core.errors import (
        EquilibriumError,
        InfeasibleError,
        IntegrationError,
        MassMatrixError,
        NominalWarning,
        PliantError,
        StabilityLimitError,
        UncontrollableError,
        UnstableRestWarning,
        ValidityWarning,
    )
    from pliant.plants.core.signals import Signal
    from pliant.plants.core.trajectory import Trajectory
    from pliant.plants.dynamics.lagrangian import LagrangianPlant
    from pliant.plants.dynamics.plant import Plant
    from pliant.plants.experiments.csv_columns import read_experiment, write_experiment
    from pliant.plants.experiments.experiment import Experiment
    from pliant.plants.identification.experiment_design import rank_motions
    from pliant.plants.identification.maximum_likelihood import identify
    from pliant.plants.integration.step_maps import step_limit
    from pliant.plants.large_deflection.large_beam import LargeDeflectionBeam
    from pliant.plants.large_deflection.transfer_matrices import TransferMatrices
    from pliant.plants.linear.lti import LinearModel
    from pliant.plants.linear.ltv import LTVModel
    from pliant.plants.modal_data.modal_data import ModalData
    from pliant.plants.modal_data.modal_fields import ModalNode
    from pliant.plants.multibody.tree import FlexibleTree
    from pliant.plants.multibody_parts.joint import ElasticJoint, Frame, FrameThruster, Joint, Sliding
    from pliant.plants.multibody_parts.tree_body import TreeBody
    from pliant.plants.slider_crank.plant import SliderCrank
    from pliant.plants.spacecraft.plant import FlexibleSpacecraft
    from pliant.plants.spacecraft_parts.appendage import Appendage, Hinge
    from pliant.plants.spacecraft_parts.environment import Environment, Orbit, Sun, Surface
    from pliant.plants.spacecraft_parts.hub import Hub, Thruster, Wheel
    from pliant.plants.tables.plant_types import register

__all__ = [
    "Appendage",
    "Beam",
    "ElasticJoint",
    "Environment",
    "EquilibriumError",
    "Experiment",
    "FlexibleSpacecraft",
    "FlexibleTree",
    "Frame",
    "FrameThruster",
    "Hinge",
    "Hub",
    "InfeasibleError",
    "IntegrationError",
    "Joint",
    "LTVModel",
    "LagrangianPlant",
    "LargeDeflectionBeam",
    "LinearModel",
    "MassMatrixError",
    "Material",
    "ModalData",
    "ModalNode",
    "NominalWarning",
    "Orbit",
    "Payload",
    "Plant",
    "PliantError",
    "Signal",
    "SingleLinkArm",
    "SliderCrank",
    "Sliding",
    "StabilityLimitError",
    "Sun",
    "Surface",
    "Terms",
    "Thruster",
    "Trajectory",
    "TransferMatrices",
    "TreeBody",
    "TwoLinkArm",
    "UncontrollableError",
    "UnstableRestWarning",
    "ValidityWarning",
    "Wheel",
    "beams",
    "check",
    "identify",
    "paper_terms",
    "rank_motions",
    "read_experiment",
    "register",
    "step_limit",
    "write_experiment",
]

imports.offer(
    __name__,
    {
        "": "arms attitudes beams dynamics exponents finite_horizon identification large_deflection linear modal_data "
        "motions multibody periodic slider_crank spacecraft stability",
        "arms.single_link": "SingleLinkArm",
        "arms.two_link": "TwoLinkArm",
        "arms.two_link_paper_terms": "Terms paper_terms",
        "beams.payload": "Payload",
        "beams.section": "Beam Material",
        "contract.check": "check",
        "core.errors": "EquilibriumError InfeasibleError IntegrationError MassMatrixError NominalWarning PliantError "
        "StabilityLimitError UncontrollableError UnstableRestWarning ValidityWarning",
        "core.signals": "Signal",
        "core.trajectory": "Trajectory",
        "dynamics.lagrangian": "LagrangianPlant",
        "dynamics.plant": "Plant",
        "experiments.csv_columns": "read_experiment write_experiment",
        "experiments.experiment": "Experiment",
        "identification.experiment_design": "rank_motions",
        "identification.maximum_likelihood": "identify",
        "integration.step_maps": "step_limit",
        "large_deflection.large_beam": "LargeDeflectionBeam",
        "large_deflection.transfer_matrices": "TransferMatrices",
        "linear.lti": "LinearModel",
        "linear.ltv": "LTVModel",
        "modal_data.modal_data": "ModalData",
        "modal_data.modal_fields": "ModalNode",
        "multibody.tree": "FlexibleTree",
        "multibody_parts.joint": "ElasticJoint Frame FrameThruster Joint Sliding",
        "multibody_parts.tree_body": "TreeBody",
        "slider_crank.plant": "SliderCrank",
        "spacecraft.plant": "FlexibleSpacecraft",
        "spacecraft_parts.appendage": "Appendage Hinge",
        "spacecraft_parts.environment": "Environment Orbit Sun Surface",
        "spacecraft_parts.hub": "Hub Thruster Wheel",
        "tables.plant_types": "register",
    },
)
imports.serve(
    __name__,
    {
        "core": "errors parameters signals functions=casadi_functions trajectory rotations=quaternions "
        "explicit=runge_kutta_tableaux",
        "linear": "ltv modal=modal_analysis second_order magnus piecewise=piecewise_ltv",
        "beams": "basis=shape_functions modes=euler_bernoulli_modes ritz=legendre_ritz rotating=rotating_beam "
        "offset_payload=offset_payload_roots payload_modes=offset_payload_modes "
        "planar=elastic_link frame_elements=pinned_rod",
        "native": "cache=kernel_cache compiler codegen=scalar_codegen sums=expression_graph packing=slp_packing "
        "wide=slp_codegen kernels=kernel_templates threads=thread_pool batch=batch_kernels",
        "integration": "integrate=step_maps adaptive=dormand_prince cvodes stepping=batch_stepper simulate=simulation "
        "sensitivities=step_sensitivities motion=minimum_jerk",
        "dynamics": "plant lagrange=lagrangian implicit=residual_jacobians equilibrium handover=python_control",
        "arms": "single_link frames=link_frames two_link two_link_terms=two_link_paper_terms",
        "large_deflection": "large_beam strain=tangent_field spatial_strain=spatial_tangent_field "
        "substructure=sub_beam_chain spatial_chain=spatial_sub_beam_chain sections=cross_sections "
        "transfer=transfer_matrices",
        "transitions": "path=state_matrix_path",
        "stability": "assessment verdict floquet period=periodicity frozen=frozen_time "
        "growth=transition_growth certificate=lyapunov_certificate",
        "slider_crank": "slider_crank_rigid=rigid_kinematics cycles=steady_cycles",
        "modal_data": "structural=component_modes",
        "attitudes": "spacecraft_feedback=feedback",
        "spacecraft": "spacecraft_equations=equations spacecraft_linear=linearisation",
        "spacecraft_parts": "hub appendage environment_loads=environment",
        "spacecraft_perturbation": "perturbation perturbation_fields=position_fields perturbation_printed="
        "printed_equations",
    },
)

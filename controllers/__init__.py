"""Controllers: everything with act(t, y) -> u."""

if __name__ != "pliant.controllers":
    raise ImportError("this folder is installed as pliant.controllers: write `import pliant.controllers`")

from typing import TYPE_CHECKING

from pliant.plants.core import imports

if TYPE_CHECKING:  # imported when they are first asked for: see below
    from pliant.controllers import learning as rl
    from pliant.controllers import riccati
    from pliant.controllers.analysis.loops import loop
    from pliant.controllers.analysis.margins import Margins, margins
    from pliant.controllers.analysis.margins_along import MarginsAlong, margins_along
    from pliant.controllers.analysis.spillover import Spillover, spillover
    from pliant.controllers.base.controller import Controller, Feedback
    from pliant.controllers.base.objective import Objective
    from pliant.controllers.cycles.periodic_kalman import PeriodicKalman
    from pliant.controllers.cycles.periodic_lqg import PeriodicLQG
    from pliant.controllers.cycles.periodic_lqr import PeriodicLQR
    from pliant.controllers.cycles.periodic_mpc import PeriodicMPC
    from pliant.controllers.cycles.periodic_nmpc import periodic_nmpc
    from pliant.controllers.cycles.periodic_tvlqr import PeriodicTVLQR
    from pliant.controllers.estimation import sensors
    from pliant.controllers.estimation.kalman import Kalman
    from pliant.controllers.estimation.sensors import Sensor, sensors_of
    from pliant.controllers.export.arrays import arrays_of, export_arrays
    from pliant.controllers.export.export_c import export_c
    from pliant.controllers.filters import Filter, Filtered, lag, notch, roll_off
    from pliant.controllers.joint_control.computed_torque import ComputedTorque
    from pliant.controllers.joint_control.input_shaping import Shaper, shape, shaper_for
    from pliant.controllers.joint_control.pd import PD
    from pliant.controllers.learning.policy import Policy
    from pliant.controllers.linear_quadratic.delay import Predictive, delayed
    from pliant.controllers.linear_quadratic.lqg import LQG
    from pliant.controllers.linear_quadratic.lqr import LQR
    from pliant.controllers.linear_quadratic.tvlqr import TVLQR
    from pliant.controllers.mpc.mpc import MPC
    from pliant.controllers.mpc_gradients.law_derivative import DifferentiableMPC, LawDerivative
    from pliant.controllers.mpc_gradients.tuning import TunedMPC, tune_mpc
    from pliant.controllers.nmpc.nmpc import NMPC
    from pliant.controllers.optimal_control.optimal import Motion, optimal
    from pliant.controllers.optimal_control.plan import plan
    from pliant.controllers.robust_analysis.miss_over_box import MissOverBox, miss_over_box
    from pliant.controllers.robust_analysis.robust_gain import RobustGain, UncertainLTV, robust_gain
    from pliant.controllers.robust_analysis.robust_stability import RobustStability, over_box, robust_stability, stands
    from pliant.controllers.robust_analysis.worst_parameters import WorstParameters, worst_parameters
    from pliant.controllers.robust_design.led import Led
    from pliant.controllers.robust_design.many_model_lqr import MultiModelLQR
    from pliant.controllers.robust_design.robust_lqg import RobustLQG, robust_lqg
    from pliant.controllers.tube_mpc import DisturbanceSet, TubeMPC

__all__ = [
    "LQG",
    "LQR",
    "MPC",
    "NMPC",
    "PD",
    "TVLQR",
    "ComputedTorque",
    "Controller",
    "DifferentiableMPC",
    "DisturbanceSet",
    "Feedback",
    "Filter",
    "Filtered",
    "Kalman",
    "LawDerivative",
    "Led",
    "Margins",
    "MarginsAlong",
    "MissOverBox",
    "Motion",
    "MultiModelLQR",
    "Objective",
    "PeriodicKalman",
    "PeriodicLQG",
    "PeriodicLQR",
    "PeriodicMPC",
    "PeriodicTVLQR",
    "Policy",
    "Predictive",
    "RobustGain",
    "RobustLQG",
    "RobustStability",
    "Sensor",
    "Shaper",
    "Spillover",
    "TubeMPC",
    "TunedMPC",
    "UncertainLTV",
    "WorstParameters",
    "arrays_of",
    "delayed",
    "export_arrays",
    "export_c",
    "lag",
    "loop",
    "margins",
    "margins_along",
    "miss_over_box",
    "notch",
    "optimal",
    "over_box",
    "periodic_nmpc",
    "plan",
    "riccati",
    "rl",
    "robust_gain",
    "robust_lqg",
    "robust_stability",
    "roll_off",
    "sensors",
    "sensors_of",
    "shape",
    "shaper_for",
    "spillover",
    "stands",
    "tune_mpc",
    "worst_parameters",
]

imports.offer(
    __name__,
    {
        "": "rl=learning riccati sensors=estimation.sensors",
        "analysis.loops": "loop",
        "analysis.margins": "Margins margins",
        "analysis.margins_along": "MarginsAlong margins_along",
        "analysis.spillover": "Spillover spillover",
        "base.controller": "Controller Feedback",
        "base.objective": "Objective",
        "estimation.kalman": "Kalman",
        "estimation.sensors": "Sensor sensors_of",
        "export": "arrays_of export_arrays export_c",
        "filters": "Filter Filtered lag notch roll_off",
        "joint_control.computed_torque": "ComputedTorque",
        "joint_control.input_shaping": "Shaper shape shaper_for",
        "joint_control.pd": "PD",
        "learning.policy": "Policy",
        "linear_quadratic.delay": "Predictive delayed",
        "linear_quadratic.lqg": "LQG",
        "linear_quadratic.lqr": "LQR",
        "cycles.periodic_kalman": "PeriodicKalman",
        "cycles.periodic_lqg": "PeriodicLQG",
        "cycles.periodic_lqr": "PeriodicLQR",
        "cycles.periodic_mpc": "PeriodicMPC",
        "cycles.periodic_nmpc": "periodic_nmpc",
        "cycles.periodic_tvlqr": "PeriodicTVLQR",
        "linear_quadratic.tvlqr": "TVLQR",
        "mpc.mpc": "MPC",
        "mpc_gradients.law_derivative": "DifferentiableMPC LawDerivative",
        "mpc_gradients.tuning": "TunedMPC tune_mpc",
        "nmpc.nmpc": "NMPC",
        "optimal_control.optimal": "Motion optimal",
        "optimal_control.plan": "plan",
        "robust_analysis.miss_over_box": "MissOverBox miss_over_box",
        "robust_analysis.robust_gain": "RobustGain UncertainLTV robust_gain",
        "robust_analysis.robust_stability": "RobustStability over_box robust_stability stands",
        "robust_analysis.worst_parameters": "WorstParameters worst_parameters",
        "robust_design.led": "Led",
        "robust_design.many_model_lqr": "MultiModelLQR",
        "robust_design.robust_lqg": "RobustLQG robust_lqg",
        "tube_mpc": "DisturbanceSet TubeMPC",
    },
)
imports.serve(
    __name__,
    {
        "": "rl=learning",
        "base": "controller playable=scene_protocol weights=quadratic_weights goal_model objective "
        "record=solver_record reference=joint_reference",
        "riccati": "riccati_checks=checks time_varying_riccati=time_varying intervals=ltv_discretisation",
        "estimation": "sensors process_noise filtering=kalman_gains observer=kalman",
        "solvers": "qp=least_distance_qp soft_program=soft_qp sparse_blocks=block_sparsity interior_point "
        "hinf=hinf_norm",
        "optimal_control": "optimal plan transcription=multiple_shooting shooting=shooting_derivatives "
        "stage_terms=stage_derivatives nominals=nominal_motions",
        "linear_quadratic": "lqr lqg tvlqr funnel period_cost delay",
        "analysis": "loops margins spillover",
        "joint_control": "pd computed_torque collocated=collocation shaping=input_shaping",
        "learning": "run=training_callback lanes=training_env policy actor=sb3_export checkpoint torch_threads",
        "mpc": "mpc_design=design mpc_along=ltv_design condensed=condensed_prediction "
        "predicted_limits=constraints penalty=exact_penalty last_plan=fallback_plan "
        "disturbance=offset_free",
        "nmpc": "horizon horizon_program=horizon_qp condensing gauss_newton terminal=terminal_cost",
    },
)

"""Valid calls of controllers, scenes and studies, and what of these packages is not called, with the reason."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from collections.abc import Iterator
from fnmatch import fnmatch
from types import ModuleType
from typing import Any

from argument_kinds import Call
from calls_of_designs import design_calls
from calls_of_kit import kit_calls
from calls_of_optima import optima_calls
from calls_of_scene_laws import scene_law_calls
from calls_of_scenes import scene_calls
from calls_of_studies import study_calls

import pliant.controllers
import pliant.envs.scenes
import pliant.studies


def law_calls() -> list[Call]:
    """Of everything."""
    return [*design_calls(), *kit_calls(), *scene_law_calls(), *optima_calls(), *scene_calls(), *study_calls()]


INNER = "a part of a design: its arguments are arrays and models that the call which makes it has checked"
RESULT = "a result: made by what it is the result of"
DRAWN = "drawing and words: takes what studies return"
NOTHING = "takes nothing"
PROTOCOL = "a protocol or a warning"
COMMAND = "the command line: tests/campaigns/bad_commands.py"
REASONS = {  # patterns of module and name
    "controllers.analysis.late_loops*": INNER,
    "controllers.analysis.linear_laws.law_of": INNER,
    "controllers.analysis.linear_laws.readings_under_way": INNER,
    "controllers.analysis.linear_laws.closed_matrix": INNER,
    "controllers.analysis.loops.felt_by": INNER,
    "controllers.analysis.loops.plant_of": INNER,
    "controllers.analysis.loops.Loop": RESULT,
    "controllers.analysis.loops.Loop.closed": NOTHING,
    "controllers.analysis.margins.Channel*": RESULT,
    "controllers.analysis.margins.Margins*": RESULT,
    "controllers.analysis.margins.scaled_peak": INNER,
    "controllers.analysis.spillover.Case*": RESULT,
    "controllers.analysis.spillover.Spillover*": RESULT,
    "controllers.analysis.spillover.model_of": INNER,
    "controllers.analysis.spillover.origin": INNER,
    "controllers.base.controller.Controller*": PROTOCOL,
    "controllers.base.controller.*": "a gate itself",
    "controllers.base.goal_model*": INNER,
    "controllers.base.joint_reference.Impulses*": PROTOCOL,
    "controllers.base.joint_reference.Joints*": RESULT,
    "controllers.base.joint_reference.*": INNER,
    "controllers.base.objective.Objective.rate": "takes what Plant.measure takes, by the plant's own gate",
    "controllers.base.objective.Objective.quadratic": NOTHING,
    "controllers.base.quadratic_weights*": INNER,
    "controllers.base.scene_protocol*": PROTOCOL,
    "controllers.base.solver_record*": RESULT,
    "controllers.estimation.kalman.Kalman": "made by design, along and for_scene",
    "controllers.estimation.kalman_gains*": INNER,
    "controllers.estimation.parameter_noise.*": INNER,
    "controllers.estimation.sensors.encoder": "as Sensor",
    "controllers.estimation.sensors.accelerometer": "as Sensor",
    "controllers.estimation.square_root*": INNER,
    "controllers.analysis.users_laws*": INNER,
    "controllers.analysis.margins_along.MarginsAlong*": RESULT,
    "controllers.analytic_gradients*": "by rl.train",
    "controllers.uncertain_blocks.blocks*": INNER,
    "controllers.uncertain_blocks.scalings*": INNER,
    "controllers.uncertain_blocks.power_iteration*": INNER,
    "controllers.uncertain_blocks.fractional_form*": INNER,
    "controllers.uncertain_blocks.over_frequencies*": INNER,
    "controllers.robust_analysis.nearest_instability*": INNER,
    "controllers.robust_analysis.parts_of_box*": INNER,
    "controllers.robust_analysis.modal_norms*": INNER,
    "controllers.robust_analysis.scaled_part*": INNER,
    "controllers.robust_analysis.robust_stability.RobustStability*": RESULT,
    "controllers.robust_analysis.robust_stability.require_box": "a gate itself",
    "controllers.robust_analysis.robust_gain.RobustGain*": RESULT,
    "controllers.robust_analysis.robust_gain.end_gain": INNER,
    "controllers.robust_analysis.robust_gain.UncertainLTV.closed": INNER,
    "controllers.robust_analysis.loop_over_box*": INNER,
    "controllers.robust_analysis.miss_over_box.MissOverBox*": RESULT,
    "controllers.robust_analysis.worst_parameters.MotionsInBox*": INNER,
    "controllers.robust_analysis.worst_parameters.motions_in_box": "a gate itself",
    "controllers.robust_analysis.worst_parameters.WorstParameters*": RESULT,
    "controllers.export.arrays.*": "see the calls that are there",
    "controllers.export.c_text*": INNER,
    "controllers.export.estimators*": INNER,
    "controllers.export.export_c.law_code": INNER,
    "controllers.export.plant_step*": INNER,
    "controllers.export.joint_laws*": INNER,
    "controllers.export.offset_free*": INNER,
    "controllers.export.policies*": INNER,
    "controllers.export.predictive*": INNER,
    "controllers.export.state_feedback*": INNER,
    "controllers.joint_control.collocation*": INNER,
    "controllers.joint_control.computed_torque.ComputedTorque": "made by design and for_scene",
    "controllers.joint_control.computed_torque.inverse_dynamics": INNER,
    "controllers.joint_control.input_shaping.light": INNER,
    "controllers.joint_control.pd.PD": "made by design and for_scene",
    "controllers.joint_control.pd.fastest_decay": INNER,
    "controllers.learning.checkpoint*": INNER,
    "controllers.learning.evaluation.Evaluation": RESULT,
    "controllers.learning.evaluation.Training": RESULT,
    "controllers.learning.policy.shipped": NOTHING,
    "controllers.learning.policy_files*": INNER,
    "controllers.linear_quadratic.held_goal*": INNER,
    "controllers.learning.policy.Policy.from_sb3_zip": "reads a pickle: tests/controllers/learning/test_sb3_export.py",
    "controllers.learning.sb3_export*": INNER,
    "controllers.learning.torch_threads*": NOTHING,
    "controllers.learning.training*": INNER,
    "controllers.linear_quadratic.funnel.Funnel": RESULT,
    "controllers.linear_quadratic.funnel.Funnel.about": INNER,
    "controllers.linear_quadratic.hold_set*": INNER,
    "controllers.linear_quadratic.lqr.LQR": "made by design, for_plant and for_scene",
    "controllers.linear_quadratic.nominal_loop*": INNER,
    "controllers.linear_quadratic.period_cost*": INNER,
    "controllers.cycles.periodic_lqr.PeriodicLQR": "made by for_scene",
    "controllers.base.inputs_on_their_way*": INNER,
    "controllers.estimation.process_noise.recovering": INNER,
    "controllers.estimation.process_noise.scene_noise": INNER,
    "controllers.linear_quadratic.state_ahead*": INNER,
    "controllers.riccati.late_inputs*": INNER,
    "controllers.mpc_gradients.law_derivative.LawDerivative": RESULT,
    "controllers.mpc_gradients.law_derivative.DifferentiableMPC": "for_scene is called, and hands over to it",
    "controllers.mpc_gradients.law_derivative.DifferentiableMPC.derivative": "the gate of every law, `reading`",
    "controllers.mpc_gradients.law_derivative.DifferentiableMPC.with_weights": "hands over to the class",
    "controllers.mpc_gradients.tuning.TunedMPC*": RESULT,
    "controllers.mpc_gradients.tuning.ClosedLoop*": INNER,
    "controllers.robust_design.led.Led": "made by for_scene",
    "controllers.robust_design.led.Led.act": "the gate of every law, `reading`: LQR.act is called",
    "controllers.robust_design.lqg_over_box.*": INNER,
    "controllers.robust_design.robust_lqg.RobustLQG": RESULT,
    "controllers.robust_design.box_models.*": INNER,
    "controllers.robust_design.many_models.*": INNER,
    "controllers.robust_design.many_model_lqr.MultiModelLQR": "made by for_scene",
    "controllers.robust_design.many_model_lqr.MultiModelLQR.act": "the gate of every law, `reading`: LQR.act is called",
    "controllers.robust_design.many_model_lqr.box_of": INNER,
    "controllers.robust_design.many_model_lqr.delays_of": INNER,
    "studies.robust.robustify.Attempt": RESULT,
    "studies.robust.robustify.Robustified*": RESULT,
    "controllers.cycles.*": INNER,
    "controllers.robust_analysis.guardian_map.*": INNER,
    "controllers.riccati.periodic_drawn.DrawnRegulator": RESULT,
    "controllers.riccati.periodic_filter.PeriodicFilter": RESULT,
    "controllers.linear_quadratic.lqg.PlainFilterWarning": PROTOCOL,
    "controllers.linear_quadratic.tvlqr.TVLQR": "made by along, design and for_scene",
    "controllers.mpc.mpc.MPC": "made by design, along and for_scene",
    "controllers.mpc.mpc.MPC.*": "see the calls that are there",
    "controllers.mpc.*": INNER,
    "controllers.tube_mpc.disturbance_set.*": "see the calls that are there",
    "controllers.tube_mpc.tube_mpc.TubeMPC": "made by design, along and for_scene",
    "controllers.tube_mpc.tube_mpc.TubeMPC.*": "see the calls that are there",
    "controllers.tube_mpc.*": INNER,
    "controllers.nmpc.nmpc.IterationRecord*": RESULT,
    "controllers.nmpc.nmpc.Converged*": RESULT,
    "controllers.nmpc.nmpc.NMPC.prepare": NOTHING,
    "controllers.nmpc.*": INNER,
    "controllers.optimal_control.multiple_shooting*": INNER,
    "controllers.optimal_control.nominal_motions.*": INNER,
    "controllers.optimal_control.optimal.Motion": RESULT,
    "controllers.optimal_control.optimal.driven": INNER,
    "controllers.optimal_control.plan.rigid_motion": INNER,
    "controllers.optimal_control.s*": INNER,
    "controllers.riccati.algebraic.Regulator": RESULT,
    "controllers.riccati.algebraic.Sampled": RESULT,
    "controllers.riccati.algebraic.with_integrals": INNER,
    "controllers.riccati.algebraic.filter_gain": INNER,
    "controllers.riccati.checks*": INNER,
    "controllers.riccati.ltv_discretisation.SampledLTV": RESULT,
    "controllers.riccati.ltv_discretisation.hamiltonian_flow": INNER,
    "controllers.riccati.node_distance*": INNER,
    "controllers.riccati.scaled_equation*": INNER,
    "controllers.riccati.periodic.PeriodicRegulator": RESULT,
    "controllers.riccati.steerable*": INNER,
    "controllers.riccati.time_varying.TimeVaryingRegulator": RESULT,
    "controllers.solvers*": INNER,
    "*.reset": NOTHING,
    "envs.scenes.arms*": NOTHING,
    "envs.scenes.beams*": "by scenes.get",
    "envs.scenes.checks*": "a gate itself",
    "envs.scenes.cost.*": "by Scene.stage_cost and Scene.cost",
    "envs.scenes.mechanisms*": "by scenes.get",
    "envs.scenes.nominal_inputs*": INNER,
    "envs.scenes.registry.names": NOTHING,
    "envs.scenes.registry.is_file": INNER,
    "envs.scenes.registry.is_by_name": INNER,
    "envs.scenes.registry.keywords": INNER,
    "envs.scenes.registry.require_name": "a gate itself",
    "envs.scenes.trees*": "by scenes.get",
    "envs.scenes.scene.once_per_scene": INNER,
    "envs.scenes.scene.Manoeuvre*": "by Scene",
    "envs.scenes.scene.Scene.cost_rate": INNER,
    "envs.scenes.scene.Scene.quadratic": NOTHING,
    "envs.scenes.scene.Scene.goal_motion": NOTHING,
    "envs.scenes.scene.Scene.open_loop": "options of Plant.simulate",
    "envs.scenes.scene.Scene.nominal_motion": "options of Plant.simulate",
    "envs.scenes.scene.Scene.vector_env": "an environment's arguments: calls of environments",
    "envs.scenes.scene.Scene.differentiable": "takes torch or jax: tests/envs/gradients",
    "envs.scenes.scene.Scene.sb3_env": "an environment's arguments: calls of environments",
    "envs.scenes.scene.Scene.puffer_env": "an environment's arguments: calls of environments",
    "envs.scenes.spacecraft*": "by scenes.get",
    "studies.closed_loop.rollout.Conditions": "by rollout",
    "studies.closed_loop.*": "a part of scoreboard and report",
    "studies.monte_carlo.monte_carlo.MonteCarlo*": RESULT,
    "studies.monte_carlo.trial*": INNER,
    "studies.scene_pages.markdown*": DRAWN,
    "studies.scene_pages.returns.under_lqr": INNER,
    "studies.scene_pages.returns.charged": INNER,
    "studies.scene_pages.tables.Table": RESULT,
    "studies.slews.comparison.Slew": RESULT,
    "studies.slews.picture*": DRAWN,
    "studies.two_carts.comparison*": RESULT,
    "studies.two_carts.machine*": INNER,
    "studies.two_carts.published*": INNER,
    "studies.two_carts.merit*": "takes a LinearLaw, by its gates",
    "studies.charts.gallery.index": DRAWN,
    "studies.charts.gallery.counted": DRAWN,
    "studies.charts.kept_rows*": INNER,
    "studies.charts.linear_runs*": INNER,
    "studies.charts.measure.programs": "a gate itself",
    "studies.charts.measure.rounded_up": INNER,
    "studies.charts.page*": DRAWN,
    "studies.charts.plan*": INNER,
    "studies.charts.runner*": INNER,
    "studies.fidelity.stepper_runs*": INNER,
    "studies.commands*": COMMAND,
    "studies.common*": INNER,
    "studies.effectivity.*": RESULT,
    "studies.fidelity.choice.*": RESULT,
    "studies.fidelity.climb.*": INNER,
    "studies.identification.scene_data.*": INNER,
    "studies.identification.residual_plot.residual_plot": "takes what identify gives, by its gate",
    "studies.identification.residual_plot.draw": INNER,
    "studies.physics.block_collocation.*": INNER,
    "studies.physics.closed_motion.*": INNER,
    "studies.physics.effects.*": INNER,
    "studies.physics.fine_model.*": INNER,
    "studies.fidelity.integrators.*": INNER,
    "studies.physics.known_physics.*": INNER,
    "studies.physics.motion_nodes.*": INNER,
    "studies.physics.node_search.*": INNER,
    "studies.physics.physics_motion.*": INNER,
    "studies.physics.quasi_linear.*": INNER,
    "studies.physics.time_windows.*": INNER,
    "studies.fidelity.verdict_in_words.*": INNER,
    "studies.fidelity.mode_count.*": RESULT,
    "studies.fidelity.speed_accuracy.*": RESULT,
    "studies.fidelity.stiffening.Stiffening": RESULT,
    "studies.fidelity.error_sources.ErrorSources*": RESULT,
    "studies.figures*": DRAWN,
    "studies.papers*": DRAWN,
    "studies.peers.*": INNER,
    "studies.report*": DRAWN,
    "studies.scoreboard*": RESULT,
    "studies.stability.*": RESULT,
}


def public() -> Iterator[str]:
    """Functions, classes and their methods, by module and name without "pliant.", where they are defined."""
    for package in (pliant.controllers, pliant.envs.scenes, pliant.studies):
        for info in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if not info.ispkg and not reason(info.name.removeprefix("pliant.")):  # of a whole module
                yield from _of(importlib.import_module(info.name))


def _of(module: ModuleType) -> Iterator[str]:
    short = module.__name__.removeprefix("pliant.")
    for name, thing in vars(module).items():
        if name.startswith("_") or not callable(thing) or getattr(thing, "__module__", None) != module.__name__:
            continue
        yield f"{short}.{name}"
        if inspect.isclass(thing):
            for method, own in vars(thing).items():
                if not method.startswith("_") and (
                    inspect.isfunction(own) or isinstance(own, (classmethod, staticmethod))
                ):
                    yield f"{short}.{name}.{method}"


def called(call: Call) -> str:
    """The same of a call."""
    thing: Any = call.function
    return f"{thing.__module__}.{thing.__qualname__}".removeprefix("pliant.")


def reason(name: str) -> str:
    """Why it has no call; empty where there is none."""
    return next((why for pattern, why in REASONS.items() if fnmatch(name, pattern)), "")


def without_call(found: list[Call]) -> list[str]:
    """What has neither a call nor a reason."""
    have = {called(call) for call in found}
    return [name for name in public() if name not in have and not reason(name)]

"""Stability charts and mode counts: against closed forms, in parallel, in pictures."""

import dataclasses
import json
import sys
import warnings

import numpy as np
import pytest

from pliant.plants import LinearModel, LTVModel, SingleLinkArm, Trajectory, TwoLinkArm
from pliant.plants.core.errors import UnstableRestWarning
from pliant.plants.spacecraft.plant import FlexibleSpacecraft
from pliant.plants.stability import assess
from pliant.studies.fidelity.mode_count import ModeCount, _settled, modes_needed
from pliant.studies.figures.stability import chart, evidence
from pliant.studies.stability.parameter_map import KINDS, map_stability


def oscillator(damping, stiffness):
    """Stable where both are above zero."""
    if stiffness == 7.0:
        raise ValueError("no such spring")
    return LinearModel.from_matrices([[0.0, 1.0], [-stiffness, -damping]], np.zeros((2, 0)))


def pumped():
    """A function made here is sent to workers by value: they need not import this file."""

    def hill(depth, frequency):
        """8 states, two of them pumped."""
        t = np.linspace(0.0, 2 * np.pi / frequency, 65)
        A = np.zeros((65, 8, 8))
        omega = np.array([1.0, 2.3, 3.9, 6.1])
        A[:, :4, 4:], A[:, 4:, :4] = np.eye(4), -np.diag(omega**2)
        A[:, 4, 0] -= depth * np.cos(frequency * t)
        A[:, 4:, 4:] = -0.05 * np.eye(4)
        none, rows = np.zeros((65, 8, 0)), {k: np.zeros((65, 8 if k in "cx" else 0)) for k in ("c", "x", "u", "y")}
        gone = {"C": np.zeros((65, 0, 8)), "D": np.zeros((65, 0, 0)), "F": np.zeros((65, 0, 0))}
        names = tuple(f"x{i}" for i in range(8))
        return LTVModel(t, A, none, none, **gone, **rows, states=names, inputs=(), disturbances=(), outputs=())

    return hill


hill = pumped()


def test_chart_of_an_oscillator_and_its_failures():
    damping, stiffness = np.linspace(-1, 1, 5), np.array([-2.0, 0.5, 3.0, 7.0])
    told = []
    found = map_stability(
        oscillator,
        {"damping": damping, "stiffness": stiffness},
        backend="sequential",
        progress=lambda fraction, text: told.append(fraction),
    )
    for i, d in enumerate(damping):
        for j, k in enumerate(stiffness):
            wanted = "failed" if k == 7 else "unstable" if k < 0 or d < 0 else "marginal" if d == 0 else "stable"
            assert found.verdicts[i, j] == wanted
            if wanted != "failed":
                exact = -np.linalg.eigvals([[0, 1], [-k, -d]]).real.max()
                assert found.margins[i, j] == pytest.approx(exact, abs=1e-12)
    assert len(found.failures) == 5 and "ValueError: no such spring" in found.failures[0, 3]
    assert found.share("failed") == 0.25 and sum(found.share(k) for k in KINDS) == pytest.approx(1.0)
    assert told[0] == 0.0 and told[-1] == 1.0 and told == sorted(told)


@pytest.mark.parametrize("backend", ("threading", "loky"))
def test_backends_agree_point_by_point(backend):
    grid = {"depth": np.linspace(0.0, 1.0, 4), "frequency": np.linspace(1.7, 2.3, 5)}
    one = map_stability(hill, grid, backend="sequential")
    other = map_stability(hill, grid, backend=backend, jobs=2)
    assert (one.verdicts == other.verdicts).all()
    np.testing.assert_allclose(one.margins, other.margins, rtol=1e-12)
    for i, depth in enumerate(grid["depth"]):
        assert one.verdicts[i, 2] == assess(hill(depth, 2.0)).verdict
    assert (one.verdicts[0] == "stable").all() and one.verdicts[3, 2] == "unstable"


@pytest.mark.campaign  # two processes that start Dask: seven seconds
def test_the_same_call_on_a_local_dask_cluster():
    distributed = pytest.importorskip("distributed")
    grid = {"depth": np.linspace(0.0, 1.0, 3), "frequency": np.linspace(1.7, 2.3, 3)}
    with distributed.Client(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None):
        there = map_stability(hill, grid, backend="dask")
    assert (there.verdicts == map_stability(hill, grid, backend="sequential").verdicts).all()


def test_the_same_call_on_a_local_ray_cluster():
    ray = pytest.importorskip("ray")
    grid = {"depth": np.linspace(0.0, 1.0, 3), "frequency": np.linspace(1.7, 2.3, 3)}
    ray.init(num_cpus=1, include_dashboard=False, log_to_driver=False)
    try:
        there = map_stability(hill, grid, backend="ray", jobs=1)
    finally:
        ray.shutdown()
    assert there.backend == "ray"
    assert (there.verdicts == map_stability(hill, grid, backend="sequential").verdicts).all()


def test_a_backend_that_is_not_installed_is_named(monkeypatch):
    grid = {"depth": [0.5], "frequency": [2.0]}
    monkeypatch.setitem(sys.modules, "ray.util.joblib", None)
    with pytest.raises(ImportError, match=r"map_stability.backend = 'ray' needs ray: pip install pliant\[ray\]"):
        map_stability(hill, grid, backend="ray")
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ImportError, match=r"map_stability.backend = 'dask' needs dask: pip install pliant\[dask\]"):
        map_stability(hill, grid, backend="dask")


@pytest.mark.campaign
def test_a_plants_parameters_by_name():
    arm = dataclasses.replace(SingleLinkArm.textbook(), gravity=9.81, hub_friction=0.3, basis="clamped-free")
    grid = {"hub_friction": (0.1, 0.4), "payload.mass": (0.2, 0.6, 1.0)}
    found = map_stability(arm, grid, at={"hub_angle": -np.pi / 2}, backend="sequential")
    for i, friction in enumerate(grid["hub_friction"]):
        for j, mass in enumerate(grid["payload.mass"]):
            payload = dataclasses.replace(arm.payload, mass=mass)
            other = dataclasses.replace(arm, hub_friction=friction, payload=payload)
            wanted = assess(other.linearize(*other.equilibrium(hub_angle=-np.pi / 2)))
            assert found.verdicts[i, j] == wanted.verdict
            assert found.margins[i, j] == pytest.approx(wanted.margin, rel=1e-6, abs=1e-9)
    motion = arm.simulate(np.r_[0.1, np.zeros(arm.nx - 1)], None, np.linspace(0.0, 0.5, 101))
    along = map_stability(arm, grid, nominal=motion, backend="sequential")
    assert "failed" not in along.verdicts


def test_a_map_tells_of_rests_by_its_verdicts():
    """A rod that stands up, or hangs under gravity that pulls it up: no warning for each point of the grid."""
    rod = dataclasses.replace(SingleLinkArm.textbook(), gravity=9.81).ladder()[0]
    with warnings.catch_warnings():
        warnings.simplefilter("error", UnstableRestWarning)
        grid = {"gravity": [-9.81, 9.81], "link.damping": [0.0]}
        found = map_stability(rod, grid, at={"hub_angle": np.pi / 2}, backend="sequential")
    assert found.verdicts[1, 0] == "unstable" and found.verdicts[0, 0] not in ("unstable", "failed")


def test_saved_as_json_and_as_a_picture(tmp_path):
    found = map_stability(
        hill, {"depth": np.linspace(0, 1, 6), "frequency": np.linspace(1.6, 2.4, 7)}, backend="sequential"
    )
    found.save(tmp_path / "map.json", tmp_path / "map.png", title="Pumped", labels=("depth [-]", "frequency [rad/s]"))
    table = json.loads((tmp_path / "map.json").read_text())
    assert np.array(table["verdicts"]).shape == (6, 7) and table["names"] == ["depth", "frequency"]
    assert (tmp_path / "map.png").stat().st_size > 5000
    ax = chart(found).axes[0]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("frequency", "depth")


@pytest.mark.parametrize("model", [hill(0.5, 2.0), hill(0.1, 1.5), oscillator(0.1, 1.0)])
def test_pictures_of_a_verdict(model):
    verdict = assess(model)
    figure = evidence(verdict, title="test")
    assert verdict.verdict in figure.axes[0].get_title(loc="left")
    assert len(figure.axes) == (4 if "floquet" in verdict.evidence else 1)


@pytest.mark.parametrize(
    ("grid", "options", "match"),
    [
        ({"a": [1.0]}, {}, "must name two parameters"),
        ({"a": [1.0, 1.0], "b": [1.0]}, {}, r"grid\['a'\] must be one or more ascending values"),
        ({"a": [1.0], "b": [np.nan]}, {}, r"grid\['b'\]\[0\] = nan must be finite"),
        ({"a": [1.0], "b": [1.0]}, {"backend": "mpi"}, "map_stability.backend = 'mpi' must be one of 'loky'"),
    ],
)
def test_bad_grids_are_refused(grid, options, match):
    with pytest.raises(ValueError, match=match):
        map_stability(oscillator, grid, **options)


# --- how many modes -----------------------------------------------------------------------------------------------


def test_modes_needed_by_a_link_and_by_the_nonlinear_simulation():
    arm = dataclasses.replace(SingleLinkArm.textbook(), gravity=9.81, hub_friction=0.2, basis="clamped-free")

    def hanging(variant):
        """Upside down: the hub angle at which gravity makes it fall."""
        t = np.linspace(0.0, 0.4, 81)
        return _rest(variant, *variant.equilibrium({"hub_angle": np.pi / 2}), t)

    found = modes_needed(arm, hanging, 1e-2, most=4)
    assert found.modes is not None and 1 <= found.modes < 4
    margins = [row.margin for row in found.rows]
    assert all(abs(m - margins[-1]) <= 1e-2 for m in margins[found.modes - 1 :])
    assert found.difference < 1e-3  # the worst deviation grows in the nonlinear plant as the linear model says
    tight = modes_needed(arm, hanging, 1e-9, most=2)
    assert tight.modes is None and "still changes" in tight.why


def _rest(variant, x0, u0, t):
    many = np.ones((len(t), 1))
    return Trajectory.from_arrays(t, many * x0, many * u0, plant=variant, dx=np.zeros((len(t), variant.nx)))


def test_a_nominal_from_a_rigid_plant_is_lifted():
    arm = dataclasses.replace(TwoLinkArm.textbook(), joint_friction=(0.5, 0.3))
    rigid = dataclasses.replace(arm, reduction="rigid")
    x0 = rigid.equilibrium(theta1=-np.pi / 2, theta2=0.0)[0]
    x0[0] += 0.05
    motion = rigid.simulate(x0, None, np.linspace(0.0, 0.3, 61))
    found = modes_needed(arm, motion, 100.0, most=2)
    assert found.modes == 1 and [row.states for row in found.rows] == [8, 12]
    assert found.linear_growth > 0 and np.isfinite(found.nonlinear_growth)
    with pytest.raises(ValueError, match=r"modes_needed.tolerance = -1 must be > 0"):
        modes_needed(arm, motion, -1)
    with pytest.raises(ValueError, match=r"modes_needed.most = 0 must be an integer from 1 to 1000"):
        modes_needed(arm, motion, 1.0, most=0)


@pytest.mark.campaign
def test_a_spacecraft_that_spins_about_its_intermediate_axis_needs_one_mode(reference):
    """The nominal is a rigid spin; the reference is without geometric stiffening, which changes 1e-7 here."""

    def spin(craft, rate=0.1):
        t = np.linspace(0.0, 2 * np.pi / rate, 401)
        x, dx = np.zeros((2, len(t), craft.nx))
        quaternion, omega = craft.layout.quaternion.start, craft.layout.omega.start
        half = rate * t / 2
        x[:, quaternion], x[:, quaternion + 2], x[:, omega + 1] = np.cos(half), np.sin(half), rate
        dx[:, quaternion], dx[:, quaternion + 2] = -rate / 2 * np.sin(half), rate / 2 * np.cos(half)
        return Trajectory.from_arrays(t, x, np.zeros((len(t), craft.nu)), plant=craft, dx=dx)

    def with_modes(craft, n):
        fewer = tuple(dataclasses.replace(a, modes=(1, n)) for a in craft.appendages)
        return dataclasses.replace(craft, appendages=fewer)

    found = modes_needed(FlexibleSpacecraft.textbook(), spin, 1e-6, most=2, with_modes=with_modes)
    known = max(root[0] for root in reference("spacecraft")["spin_0.1_rad_s"]["y"])
    assert found.modes == 1 and found.rows[1].verdict == "unstable"
    assert found.rows[1].margin == pytest.approx(-known, abs=5e-7)
    assert found.difference < 1e-6


def test_margins_that_fall_by_factors_are_not_settled():
    """1e-3, 1e-5, 1e-7: all of them within a tolerance of 1e-2, and none like the next."""
    rows = [ModeCount(n, 2 * n, "stable", 10.0 ** (1 - 2 * n), None) for n in (2, 3, 4)]
    assert _settled(rows, 1e-2) is None
    assert _settled([*rows, dataclasses.replace(rows[-1], modes=5, margin=0.9e-7)], 1e-2) == 4
    still = [dataclasses.replace(row, verdict="marginal") for row in rows]
    assert _settled(still, 1e-2) == 2


@pytest.mark.parametrize("error", [ZeroDivisionError("by zero"), TypeError("no"), KeyError("gone"), IndexError("out")])
def test_whatever_a_point_raises_is_its_own_failure(error):
    def build(first, second):
        if first > 0:
            raise error
        return oscillator(second, 1.0)

    found = map_stability(build, {"a": [0.0, 1.0], "b": [0.1, 0.2]}, backend="sequential")
    assert found.verdicts.tolist() == [["stable", "stable"], ["failed", "failed"]]
    assert type(error).__name__ in found.failures[1, 0] and len(found.failures) == 2
    assert (found.margin_bounds[0] <= found.margins[0]).all() and np.isnan(found.margin_bounds[1]).all()

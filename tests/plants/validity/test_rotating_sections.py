"""Ranges of large rotations: strains of the fibres, turns within a sub-beam, one turn in space."""

import dataclasses

import numpy as np
import pytest
from scipy.optimize import root

from pliant.plants import LargeDeflectionBeam, Payload, SingleLinkArm, Trajectory, TwoLinkArm, beams
from pliant.plants.exact_rotations.quadrature import points
from pliant.plants.exact_rotations.strain_link import enough
from pliant.plants.validity import rotating_sections
from pliant.plants.validity.ranges import values

BEAM = LargeDeflectionBeam.textbook()


def reached(plant, x, u=None):
    """{quantity: value} at a state."""
    u = np.zeros(plant.nu) if u is None else u
    motion = Trajectory.from_arrays([0.0, 1.0], [x, x], [u, u], plant=plant)
    return dict(zip((r.quantity for r in plant.validity), values(plant, motion)[0], strict=True))


def state(plant, **named):
    x = np.zeros(plant.nx)
    for name, value in named.items():
        x[[s.name for s in plant.states].index(name)] = value
    return x


def test_fibres_of_a_circle_strain_by_their_distance_over_its_radius() -> None:
    """A polynomial rotation field that grows evenly is a circle; in space both planes are added."""
    plane = dataclasses.replace(BEAM, basis="polynomial", modes=1)
    depth = np.sqrt(3 * BEAM.beam.I_z / BEAM.beam.area)
    found = reached(plane, state(plane, bend1=1.2))
    assert found["strain of the beam's fibres"] == pytest.approx(1.2 * depth / 10.0, rel=1e-9)
    space = dataclasses.replace(plane, planar=False)
    found = reached(space, state(space, bend1=1.2, flap1=-0.5))
    assert found["strain of the beam's fibres"] == pytest.approx(1.7 * depth / 10.0, rel=1e-9)
    assert found["rotation of a section against the root"] == pytest.approx(1.3, rel=1e-9)


@pytest.mark.parametrize("root_kind", ["hinged", "driven"])
def test_the_root_may_turn_at_will_and_its_spin_pulls(root_kind) -> None:
    load = Payload(mass=0.5)
    space = dataclasses.replace(BEAM, root=root_kind, planar=False, modes=1, payload=load, gravity=(0.0, 0.0, 0.0))
    turning = space.states[0].name
    found = reached(space, state(space, **{turning: 40.0, f"{turning}_rate": 2.0, "flap1": 0.3}))
    assert found["rotation of a section against the root"] == pytest.approx(0.3, rel=1e-9)
    pull = 4.0 * 10.0 * (BEAM.beam.mass / 2 + 0.5)
    assert found["axial strain of the beam"] == pytest.approx(pull / (BEAM.beam.E * BEAM.beam.area), rel=1e-9)


def test_a_tip_force_counts_as_pull() -> None:
    still = dataclasses.replace(BEAM, gravity=(0.0, 0.0, 0.0))
    found = reached(still, np.zeros(still.nx), np.array([-30.0, 40.0]))
    assert found["axial strain of the beam"] == pytest.approx(50.0 / (BEAM.beam.E * BEAM.beam.area), rel=1e-12)


@pytest.mark.parametrize("planar", [True, False])
def test_turns_within_a_sub_beam(planar) -> None:
    """Those of its shapes in its frame; the second of two sub-beams alone is bent, and twisted."""
    chain = dataclasses.replace(BEAM, kinematics="substructured", segments=2, modes=1, frame="tangent", planar=planar)
    named = {"bend2_1": 0.4} if planar else {"bend2_1": 0.3, "flap2_1": 0.4, "twist2_1": 0.2}
    shapes = chain.shapes.shapes
    xi = np.linspace(0.0, 1.0, 5)
    most = np.abs(shapes(xi, 1)[:, 0] - shapes.offset("tangent")[0]).max()
    found = reached(chain, state(chain, **named))
    bent = (0.4 if planar else 0.5) * most
    assert found["turn within a sub-beam"] == pytest.approx(bent if planar else np.hypot(bent, 0.2), rel=1e-9)
    if not planar:
        assert found["twist of a sub-beam times I_max/I_min - 1"] == 0.0  # a round section
    curved = np.abs(shapes(xi, 2)[:, 0]).max() * 2 / 10.0 * np.sqrt(3 * BEAM.beam.I_z / BEAM.beam.area)
    assert found["strain of the beam's fibres"] == pytest.approx(
        sum(v for k, v in named.items() if k[0] in "bf") * curved
    )


@pytest.mark.parametrize("frame", ["tangent", "mean-axis"])
def test_at_the_limit_of_one_sub_beam_it_errs_by_less_than_is_claimed(frame) -> None:
    """Under a tip force, against a rotation field; where the frame is the root's tangent by nearly all of it."""
    tips = []
    for own in ({"kinematics": "substructured", "segments": 1, "modes": 4, "frame": frame}, {"modes": 8}):
        beam = dataclasses.replace(BEAM, gravity=(0.0, 0.0, 0.0), **own)
        force = np.array([0.0, 0.6 * beam.beam.EI / beam.beam.length**2])  # the linear tip turns by 0.3
        x = solved(beam, np.zeros(beam.nx), range(beam.nx // 2), force)
        tips.append(beam.measure(x)[[s.name for s in beam.outputs].index("tip_v")])
        if len(tips) == 1:
            assert reached(beam, x)["turn within a sub-beam"] == pytest.approx(
                0.3 if frame == "tangent" else 0.2, abs=0.01
            )
    error = abs(tips[0] / tips[1] - 1)
    assert (0.03 if frame == "tangent" else 0.001) < error < 0.05


def solved(beam, x, free, force):
    """The state with the coordinates `free` at rest under a tip force."""
    free, n = list(free), beam.nx // 2

    def lacking(q):
        at = x.copy()
        at[free] = q
        return beam.rest_conditions().forces(at, np.asarray(force), at)[[n + i for i in free]]

    found = root(lacking, np.zeros(len(free)), tol=1e-12)
    assert np.abs(found.fun).max() < 1e-9
    x = x.copy()
    x[free] = found.x
    return x


@pytest.mark.parametrize("along", [1, 2])
def test_a_twisted_sub_beam_sends_its_bends_out_of_their_plane_by_less_than_is_claimed(along) -> None:
    """I_y four times I_z, one sub-beam twisted to the limit, a tip force along y or z: against an exact field."""
    tips, thick = [], dataclasses.replace(BEAM.beam, I_y=4 * BEAM.beam.I_z)
    for own in ({"kinematics": "substructured", "segments": 1, "modes": 3}, {"modes": 4}):
        beam = dataclasses.replace(BEAM, beam=thick, gravity=(0.0, 0.0, 0.0), planar=False, twists=1, **own)
        held = next(i for i, s in enumerate(beam.coordinates) if s.name.startswith("twist"))
        x = np.zeros(beam.nx)
        x[held] = rotating_sections.SKEW / 3
        x = solved(beam, x, [i for i in range(beam.nx // 2) if i != held], np.eye(3)[along])
        y = dict(zip((s.name for s in beam.outputs), beam.measure(x), strict=True))
        tips.append(np.array([y["tip_y"], y["tip_z"]]))
        if len(tips) == 1:
            found = reached(beam, x)["twist of a sub-beam times I_max/I_min - 1"]
            assert found == pytest.approx(rotating_sections.SKEW, rel=1e-9)
    error = np.linalg.norm(tips[0] - tips[1]) / np.linalg.norm(tips[1])
    assert (0.005 if along == 2 else 0.001) < error < 0.05


def test_a_link_of_exact_rotations_is_asked_for_strains_and_turn_not_for_slopes() -> None:
    """One polynomial bends it to a circle: slope and curvature by hand. Rigid links are asked for nothing."""
    arm = dataclasses.replace(SingleLinkArm.textbook(), kinematics="strain", basis="polynomial", modes=1)
    turned = float(arm.elastic.basis.tip_slope[0]) * 0.1 / arm.link.length
    found = reached(arm, state(arm, eta1=0.1))
    assert set(found) == {"strain of the link's fibres", "axial strain of the link", "turn of the link's sections"}
    depth = np.sqrt(3 * arm.link.I_z / arm.link.area)
    assert found["strain of the link's fibres"] == pytest.approx(turned * depth / arm.link.length, rel=1e-9)
    assert found["turn of the link's sections"] == pytest.approx(turned, rel=1e-9)
    two = dataclasses.replace(TwoLinkArm.textbook(), kinematics="strain", modes=(0, 1))
    assert {q.split(" of ")[1].split("'")[0] for q in reached(two, np.zeros(two.nx))} == {"link 2"}


@pytest.mark.parametrize("n", [1, 4, 8])
def test_quadrature_errs_by_less_than_is_said_up_to_the_turn(n) -> None:
    """T of a polynomial field bent to RESOLVED, from its tangents at the link's points and at 64."""
    basis = beams.basis("polynomial", n)
    bent = np.eye(n)[0] * rotating_sections.RESOLVED / np.abs(basis.phi(np.linspace(0, 1, 101), 1)).max(axis=0)[0]

    def inertia(at, q):
        psi = basis.phi(at.xi, 1)
        each, angle = np.column_stack([np.ones(len(psi)), psi]), (psi @ q)[:, None]
        rows = np.vstack([at.root @ (-np.sin(angle) * each), at.root @ (np.cos(angle) * each)])
        return rows.T @ rows

    exact = inertia(points(64), bent)
    lacking = np.linalg.eigvals(np.linalg.solve(exact, inertia(enough(basis), bent) - exact))
    assert 1e-4 < np.abs(lacking).max() < 0.05


def test_a_longer_beam_keeps_its_mass():
    """By the strain of a straight one, by one and a half times as much for each radian of turn more."""
    beam = BEAM.beam
    straight, bent = (rotating_sections.longer(beam, 1e-3, turn) for turn in (0.0, 0.5))
    np.testing.assert_allclose([straight.length, bent.length], beam.length * np.array([1.001, 1.00175]), rtol=1e-14)
    np.testing.assert_allclose([straight.mass, bent.mass], beam.mass, rtol=1e-14)

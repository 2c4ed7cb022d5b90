"""SliderCrank against closed forms, the reference cycle, Newton's laws on the bent rod, and Mathieu's tongue."""

import dataclasses

import numpy as np
import pytest

from pliant.plants.beams.pinned_rod import AxialModes, rod_shapes
from pliant.plants.slider_crank.plant import SliderCrank
from pliant.plants.slider_crank.steady_cycles import floquet_multipliers, speed_scan, steady_cycle

PLANT = SliderCrank.textbook()
ROD = PLANT.rod
FIRST = (np.pi / ROD.length) ** 2 * np.sqrt(ROD.EI / ROD.linear_density)
LOCKED = ("crank_angle",)


def changed(**changes):
    return dataclasses.replace(PLANT, **changes)


def outputs(plant, x, u=0.0, w=None):
    return dict(zip((s.name for s in plant.outputs), plant.measure(x, [u], w=w)))


def bent_state(plant, seed, deflection=1e-4):
    rng = np.random.default_rng(seed)
    x = plant.state(rng.uniform(-3, 3), rng.uniform(5, 20))
    n, k = plant.counts
    size = np.concatenate([np.full(n, deflection), np.full(k, 1e-3 * deflection)])
    x[1 : 1 + n + k] = size * rng.normal(size=n + k)
    x[-(n + k) :] = 300 * size * rng.normal(size=n + k)
    return x


def test_rigid_limit_is_exact(reference):
    rigid = changed(kinematics="rigid")
    names = {
        "phi2_deg": "rod_angle",
        "omega2": "rod_rate",
        "eps2": "rod_acceleration",
        "x_m": "slider_x",
        "v": "slider_speed",
        "a": "slider_acceleration",
    }
    forces = {"torque_Nm": "crank_torque", "N_B": "axial_force", "guide_By": "guide_force", "x_m": "slider_x"}
    for row in reference("slider_crank")["rigid"]:
        angle = np.radians(row["phi1_deg"])
        motion = rigid.rigid.motion(angle, rigid.crank_speed)._asdict()
        motion["rod_angle"] = np.degrees(motion["rod_angle"])
        for key, name in names.items():
            assert motion[name] == pytest.approx(row[key], rel=1e-9, abs=1e-12), key
        y = outputs(rigid, rigid.state(angle))
        for key, name in forces.items():
            assert y[name] == pytest.approx(row[key], rel=1e-9, abs=1e-12), key
    stiff = changed(rod=dataclasses.replace(ROD, E=ROD.E * 1e9, damping=ROD.damping * 1e-4))
    row = reference("slider_crank")["rigid"][1]
    y = outputs(stiff, steady_cycle(stiff, points=361).x[60])
    for key, name in forces.items():
        assert y[name] == pytest.approx(row[key], rel=1e-9), key


@pytest.mark.parametrize(
    ("changes", "within"),
    [
        ({"modes": 1}, 5e-3),
        ({"modes": 3}, 5e-4),
        ({"modes": 5, "axial_modes": 1}, 1e-4),
        ({"modes": 9}, 1e-7),
        ({"basis": "frame-elements", "modes": 2}, 2e-4),
        ({"basis": "frame-elements", "modes": 4}, 2e-5),
    ],
)
def test_steady_deflection_of_the_middle(reference, changes, within):
    """Of the peak, at the tabulated angles and at the extremes; modes 2, 4, .. do not move the middle."""
    expected = reference("slider_crank")
    cycle = steady_cycle(changed(**changes), points=3601)
    found = 1e6 * cycle["mid_deflection"]
    peak = expected["mid_extremes_um"]["max"]
    for degrees, value in expected["mid_deflection_um"].items():
        assert found[10 * int(degrees)] == pytest.approx(value, abs=within * peak)
    assert found.max() == pytest.approx(peak, rel=within)
    assert found.min() == pytest.approx(expected["mid_extremes_um"]["min"], rel=within)
    assert found.argmax() / 10 == pytest.approx(expected["mid_extremes_um"]["at_max"], abs=0.11)
    assert found.argmin() / 10 == pytest.approx(expected["mid_extremes_um"]["at"], abs=0.11)


def test_without_the_axial_force_stiffness_the_deflection_is_one_per_cent_off(reference):
    peak = reference("slider_crank")["mid_extremes_um"]["max"]
    found = 1e6 * steady_cycle(changed(kinematics="linear", modes=5))["mid_deflection"].max()
    assert 0.01 < abs(found / peak - 1) < 0.02


def test_pinned_pinned_frequencies(reference):
    plant = changed(force=0.0, modes=6)
    found = plant.natural_frequencies(plant.state(0.9, 0.0)) / (2 * np.pi)
    np.testing.assert_allclose(found, reference("slider_crank")["pinned_pinned_Hz"], rtol=1e-9)
    free = dataclasses.replace(plant, crank_speed=None)
    np.testing.assert_allclose(free.natural_frequencies(locked=LOCKED), 2 * np.pi * found, rtol=1e-9)


def test_frame_elements_converge_at_their_orders():
    """Bending as h^4, stretching (with the slider at the end) as h^2."""
    counts = np.array([2, 4, 6])
    axial = AxialModes(1, PLANT.slider_mass / ROD.mass).roots[0] / ROD.length * np.sqrt(ROD.E / ROD.density)
    for exact, order in ((FIRST, -4), (axial, -2)):
        errors = []
        for n in counts:
            plant = changed(force=0.0, basis="frame-elements", modes=int(n))
            found = plant.natural_frequencies()
            errors.append(np.abs(found / exact - 1).min())
        assert np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(order, abs=0.2)


def test_axial_modes_are_orthogonal_with_the_slider():
    ratio = 2.3
    shapes = rod_shapes("pinned-pinned", 0, 4, ratio)
    for G in (shapes.mass + ratio * np.outer(shapes.tip, shapes.tip), shapes.stiffness):
        scale = np.sqrt(np.diag(G))
        np.testing.assert_allclose(G / scale / scale[:, None], np.eye(4), atol=1e-12)


def test_axial_force_changes_the_frequency_as_euler_says():
    """omega^2 = omega1^2 (1 - Q/P), P = pi^2 E I/l^2, in a dead centre; past P the straight rod buckles."""
    P = np.pi**2 * ROD.EI / ROD.length**2
    for share in (-1.0, 0.5, 0.9, 1.2):
        plant = changed(force=share * P)
        found = plant.natural_frequencies(plant.state(0.0, 0.0))[0]
        assert found * abs(found) == pytest.approx(FIRST**2 * (1 - share), rel=1e-9)
    loose = changed(force=0.9 * P, kinematics="linear")
    assert loose.natural_frequencies()[0] == pytest.approx(FIRST, rel=1e-9)


FULL = {
    "crank_friction": 0.01,
    "slider_friction": 2.0,
    "dry_friction": 0.5,
    "gravity": 9.81,
}


def turning(a, b):
    """a x b about z."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


@pytest.mark.parametrize("basis", ["pinned-pinned", "frame-elements"])
def test_forces_obey_newtons_laws_on_the_bent_rod(basis):
    """Momentum of rod points taken from the outline, by differences in time, and of the slider; second order in e."""
    plant = changed(**FULL, basis=basis, axial_modes=2 if basis == "pinned-pinned" else 0, crank_speed=None)
    w = np.array([3.0, 2.0])
    for seed in range(3):
        x = bent_state(plant, seed, 1e-5)
        y = outputs(plant, x, 1.3, w)
        assert y["crank_torque"] == pytest.approx(1.3, rel=1e-10)
        h = 1e-6
        path = plant.simulate(x, [1.3], h * np.arange(5), w=w, rtol=1e-12, atol=1e-15)
        points = np.array([plant.outline(s, 241)[1] for s in path.x])
        weights = np.ones(241)
        weights[1:-1:2], weights[2:-1:2] = 4, 2
        dm = ROD.mass * weights / weights.sum()
        acceleration = np.tensordot([-1, 16, -30, 16, -1], points, axes=1) / (12 * h**2)
        y = dict(zip((s.name for s in plant.outputs), plant.measure(path.x[2], [1.3], w=w)))
        q, place = path.x[2], points[2]
        tilt = np.arctan2(-np.sin(q[0]) * PLANT.crank_radius, place[-1, 0] - np.cos(q[0]) * PLANT.crank_radius)
        across = np.array([-np.sin(tilt), np.cos(tilt)])
        weight = np.array([0.0, -9.81])
        pin = np.array([y["crank_pin_x"], y["crank_pin_y"]])
        speed = (points[3, -1, 0] - points[1, -1, 0]) / (2 * h)
        drag = 2.0 * speed + 0.5 * speed / np.hypot(speed, 0.01)
        slider_x = -(0.2 * acceleration[-1, 0] + 20.0 + w[0] + drag)
        slider = np.array([slider_x, y["guide_force"] - 0.2 * 9.81])
        needed = dm @ (acceleration - weight)
        np.testing.assert_allclose(pin + slider + w[1] * across, needed, atol=2e-3 * np.abs(pin).max())
        arm = place - place[0]
        moment = dm @ turning(arm, acceleration - weight)
        middle = turning(arm[120], w[1] * across)
        assert turning(arm[-1], slider) + middle == pytest.approx(moment, abs=2e-3 * abs(slider_x) * 0.05)
        along = slider @ np.array([np.cos(tilt), np.sin(tilt)])
        assert y["axial_force"] == pytest.approx(along, rel=1e-3)
        assert abs(place[-1, 1]) < 1e-15  # the slider stays on its line
        assert y["slider_x"] == pytest.approx(place[-1, 0], abs=1e-12)


def test_prescribed_speed_and_its_torque_give_the_same_cycle():
    free = changed(**(FULL | {"dry_friction": 0.0}), crank_speed=None, axial_modes=1)
    driven = dataclasses.replace(free, crank_speed=20.0)
    a, b = steady_cycle(free, speed=20.0), steady_cycle(driven)
    np.testing.assert_array_equal(a.x, b.x)
    n = free.nx // 2
    assert np.abs(a.dx[:, n]).max() < 1e-8  # the torque keeps the speed
    np.testing.assert_allclose(a.dx, b.dx, rtol=0, atol=1e-7 * np.abs(b.dx).max())
    power = [free.power(x, u, w=np.zeros(2)) for x, u in zip(a.x[:-1], a.u[:-1])]
    balance = np.array(power).sum(axis=0)
    assert balance[0] == pytest.approx(balance[1], rel=1e-6)  # over a cycle all the work is lost


def test_steady_cycle_closes_under_the_nonlinear_equations():
    cycle = steady_cycle(PLANT, points=91)
    motion = PLANT.simulate(cycle.x[0], None, cycle.t)
    np.testing.assert_allclose(motion.x[:, 1:3], cycle.x[:, 1:3], rtol=0, atol=1e-15)
    assert motion.x[-1, 0] == pytest.approx(2 * np.pi, rel=1e-12)
    assert np.abs(PLANT.linearize_along(cycle).c).max() < 1e-6 * np.abs(cycle.dx).max()


def test_accelerations_of_the_middle_are_the_derivatives_of_its_motion():
    """Fourier derivatives around the cycle of the middle's position, taken from the outline."""
    cycle = steady_cycle(PLANT, points=361)
    x = cycle.x[:-1]
    place = np.array([PLANT.outline(s, 3)[1, 1] for s in x])
    order = np.fft.rfftfreq(360, 1 / 360) * PLANT.crank_speed

    def second(values):
        c = np.fft.rfft(values, axis=0) * (-(order**2)).reshape(-1, *[1] * (values.ndim - 1))
        c[60:] = 0
        return np.fft.irfft(c, 360, axis=0)

    absolute, elastic = second(place), second(cycle["mid_deflection"][:-1])
    tilt = PLANT.rigid.motion(x[:, 0], 1.0).rod_angle
    c, s = np.cos(tilt), np.sin(tilt)
    scale = np.abs(absolute).max()
    across, along = c * absolute[:, 1] - s * absolute[:, 0], c * absolute[:, 0] + s * absolute[:, 1]
    np.testing.assert_allclose(cycle["mid_acceleration"][:-1], across, rtol=0, atol=1e-8 * scale)
    np.testing.assert_allclose(cycle["mid_acceleration_along"][:-1], along, rtol=0, atol=1e-8 * scale)
    found = cycle["mid_acceleration_elastic"][:-1]
    np.testing.assert_allclose(found, elastic, rtol=0, atol=1e-5 * np.abs(elastic).max())


def test_mirror_image_moves_as_the_mirror_image():
    x = bent_state(PLANT, 4)
    mirror = np.ones(PLANT.nx)
    mirror[[0, 1, 2, 3, 4, 5]] = -1
    np.testing.assert_allclose(PLANT.dynamics(mirror * x), mirror * PLANT.dynamics(x), rtol=1e-11, atol=1e-9)


def test_energy_of_the_free_mechanism_is_kept():
    plant = changed(crank_speed=None, force=0.0, gravity=9.81, rod=dataclasses.replace(ROD, damping=0.0))
    motion = plant.simulate(bent_state(plant, 1), None, np.linspace(0, 1, 11), rtol=1e-11, atol=1e-14)
    energy = plant.energy(motion.x)
    assert np.ptp(energy) < 1e-9 * energy[0]


def test_floquet_multipliers_are_those_of_the_nonlinear_motion():
    plant = changed(modes=1, rod=dataclasses.replace(ROD, damping=0.05 * ROD.damping))
    cycle = steady_cycle(plant, speed=150.0, points=181)
    model = plant.linearize_along(cycle)
    found = floquet_multipliers(model, ("eta1", "eta1_rate"))
    kept, h = [1, 3], 1e-7
    columns = []
    for i in kept:
        ends = []
        for sign in (1, -1):
            start = cycle.x[0].copy()
            start[i] += sign * h * (1 if i == 1 else FIRST)
            ends.append(plant.simulate(start, None, cycle.t[[0, -1]], rtol=1e-12, atol=1e-15).x[-1, kept])
        columns.append((ends[0] - ends[1]) / (2 * h * (1 if i == 1 else FIRST)))
    expected = np.linalg.eigvals(np.transpose(columns))
    np.testing.assert_allclose(np.sort_complex(found), np.sort_complex(expected), atol=1e-6)
    every = floquet_multipliers(model)
    assert np.sort(np.abs(every))[-2:] == pytest.approx([1.0, 1.0], abs=1e-6)  # the crank's angle and speed


def short_crank(ratio):
    """A short crank, a light slider and light damping: (plant, half the relative width of the tongue).

    The axial force is -(m_s + rho A (L - x)) r W^2 cos(W t); on the first mode it makes the stiffness
    omega1^2 (1 + eps cos W t) with eps = (m_s + m_rod/2) r W^2/P, P = pi^2 E I/l^2, and at W = 2 omega1
    eps = 4 pi^2 (r/l)(m_s/m_rod + 1/2). Mathieu's equation with damping zeta is unstable where
    |W/(2 omega1) - 1| < sqrt((eps/4)^2 - zeta^2) to first order (Nayfeh and Mook, "Nonlinear Oscillations", 5.3).
    """
    zeta = 0.5 * ratio
    plant = changed(
        crank_radius=ratio * ROD.length,
        slider_mass=0.1 * ROD.mass,
        force=0.0,
        modes=1,
        rod=dataclasses.replace(ROD, damping=2 * zeta / FIRST),
    )
    eps = 4 * np.pi**2 * ratio * 0.6
    return plant, np.sqrt((eps / 4) ** 2 - zeta**2), eps, zeta


def test_first_tongue_is_where_theory_puts_it():
    misses = []
    for ratio in (0.004, 0.002):
        plant, half, eps, zeta = short_crank(ratio)
        speeds = 2 * FIRST * (1 + half * np.array([-2.0, 0.0, 2.0]))
        scan = speed_scan(plant, speeds, points=91, edge=1e-6)
        ((low, high),) = scan.tongues
        edges = np.array([low, high]) / (2 * FIRST) - 1
        np.testing.assert_allclose(edges, [-half, half], rtol=0, atol=0.15 * eps**2)
        assert scan.growth[1] == pytest.approx((eps / 4 - zeta) * FIRST, rel=eps**2)
        assert scan.multipliers[1, 0].real < -1 and abs(scan.multipliers[1, 0].imag) < 1e-9  # half the frequency
        assert scan.growth[0] == pytest.approx(-zeta * FIRST, rel=0.02)
        misses.append(np.abs(edges - [-half, half]).max())
    assert misses[0] / misses[1] == pytest.approx(4.0, rel=0.1)  # what is missing is of second order


def test_damping_past_the_threshold_closes_the_tongue():
    plant, _, eps, _ = short_crank(0.004)
    heavy = dataclasses.replace(plant, rod=dataclasses.replace(plant.rod, damping=2 * 1.1 * (eps / 4) / FIRST))
    assert speed_scan(heavy, 2 * FIRST * np.array([0.99, 1.0, 1.01]), points=91).tongues == ()
    light = dataclasses.replace(plant, rod=dataclasses.replace(plant.rod, damping=2 * 0.9 * (eps / 4) / FIRST))
    assert speed_scan(light, 2 * FIRST * np.array([1.0]), points=91).tongues != ()


def test_ladder_shares_outputs_and_every_step_has_its_own_label():
    ladder = PLANT.ladder()
    assert ladder[0].label == "rigid" and len({p.label for p in ladder}) == len(ladder)
    assert all(p.outputs == PLANT.outputs for p in ladder)
    assert [p.nx for p in ladder] == [2, 4, 8, 4, 6, 8, 12]
    elements = changed(basis="frame-elements")
    np.testing.assert_array_equal(elements.ladder()[0].measure([0.4, 3.0]), ladder[0].measure([0.4, 3.0]))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"crank_speed": np.inf}, "crank_speed = inf"),
        ({"crank_speed": "fast"}, "crank_speed = 'fast'"),
        ({"slider_mass": -1.0}, "slider_mass = -1.0"),
        ({"basis": "springs"}, "basis = 'springs'"),
        ({"kinematics": "strain"}, "kinematics = 'strain'"),
        ({"basis": "frame-elements", "axial_modes": 1}, "axial_modes = 1"),
        ({"modes": 41}, "modes = 41"),
    ],
)
def test_bad_parameters_are_named(changes, message):
    with pytest.raises(ValueError, match=message):
        changed(**changes)


def test_bad_cycles_are_named():
    with pytest.raises(ValueError, match=r"steady_cycle.speed = None"):
        steady_cycle(changed(crank_speed=None))
    with pytest.raises(ValueError, match=r"steady_cycle.speed = -3.0 must be > 0"):
        steady_cycle(PLANT, speed=-3.0)
    with pytest.raises(ValueError, match=r"speed_scan.speeds"):
        speed_scan(PLANT, [2.0, 1.0])
    with pytest.raises(ValueError, match="no deviations"):
        speed_scan(changed(kinematics="rigid"), [1.0])

"""What is claimed of loops - delay, gain, phase and disk margins, spillover's windows, shapers - on random plants.

    python tests/campaigns/loops.py --count 2000

Plants that are stable, unstable, undamped or rigid, with feedthrough, one to three channels, modes up to three times
the Nyquist frequency, under regulators, output feedbacks and laws with states of their own; sampled loops where only
the sampled model is known too. Against them, all put together in random_loops.py and late_delays.py:

delay     borne up to the claim on a grid of delays, not beyond it; of continuous loops the exact shortest one
gain, phase, disk   poles with real or complex factors inside the claim, and just outside it
windows   spillover's factor: poles on a fine grid of gains over thirty octaves
shaper    what a shaped step leaves of each mode, by matrix exponentials
"""

from __future__ import annotations

import warnings
from collections import Counter
from typing import Any

import by_seed
import numpy as np
import scipy.linalg as sla
from late_delays import INSIDE, OUTSIDE, continuous_delay, sampled_delay
from random_loops import Wrong, alone, case, closed, expect, growth, held, modes, resting, series

from pliant.controllers import LQR, Feedback, loop, margins, spillover
from pliant.controllers.analysis.spillover import MOST, NEAR, RESERVE, TRIED
from pliant.controllers.joint_control.input_shaping import KINDS, LIGHT, shaper_for
from pliant.plants import LinearModel, PliantError

FINE = 2  # gains looked at between two that spillover tries
LEFT = 1e-8  # vibration that a shaper may leave, against what one step does


def factors(rng, L, dt: float | None, i: int, c) -> None:
    """Gain, phase and disk margins of one channel."""
    n = len(L[3])

    def at(f: complex) -> float:
        every = np.ones(n, dtype=complex)
        every[i] = f
        return float(growth(closed(L, every if abs(np.imag(f)) > 0 else every.real), dt))

    low, high = c.gain
    for f in np.exp(rng.uniform(np.log(max(low, 1e-4) / INSIDE), np.log(min(high, 1e4) * INSIDE), 12)):
        expect(True, at(float(f)), f"gain {f:.6g} of {low:.6g} to {high:.6g}")
    for f in [low * INSIDE] * bool(low > 0) + [high * OUTSIDE] * bool(np.isfinite(high)):
        expect(False, at(float(f)), f"gain {f:.8g} outside {low:.6g} to {high:.6g}")
    phase = np.deg2rad(c.phase_deg)
    for turn in [*rng.uniform(-phase, phase, 6), phase * INSIDE, -phase * INSIDE]:
        expect(True, at(complex(np.exp(1j * turn * INSIDE))), f"phase {np.rad2deg(turn):.6g} of {c.phase_deg:.6g}")
    if phase < np.pi * INSIDE:
        expect(False, max(at(complex(np.exp(1j * w * phase * OUTSIDE))) for w in (1, -1)), "phase past the claim")
    for _ in range(8):
        d = INSIDE * c.disk * np.sqrt(rng.uniform()) * np.exp(2j * np.pi * rng.uniform())
        expect(True, at((1 + d / 2) / (1 - d / 2)), f"a factor in the disk {c.disk:.6g}")
    at_infinity = dt is None and abs(abs(1 / (1 + alone(L, i)[3]) - 0.5) * c.disk - 1) < 1e-6
    if c.disk > 1.9 or at_infinity:  # reached at infinite factors, or by a pole at infinity, only
        return
    edge = max(at((1 + d / 2) / (1 - d / 2)) for d in 1.02 * c.disk * np.exp(2j * np.pi * np.arange(90) / 90))
    expect(False, edge, f"no factor past the disk {c.disk:.6g} makes it grow")


def margin_case(rng) -> list[str]:
    model, law, dt = case(rng)
    at = str(rng.choice(["input", "output"])) if not isinstance(law, LQR) or len(model.A) <= 4 else "input"
    known = dt is None or rng.random() < 0.8
    L = series(model, law, dt, at)
    if growth(closed(L, np.ones(len(L[3]))), dt) > -1e-6:
        raise PliantError("at the edge")
    found = margins(loop(model if known else model.discretize(dt), law, at=at))
    said = ["disk, all channels"]
    for i, c in enumerate(found.channels):
        factors(rng, L, dt, i, c)
        if dt is None:
            said.append(continuous_delay(rng, L, i, c.delay))
        else:
            said.append(sampled_delay(rng, model, law, dt, at, i, c.delay, known))
    for _ in range(10):
        d = INSIDE * found.disk * np.exp(2j * np.pi * rng.uniform(size=len(found.channels)))
        expect(True, float(growth(closed(L, (1 + d / 2) / (1 - d / 2)), dt)), "factors in the disk of all")
    return [*said, *["gain, phase, disk"] * len(found.channels)]


def windows(rng) -> list[str]:
    """A regulator designed on some of the modes, spillover on all of them."""
    A, _ = modes(rng)
    more, _ = modes(rng)
    n, k, nu = len(A), len(more), int(rng.integers(1, 3))
    B = rng.standard_normal((n, nu))
    design = LinearModel.from_matrices(A, B, np.eye(n), outputs=[f"y{i + 1}" for i in range(n)])
    fastest = np.abs(np.linalg.eigvals(sla.block_diag(A, more))).max()
    dt = None if rng.random() < 0.5 else float(10 ** rng.uniform(-1, 0.7) / max(fastest, 0.3))
    law = LQR.design(design, np.eye(n), 10 ** rng.uniform(-3, 1) * np.eye(nu), dt=dt)
    law = Feedback(law.K, design.output_names, dt=dt)
    D = 0.1 * rng.standard_normal((n, nu)) * (rng.random() < 0.3)
    fine = LinearModel.from_matrices(
        sla.block_diag(A, more),
        np.vstack([B, 10 ** rng.uniform(-1.5, 0.5) * rng.standard_normal((k, nu))]),
        np.hstack([np.eye(n), 10 ** rng.uniform(-1.5, 0.5) * rng.standard_normal((n, k))]),
        D,
        outputs=list(design.output_names),
    )
    report = spillover(law, [design, fine])
    loops = [series(model, law, dt, "input") for model in (design, fine)]
    left = [resting(raised(L, np.ones(1))[0], dt) for L in loops]

    def worst(gains) -> Any:
        """Of both plants, at gains (m,), apart from what no input moves."""
        return np.max([growth(raised(L, np.asarray(gains)), dt, n) for L, n in zip(loops, left)], axis=0)

    own = worst([1.0])[0]
    if abs(own) > 1e-8 and report.holds != (own < 0):
        raise Wrong(f"holds: {report.holds}, growth {own:.2g}")
    if report.holds:
        return ["window, none needed"]
    step = 2 ** (1 / TRIED["gain"])
    if report.factor is not None:
        most = report.factor * RESERVE
        for g in np.geomspace(report.factor, most, 40):
            expect(True, float(worst([g])[0]), f"gain {g:.6g} of the window {report.factor:.6g} to {most:.6g}")
        past = np.geomspace(report.factor * (1 + 2 * NEAR), most * (1 + 2 * NEAR), 60)
        if report.factor * (1 + 2 * NEAR) < 1:
            expect(False, float(worst(past).max()), "the window goes on past its end")
    top = 0.0 if report.factor is None else np.log(report.factor * RESERVE) / np.log(step)
    low = -np.log(MOST) / np.log(step) if report.factor is None else top
    return ["window", *missed(worst, report.factor, low, step)]


def raised(L, gains: Any) -> Any:
    """A of the loop with every channel's gain raised by gains (m,)."""
    A, B, C, D = L
    g = gains[:, None, None]
    return A - B @ np.linalg.solve(np.eye(len(D)) + g * D, g * C)


def missed(worst, factor, low: float, step: float) -> list[str]:
    """Wrong where a window at larger gains than the factor is wide enough for the reserve and a step of the search."""
    least = 1 / MOST if factor is None else factor * step
    gains = np.geomspace(RESERVE, least, int(np.log(RESERVE / least) / np.log(step)) * FINE + 2)
    holds = np.concatenate([[False], worst(gains) < -1e-9, [False]])
    ends = np.flatnonzero(np.diff(holds.astype(int)))
    for first, last in zip(ends[::2], ends[1::2] - 1):
        top, bottom = gains[first], gains[last]
        if top / bottom > RESERVE * step * step and bottom < 1 / step:
            raise Wrong(f"gains {bottom:.4g} to {top:.4g} hold, {factor} was told")
    return ["nothing missed"]


def shaped(rng) -> list[str]:
    """A step, shaped for the light modes of a model, continuous or sampled: what is left of each at its end."""
    A, shaking = modes(rng)
    size = np.abs(np.linalg.eigvals(A)).max()
    light = [z for z in shaking if z.real <= 0 and -z.real < LIGHT * abs(z) and z.imag > 1e-6 * size]
    if not light or (np.linalg.eigvals(A).real > 1e-9 * size).any():  # what grows would drown what is left
        return ["shaper, no such modes"]
    T = np.linalg.qr(rng.standard_normal(A.shape))[0]
    A, B = T @ A @ T.T, rng.standard_normal((len(A), 1))
    model = LinearModel.from_matrices(A, B)
    if rng.random() < 0.5:
        model = model.discretize(rng.uniform(0.05, 0.95) * np.pi / max(z.imag for z in shaking))
    made = shaper_for(model, str(rng.choice(KINDS[:3])))
    before, x = 0.0, np.zeros(len(A))
    value, whole = 0.0, held(A, B, made.duration)[1][:, 0]
    for t, a in zip(made.times, made.amplitudes):
        E, G = held(A, B, t - before)
        x, before, value = E @ x + G[:, 0] * value, t, value + a
    rows = np.linalg.eig(A.T)[1].T  # left eigenvectors: each sees one mode
    lam = np.linalg.eigvals(A.T)
    for row, value in zip(rows, lam):
        if any(abs(value - z) < 1e-6 * size for z in light):
            rest = row @ x + (row @ B[:, 0]) / value  # about the level that the step ends at
            if abs(rest) > LEFT * abs(row @ B[:, 0] / value):
                raise Wrong(f"the shaper leaves {abs(rest * value / (row @ B[:, 0])):.2g} of a mode at {value:.4g}")
    return ["shaper"] if np.isfinite(whole).all() else ["shaper, grows"]


def run(seed: int) -> dict[str, Any]:
    """One plant for the margins, one for the shaper, and in each third seed one for the windows."""
    rng = np.random.default_rng([seed, 5])
    row: dict[str, Any] = {"seed": seed, "said": [], "wrong": ""}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for check in (margin_case, shaped, windows)[: 3 if seed % 3 == 0 else 2]:
            try:
                row["said"] += check(rng)
            except Wrong as error:
                row["wrong"] += f"{check.__name__}: {error}; "
            except PliantError as error:
                row["said"].append(f"{check.__name__}, refused: {type(error).__name__}")
    return row


def summary(rows: list[dict[str, Any]]) -> str:
    found = Counter(said for r in rows for said in r["said"])
    wrong = [r for r in rows if r["wrong"]]
    text = f"{len(rows)} plants, {sum(found.values())} claims: {len(wrong)} wrong"
    text += "".join(f"\n  {said:36} {count:6}" for said, count in sorted(found.items()))
    return text + "".join(f"\n  seed {r['seed']}: {r['wrong']}" for r in wrong[:20])


if __name__ == "__main__":
    by_seed.main(__doc__ or "", 2000, run, summary, lambda row: bool(row["wrong"]))

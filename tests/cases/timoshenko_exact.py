"""Exact frequencies of a clamped Timoshenko beam with a rigid body at its tip, in forty digits.

The beam's equations at omega^2 = W are linear with constant coefficients: w' = psi + shear Q, psi' = B,
B' = -Q - rotary W psi, Q' = -W w, from w = psi = 0 to Q = W (m w + e psi), B = W (e w + j psi); their solution is a
power series in x, which converges everywhere. Timoshenko, Philosophical Magazine 41 (1921), 744.
Scale    as in `legendre_ritz`
"""

import mpmath

DIGITS = 40


def residual(W, rotary, shear, tip_mass=0.0, tip_inertia=0.0, coupling=0.0):
    """The characteristic determinant at omega^2 = W."""
    r, s, m, j, e = (mpmath.mpf(float(v)) for v in (rotary, shear, tip_mass, tip_inertia, coupling))
    ends = []
    for term in ((0, 0, 1, 0), (0, 0, 0, 1)):
        end, k, least = (0, 0, 0, 0), 0, mpmath.mpf(10) ** -DIGITS
        while any(abs(part) > least for part in term):
            end = tuple(total + part for total, part in zip(end, term))
            k += 1
            w, psi, bending, force = (mpmath.mpf(part) / k for part in term)
            term = (psi + s * force, bending, -force - r * W * psi, -W * w)
        w, psi, bending, force = end
        ends.append((force - W * (m * w + e * psi), bending - W * (e * w + j * psi)))
    return ends[0][0] * ends[1][1] - ends[0][1] * ends[1][0]


def exact_square(near, *beam):
    """The root omega^2 of the characteristic equation next to `near`, which must be good to 1e-4."""
    with mpmath.workdps(DIGITS):
        low, high = (mpmath.mpf(float(near)) * (1 + k * mpmath.mpf("1e-4")) for k in (-1, 1))
        if residual(low, *beam) * residual(high, *beam) > 0:
            raise ValueError(f"no root within 1e-4 of {near}")
        root = mpmath.findroot(
            lambda W: residual(W, *beam),
            (low, high),
            solver="anderson",
            tol=mpmath.mpf(10) ** (-2 * DIGITS),
            verify=False,
        )
        assert low < root < high
        return root

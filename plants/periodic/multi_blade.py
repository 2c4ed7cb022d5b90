"""Multi-blade coordinates: bodies that repeat about an axis seen from the frame that does not turn.

Of N blades at angles psi_b = psi + 2 pi b/N, q_b = a_0 + sum_n (a_nc cos n psi_b + a_ns sin n psi_b) (+ a_N/2 (-1)^b):
q = T(psi) z. A rotor of equal blades on a support that is the same in all directions of the plane, whose linear model
is periodic in q, is constant in z.

Source   Coleman and Feingold 1958; Bir, "Multiblade coordinate transformation and its application to wind turbine
         analysis", 2008
"""

from __future__ import annotations

import numpy as np

from pliant.plants.core.argument_gates import require_count, require_finite, require_number

Array = np.ndarray


def multi_blade(blades: int, angle: float) -> tuple[Array, Array]:
    """T (N, N) and dT/dpsi of N blades, the first at `angle` [rad]: q = T z, z collective, cosine and sine in turn.

    T' T is diagonal: N for the collective (and, of an even number, the alternating) coordinate, N/2 for the others.
    """
    N = require_count("multi_blade", "blades", blades, 1, 1000)
    psi = require_number("multi_blade.angle", angle, unit="rad") + 2 * np.pi * np.arange(N) / N
    columns: list[Array] = [np.ones(N)]
    slopes: list[Array] = [np.zeros(N)]
    for n in range(1, (N - 1) // 2 + 1):
        columns += [np.cos(n * psi), np.sin(n * psi)]
        slopes += [-n * np.sin(n * psi), n * np.cos(n * psi)]
    if N % 2 == 0:
        columns += [(-1.0) ** np.arange(N)]
        slopes += [np.zeros(N)]
    return np.column_stack(columns), np.column_stack(slopes)


def multi_blade_model(M: Array, D: Array, K: Array, blades: int, angle: float, speed: float) -> tuple[Array, ...]:
    """M, D, K (n, n) of M q'' + D q' + K q = 0 whose last `blades` coordinates are one of each blade, in multi-blade
    coordinates at `angle` [rad] and `speed` [rad/s]: the rest stays as it is.

    q = T z, q' = T z' + W T' z, q'' = T z'' + 2 W T' z' + W^2 T'' z; equations are projected with T^-1.
    """
    M = require_finite("multi_blade_model.M", M, (-1, -1))
    n = len(M)
    M, D, K = (require_finite(f"multi_blade_model.{s}", m, (n, n)) for s, m in (("M", M), ("D", D), ("K", K)))
    blades = require_count("multi_blade_model", "blades", blades, 1, n)
    speed = require_number("multi_blade_model.speed", speed, unit="rad/s")
    whole, slope, bend = np.eye(n), np.zeros((n, n)), np.zeros((n, n))
    T, S = multi_blade(blades, angle)
    whole[-blades:, -blades:], slope[-blades:, -blades:] = T, S
    harmonic = [0.0, *(float(h) for h in range(1, (blades - 1) // 2 + 1) for _ in range(2))]
    harmonic += [0.0] * (blades - len(harmonic))
    bend[-blades:, -blades:] = -T * np.array(harmonic) ** 2  # d2T/dpsi2
    left = np.linalg.inv(whole)
    return (
        left @ M @ whole,
        left @ (D @ whole + 2 * speed * M @ slope),
        left @ (K @ whole + speed * D @ slope + speed**2 * M @ bend),
    )

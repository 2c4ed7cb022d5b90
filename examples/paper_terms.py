"""What each elastic effect contributes to the six equations of "Coupled-Nonlinear Elastic Structure"."""

import numpy as np

from pliant.plants import TwoLinkArm, paper_terms

arm = TwoLinkArm.textbook()
x = np.array([-1.2, 0.7, 0.01, -0.002, 0.008, 0.001, 0.9, -1.3, 0.05, 0.02, -0.04, 0.03])
terms = paper_terms(arm, x, [2.0, -1.0])
print("equation        J q''        F q'       Gamma         tau")
for i, q in enumerate(arm.coordinates):
    parts = (terms.J[i] * terms.acceleration[i], terms.F[i] * terms.rate[i], terms.Gamma[i], terms.applied[i])
    print(f"{q.name:8s}" + "".join(f"{part:12.5f}" for part in parts))
print(f"largest residual {np.abs(terms.residual).max():.1e}")

"""A robust gain is one of its model: of a rigid arm with an uncertain motor it is broken by links that bend.

The naive way: the two-link arm of Seiler, Moore, Meissen, Arcak and Packard is rigid, and for every block of a norm of
0.8 on its second torque a disturbance of unit energy moves its joints by at most 0.059 rad at the end of its motion.
What holds: links of E I = 1.3 N m^2 under the same torques and gains move them by more, and no block is needed.
"""

import numpy as np
from finite_horizon_arm import arm, gains, in_its_loop, nominal

from pliant.controllers.robust_analysis.robust_gain import end_gain, shows
from pliant.plants import Trajectory


def test_links_that_bend_leave_the_bound_of_rigid_ones():
    rigid = arm()
    motion = nominal(rigid)
    ltv = rigid.linearize_along(motion)
    K = gains(ltv)
    system = in_its_loop(ltv, K)
    bound = 0.059
    assert shows(system, bound, np.array([[0.652, 0.0912], [0.0912, 25.76]]) * end_gain(system) ** 2, size=0.8)

    bends = arm("stiffened", E=1e8, modes=(1, 1))  # 1.33 N m^2 by a section of 20 mm
    n = bends.nx // 2
    x, wide = np.zeros((len(motion.t), bends.nx)), np.zeros((len(motion.t), 2, bends.nx))
    x[:, :2], x[:, n : n + 2] = motion.x[:, :2], motion.x[:, 2:]
    wide[:, :, :2], wide[:, :, n : n + 2] = K[:, :, :2], K[:, :, 2:]
    along = bends.linearize_along(Trajectory.from_arrays(motion.t, x, motion.u, plant=bends))
    of_bending = end_gain(in_its_loop(along, wide))
    assert of_bending > 1.02 * bound
    assert end_gain(system) < 0.056

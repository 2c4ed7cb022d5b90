"""Adam (Kingma and Ba, "Adam: a method for stochastic optimization", Algorithm 1), with a way back.

Where the cost of a batch rises past WORSE times its running mean, the numbers of the last good batch come back, the
moments are forgotten and steps are half as long; they grow again with every good one. Batches differ: what is compared
with rises by AGAIN each time, so that a batch of easy episodes does not hold the method back for good; and a batch that
is as dear at the last good numbers is a hard one, as where an episode falls whatever the policy does, and no reason to
go back: else one in ten of them would halve the steps until nothing moves.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray
BETA1, BETA2, EPSILON = 0.9, 0.999, 1e-8
WARM = 20  # steps until the full length
WORSE, BETTER = 1.3, 1.05
AGAIN, RECOVERY = 1.1, 1.02
MEMORY, RISE = 0.9, 1.02  # of the running mean of costs: share kept, most that it rises a step
LONGEST = 1.0  # norm of a gradient that is not shortened


@dataclass(eq=False)
class Adam:
    """theta (size,) and what the method remembers of it; all of it is state that a checkpoint keeps."""

    theta: Array
    first: Array
    second: Array
    good: Array  # theta of the last good batch
    count: int = 0  # steps since the moments were forgotten
    scale: float = 1.0
    smooth: float = np.inf  # running mean of costs
    returns: int = 0  # times that it went back

    @classmethod
    def start(cls, theta: Array) -> Adam:
        return cls(theta.copy(), np.zeros_like(theta), np.zeros_like(theta), theta.copy())

    def step(self, cost: float, gradient: Array, rate: float, before: Callable[[], float] | None = None) -> None:
        """Go on from a batch's mean cost and gradient (size,) at theta, with the learning rate `rate`.

        before() is what the same batch costs at `good`, asked where it is dear. None: a dear batch goes back.
        """
        norm = float(np.linalg.norm(gradient))
        if not (np.isfinite(norm) and cost < WORSE * self.smooth):
            if not np.isfinite(self.smooth):
                return
            known = 0.0 if before is None else before()
            if not np.isfinite(known):  # it says nothing of the step
                return
            if not (np.isfinite(norm) and cost < WORSE * known):
                self._return()
                return
        self.smooth = cost if self.smooth == np.inf else min(RISE * self.smooth, MEMORY * self.smooth + 0.1 * cost)
        if cost <= BETTER * self.smooth:
            self.good[:] = self.theta
        self.scale = min(1.0, RECOVERY * self.scale)
        gradient = gradient / max(norm / LONGEST, 1.0)
        self.count += 1
        self.first += (1 - BETA1) * (gradient - self.first)
        self.second += (1 - BETA2) * (gradient**2 - self.second)
        mean = self.first / (1 - BETA1**self.count)
        size = np.sqrt(self.second / (1 - BETA2**self.count))
        self.theta -= self.scale * min(1.0, self.count / WARM) * rate * mean / (size + EPSILON)

    def _return(self) -> None:
        self.theta[:] = self.good
        self.first[:] = self.second[:] = 0.0
        self.count, self.scale, self.returns = 0, self.scale / 2, self.returns + 1
        self.smooth *= AGAIN

    def arrays(self) -> dict[str, Array]:
        return {name: getattr(self, name) for name in ("theta", "first", "second", "good")}

    def words(self) -> dict[str, Any]:
        smooth = None if self.smooth == np.inf else self.smooth
        return {"count": self.count, "scale": self.scale, "smooth": smooth, "returns": self.returns}

    @classmethod
    def again(cls, arrays: dict[str, Array], words: dict[str, Any]) -> Adam:
        """What `arrays` and `words` gave."""
        smooth = np.inf if words["smooth"] is None else float(words["smooth"])
        kept = {name: np.array(arrays[name], dtype=float) for name in ("theta", "first", "second", "good")}
        return cls(
            **kept, count=int(words["count"]), scale=float(words["scale"]), smooth=smooth, returns=int(words["returns"])
        )

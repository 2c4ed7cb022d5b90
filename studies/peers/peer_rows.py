"""What another program gives of a scene: one row a setting, or the reason why there is none."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class PeerRow:
    """Another program at one setting. `failure` says why there are no numbers."""

    peer: str  # the program and its model, such as "Exudyn, beam elements"
    setting: str  # such as "8 elements, step 8.6 ms"
    seconds: float | None = None  # wall time per simulated second, one core
    error: float | None = None  # of the compared outputs, against the chart's reference [the outputs' unit]
    runs: int = 0  # timed runs
    searched: int = 0  # settings tried for this row
    failure: str | None = None

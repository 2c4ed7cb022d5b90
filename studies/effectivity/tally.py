"""What the rows of a study come to: wrong verdicts, ratios of predicted to true error, what stays undecided, costs.

Counted are the scenes whose truth is known to `KNOWN` of the tolerance; the others are told and left out.

    wrong      "met", and the true error of the chosen model is above the tolerance
    false      refused, and a rung's true error is at most half the tolerance
    decided    met and true, or refused where no rung that was tried keeps the tolerance, or where physics itself leaves
               the range in which it holds, which is said, or extension is missing, which the truth of arms lacks
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from statistics import median
from typing import Any

Row = dict[str, Any]
KNOWN = 0.05
WIDE, NARROW = (0.5, 2.0), (0.8, 1.25)


class Tally:
    """Numbers by name, and the seeds behind them."""

    def __init__(self, rows: Sequence[Row]) -> None:
        self.rows = tuple(rows)

    @cached_property
    def crashed(self) -> list[Row]:
        """`choose` itself raised."""
        return [r for r in self.rows if r["failure"]]

    @cached_property
    def known(self) -> list[Row]:
        """Those whose truth is known."""
        done = [r for r in self.rows if not r["failure"] and r["uncertainty"] is not None]
        return [r for r in done if r["uncertainty"] <= KNOWN * r["tolerance"]]

    @cached_property
    def wrong(self) -> list[Row]:
        return [r for r in self.known if r["met"] and not _within(r["true"], r["tolerance"])]

    @cached_property
    def false_refusals(self) -> list[Row]:
        return [r for r in self._refused if _any_within(r, 0.5)]

    @cached_property
    def undecided(self) -> list[Row]:
        """Refused, though a rung keeps the tolerance, and no range is left."""
        return [r for r in self._refused if _any_within(r, 1.0)]

    @cached_property
    def beyond_truth(self) -> list[Row]:
        """Refused for the stretch of an arm's links, which the models that are taken for the truth of arms have not."""
        return [
            r
            for r in self.known
            if not r["met"] and "extension" in r.get("missing", ()) and "stretch" not in r["truth"]
        ]

    @cached_property
    def _refused(self) -> list[Row]:
        return [r for r in self.known if not r["met"] and not _left(r) and r not in self.beyond_truth]

    @cached_property
    def ratios(self) -> list[tuple[str, float]]:
        """(kind, predicted over true) of every rung tried whose true error is above what the truth is known to.

        Infinite where only the prediction is, zero where only the true error is; none where both motions fail.
        """
        found = []
        for row in self.known:
            for rung in row["rungs"]:
                predicted, true = rung["predicted"], rung["true"]
                if (predicted is None and true is None) or (true is not None and true <= row["uncertainty"]):
                    continue
                one = float("inf") if predicted is None else 0.0 if true is None else predicted / true
                found.append((row["kind"], one))
        return found

    def share(self, within: tuple[float, float]) -> float:
        """Of the ratios within these bounds; NaN of none."""
        inside = [within[0] <= one <= within[1] for _, one in self.ratios]
        return sum(inside) / len(inside) if inside else float("nan")

    @cached_property
    def numbers(self) -> dict[str, Any]:
        """By name: counts, shares, costs in runs."""
        n, runs = len(self.known), _costs(self.known, "cpu_chosen")
        finest = _costs(self.known, "cpu_finest")
        decided = n - len(self.wrong) - len(self.undecided)
        return {
            "scenes": len(self.rows),
            "truth known": n,
            "left out": [r["seed"] for r in self.rows if not r["failure"] and r not in self.known],
            "met": sum(r["met"] for r in self.known),
            "wrongly met": [r["seed"] for r in self.wrong],
            "crashed": [r["seed"] for r in self.crashed],
            "false refusals": [r["seed"] for r in self.false_refusals],
            "undecided": [r["seed"] for r in self.undecided],
            "refused for what the truth lacks": [r["seed"] for r in self.beyond_truth],
            "physics out of range": [r["seed"] for r in self.known if not r["met"] and _left(r)],
            "decided": decided / n if n else None,
            "ratios": len(self.ratios),
            "within 0.5 to 2": self.share(WIDE),
            "within 0.8 to 1.25": self.share(NARROW),
            "smallest ratio": min((one for _, one in self.ratios), default=None),
            "largest ratio": max((one for _, one in self.ratios), default=None),
            "median cost in runs of the chosen": median(runs) if runs else None,
            "share below one run of the finest": sum(c < 1 for c in finest) / len(finest) if finest else None,
            "median seconds of choose": median(r["wall"] for r in self.known) if self.known else None,
        }

    @property
    def faulty(self) -> bool:
        """A wrong "met" or a crash."""
        return bool(self.wrong or self.crashed)

    def lines(self) -> list[tuple[str, str]]:
        """(name, number), in words."""
        return [(name, _shown(value)) for name, value in self.numbers.items()]


def _within(error: float | None, bound: float) -> bool:
    return error is not None and error <= bound


def _any_within(row: Row, share: float) -> bool:
    return any(_within(rung["true"], share * row["tolerance"]) for rung in row["rungs"])


def _left(row: Row) -> bool:
    """Refused though a bound keeps the tolerance: physics leaves its own range."""
    return any(_within(rung["bound"], row["tolerance"]) for rung in row["rungs"])


def _costs(rows: Sequence[Row], of: str) -> list[float]:
    return [r["cpu"] / r[of] for r in rows if r[of]]


def _shown(value: Any) -> str:
    if isinstance(value, list):
        return f"{len(value)}" + (f" ({', '.join(map(str, value))})" if value else "")
    return f"{value:.4g}" if isinstance(value, float) else str(value)

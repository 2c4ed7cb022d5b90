"""Comparisons with sources outside the project: asserted, and kept for docs/validation.md."""

import os

import numpy as np

KINDS = ("closed form", "table", "other program", "finer model", "independent arithmetic")
KEPT = {}  # {test: [comparison]}, of this process; `--evidence PATH` writes them


def agrees(found, reference, *, within, of, source, kind, what="", variant="", absolute=False):
    """Assert that `found` is `reference` to within `within`, and keep the largest error that was measured.

    Errors are relative to each number of the reference, or absolute. `of`: the plant or method; `source`: what the
    reference is, with its year where it was published; `kind`: one of KINDS; `what`: the quantity; `variant`: which of
    several variants of a plant or method meets it: they count once.
    """
    assert kind in KINDS, kind
    found, reference = np.asarray(found), np.asarray(reference)
    assert found.shape == reference.shape
    scale = 1.0 if absolute else np.abs(reference)
    error = np.abs(found - reference)
    worst = float(np.max(np.where(error == 0, 0.0, error / np.where(scale == 0, 1e-300, scale)), initial=0.0))
    test = os.environ.get("PYTEST_CURRENT_TEST", "").rpartition(" (")[0]
    told = {"of": of, "what": what, "source": source, "kind": kind, "within": within, "error": worst}
    told |= {"variant": variant} if variant else {}
    KEPT.setdefault(test, []).append(told | {"absolute": absolute, "numbers": int(reference.size)})
    assert worst <= within, f"{of}: {what} off {source} by {worst:.3g}, more than {within:.3g}"

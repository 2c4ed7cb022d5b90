""" "Substructuring Technique": the paper's cantilever."""

import numpy as np
import pytest

from pliant.plants import LargeDeflectionBeam
from pliant.studies.papers.large_beam import chain, exact, released


def test_variants_of_the_papers_cantilever():
    assert chain(3, "chord", 2).nx == 2 * 3 * 2 and exact().nx == 12
    assert (chain(3).beam, chain(3).kinematics) == (LargeDeflectionBeam.textbook().beam, "substructured")


def test_released_from_rest_it_falls():
    """At first every point falls freely but near the clamp: the tip by g t^2 / 2 within 2 %."""
    motion = released(exact(), 0.1)
    assert motion["tip_v"][0] == 0.0
    assert motion["tip_v"][-1] == pytest.approx(-9.8 * 0.1**2 / 2, rel=0.02)
    np.testing.assert_allclose(motion.t, 0.01 * np.arange(11), atol=1e-12)

"""Settings in words."""

from pliant.studies.peers.measure import PROGRAMS
from pliant.studies.peers.programs import Setting, described


def test_described():
    assert described(PROGRAMS[0], Setting(4, 8), 0.02) == "4 elements a link, step 2.5 ms"
    assert described(PROGRAMS[1], Setting(4, 8, "RK4"), 0.02) == "4 hinges a link, step 2.5 ms, RK4"


def test_every_program_offers_settings():
    for program in PROGRAMS:
        assert program.solvers() and len({program.peer for program in PROGRAMS}) == len(PROGRAMS)

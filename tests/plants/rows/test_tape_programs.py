"""The C of tapes: compiled once that pays, and refused where an operation gives other bits than CasADi's does."""

from pliant.plants.rows import instruction_tape, tape_programs
from pliant.plants.rows.tape_programs import COMPILING, Program


def program(source=tape_programs.source, kind="rows"):
    return Program(kind, source, instruction_tape._load, instruction_tape._check)


def test_nothing_is_compiled_before_it_pays(monkeypatch):
    monkeypatch.setattr(tape_programs.compiler, "build", lambda *a: 1 / 0)
    found = program(kind="unknown")
    assert found.at_hand(0.4 * COMPILING) is None
    assert found.at_hand(0.4 * COMPILING) is None
    monkeypatch.setenv("PLIANT_NATIVE", "0")
    assert found.at_hand(COMPILING) is None


def test_c_with_other_numbers_is_refused(monkeypatch):
    monkeypatch.setitem(tape_programs.UNARY, "SQ", "a * a * (1 + 2e-16)")
    assert program().at_hand(2 * COMPILING) is None

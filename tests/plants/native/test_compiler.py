"""The compiler: flags that a user adds come after Pliant's own, and part in the cache what is compiled with them."""

import ctypes
import subprocess

import pytest

from pliant.plants.native import compiler, kernel_loader

pytestmark = pytest.mark.skipif(not kernel_loader.wanted(), reason="PLIANT_NATIVE=0: nothing is compiled")
SOURCE = "int answer(void) { return ANSWER; }\n"


@pytest.fixture
def toolchain(monkeypatch, tmp_path):
    """The toolchain under a value of PLIANT_CFLAGS, on an empty cache."""
    monkeypatch.setenv("PLIANT_CACHE", str(tmp_path / "cache"))
    compiler.toolchain.cache_clear()

    def under(flags):
        monkeypatch.setenv("PLIANT_CFLAGS", flags)
        compiler.toolchain.cache_clear()
        return compiler.toolchain()

    yield under
    compiler.toolchain.cache_clear()


def test_added_flags_are_last_and_enter_the_key(toolchain):
    plain, added = toolchain(""), toolchain("-DANSWER=42 '-DWORDS=two words'")
    assert added.compile_flags == (*plain.compile_flags, "-DANSWER=42", "-DWORDS=two words")
    assert added.link_flags == plain.link_flags
    assert compiler.digest(SOURCE, added) != compiler.digest(SOURCE, plain)
    # What a process remembers for the next one is told apart as well: back without flags, and with others.
    assert toolchain("") == plain and toolchain("-DANSWER=43").compile_flags[-1] == "-DANSWER=43"


def test_added_flags_reach_the_compiler(toolchain, tmp_path):
    toolchain("-DANSWER=42")
    library = tmp_path / "answer.so"
    library.write_bytes(compiler.build(SOURCE))
    assert ctypes.CDLL(str(library)).answer() == 42
    toolchain("")
    with pytest.raises(compiler.CompileError, match="ANSWER"):
        compiler.build(SOURCE)


def test_added_flags_decide_on_the_processor(toolchain):
    """The macros that give target and vector width are those under the added flags."""
    command = compiler.candidates()[0]
    done = subprocess.run([*command, "-march=x86-64", "-E", "-x", "c", "-"], input="", capture_output=True, text=True)
    if done.returncode:
        pytest.skip("no x86-64 compiler")
    plain, oldest = toolchain(""), toolchain("-march=x86-64")
    assert (oldest.width == 128 and oldest.target != plain.target) or plain.width == 128


def test_flags_that_the_compiler_does_not_know_are_named(toolchain):
    with pytest.raises(compiler.CompileError, match="does not take PLIANT_CFLAGS=-no-such-flag"):
        toolchain("-no-such-flag")


def test_the_link_step_has_no_added_flags(toolchain, monkeypatch):
    """-ffast-math there would set flush-to-zero for the whole process."""
    toolchain("-DANSWER=42")
    asked = []
    run = compiler._run
    monkeypatch.setattr(compiler, "_run", lambda *a, **k: asked.append(a) or run(*a, **k))
    compiler.build(SOURCE)
    compiled, linked = asked
    assert "-DANSWER=42" in compiled and "-DANSWER=42" not in linked and "-ffast-math" not in linked

"""The compiler: flags that a user adds, one that hangs, and what an earlier process or another machine left of it."""

import ctypes
import dataclasses
import json
import subprocess
from pathlib import Path

import pytest

from pliant.plants.native import compiler, kernel_cache, kernel_loader
from pliant.plants.toolchain import compiler_process

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


@pytest.mark.campaign
def test_added_flags_are_last_and_enter_the_key(toolchain):
    plain, added = toolchain(""), toolchain("-DANSWER=42 '-DWORDS=two words'")
    assert added.compile_flags == (*plain.compile_flags, "-DANSWER=42", "-DWORDS=two words")
    assert added.link_flags == plain.link_flags
    assert compiler.digest(SOURCE, added) != compiler.digest(SOURCE, plain)
    # What a process remembers for the next one is told apart as well: back without flags, and with others.
    assert toolchain("") == plain and toolchain("-DANSWER=43").compile_flags[-1] == "-DANSWER=43"


@pytest.mark.campaign
def test_added_flags_reach_the_compiler(toolchain, tmp_path):
    toolchain("-DANSWER=42")
    library = tmp_path / "answer.so"
    library.write_bytes(compiler.build(SOURCE))
    assert ctypes.CDLL(str(library)).answer() == 42
    toolchain("")
    with pytest.raises(compiler.CompileError, match="ANSWER"):
        compiler.build(SOURCE)


@pytest.mark.campaign
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


@pytest.mark.parametrize("flags", ["-fsyntax-only", "--version", "--help"])
def test_flags_under_which_nothing_is_compiled_are_named(toolchain, flags):
    """The compiler ends with status 0, and leaves no object: an earlier one was once taken for it."""
    with pytest.raises(compiler.CompileError, match=flags):
        toolchain(flags)


def test_the_link_step_has_no_added_flags(toolchain, monkeypatch):
    """-ffast-math there would set flush-to-zero for the whole process."""
    toolchain("-DANSWER=42")
    asked = []
    run = compiler._run
    monkeypatch.setattr(compiler, "_run", lambda *a, **k: asked.append(a) or run(*a, **k))
    compiler.build(SOURCE)
    compiled, linked = asked
    assert "-DANSWER=42" in compiled and "-DANSWER=42" not in linked and "-ffast-math" not in linked


HANGS = '#!/bin/sh\necho asked >> {count}\ncase "$*" in *{on}*) exec sleep 30 ;; *) exec {real} "$@" ;; esac\n'


@pytest.fixture
def hanging(monkeypatch, tmp_path):
    """A compiler that hangs where `on` is among its arguments, given up after a second; how often it was started."""
    monkeypatch.setenv("PLIANT_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("PLIANT_CFLAGS", "")
    monkeypatch.setattr(compiler, "TIMEOUT", 1.0)
    monkeypatch.setattr(compiler, "ANSWER", 1.0)
    command, count = tmp_path / "slow-cc", tmp_path / "count"
    real = compiler.candidates()[0][0]

    def made(on):
        command.write_text(HANGS.format(count=count, on=on, real=real))
        command.chmod(0o755)
        monkeypatch.setenv("CC", str(command))
        again()
        return lambda: len(count.read_text().split()) if count.exists() else 0

    def again():
        """As a new process has it."""
        compiler.toolchain.cache_clear()
        compiler._memories.clear()

    yield made, again
    compiler.toolchain.cache_clear()


def test_a_compiler_that_hangs_is_asked_once_also_by_the_next_process(hanging, tmp_path):
    made, again = hanging
    started = made("version")
    for _ in range(3):
        with pytest.raises(compiler.NoCompiler, match=r"CC=.*slow-cc: .* took more than 1 s"):
            compiler.toolchain()
    again()
    with pytest.raises(compiler.NoCompiler, match="asked again an hour later"):
        compiler.toolchain()
    assert started() == 1
    (tmp_path / "slow-cc").write_text((tmp_path / "slow-cc").read_text().replace("version", "nothing"))
    assert compiler.toolchain().width >= 64  # a repaired one is found at once


def test_a_time_out_is_forgotten_after_an_hour(hanging, monkeypatch):
    made, again = hanging
    started = made("version")
    with pytest.raises(compiler.NoCompiler):
        compiler.toolchain()
    again()
    later = compiler.time.time() + compiler.REMEMBERED + 1
    monkeypatch.setattr(compiler.time, "time", lambda: later)
    with pytest.raises(compiler.NoCompiler):
        compiler.toolchain()
    assert started() == 2


def test_a_compiler_that_hangs_on_kernels_alone_is_given_up_for_all_of_them(hanging):
    """Its probes pass; the second source waits no longer, nor does the next process."""
    made, again = hanging
    started, before = made("kernel.c"), 0
    for number in range(3):
        with pytest.raises(compiler.CompileError, match="took more than 1 s"):
            compiler.build(f"int answer(void) {{ return {number}; }}\n")
        before = before or started()
        assert started() == before
    again()
    with pytest.raises(compiler.CompileError, match="took more than 1 s"):
        compiler.build(SOURCE)
    assert started() == before


def test_one_source_that_takes_too_long_stops_no_shorter_ones(monkeypatch, tmp_path):
    monkeypatch.setenv("PLIANT_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(compiler, "_memories", {})
    run = compiler._run

    def limited(command, *args, **options):
        if "kernel.c" in " ".join(args) and "long" in next(Path(a) for a in args if a.endswith(".c")).read_text():
            raise compiler.CompilerTimeout("cc took more than 1 s")
        return run(command, *args, **options)

    compiler.toolchain.cache_clear()
    monkeypatch.setattr(compiler, "_run", limited)
    source = "/* long " + 1400 * "." + "*/\n" + SOURCE.replace("ANSWER", "1")
    for _ in range(2):
        with pytest.raises(compiler.CompileError, match=r"took more than 1 s for 1 kB of C"):
            compiler.build(source)
    with pytest.raises(compiler.CompileError, match="took more than"):
        compiler.build(source[: len(source) * 3 // 4])  # more than half as long
    assert compiler.build(SOURCE.replace("ANSWER", "1"))
    assert compiler.build(source.replace("long", "else"), ("-O0",))  # as long, but quickly compiled
    compiler.toolchain.cache_clear()


FOREIGN = {
    "truncated": lambda text: text[: len(text) // 2],
    "a list": lambda text: "[1, 2]",
    "a string": lambda text: '"gcc"',
    "no text": lambda text: "\udcff",
    "another field": lambda text: text.replace('"width"', '"breadth"'),
    "another flag": lambda text: text.replace('"-fPIC"', '"-fplugin=/tmp/other.so"'),
    "another compiler": lambda text: text.replace(json.loads(text)["command"][0], "/opt/elsewhere/cc"),
    "another machine": lambda text: text.replace('"-fopenmp-simd"', '"-mcpu=other"'),
}


def test_a_toolchain_file_that_is_not_ours_is_written_anew(toolchain, monkeypatch):
    right = toolchain("")
    (path,) = [p for p in kernel_cache.entries() if p.name.startswith("toolchain")]
    text = kernel_cache.read_text(path.name)
    probed = []
    monkeypatch.setattr(compiler, "_probe", lambda command: probed.append(command) or right)
    for count, (what, change) in enumerate(FOREIGN.items(), start=1):
        assert change(text) != text
        kernel_cache.write(path.name, change(text).encode("utf-8", "surrogateescape"))
        assert toolchain("") == right and len(probed) == count, what
        assert json.loads(kernel_cache.read_text(path.name)) == json.loads(text)


@pytest.mark.campaign
def test_flags_that_no_longer_serve_are_found_anew(toolchain, monkeypatch):
    """A compiler that lost a feature under the same file: its stored flags fail, and it is asked for others."""
    plain = toolchain("")
    monkeypatch.setattr(compiler, "OPTIONAL", (*compiler.OPTIONAL, "-flost"))
    stale = dataclasses.replace(plain, compile_flags=(*plain.compile_flags, "-flost"))
    kernel_cache.write(compiler._toolchain_file(plain.command), json.dumps(dataclasses.asdict(stale)).encode())
    compiler.toolchain.cache_clear()
    assert compiler.toolchain() == stale
    assert compiler.build("int one(void) { return 1; }\n")
    assert "-flost" not in compiler.toolchain().compile_flags


@pytest.mark.parametrize(("name", "value"), [("CC", "  "), ("CC", 'gcc "'), ("PLIANT_CFLAGS", "-O1 'x")])
def test_nonsense_in_the_environment_is_an_error_that_names_it(toolchain, monkeypatch, name, value):
    monkeypatch.setenv(name, value)
    with pytest.raises(compiler_process.CompilerSettingError, match=f"{name}="):
        toolchain(value if name == "PLIANT_CFLAGS" else "")


@pytest.mark.every(2)
@pytest.mark.parametrize("left", [None, b"", b"Segmentation fault", "half"])
def test_what_a_compiler_leaves_is_looked_at(toolchain, monkeypatch, left):
    """It ends with status 0 and wrote nothing, something else or half a library, which would end the process."""
    tools, run = toolchain("-DANSWER=42"), compiler._run

    def spoilt(command, *args, **options):
        done = run(command, *args, **options)
        if "-shared" in args:
            made = Path(args[args.index("-o") + 1])
            whole = made.read_bytes()
            made.unlink() if left is None else made.write_bytes(whole[: len(whole) // 2] if left == "half" else left)
        return done

    monkeypatch.setattr(compiler, "_run", spoilt)
    with pytest.raises(compiler.CompileError, match="wrote"):
        compiler._built(tools, SOURCE)
    with pytest.raises(compiler.CompileError, match="wrote"):  # nor is it taken for one that works
        compiler._probe(tools.command)


def test_a_compiler_that_does_nothing_is_none(monkeypatch, tmp_path):
    monkeypatch.setattr(compiler, "_run", lambda *a, **k: subprocess.CompletedProcess(a, 0, "", ""))
    with pytest.raises(compiler.CompileError, match="small C file"):
        compiler._probe(("true",))


def test_a_compiler_that_takes_too_long_is_given_up(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    slow = tmp_path / "slow-cc"
    slow.write_text("#!/bin/sh\nsleep 20\n")
    slow.chmod(0o755)
    monkeypatch.setattr(compiler, "TIMEOUT", 0.2)
    with pytest.raises(compiler.CompileError, match="took more than"):
        compiler._run((str(slow),), "--version")


def test_the_longest_sources_are_compiled_in_fewer_passes_and_added_flags_stay_last(monkeypatch):
    """A fifth of the time of eight megabytes, linearly implicit steps of a strain beam of 14 coordinates."""
    monkeypatch.setenv("PLIANT_CFLAGS", "-DOWN")
    tools = compiler.Toolchain(("cc",), "cc", "", 512, ("-O2", "-DOWN"), ())
    short, long, longest = (compiler._flags_for(" " * n, tools) for n in (10, 200_000, 4_000_001))
    assert short == ("-O2", "-DOWN")
    assert long == ("-O2", *compiler.QUICK, "-DOWN")
    assert longest[: len(long) - 1] == long[:-1] and longest[-1] == "-DOWN" and "-fno-tree-reassoc" in longest
    clang = compiler.Toolchain(("cc",), "cc", "", 512, (*compiler.CLANG, "-DOWN"), ())
    assert compiler._flags_for(" " * 200_000, clang) == clang.compile_flags
    assert compiler._flags_for(" " * 4_000_001, clang) == (*compiler.CLANG, "-O1", "-DOWN")

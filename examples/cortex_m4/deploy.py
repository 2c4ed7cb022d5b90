"""A controller of a scene on a Cortex-M4F under qemu: the same inputs as here, how large it is, how long it takes.

    python examples/cortex_m4/deploy.py [--scene two-link-reach] [--law mpc] [--folder FOLDER]

It exports the controller in single precision, records its readings in a closed loop here, builds both with `startup.c`,
`main.c` and `cortex_m4.ld` by arm-none-eabi-gcc, runs them on qemu's MPS2 board with a Cortex-M4, and compares. qemu
counts instructions, not cycles: a Cortex-M4 takes one cycle or more for each.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pliant.controllers import LQG, LQR, MPC, PD, ComputedTorque, Policy, export_c
from pliant.envs import scenes

HERE = Path(__file__).parent
TOOLS = {  # programs and the packages that they are in
    "arm-none-eabi-gcc": ("gcc-arm-none-eabi", "libnewlib-arm-none-eabi"),
    "qemu-system-arm": ("qemu-system-arm",),
}
CPU = ("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16")
STRICT = ("-Wall", "-Wextra", "-Werror", "-O2", "-ffunction-sections", "-fdata-sections")
OWN = (
    "-std=c99",
    "-pedantic",
    "-fno-math-errno",
    "-fstack-usage",
)  # of the exported file; a square root is one instruction
SHIFT = 6  # of -icount: an instruction takes 2^6 ns
TICKS = 2**SHIFT * 25e6 / 1e9  # of the board's timer, 25 MHz, in an instruction
LOOP = 20_000  # instructions of main.c's known loop
PERIODS = 100
LAWS = {
    "mpc": lambda scene: MPC.for_scene(scene),
    "mpc-blocks": lambda scene: MPC.for_scene(scene, blocks=(1, 1, 2, 4, 12)),
    "mpc-track": lambda scene: MPC.for_scene(scene, track=("theta1", "theta2")),
    "lqr": lambda scene: LQR.for_scene(scene),
    "lqg": lambda scene: LQG.for_scene(scene),
    "pd": lambda scene: PD.for_scene(scene),
    "computed-torque": lambda scene: ComputedTorque.for_scene(scene),
    "policy": lambda scene: Policy.for_scene(scene.name),
}


@dataclass(frozen=True)
class Run:
    """What a controller did on the target."""

    u: np.ndarray  # (periods, nu)
    instructions: np.ndarray  # (periods,) of each act
    known: float  # instructions counted in the loop of LOOP
    code: int  # [bytes] of the controller's instructions and constants, in flash
    state: int  # [bytes] of its state, in RAM
    stack: int  # [bytes] the most that one of its functions takes


def missing() -> str:
    """What to install, in words; nothing where all is there."""
    lacks = [package for program, packages in TOOLS.items() if not shutil.which(program) for package in packages]
    return f"not here: {', '.join(lacks)}; on Debian: apt-get install {' '.join(lacks)}" if lacks else ""


def recorded(scene, law, periods: int) -> tuple[np.ndarray, np.ndarray]:
    """Readings (periods, n) and inputs (periods, nu) of a closed loop here."""
    law.reset()
    motion = scene.plant.simulate(scene.initial[0], law, np.arange(periods + 1) * scene.dt)
    readings = np.stack([motion[name] for name in law.reads], axis=1)[:periods]
    law.reset()
    return readings, np.array([law.act(k * scene.dt, y) for k, y in enumerate(readings)])


def built(folder: Path, law, readings: np.ndarray, nu: int) -> Path:
    """The program for the target."""
    export_c(law, folder / "law.c", precision="single")
    rows = ",\n    ".join(", ".join(f"{float(np.float32(v))!r}f" for v in row) for row in readings)
    count, n = readings.shape
    (folder / "readings.h").write_text(
        f"enum {{ PERIODS = {count}, READS = {n}, INPUTS = {nu} }};\n#define PERIOD {law.dt!r}\n"
        f"static const law_real readings[PERIODS * READS] = {{\n    {rows}\n}};\n"
    )
    for name in ("startup.c", "main.c"):
        flags = (*CPU, *STRICT, "-std=gnu99", "-ffreestanding", f"-I{folder}")
        _called("arm-none-eabi-gcc", *flags, "-c", HERE / name, "-o", folder / f"{name}.o")
    _called("arm-none-eabi-gcc", *CPU, *STRICT, *OWN, "-c", folder / "law.c", "-o", folder / "law.o")
    objects = [folder / f"{name}.o" for name in ("startup.c", "main.c")] + [folder / "law.o"]
    link = (*CPU, "-nostartfiles", f"-T{HERE / 'cortex_m4.ld'}", "-Wl,--gc-sections")
    _called("arm-none-eabi-gcc", *link, *objects, "-lm", "-lc", "-o", folder / "law.elf")
    return folder / "law.elf"


def played(folder: Path, nu: int) -> Run:
    """What the program says under qemu."""
    board = ("-machine", "mps2-an386", "-nographic", "-monitor", "none", "-serial", "none")
    says = (
        "-semihosting-config",
        "enable=on,target=native",
        "-icount",
        f"shift={SHIFT}",
        "-kernel",
        folder / "law.elf",
    )
    done = subprocess.run(["qemu-system-arm", *board, *says], capture_output=True, text=True, timeout=300)
    lines = [line.split() for line in (done.stdout + done.stderr).splitlines() if line.strip()]
    if done.returncode or any(len(line) != nu + 1 for line in lines[1:]):
        raise SystemExit(f"qemu-system-arm failed: {done.stdout[-200:]} {done.stderr[-500:]}")
    words = np.array([[int(word, 16) for word in line] for line in lines[1:]], dtype=np.uint32)
    around = int(lines[0][1], 16)
    code, state, stack = sizes(folder)
    counted = (words[:, -1].astype(float) - around) / TICKS
    return Run(
        words[:, :-1].copy().view(np.float32).astype(float),
        counted,
        (int(lines[0][0], 16) - around) / TICKS,
        code,
        state,
        stack,
    )


def sizes(folder: Path) -> tuple[int, int, int]:
    """[bytes] of law.o's text and constants, of its state, and of its functions' largest frame."""
    text, data = _called("arm-none-eabi-size", folder / "law.o").splitlines()[1].split()[:2]
    table = _called("arm-none-eabi-nm", "--print-size", folder / "main.c.o")
    state = next(int(line.split()[1], 16) for line in table.splitlines() if line.endswith(" state"))
    frames = [int(line.split()[1]) for line in (folder / "law.su").read_text().splitlines()]
    return int(text) + int(data), state, max(frames)


def _called(*command) -> str:
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=300)
    if done.returncode:
        raise SystemExit(f"{command[0]} failed:\n{done.stderr}")
    return done.stdout


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--scene", default="two-link-reach")
    arguments.add_argument("--law", default="mpc", choices=sorted(LAWS))
    arguments.add_argument("--folder", type=Path, default=None, help="where the files stay; none: nowhere")
    given = arguments.parse_args()
    if words := missing():
        raise SystemExit(words)
    scene = scenes.get(given.scene)
    law = LAWS[given.law](scene)
    readings, wanted = recorded(scene, law, PERIODS)
    with tempfile.TemporaryDirectory() as temporary:
        folder = given.folder or Path(temporary)
        folder.mkdir(exist_ok=True)
        built(folder, law, readings, wanted.shape[1])
        run = played(folder, wanted.shape[1])
    off = np.abs(run.u - wanted).max(axis=0) / np.abs(wanted).max(axis=0)
    print(f"{given.law} of {scene.name} on a Cortex-M4F, single precision, {PERIODS} periods of {law.dt} s")
    print(f"inputs: within {off.max():.1e} of the largest here")
    if isinstance(law, MPC):
        print(f"programs solved: {law.record.limited}, of which failed: {law.record.failures}")
    print(f"size: {run.code:,} bytes of flash, {run.state:,} of RAM, frames up to {run.stack:,} of stack")
    print(f"counted in a loop of {LOOP:,} instructions: {run.known:,.0f}")
    least, median, most = run.instructions.min(), np.median(run.instructions), run.instructions.max()
    print(f"instructions of an act: {least:,.0f} at least, {median:,.0f} in the median, {most:,.0f} at most")
    print(f"the longest at 168 MHz, were each instruction one cycle: {most / 168e6 * 1e3:.2f} ms")


if __name__ == "__main__":
    main()

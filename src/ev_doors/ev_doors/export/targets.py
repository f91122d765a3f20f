"""Targets of exports, and the C compiler of each."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ev_core.compiling import other_processors
from ev_core.compiling.other_processors import Processor
from ev_msgs_py.refusal import ParameterError, unknown_name

# Products are never fused with sums, so the bits are those of every other compiler. What copies and
# fills memory is written as loops, and stays so.
OPTIONS = (
    "-std=c99",
    "-O2",
    "-ffp-contract=off",
    "-ffreestanding",
    "-fno-tree-loop-distribute-patterns",
    "-fPIC",
    "-Wall",
)


@dataclass(frozen=True)
class Target:
    """A processor with its system, its C compiler and that one's `options`; `package` is Debian's.

    Programs are linked with `linking`: on Linux all functions are found at the start, so that no
    step looks for one. `emulator` runs its programs here. A `board` has no system: a program there
    brings its own start and memory map.
    """

    name: str
    about: str
    processor: Processor
    prefix: str
    package: str
    options: tuple[str, ...] = ()
    linking: tuple[str, ...] = ("-Wl,-z,now",)
    system: str = "Linux"
    emulator: tuple[str, ...] = ()
    board: bool = False

    @property
    def compiler(self) -> str:
        """The name of the C compiler."""
        return f"{self.prefix}gcc"

    def refuse_missing_compiler(self) -> None:
        """ParameterError, in one line, if the compiler is not installed."""
        if not shutil.which(self.compiler):
            raise ParameterError(
                f"target {self.name}: {self.compiler} is not installed; Debian has it in"
                f" {self.package}"
            )

    def compiled(self, source: Path, options: Sequence[str] = OPTIONS) -> Path:
        """The object file of a C source, beside it."""
        made = source.with_suffix(".o")
        self._call(self.compiler, *self.options, *options, "-c", source, "-o", made)
        return made

    def program(
        self, sources: Sequence[Path], made: Path, options: Sequence[str] = ("-O2",)
    ) -> Path:
        """A program, or with other options a shared library, of sources, objects and libraries."""
        self._call(self.compiler, *self.options, *options, *sources, "-o", made, "-lm")
        return made

    def archive(self, objects: Sequence[Path], made: Path) -> Path:
        """A static library; the same objects give the same bytes."""
        self._call(f"{self.prefix}ar", "rcsD", made, *objects)
        return made

    def _call(self, *words: str | Path) -> None:
        done = subprocess.run(
            [str(word) for word in words], capture_output=True, text=True, check=False
        )
        if done.returncode:
            lines = done.stderr.splitlines() or ["failed"]
            # Warnings and the place of an include come before the error.
            line = next((line for line in lines if "error" in line), lines[0])
            raise ParameterError(f"target {self.name}: {words[0]}: {line}")


TARGETS = {
    target.name: target
    for target in (
        Target(
            "x86_64-linux", "x86-64 with SSE 4.2, Linux", other_processors.X86_64_LINUX, "", "gcc"
        ),
        Target(
            "x86_64-windows",
            "x86-64 with SSE 4.2, Windows",
            other_processors.X86_64_WINDOWS,
            "x86_64-w64-mingw32-",
            "gcc-mingw-w64-x86-64",
            linking=("-static", "-pthread"),  # which has the clock
            system="Windows",
        ),
        Target(
            "aarch64-linux",
            "64-bit Arm, Linux",
            other_processors.AARCH64_LINUX,
            "aarch64-linux-gnu-",
            "gcc-aarch64-linux-gnu",
            emulator=("qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"),
        ),
        Target(
            "arm-linux",
            "32-bit Arm (ARMv7 with VFPv4, hard float), Linux",
            other_processors.ARM_LINUX,
            "arm-linux-gnueabihf-",
            "gcc-arm-linux-gnueabihf",
            emulator=("qemu-arm", "-L", "/usr/arm-linux-gnueabihf"),
        ),
        Target(
            "thumbv7em",
            "Cortex-M4F and M7 (hard float) without operating system",
            other_processors.CORTEX_M4,
            "arm-none-eabi-",
            "gcc-arm-none-eabi",
            ("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"),
            linking=("--specs=rdimon.specs", "-nostartfiles"),
            system="Generic",
            emulator=(
                *(
                    "qemu-system-arm",
                    "-M",
                    "mps2-an386",
                    "-nographic",
                    "-monitor",
                    "none",
                    "-serial",
                    "none",
                ),
                *(
                    "-semihosting-config",
                    "enable=on,target=native",
                    "-icount",
                    "shift=10",
                    "-kernel",
                ),
            ),
            board=True,
        ),
    )
}


def target_of(name: str) -> Target:
    """A target by its name; ParameterError that lists them, or if its compiler is not installed."""
    if name not in TARGETS:
        raise unknown_name("target", name, TARGETS)
    TARGETS[name].refuse_missing_compiler()
    return TARGETS[name]

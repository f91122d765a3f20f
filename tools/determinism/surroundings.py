"""What may differ from machine to machine and from call to call, drawn by seed."""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

WAYS = ("offline", "in one process", "as processes")

NO_FMA = "glibc.cpu.hwcaps=-AVX2_Usable,-FMA_Usable,-AVX2,-FMA"
COMPILERS = {
    "this processor": {},
    "any x86-64 processor": {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""},
    "without optimisation": {"NUMBA_OPT": "0"},
}
C_LIBRARIES = {"as it is": {}, "without FMA and AVX2": {"GLIBC_TUNABLES": NO_FMA}}
LOCALES = ("C", "C.UTF-8", "de_DE.UTF-8", "tr_TR.UTF-8", "POSIX")
THREADS = (1, 2, 8)


@dataclass(frozen=True, slots=True)
class Surroundings:
    """Where and how one trial is driven."""

    way: str
    compiler: str
    c_library: str
    busy: bool  # whether all cores have other work
    variables: Mapping[str, str]

    @property
    def environment(self) -> dict[str, str]:
        """The variables of its process."""
        return {**self.variables, **COMPILERS[self.compiler], **C_LIBRARIES[self.c_library]}


def drawn(trial: int, seed: int) -> Surroundings:
    """Those of a trial; ways, compilers, C libraries and load take turns, so that a few trials meet all of them.

    Two of three trials keep the compiler of this machine: another one has to compile all methods of
    a scenario first.
    """
    chance = random.Random(f"{seed} {trial}")
    own, *foreign = COMPILERS
    c_libraries = list(C_LIBRARIES)
    compiler = (
        foreign[trial // len(WAYS) % len(foreign)] if (trial + trial // len(WAYS)) % 3 == 2 else own
    )
    variables = {
        "PYTHONHASHSEED": str(chance.randrange(2**32)),
        "LC_ALL": chance.choice(LOCALES),
        "TZ": chance.choice(("UTC", "Asia/Kathmandu", "America/St_Johns")),
        **dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"), str(chance.choice(THREADS))),
        "NUMBA_NUM_THREADS": str(chance.choice((1, 2))),
    }
    return Surroundings(
        WAYS[trial % len(WAYS)],
        compiler,
        c_libraries[trial // 2 % len(c_libraries)],
        busy=trial % 4 == 3,
        variables=MappingProxyType(variables),
    )

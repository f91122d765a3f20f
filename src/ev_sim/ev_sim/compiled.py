"""How every numerical function of the simulation is compiled, and where the compiled code is kept."""

import hashlib
from pathlib import Path

from numba import config, njit


def _cache_directory() -> Path:
    """A folder of its own for each state of the compiled sources.

    numba keeps a compiled function until its own file changes; that a function it calls has changed in another file
    goes unnoticed, and the old numbers would come back.
    """
    package = Path(__file__).parent
    digest = hashlib.sha256()
    for source in sorted(package.rglob("*.py")):
        text = source.read_bytes()
        if b"ev_sim.compiled" in text:
            digest.update(text)
    return package / "__pycache__" / f"compiled-{digest.hexdigest()[:12]}"


if not config.CACHE_DIR:
    config.CACHE_DIR = str(_cache_directory())

# Compiled code is kept on disk. Division by zero gives infinity as in numpy, without a test at each division; sums
# keep the order in which they are written (no fastmath), so results are the same to the bit in every run.
compiled = njit(cache=True, error_model="numpy")

"""Tests that a script runs in the background, where a shell has interrupts ignored."""

import signal
import subprocess
import sys
from pathlib import Path

TESTS = Path(__file__).parents[2]


def test_an_interrupt_ends_what_tests_in_the_background_have_started():
    """A process ignores what its parent ignores: without `conftest` a child would live on."""
    code = (
        "import signal, subprocess, sys; signal.signal(signal.SIGINT, signal.SIG_IGN); import conftest; "
        "child = 'import signal; signal.raise_signal(signal.SIGINT)'; "
        "print(subprocess.run([sys.executable, '-c', child], stderr=subprocess.DEVNULL).returncode)"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=TESTS, capture_output=True, text=True)
    assert done.stdout.split() == [str(-signal.SIGINT)], done.stderr

"""Threads of the linear algebra, in a process of its own: the first thread that sets their number is its master."""

import subprocess
import sys
from pathlib import Path


def test_set_ups_have_one_thread_and_programs_keep_theirs():
    checks = Path(__file__).with_name("threads_alone.py")
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:xdist", "-p", "no:cacheprovider", str(checks)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=checks.parents[3])
    assert done.returncode == 0, done.stdout
    assert "2 passed" in done.stdout or "skipped" in done.stdout

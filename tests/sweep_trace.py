"""Templates that tell on what they are asked for; a module of its own, so that other processes find it."""

import os
import signal
from pathlib import Path

from ltcgear.symbolic import Template


class Traced(Template):
    """Notes each model that is made: the process and the changes, in a file that all processes append to.

    Where one change has the value ``deadly``, the process gets a signal; ``times`` says how often at most.
    """

    def __init__(self, trace, name, changes=None, deadly=None, times=99, by=signal.SIGKILL):
        super().__init__(name, changes)
        self.by = by
        self.trace, self.deadly, self.times_killed = trace, deadly, times
        self.home = os.getpid()

    def make(self, changes):
        with Path(self.trace).open("a") as file:
            file.write(f"{os.getpid()} {sorted(changes.items())}\n")
        if self.deadly in changes.values() and os.getpid() != self.home and self._count(changes) <= self.times_killed:
            os.kill(os.getpid(), self.by)
        return super().make(changes)

    def _count(self, changes):
        return sum(text == str(sorted(changes.items())) for _, text in self.made())

    def made(self):
        """Return processes and changes, without those of the process that leads."""
        lines = [line.split(" ", 1) for line in Path(self.trace).read_text().splitlines()]
        return [(int(pid), text) for pid, text in lines if int(pid) != self.home]


if __name__ == "__main__":
    import sys

    from ltcgear.runtime import sweep

    trace, target, *vary = sys.argv[1:]
    sweep(Traced(trace, "lsp"), vary, target, sample="lhs", points=60, t_end=0.05, workers=2)

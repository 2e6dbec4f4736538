"""Exceptions of ltcgear, under one base; each carries the exit code of the command line."""


class LtcgearError(Exception):
    """Base of every error that ltcgear raises on purpose.

    The message is written for the user: what, where, why and what to do about it.
    """

    exit_code = 2


class SceneError(LtcgearError):
    """A scene cannot be used.

    Likely causes: a misspelt key, a unit that does not fit, teeth that cannot mesh, a train
    whose speeds contradict each other. The message lists every defect that was found.
    """


class CheckError(LtcgearError):
    """A check of the equations did not pass; the model must not be trusted."""

    exit_code = 1


class MachineError(LtcgearError):
    """The machine, not the model: a store, a disk, a memory or a program that cannot be used.

    Every other model would meet the same, so that a sweep stops at it in place of going on without the row.
    """


class CompileError(MachineError):
    """The C compiler cannot be used or refused generated code; the message names the log."""

    exit_code = 3


class SolverError(LtcgearError):
    """No equilibrium or no solution was found.

    Likely causes: an unrestrained member under load, a centre distance below the base-circle
    sum, a tolerance that cannot be met.
    """

    exit_code = 3

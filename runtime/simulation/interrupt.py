"""Interrupt: Ctrl-C ends an integration between two segments, where its state is whole."""

import signal
from threading import current_thread, main_thread
from types import FrameType, TracebackType


class Interrupt:
    """While it is held, the first Ctrl-C only sets ``pulled``; the second interrupts at once.

    Where Ctrl-C means something else to the program at hand, or in another thread, nothing is changed.
    """

    def __init__(self) -> None:
        self.pulled = False
        self._armed = False

    def __enter__(self) -> "Interrupt":
        """Take Ctrl-C over."""
        plain = signal.getsignal(signal.SIGINT) is signal.default_int_handler
        if plain and current_thread() is main_thread():
            signal.signal(signal.SIGINT, self._pull)
            self._armed = True
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        """Give Ctrl-C back."""
        self._release()

    def _pull(self, number: int, frame: FrameType | None) -> None:
        self.pulled = True
        self._release()

    def _release(self) -> None:
        if self._armed:
            signal.signal(signal.SIGINT, signal.default_int_handler)
            self._armed = False

"""Peers: the same physics by other tools, checked against ours, then timed beside it, all on one core."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # read where NumPy is first imported

r"""Printed equations of Wu et al. 2021, misprints included.

One representative planet stands for the sum over i. A prime is a time derivative, so ``d_PS'`` is the
printed :math:`\dot d_{PS}^i`. Every row is kept as term groups whose sum is lhs - rhs = 0; products with a
bracket are written out, nothing else is rearranged. Indices mixed by the paper stay mixed.

The source is a machine-read text of the paper. Two readings are marked here because a reader of the
journal's page may see more: the torque rows 32, 34, 37 have a centre distance where its rate belongs (a
dot may have been lost in reading), and row 32 repeats that factor six times (read once).
"""

from .balances import BALANCES
from .printed_laws import EXACT, LAWS
from .printed_row import RIGHT, Row, evaluate, text
from .slips import MEANING, Edit, edits, exchange

ROWS: tuple[Row, ...] = (*LAWS, *BALANCES)
"""All printed rows, by equation."""

__all__ = ["EXACT", "MEANING", "RIGHT", "ROWS", "Edit", "Row", "edits", "evaluate", "exchange", "text"]

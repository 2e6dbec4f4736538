"""All checks of one model, in a fixed order, shown by ``ltcgear check SCENE``."""

from ..mechanics.equations import derive
from ..mechanics.model import Model
from .agree import agreement
from .check import Check
from .identity import identities
from .physics import physics


def check_model(model: Model) -> tuple[Check, ...]:
    """Run every check of a model.

    Parameters
    ----------
    model
        The model.

    Returns
    -------
    tuple of Check
        Symbolic proofs first (elements, stages), then the routes to one right-hand side, then the laws of
        physics of each element type.
    """
    return (*identities(model), *agreement(model, derive(model)), *physics(model))

"""Selection of outputs named QUANTITY or QUANTITY:ITEM."""

from difflib import get_close_matches
from typing import TYPE_CHECKING

from ltcgear.generated.errors import LtcgearError

if TYPE_CHECKING:
    import xarray as xr


def split_output(output: str) -> tuple[str, str]:
    """Return quantity and item of QUANTITY:ITEM; the item is ``""`` where none is named."""
    quantity, _, item = output.partition(":")
    return quantity, item


def find_columns(dataset: "xr.Dataset", wanted: list[str], option: str = "--output ") -> dict[str, list[str] | None]:
    """Return quantity -> items that are wanted of it; None if it is wanted as a whole, or has no items.

    Parameters
    ----------
    dataset
        A result's data.
    wanted
        QUANTITY or QUANTITY:ITEM each.
    option
        Prefix of a refused output, as the user gave it.

    Raises
    ------
    LtcgearError
        If there is no such quantity or item; the nearest is named.
    """
    found: dict[str, list[str] | None] = {}
    for output in wanted:
        quantity, item = split_output(output)
        items = _items(dataset, option + output, quantity)
        if item and item not in items:
            raise LtcgearError(f"{option}{output}: {quantity} has no such item; {nearest(item, items)}")
        if not item:
            found[quantity] = None
        elif (others := found.setdefault(quantity, [])) is not None and item not in others:
            others.append(item)
    return found


def _items(dataset: "xr.Dataset", output: str, quantity: str) -> list[str]:
    """Return the items of a quantity over time; none of one that has no items."""
    known = [str(name) for name, variable in dataset.data_vars.items() if "time" in variable.dims]
    if quantity not in known:
        raise LtcgearError(f"{output}: no such quantity; {nearest(quantity, known)}")
    variable = dataset[quantity]
    dimensions = [name for name in variable.dims if name != "time"]
    return [str(item) for item in variable[dimensions[0]].values] if dimensions else []


def nearest(name: str, known: list[str]) -> str:
    """Say what is meant perhaps, or what there is."""
    near = get_close_matches(name, known, 1)
    return f'did you mean "{near[0]}"?' if near else f"there are {', '.join(known) or 'none'}"

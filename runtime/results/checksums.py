"""Check sums of attributes and of arrays."""

import hashlib
import json
import zlib
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .file_content import FileContent

if TYPE_CHECKING:
    import xarray as xr

SUMS = "attribute_sums"
"""Attribute with the checksums of all others (CRC-32), as JSON; those of a variable are VARIABLE:ATTRIBUTE, and
VARIABLE: is that of the texts that it holds, which NetCDF has no checksums for."""


def list_sums(dataset: "FileContent | xr.Dataset") -> dict[str, str]:
    """Return the attribute with the checksums of all others; what somebody adds to a file later has none."""
    found = {name: _sum(value) for name, value in _list_attributes(dataset) if name != SUMS}
    return {SUMS: json.dumps(found)}


def find_changed(dataset: "xr.Dataset") -> str:
    """Return the first attribute that is not what was written; "" where all are, or none has a checksum."""
    if SUMS not in dataset.attrs:
        return ""
    found = {name: _sum(value) for name, value in _list_attributes(dataset)}
    try:
        known = dict(json.loads(dataset.attrs[SUMS]))
    except (TypeError, ValueError, RecursionError):
        return SUMS
    return next((name for name in known if found.get(name) != known[name]), "")


def _list_attributes(dataset: "FileContent | xr.Dataset") -> Iterator[tuple[str, Any]]:
    """Yield all attributes of a dataset and its variables, and the texts that variables hold."""
    yield from ((str(name), value) for name, value in dataset.attrs.items())
    for variable, data in dataset.variables.items():
        yield from ((f"{variable}:{name}", value) for name, value in data.attrs.items())
        if data.values.dtype.kind in "OSU":
            yield f"{variable}:", "\0".join(map(str, data.values.ravel()))


def _sum(value: Any) -> str:  # noqa: ANN401
    """Return the checksum of an attribute, which NetCDF keeps as text or as a number."""
    text = value if isinstance(value, str) else repr(np.asarray(value).tolist())
    return f"{zlib.crc32(text.encode('utf-8', 'surrogatepass')):08x}"


def digest_arrays(arrays: Mapping[str, Any]) -> str:
    """Return the digest of named arrays: names, types, shapes and content."""
    state = hashlib.sha256()
    for name in sorted(arrays):
        array = np.asarray(arrays[name])
        state.update(f"{name}:{array.dtype.str}:{array.shape}:".encode())
        state.update(np.ascontiguousarray(array).tobytes())
    return state.hexdigest()

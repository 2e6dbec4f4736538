"""Table 9 row by row: printed, predicted without any fit, and after the fit."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ...results.statistics import pressure_angles
from ...results.train_record import read_train
from .comparison import group_cosine, grouped_statistics, published

if TYPE_CHECKING:
    import xarray as xr

MEAN_AIM, FACTOR_AIM = 0.03, 0.10
"""How near to print means and load factors should come."""


def tell_loads(datasets: Mapping[str, "xr.Dataset"], start_s: float) -> list[dict[str, Any]]:
    """Compare the mesh forces of several runs with Table 9.

    Parameters
    ----------
    datasets
        Results of the whole rig by name: assumed, fitted.
    start_s
        First instant that counts [s].

    Returns
    -------
    list of dict
        Per printed row its position, the force's ``component`` that the printed mean is nearer to (of the first
        result), the printed ``mean``, ``amplitude`` [1e5 N] and ``factor``, and under ``rigs`` the same of each result
        with ``mean_off`` and ``factor_off``, relative to print.
    """
    groups = {rig: grouped_statistics(dataset, start_s) for rig, dataset in datasets.items()}
    first = next(iter(datasets.values()))
    angles, train = pressure_angles(first), read_train(first)
    rows = []
    for printed in published()["table9"]["rows"]:
        group, mean = printed["meshes"], printed["mean"]
        normal = next(iter(groups.values()))[group]["mean"]
        scales = {"normal": 1.0, "tangential": group_cosine(angles, train, group) or 1.0}
        component = min(scales, key=lambda name: abs(scales[name] * normal - mean))
        rows.append(
            {
                "position": printed["position"], "component": component, "mean": mean,
                "amplitude": printed["amplitude"], "factor": printed["load_factor"],
                "rigs": {rig: _beside(own[group], scales[component], printed) for rig, own in groups.items()},
            }
        )  # fmt: skip
    return rows


def _beside(found: Mapping[str, float], scale: float, printed: Mapping[str, Any]) -> dict[str, float]:
    """Return one group's numbers in the printed component, and how far they are off."""
    mean = scale * found["mean"]
    return {
        "mean": mean, "amplitude": scale * found["amplitude"], "factor": found["load_factor"],
        "mean_off": mean / printed["mean"] - 1, "factor_off": found["load_factor"] / printed["load_factor"] - 1,
    }  # fmt: skip

"""Arrays of pixels in a plot of matplotlib's, with a bar and units."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from firsthit._base.types import DistanceName, IdentifierName

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit._base.types import Asked

_UNITS = {**dict.fromkeys(get_args(DistanceName), "scene units"), "incidence": "radians"}


class Plottable:
    """Channels in rows and columns that matplotlib draws."""

    if TYPE_CHECKING:

        def __getitem__(self, name: Any) -> Any: ...

    def plot(self, channel: Asked, *, ax: Any = None) -> Any:
        """Plot a channel by matplotlib, with a bar of its colours and its unit.

        Parameters
        ----------
        channel : str
            One of the channels, of one number for each pixel.
        ax : matplotlib.axes.Axes, optional
            Where it is drawn; in a new figure if left out.

        Returns
        -------
        matplotlib.axes.Axes
            With columns to the right and rows downwards. Near is yellow, and a miss is black.

        Raises
        ------
        ImportError
            Where matplotlib is missing.
        ValueError
            For a channel of several numbers, and for hits without rows and columns.
        KeyError
            For a channel that there is not.
        """
        values: npt.NDArray[Any] = self[channel]
        if values.ndim != 2 or values.dtype.kind not in "biuf":
            wanted = "rows and columns of one number each"
            raise ValueError(f"{channel} must have {wanted}, got the shape {values.shape}")
        if ax is None:
            try:
                pyplot: Any = importlib.import_module("matplotlib.pyplot")
            except ImportError:
                raise ImportError("plot takes matplotlib: pip install matplotlib") from None
            ax = pyplot.figure().add_subplot()
        is_identifier = channel in get_args(IdentifierName)
        missing = values < 0 if is_identifier else ~np.isfinite(values)
        ax.set_facecolor("black")
        image = ax.imshow(
            np.ma.masked_array(values, missing),
            cmap="tab20" if is_identifier else "viridis_r",
            interpolation="nearest",
        )
        unit = f" ({_UNITS[channel]})" if channel in _UNITS else ""
        ax.figure.colorbar(image, ax=ax, label=channel + unit)
        ax.set(xlabel="column", ylabel="row")
        return ax

"""Arrays of pixels in a plot of matplotlib's, with a bar and units."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from firsthit._base.optional import optional
from firsthit.typing import DistanceName, IdentifierName

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit.typing import Asked

_UNITS = {**dict.fromkeys(get_args(DistanceName), "scene units"), "incidence": "radians"}

#: The colours of `tab20`. With more identifiers they are used again, and there is no bar.
_COLORS = 20


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
            With columns to the right and rows downwards. Near is yellow, by powers of ten where
            distances differ a hundredfold. Each identifier has a colour. A pixel without a number
            or an identifier is black.

        Raises
        ------
        ImportError
            Where matplotlib is missing.
        ValueError
            For a channel of several numbers, for hits without rows and columns, and for a channel
            that hits do not have.
        KeyError
            For a channel that a frame does not have.
        """
        values: npt.NDArray[Any] = self[channel]
        if values.ndim != 2 or values.dtype.kind not in "biuf":
            wanted = "rows and columns of one number each"
            raise ValueError(f"{channel} must have {wanted}, got the shape {values.shape}")
        if ax is None:
            ax = optional("matplotlib.pyplot", "plot").figure().add_subplot()
        ax.set_facecolor("black")
        unit = f" ({_UNITS[channel]})" if channel in _UNITS else ""
        if channel in get_args(IdentifierName):
            _draw_identifiers(ax, values, channel)
        else:
            shown = np.ma.masked_invalid(values)
            is_wide = channel in get_args(DistanceName) and 0 < 100 * shown.min() < shown.max()
            norm = "log" if is_wide else None
            image = ax.imshow(shown, cmap="viridis_r", norm=norm, interpolation="nearest")
            ax.figure.colorbar(image, ax=ax, label=channel + unit)
        ax.set(xlabel="column", ylabel="row")
        return ax


def _draw_identifiers(ax: Any, values: npt.NDArray[Any], channel: str) -> None:
    """Draw each identifier in a colour, by its place among those that are there."""
    found = np.unique(values[values >= 0])
    places = np.ma.masked_array(np.searchsorted(found, values), values < 0)
    image = ax.imshow(
        places % _COLORS, cmap="tab20", vmin=-0.5, vmax=_COLORS - 0.5, interpolation="nearest"
    )
    if 0 < len(found) <= _COLORS:
        bounds = np.arange(len(found) + 1) - 0.5
        bar = ax.figure.colorbar(image, ax=ax, label=channel, boundaries=bounds)
        bar.set_ticks(np.arange(len(found)), labels=[str(each) for each in found])

"""The types of arguments and results, for annotations.

>>> from firsthit.typing import ChannelName, ViewName
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from ._base.types import (
    AlphaMode,
    AngleName,
    Asked,
    AttributeChannel,
    AttributeOf,
    BodyName,
    Build,
    ChannelName,
    ColorMapName,
    DistanceName,
    EdgeKind,
    Extrapolation,
    FillRule,
    Filter,
    ForeignMesh,
    FovAxis,
    IdentifierName,
    Interpolation,
    LightName,
    MatteChannel,
    MatteName,
    MeshLike,
    NamedIdentifier,
    ObjectKey,
    Progress,
    Projection,
    RayStart,
    Readout,
    Returns,
    Rings,
    Rule,
    SceneLike,
    Selection,
    ShaderName,
    Side,
    ToneMapName,
    TrajectoryFormat,
    Turn,
    Unit,
    Vector,
    VectorName,
    ViewName,
    Wrap,
)

if TYPE_CHECKING:
    import numpy.typing as npt

    from ._pictures.draws import Draws
    from ._queries.hits import Hits

__all__ = [
    "AlphaMode",
    "AngleName",
    "Asked",
    "AttributeChannel",
    "AttributeOf",
    "BodyName",
    "Build",
    "ChannelName",
    "ColorMapName",
    "DistanceName",
    "EdgeKind",
    "Extrapolation",
    "FillRule",
    "Filter",
    "ForeignMesh",
    "FovAxis",
    "IdentifierName",
    "Interpolation",
    "LightName",
    "MatteChannel",
    "MatteName",
    "MeshLike",
    "NamedIdentifier",
    "ObjectKey",
    "OwnShade",
    "Progress",
    "Projection",
    "RayStart",
    "Readout",
    "Returns",
    "Rings",
    "Rule",
    "SceneLike",
    "Selection",
    "ShaderName",
    "Side",
    "ToneMapName",
    "TrajectoryFormat",
    "Turn",
    "Unit",
    "Vector",
    "VectorName",
    "ViewName",
    "Wrap",
]

#: A shader of one's own: from hits, misses included, to linear colours of shape (..., 3).
OwnShade = Callable[["Hits"], "npt.ArrayLike"] | Callable[["Hits", "Draws"], "npt.ArrayLike"]

"""One job on many workers: parts in a folder, with the same bytes after any kill.

`render_many`, `shoot_many` and `visible_many` make the parts that are missing; `parts` says which
are there, and `pack` packs them for training. A worker is a process with all its threads and one
scene, in this machine or in another that shares the folder.
"""

from ._fold import Bits, Fold, Histogram, Minimum, Sum
from ._jobs import JobResult
from ._pack import Packed, pack
from ._parts_of import JobState, parts
from ._processes import processes
from ._render import render_many
from ._shoot import shoot_many
from ._visible import bits, visible_many

__all__ = [
    "Bits",
    "Fold",
    "Histogram",
    "JobResult",
    "JobState",
    "Minimum",
    "Packed",
    "Sum",
    "bits",
    "pack",
    "parts",
    "processes",
    "render_many",
    "shoot_many",
    "visible_many",
]

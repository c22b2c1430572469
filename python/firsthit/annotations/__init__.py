"""Annotations of pictures: what is where, of which class, how it lies and what hides it.

`annotate` finds it from the scene, exactly. The other functions write it for other programs, each
in the form and the frames of its format. ``docs/annotations.md`` has them side by side.
"""

from ._annotate import annotate
from ._annotations import Annotations, Instance, Occlusion, Part
from ._bop import save_bop
from ._bop_models import save_bop_models
from ._box import Box3D
from ._coco import save_coco, to_coco
from ._keypoints import Keypoint, Keypoints
from ._kitti import save_kitti
from ._mask import Mask
from ._yolo import save_yolo

__all__ = [
    "Annotations",
    "Box3D",
    "Instance",
    "Keypoint",
    "Keypoints",
    "Mask",
    "Occlusion",
    "Part",
    "annotate",
    "save_bop",
    "save_bop_models",
    "save_coco",
    "save_kitti",
    "save_yolo",
    "to_coco",
]

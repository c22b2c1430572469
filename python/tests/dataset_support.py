"""Plans for tests, and what is in folders."""

import copy
import json
from pathlib import Path

from support import FULL, ROOT

PLANS = ROOT / "docs" / "datasets"
#: The frames of a plan that is stopped in between.
LONG = 60 if FULL else 30

#: A camera and a scanner around the example's objects, with everything that can be written.
PLAN = {
    "scenes": [
        {
            "file": "yard.toml",
            "classes": {"ball": "ball", "box*": "box", "post": "post"},
            "keypoints": {"post": {"points": {"top": [0, 0, 1.5]}, "tolerance": 0.01}},
        }
    ],
    "sensors": [
        {"name": "eye", "kind": "camera", "columns": 40, "rows": 30, "fov": 50.0},
        {"kind": "lidar", "pattern": "spinning", "elevations": [-20, -5], "columns": 90}
        | {"noise": 0.01, "dropout": 0.1},
    ],
    "poses": {"kind": "sphere", "seed": 3, "count": 7, "center": [1.5, 0, 0.5]}
    | {"radius": [4, 6], "elevation": [0, 60]},
    "output": {
        "channels": ["color", "z", "object"],
        "pictures": ["color", "z"],
        "png_scale": 0.001,
        "clouds": ["npz", "ply"],
        "masks": ["visible"],
        "coco": {},
        "bop": {"unit": "m"},
        "yolo": {"validation": 0.5, "task": "segment"},
    },
}


def plan(change=None):
    """Return a copy of the plan that `change` may alter."""
    made = copy.deepcopy(PLAN)
    if change is not None:
        change(made)
    return made


def tree(folder):
    """Return the bytes of all files below a folder, but for what killed runs left."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(Path(folder).rglob("*"))
        if path.is_file() and not any(part.startswith(".") for part in path.parts[-4:])
    }


def record(folder, frame):
    """Return the record of a frame."""
    return json.loads((Path(folder) / "frames" / f"{frame:06d}" / "frame.json").read_text())

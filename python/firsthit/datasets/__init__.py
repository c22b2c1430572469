"""Data sets: a plan of scenes, sensors and poses, and the frames and annotations of it.

`Plan` is the plan, `dataset` makes it. ``docs/datasets.md`` has the plan's keys, what is in the
folder, and how a killed run goes on.
"""

from ._cost import Cost
from ._plan import Plan
from ._run import DatasetResult, dataset

__all__ = ["Cost", "DatasetResult", "Plan", "dataset"]

"""Ray clusters: an executor for `render_many` and its like, and hits for pipelines of Ray Data.

The package ``ray`` is imported when something here is used. Nothing here starts it: who calls
``ray.init`` decides who may connect to the cluster.
"""

from __future__ import annotations

import time
from concurrent.futures import Executor, Future
from concurrent.futures import wait as wait_for
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import numpy as np

from ._base.arrays import threads_or_all
from ._base.optional import optional
from ._files.channels import distinct
from ._parts.scene_store import read
from ._queries.channels import OF_RAYS

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Mapping, Sequence

    import numpy.typing as npt

    from .typing import Asked

    Columns = dict[str, npt.NDArray[Any]]

__all__ = ["Shooter", "executor"]

_Given = ParamSpec("_Given")
_Result = TypeVar("_Result")

#: Options of a Ray task that are not the user's here.
_OURS = ("num_cpus", "num_returns", "max_retries", "retry_exceptions")

#: How old the number of workers may be, in seconds: nodes come and go.
_RECENT = 10.0

#: The columns of rays.
_ORIGINS, _DIRECTIONS, _LIMITS = ("ox", "oy", "oz"), ("dx", "dy", "dz"), ("t_min", "t_max")


def executor(cpus: float | None = None, *, options: Mapping[str, Any] | None = None) -> Executor:
    """Return an executor whose work is done by tasks of the Ray cluster that is connected.

    Workers must be able to import firsthit, at the same version, and to read and write the folder
    of the job by the same path.

    Ray does not try a task again whose worker or node was lost: `render_many` and its like do so,
    and count the tries. A task that is cancelled is interrupted even if it has begun.

    Parameters
    ----------
    cpus : float, optional
        How many CPUs each task asks for. If left out, those of the smallest node that has any, so
        that a task has a machine of its own: one process, one scene, all cores. A task that asks
        for less shares a machine with others: give ``threads`` as well then.
    options : mapping, optional
        Other options of a Ray task, such as ``resources`` and ``runtime_env``.

    Returns
    -------
    concurrent.futures.Executor
        To be given as ``on``. Its ``shutdown`` leaves Ray as it is.

    Raises
    ------
    RuntimeError
        If ``ray.init`` was not called before, or no node has CPUs and ``cpus`` is left out.
    ImportError
        Without the package ray.
    ValueError
        For ``cpus`` that are not positive, and options that are not the caller's to set.

    Examples
    --------
    >>> import firsthit.ray
    >>> import ray  # doctest: +SKIP
    >>> ray.init(address="auto")  # doctest: +SKIP
    >>> on = fh.ray.executor()  # doctest: +SKIP
    >>> made = fh.render_many("city.fhs", cameras, "/shared/pictures", on=on)  # doctest: +SKIP
    """
    if cpus is not None and not 0 < cpus < np.inf:
        raise ValueError(f"cpus must be positive, got {cpus!r}")
    asked = dict(options or {})
    refused = [name for name in _OURS if name in asked]
    if refused:
        raise ValueError(f"options must be without {', '.join(refused)}; cpus is an argument")
    return _Tasks(cpus, asked)


class Shooter:
    """First hits of the rays in the batches of a dataset of Ray Data.

    It is given to ``map_batches`` as a class. Each worker opens the scene once. Ray Data promises
    no order of rows: a column that numbers the rays tells later which is which, and all columns
    are kept.

    Parameters
    ----------
    scene : path-like
        The scene's file, which all nodes read by this path. One of `Scene.save` is mapped.
    channels : str or sequence of str
        Channels of `Hits`.
    threads : int, optional
        The number of threads; all cores if left out. With several workers on a machine it is what
        each one asks Ray for.

    Raises
    ------
    FileReadError, FileFormatError
        If the scene's file cannot be read.
    ValueError, TypeError
        For channels that there are not.

    Examples
    --------
    >>> import firsthit.ray
    >>> scene = fh.Scene()
    >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
    0
    >>> scene.save("ball.fhs")
    >>> shooter = fh.ray.Shooter("ball.fhs", channels="t")
    >>> column = np.zeros(2)
    >>> rays = {"ray": np.arange(2), "ox": column, "oy": np.array([0.0, 3.0]), "oz": column + 5}
    >>> shooter({**rays, "dx": column, "dy": column, "dz": column - 1})["t"]
    array([ 4., inf])

    Ray makes it, on as many workers as are asked for:

    >>> import ray  # doctest: +SKIP
    >>> rays = ray.data.read_parquet("/shared/rays")  # doctest: +SKIP
    >>> hits = rays.map_batches(  # doctest: +SKIP
    ...     fh.ray.Shooter,
    ...     fn_constructor_args=["/shared/city.fhs"],
    ...     fn_constructor_kwargs={"channels": ["t", "object"], "threads": 8},
    ...     num_cpus=8,
    ...     compute=ray.data.ActorPoolStrategy(size=4),
    ... )
    >>> hits.write_parquet("/shared/hits")  # doctest: +SKIP
    """

    def __init__(
        self,
        scene: str | os.PathLike[str],
        *,
        channels: Asked | Sequence[Asked] = ("t", "object", "primitive"),
        threads: int | None = None,
    ) -> None:
        threads_or_all(threads)
        self._channels, self._threads = distinct(channels, OF_RAYS), threads
        self._scene = read(Path(scene))

    def __call__(self, rays: Columns) -> Columns:
        """Return the columns of a batch and those of its hits.

        Parameters
        ----------
        rays : dict of str to (n,) array
            ``ox``, ``oy``, ``oz`` and ``dx``, ``dy``, ``dz``, in world space; ``t_min`` and
            ``t_max`` where the rays have them. Others are passed on.

        Returns
        -------
        dict of str to (n,) array
            The same, and the channels as `Hits.to_dict` names them.

        Raises
        ------
        ValueError, TypeError
            If columns are missing, for those that are no rays, as `Scene.shoot`, and if a column of
            the hits is there already.
        """
        missing = [name for name in (*_ORIGINS, *_DIRECTIONS) if name not in rays]
        if missing:
            raise ValueError(f"rays must have the columns {', '.join(missing)}")
        limits: dict[str, Any] = {name: rays[name] for name in _LIMITS if name in rays}
        hits = self._scene.shoot(
            np.stack([rays[name] for name in _ORIGINS], axis=-1),
            np.stack([rays[name] for name in _DIRECTIONS], axis=-1),
            threads=self._threads,
            **limits,
        )
        made = hits.to_dict(self._channels)
        twice = [name for name in made if name in rays]
        if twice:
            raise ValueError(f"rays must not have the columns of their hits, {', '.join(twice)}")
        return {**rays, **made}


class _Tasks(Executor):
    """Does its work by Ray tasks."""

    def __init__(self, cpus: float | None, options: Mapping[str, Any]) -> None:
        ray = _connected()
        self._cpus = _smallest_node(ray) if cpus is None else cpus
        # With tries of Ray's own, one of ours would be several, and a part that kills its worker
        # would kill as many more.
        self._task = ray.remote(num_cpus=self._cpus, max_retries=0, **options)(_call)
        self._given: set[Future[Any]] = set()
        self._is_shut = False
        self._counted: tuple[float, int] | None = None

    @property
    def _max_workers(self) -> int:
        """The number of tasks that the cluster does at once, by which the driver has its window."""
        now = time.monotonic()
        if self._counted is None or now - self._counted[0] > _RECENT:
            at_once = sum(int(cpus // self._cpus) for cpus in _cpus_of_nodes(_connected()))
            self._counted = now, max(at_once, 1)
        return self._counted[1]

    def submit(
        self, fn: Callable[_Given, _Result], /, *args: _Given.args, **kwargs: _Given.kwargs
    ) -> Future[_Result]:
        if self._is_shut:
            raise RuntimeError("cannot submit after shutdown")
        ray = _connected()
        reference = self._task.remote(fn, args, kwargs)
        future: Future[_Result] = reference.future()
        self._given.add(future)

        def end(ended: Future[_Result]) -> None:
            self._given.discard(ended)
            # Ray does not hear of it otherwise, and would go on with what nobody waits for.
            if ended.cancelled() and ray.is_initialized():
                ray.cancel(reference)

        future.add_done_callback(end)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: FBT001, FBT002 - as Executor has it
        """Take no more work; Ray itself keeps running."""
        self._is_shut = True
        given = list(self._given)
        if cancel_futures:
            for future in given:
                future.cancel()
        elif wait:
            wait_for(given)


def _call(function: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]) -> Any:
    """Call a function, as a task of a worker."""
    return function(*args, **kwargs)


def _connected() -> Any:
    """Return the package ray, which is connected to a cluster.

    It is asked before each use: Ray starts a cluster by itself when its functions are called
    without one.
    """
    # Its name is this module's, too; that of the package is absolute.
    ray = optional("ray", "the executor on Ray")
    if not ray.is_initialized():
        raise RuntimeError("Ray is not connected to a cluster: call ray.init before")
    return ray


def _cpus_of_nodes(ray: Any) -> list[float]:
    """Return how many CPUs each node has that is alive and has any; a head often has none."""
    each = (node["Resources"].get("CPU", 0.0) for node in ray.nodes() if node["Alive"])
    return [cpus for cpus in each if cpus > 0]


def _smallest_node(ray: Any) -> float:
    cpus = _cpus_of_nodes(ray)
    if not cpus:
        raise RuntimeError("no node of the cluster has CPUs now: say how many a task needs, cpus")
    return min(cpus)

"""The returns of laser scanners, and files of them."""

from __future__ import annotations

import io
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import copied, flag, lock
from firsthit._base.errors import FileFormatError
from firsthit._base.log import timed
from firsthit._base.optional import optional

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    import numpy.typing as npt

    from firsthit._queries.all_hits import AllHits
    from firsthit._queries.hits import Hits
    from firsthit.typing import ObjectKey

#: The names of vectors' columns in tables.
_VECTORS = {"point": ("x", "y", "z"), "sensor_point": ("sensor_x", "sensor_y", "sensor_z")}


def shaped(columns: Iterable[tuple[str, npt.NDArray[Any]]]) -> dict[str, npt.NDArray[Any]]:
    """Return flat columns as arrays over returns."""
    return {name: column.reshape(-1, 3) if name in _VECTORS else column for name, column in columns}


class ScanOrigin:
    """The scene and the scanner, written out when it is first asked for: its digests take long."""

    def __init__(
        self, scene: _firsthit.Scene, sensor: _firsthit.Sensor, settings: dict[str, Any]
    ) -> None:
        self._parts: tuple[_firsthit.Scene, _firsthit.Sensor] | None = (scene, sensor)
        self._settings = settings
        self._text = ""

    def text(self) -> str:
        """Return it as JSON; the scene and the sensor are not kept any longer."""
        parts = self._parts
        if parts is not None:
            said: dict[str, Any] = json.loads(_firsthit.origin(*parts, []))
            said["scan"] = self._settings
            # In this order: another thread that finds no parts finds the text.
            self._text = json.dumps(said)
            self._parts = None
        return self._text


class LidarScan:
    """The returns of a laser scanner, as arrays over n returns. Read-only.

    They are beam by beam in the order of the picture's rows, and each beam's by range without its
    noise. A beam that met nothing has none.

    ``scan["range"]`` is the attribute of that name. `Lidar.scan` makes scans, `from_hits` those of
    rays of one's own, `joined` one of several, and `load` reads them.
    """

    def __init__(self) -> None:
        raise TypeError("LidarScans are made by Lidar.scan, LidarScan.from_hits and LidarScan.load")

    #: The extensions that `save` knows.
    EXTENSIONS: ClassVar[tuple[str, ...]] = (
        *(f".{extension}" for extension in _firsthit.scan_extensions()),
        ".parquet",
    )

    _arrays: dict[str, npt.NDArray[Any]]
    _shape: tuple[int, int]
    #: The origin of the scan: what was scanned, and how; as JSON, or to be.
    _origin: str | ScanOrigin

    @classmethod
    def _of(
        cls,
        arrays: dict[str, npt.NDArray[Any]],
        shape: tuple[int, int],
        origin: str | ScanOrigin,
    ) -> LidarScan:
        scan = cls.__new__(cls)
        for array in arrays.values():
            lock(array)
        scan._arrays, scan._shape, scan._origin = arrays, shape, origin
        return scan

    @classmethod
    def joined(cls, scans: Iterable[LidarScan]) -> LidarScan:
        """Return the returns of several scans as one, such as the turns of a scanner that drives.

        Parameters
        ----------
        scans : iterable of LidarScan
            In the order of time, of scanners with as many rows.

        Returns
        -------
        LidarScan
            All returns of the first scan, then all of the next. ``column`` counts on from scan to
            scan: the pictures are beside one another. ``metadata`` has the first scan's scanner and
            scene, and under ``scans`` the digests, columns and settings of each.

        Raises
        ------
        ValueError
            For no scans, other numbers of rows, and intensities that only some have.
        TypeError
            For what is no scan.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> scene.add(fh.Box((-4, -3, -1), (4, 3, 2)))
        0
        >>> drive = fh.Trajectory([0, 1], [(-1, 0, 0), (1, 0, 0)], body="forwards-left-up")
        >>> turns = [
        ...     fh.Lidar.named("vlp-16", columns=360, start=turn / 10, trajectory=drive).scan(scene)
        ...     for turn in range(3)
        ... ]
        >>> fh.LidarScan.joined(turns)
        LidarScan(17280 returns of 16 x 1080 beams)
        """
        if isinstance(scans, LidarScan):
            raise TypeError(f"joined takes several LidarScans, got {scans!r}")
        parts = list(scans)
        for part in parts:
            if not isinstance(part, LidarScan):
                raise TypeError(f"joined takes LidarScans, got {part!r}")
        return cls._whole(_firsthit.join_scans([part._parts() for part in parts]))

    @classmethod
    def from_hits(
        cls,
        hits: Hits | AllHits,
        *,
        ring: npt.ArrayLike | None = None,
        time: npt.ArrayLike | None = None,
        intensity: npt.ArrayLike | None = None,
        pose: npt.ArrayLike | None = None,
        classes: Mapping[ObjectKey, int] | None = None,
    ) -> LidarScan:
        """Return what rays of one's own met as a scan: for its files, and for its picture.

        Parameters
        ----------
        hits : Hits or AllHits
            Of the shape (rows, columns) or (n,), which is one row. Misses are no returns. All hits
            of a ray are its returns. Hits of a `Lidar` have its rings, times and poses.
        ring : array_like of int, optional
            The number of the laser of each ray; its row if left out.
        time : array_like, optional
            The time of each ray in seconds; 0 if left out.
        intensity : array_like, optional
            The intensity of each ray, or of each of all hits (m,); none if left out.
        pose : (4, 4), (3, 4) or (..., 4, 4) array_like, optional
            The matrix that takes the scanner's coordinates to the world's, of all rays or of each;
            a rotation and a translation. If left out, ``sensor_point`` is from the ray's origin,
            along the world's axes.
        classes : dict, optional
            As for `Lidar.scan`.

        Returns
        -------
        LidarScan
            In the order of the rays. A range is from the ray's origin, in scene units.

        Raises
        ------
        ValueError
            For hits of another shape, and for numbers that do not fit.
        TypeError
            For what are no hits.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> hits = scene.shoot([[0, 0, 5], [0, 3, 5], [0, 0.6, 5]], [0, 0, -1])
        >>> scan = fh.LidarScan.from_hits(hits, time=[0, 0.1, 0.2])
        >>> scan, scan.range, scan.time
        (LidarScan(2 returns of 1 x 3 beams), array([4. , 4.2]), array([0. , 0.2]))
        """
        from .own_scan import scan_of

        return cls._of(*scan_of(hits, {"ring": ring, "time": time}, intensity, pose, classes))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> LidarScan:
        """Read a scan from an ``.npz`` that `save` wrote, as it was.

        Parameters
        ----------
        path : path-like
            The file. The points of a ``.ply``, ``.pcd``, ``.las``, ``.laz`` or ``.csv`` of a scan
            are read by `read_points`, with its other numbers as columns.

        Returns
        -------
        LidarScan
            The scan, with the same arrays and metadata.

        Raises
        ------
        FileReadError
            If the system refuses to read it; also an `OSError`.
        FileFormatError
            For what is no such file; also a `ValueError`.
        """
        path = Path(path)
        if path.suffix.lower() != ".npz":
            others = "read_points reads .ply, .pcd, .las, .laz and .csv, pandas a .parquet"
            message = f"{path}: a scan is read from an .npz; {others}"
            raise FileFormatError(_firsthit.escaped(message), str(path))
        return cls._whole(_firsthit.read_scan(path))

    def _said(self) -> str:
        """Return what was scanned, and how, as JSON."""
        origin = self._origin
        return origin if isinstance(origin, str) else origin.text()

    def _parts(self) -> _firsthit._ScanParts:
        """Return flat columns, the shape and the origin, as the native half takes them."""
        columns = [
            (name, np.ascontiguousarray(array).reshape(-1)) for name, array in self._arrays.items()
        ]
        return columns, self._shape, self._said()

    @classmethod
    def _whole(cls, parts: _firsthit._ScanParts) -> LidarScan:
        """Return the scan of such parts."""
        columns, (rows, width), origin = parts
        return cls._of(shaped(columns), (rows, width), origin)

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns) of the scanner's beams."""
        return self._shape

    @property
    def point(self) -> npt.NDArray[np.float64]:
        """The points in world space, (n, 3) float64: along the middle of the beam, at its range."""
        return self._arrays["point"]

    @property
    def sensor_point(self) -> npt.NDArray[np.float64]:
        """The points in the scanner's frame at the time of the beam, (n, 3) float64."""
        return self._arrays["sensor_point"]

    @property
    def range(self) -> npt.NDArray[np.float64]:
        """The distances along the beams, (n,) float64, in scene units."""
        return self._arrays["range"]

    @property
    def object(self) -> npt.NDArray[np.int32]:
        """The identifiers of the objects, of the nearest hit of the return, (n,) int32."""
        return self._arrays["object"]

    @property
    def primitive(self) -> npt.NDArray[np.int32]:
        """The identifiers of the objects' parts, such as triangles, (n,) int32."""
        return self._arrays["primitive"]

    @property
    def incidence(self) -> npt.NDArray[np.float64]:
        """The angles between beam and surface normal, (n,) float64, radians: 0 for head on."""
        return self._arrays["incidence"]

    @property
    def ring(self) -> npt.NDArray[np.int32]:
        """The numbers of the lasers, (n,) int32: the maker's, unless others were asked for."""
        return self._arrays["ring"]

    @property
    def row(self) -> npt.NDArray[np.int32]:
        """The rows of the beams in the scanner's picture, (n,) int32."""
        return self._arrays["row"]

    @property
    def column(self) -> npt.NDArray[np.int32]:
        """The columns of the beams in the scanner's picture, (n,) int32."""
        return self._arrays["column"]

    @property
    def time(self) -> npt.NDArray[np.float64]:
        """The times of the beams, (n,) float64, in seconds."""
        return self._arrays["time"]

    @property
    def return_number(self) -> npt.NDArray[np.int32]:
        """The number of each return in its beam, by range, (n,) int32 from 1 on."""
        return self._arrays["return_number"]

    @property
    def number_of_returns(self) -> npt.NDArray[np.int32]:
        """The number of returns of its beam, (n,) int32.

        With ``returns="first"``, no divergence and no range gate the scan knows of no others, and
        says 1. With ``max_returns`` it is no larger.
        """
        return self._arrays["number_of_returns"]

    @property
    def intensity(self) -> npt.NDArray[np.float64] | None:
        """The intensities, (n,) float64 from 0 on; ``None`` unless they were asked for."""
        return self._arrays.get("intensity")

    @property
    def classification(self) -> npt.NDArray[np.int32] | None:
        """The objects' classes, (n,) int32 from 0 to 255; ``None`` unless they were given."""
        return self._arrays.get("classification")

    @property
    def metadata(self) -> dict[str, Any]:
        """The metadata in files: the scanner, how it scanned, the scene, and the arrays.

        The form is that of `Frame.metadata`, with the shape ``[n]`` and, under ``scan``, the
        settings of `Lidar.scan`; those of `joined` scans have a list ``scans``.
        """
        said = _firsthit.scan_metadata(self.keys(), len(self), self._said())
        made: dict[str, Any] = json.loads(said)
        return made

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        """Return an array by its name; a ``KeyError`` where there is none."""
        if name not in self._arrays:
            raise KeyError(f"no array {name!r}; there are {', '.join(self._arrays)}")
        return self._arrays[name]

    def keys(self) -> tuple[str, ...]:
        """Return the names of the arrays."""
        return tuple(self._arrays)

    def to_dict(self, *, copy: bool = False) -> dict[str, npt.NDArray[Any]]:
        """Return the returns as a table: columns by name, with a row for each.

        Parameters
        ----------
        copy : bool
            Whether the columns are copies, which can be written, and not views of the scan.

        Returns
        -------
        dict of str to (n,) array
            Points are ``x``, ``y``, ``z`` and ``sensor_x`` and so on.
        """
        table: dict[str, npt.NDArray[Any]] = {}
        for name, array in self._arrays.items():
            if name in _VECTORS:
                table.update(zip(_VECTORS[name], np.moveaxis(array, 1, 0), strict=True))
            else:
                table[name] = array
        return copied(table) if flag("copy", copy) else table

    def to_image(self, name: str = "range") -> npt.NDArray[Any]:
        """Return an array as the scanner's picture, of the first return of each beam.

        Parameters
        ----------
        name : str
            One of `keys`.

        Returns
        -------
        (rows, columns) or (rows, columns, k) array
            ``inf`` for ranges, -1 for integers and NaN for others where there is no return.

        Raises
        ------
        KeyError
            For another name.
        """
        values = self[name]
        miss = -1 if values.dtype.kind == "i" else np.inf if name == "range" else np.nan
        image = np.full((*self._shape, *values.shape[1:]), miss, values.dtype)
        beams = self.row.astype(np.int64) * self._shape[1] + self.column
        _, firsts = np.unique(beams, return_index=True)
        image[self.row[firsts], self.column[firsts]] = values[firsts]
        return image

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the returns to a file, whole or not at all.

        Parameters
        ----------
        path : path-like
            ``.npz``, ``.ply`` and ``.csv`` are exact; a ``.pcd`` has lengths and angles as float32,
            for PCL and ROS, but points far from the origin as float64. ``.las`` is LAS 1.4 with
            point format 6: coordinates are rounded to steps of 1e-4 scene units, of 1e-3 where
            these do not reach, and so on; what the format has no place for is in extra bytes.
            ``.laz`` is the same packed. ``.parquet`` takes the package ``pyarrow``.

        Raises
        ------
        ValueError
            For an unknown extension, and for numbers that the format cannot hold.
        ImportError
            Where the package is missing that the format takes.
        FileWriteError
            If the system refuses to write it; an old file is as it was. Also an `OSError`.
        """
        suffix = Path(path).suffix.lower()
        if suffix not in self.EXTENSIONS:
            known = ", ".join(self.EXTENSIONS)
            raise ValueError(f"path must end in one of {known}, got {os.fspath(path)}")
        with timed("wrote %s", path):
            if suffix == ".parquet":
                _firsthit.write_bytes(Path(path), self._parquet())
            else:
                _firsthit.write_scan(Path(path), self._parts())

    def _parquet(self) -> bytes:
        table = optional("pyarrow", "a .parquet").table(dict(self.to_dict()))
        table = table.replace_schema_metadata({"firsthit": json.dumps(self.metadata)})
        out = io.BytesIO()
        optional("pyarrow.parquet", "a .parquet").write_table(table, out)
        return out.getvalue()

    def __len__(self) -> int:
        """Return the number of returns."""
        return len(self.range)

    def __bool__(self) -> bool:
        """Return True, also if there are no returns: the length must not decide."""
        return True

    def __repr__(self) -> str:
        rows, columns = self._shape
        return f"LidarScan({len(self)} returns of {rows} x {columns} beams)"

    def _repr_html_(self) -> str:
        """Show it at a glance, for notebooks."""
        from firsthit._files.glance import of_scan

        return of_scan(self)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as it is."""
        return LidarScan._of, (self._arrays, self._shape, self._said())

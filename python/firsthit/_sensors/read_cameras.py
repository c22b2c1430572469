"""The cameras of other programs' files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import count, one_of
from firsthit._base.errors import warn
from firsthit._files.frame_file import read_metadata

from . import calibrations, conventions
from .camera_conventions import ConvertedCamera
from .camera_derived import DerivedCamera

if TYPE_CHECKING:
    import os
    from typing import Literal, Self

    import numpy.typing as npt

    from .calibrations import Calibration


class ReadCameras(ConvertedCamera, DerivedCamera):
    """A camera that files hold: those of other programs, and our own pictures."""

    @classmethod
    def from_colmap(
        cls, cameras: str | os.PathLike[str], images: str | os.PathLike[str] | None = None
    ) -> dict[str, Self]:
        """Read the cameras of a COLMAP reconstruction.

        Parameters
        ----------
        cameras, images : path-like
            ``cameras.bin`` and ``images.bin``, or ``cameras.txt`` and ``images.txt``; or only the
            folder that has them. Of a folder that has both pairs the binary one is read.

        Returns
        -------
        dict of str to Camera
            A camera for each image, by the image's name, in the order of the file.

        Raises
        ------
        FileReadError
            If the system refuses to read a file; also an `OSError`.
        FileFormatError
            For a file that is cut off or has more than it says, numbers that are not finite, a
            camera or a name that is there twice, a model that COLMAP does not have, and a folder
            without the files; also a `ValueError`.

        Warns
        -----
        FirsthitWarning
            For images of the models ``SIMPLE_DIVISION``, ``DIVISION`` and ``EQUIRECTANGULAR``,
            which are no lenses here: they are left out.
        """
        read, unsupported, path = _firsthit.Camera.of_colmap(
            Path(cameras), None if images is None else Path(images)
        )
        if unsupported:
            images_, models = zip(*unsupported, strict=True)
            which = f"{len(images_)} images are left out, such as {images_[0]!r}"
            known = ", ".join(sorted(set(models)))
            warn(f"{path}: {which}: their models are not supported ({known})")
        return {name: cls._of(native) for name, native in read}

    @classmethod
    def from_ros(cls, path: str | os.PathLike[str], *, pose: npt.ArrayLike | None = None) -> Self:
        """Read the camera of a ROS ``CameraInfo`` in YAML.

        Parameters
        ----------
        path : path-like
            A file of ROS's camera_calibration, or a message as ``rostopic echo`` or
            ``ros2 topic echo`` prints it.
        pose : (4, 4) or (3, 4) array_like, optional
            The pose of the optical frame, as `from_intrinsics` takes it with the convention
            ``ros``; the identity if left out.

        Returns
        -------
        Camera
            That of the raw picture: from K and D, after a region of interest and binning. The
            rectification and P do not matter. Its rays start at the eye.

        Raises
        ------
        ImportError
            Without the package PyYAML.
        FileReadError
            If the system refuses to read the file; also an `OSError`.
        FileFormatError
            For a file that is no ``CameraInfo``, a distortion other than ``plumb_bob``,
            ``rational_polynomial`` and ``equidistant``, and what `from_intrinsics` refuses; also a
            `ValueError`.
        """
        placed = np.array(conventions.pose4(pose))
        with calibrations.CalibrationFile(path) as document:
            read = calibrations.of_ros(document.yaml(), placed)
            camera = cls._calibrated(read.calibration)
            if read.region is not None:
                top, bottom, left, right = read.region
                camera = camera.crop((top, bottom), (left, right))
            if read.binning != (1, 1):
                down, across = read.binning
                camera = camera.resize(camera.rows // down, camera.columns // across)
            return camera

    @classmethod
    def from_kalibr(
        cls, path: str | os.PathLike[str], *, frame: Literal["cam0", "imu"] = "cam0"
    ) -> dict[str, Self]:
        """Read the cameras of a Kalibr camchain in YAML.

        Parameters
        ----------
        path : path-like
            The file, such as ``camchain-imucam.yaml``.
        frame : {"cam0", "imu"}
            In whose coordinates the cameras are placed: the first camera's, x to the right, y down,
            z forwards; or the IMU's.

        Returns
        -------
        dict of str to Camera
            The cameras by their names, ``cam0`` first. `Camera.moved` and `Rig` carry them.

        Raises
        ------
        ImportError
            Without the package PyYAML.
        FileReadError
            If the system refuses to read the file; also an `OSError`.
        FileFormatError
            For a file that is no camchain, a model that Kalibr does not have, a pose that is
            missing, and what `from_intrinsics` refuses; also a `ValueError`.
        """
        one_of("frame", frame, ("cam0", "imu"))
        with calibrations.CalibrationFile(path) as document:
            read = calibrations.of_kalibr(document.yaml(), frame)
            return {name: cls._calibrated(each) for name, each in read.items()}

    @classmethod
    def from_nerfstudio(
        cls,
        path: str | os.PathLike[str],
        *,
        rows: int | None = None,
        columns: int | None = None,
    ) -> dict[str, Self]:
        """Read the cameras of a ``transforms.json``, as nerfstudio and instant-ngp have it.

        Parameters
        ----------
        path : path-like
            The file.
        rows, columns : int, optional
            The size of the images, where the file does not say it (``h`` and ``w``), as that of
            NeRF's synthetic scenes does not.

        Returns
        -------
        dict of str to Camera
            A camera for each frame, by its ``file_path``, in the order of the file. Their poses are
            those of the file: an ``applied_transform`` that it speaks of is in them.

        Raises
        ------
        FileReadError
            If the system refuses to read the file; also an `OSError`.
        FileFormatError
            For a file that is none of these, a path that is there twice, an image without a size or
            a focal length, another model than nerfstudio's pinhole, fisheye and equirectangular
            ones, and what `from_intrinsics` refuses; also a `ValueError`.
        """
        if (rows is None) != (columns is None):
            raise ValueError("rows and columns must be given together")
        size = None
        if rows is not None and columns is not None:
            size = count("rows", rows, 1), count("columns", columns, 1)
        with calibrations.CalibrationFile(path) as document:
            read = calibrations.of_nerfstudio(document.json(), size)
            return {name: cls._calibrated(each) for name, each in read.items()}

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read the camera that made an output from what the output says of itself.

        Parameters
        ----------
        path : path-like
            A picture or a point cloud that firsthit wrote, of any kind: ``docs/outputs.md``.

        Returns
        -------
        Camera
            The camera, bit for bit: it makes the same picture. Of a region, it is the camera of the
            whole.

        Raises
        ------
        ValueError
            For a file that does not say which camera made it.
        FileReadError, FileFormatError
            As `Frame.load`.

        Examples
        --------
        >>> scene = fh.Scene()
        >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
        0
        >>> camera = fh.Camera.framing(scene, rows=30, columns=40)
        >>> fh.render(scene, camera, channels="z").save("z.npz")
        >>> fh.Camera.load("z.npz") == camera
        True
        """
        said = read_metadata(path)
        record = None if said is None else said.get("camera")
        if record is None:
            raise ValueError(f"{path} does not say which camera made it")
        _firsthit.note_input(Path(path))
        return cls._of(_firsthit.Camera.of_record(json.dumps(record)))

    @classmethod
    def _calibrated(cls, read: Calibration) -> Self:
        """Return the camera of a calibration."""
        if read.projection == "equirectangular":
            pose, pixels = conventions.rigid(read.pose), (read.rows, read.columns)
            view = pose[:3, 3], -pose[:3, 2], pose[:3, 1]
            return cls._of_arguments(view, pixels, ("equirectangular", "eye"), [])
        return cls.from_intrinsics(
            read.K,
            rows=read.rows,
            columns=read.columns,
            convention=read.convention,
            pose=read.pose,
            projection=read.projection,
            parameters=read.parameters,
        )

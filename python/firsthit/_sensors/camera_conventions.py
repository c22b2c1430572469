"""Cameras from the matrices of other programs, and for them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import count, number, numbers, text, vector

from . import colmap, conventions
from .camera_view import CameraView, checked_parameters
from .conventions import OpenCvCamera

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Self

    import numpy.typing as npt

    from firsthit.typing import Convention, Projection

    from .colmap import ColmapCamera


class ConvertedCamera(CameraView):
    """A camera that other programs' matrices make, and that is written as they have it."""

    @classmethod
    def from_intrinsics(
        cls,
        K: npt.ArrayLike,
        *,
        rows: int,
        columns: int,
        convention: Convention,
        pose: npt.ArrayLike | None = None,
        projection: Projection = "perspective",
        parameters: Mapping[str, float] | None = None,
    ) -> Self:
        """Make a camera from an intrinsic matrix and a pose, as another program writes them.

        Parameters
        ----------
        K : (3, 3) or (4,) array_like
            The intrinsic matrix, upper triangular with (0, 0, 1) as its last row; or its
            (fx, fy, cx, cy). In pixels.
        rows, columns : int
            Pixels down and across.
        convention : str
            Whose words these are; it is never guessed. The table below says what each means.
        pose : (4, 4) or (3, 4) array_like, optional
            The pose, without a scale or a mirror; the identity if left out. A rotation whose
            numbers are up to 1e-3 off, as of three decimals, becomes the nearest one.
        projection : str
            ``perspective``, or one with distortion, such as ``opencv``.
        parameters : mapping of str to float, optional
            Those of the distortion, as `Camera` lists them.

        Returns
        -------
        Camera
            Its rays start at the eye.

        Raises
        ------
        ValueError
            For matrices of another shape or kind, an unknown convention, a focal length that is not
            positive, and what `Camera` refuses.

        Warns
        -----
        FirsthitWarning
            For a rotation that is rounded to less than four decimals.

        Notes
        -----
        ==============  ======================  ==============================  ================
        convention      the camera's x, y, z    the pose takes                  first pixel at
        ==============  ======================  ==============================  ================
        ``opencv``      right, down, forwards   the world to the camera         (0, 0)
        ``colmap``      right, down, forwards   the world to the camera         (0.5, 0.5)
        ``ros``         right, down, forwards   the camera to the world         (0, 0)
        ``opengl``      right, up, backwards    the camera to the world         (0.5, 0.5)
        ``blender``     right, up, backwards    the camera to the world         (0.5, 0.5)
        ``gltf``        right, up, backwards    the camera to the world         (0.5, 0.5)
        ``nerfstudio``  right, up, backwards    the camera to the world         (0.5, 0.5)
        ``pytorch3d``   left, up, forwards      the world to the camera, rows   (0.5, 0.5)
        ==============  ======================  ==============================  ================

        The last column is the place of the first pixel's centre in the coordinates that K gives.
        PyTorch3D's matrix is applied to rows, so its translation is in the last row.

        Examples
        --------
        >>> camera = fh.Camera.from_intrinsics([500, 500, 319.5, 239.5], rows=480, columns=640,
        ...                                    convention="opencv")
        >>> camera.aim.tolist(), camera.project((0, 0, 2)).tolist()
        ([0.0, 0.0, 1.0], [320.0, 240.0])
        """
        native = _firsthit.Camera.from_intrinsics(
            conventions.intrinsics(K),
            conventions.pose4(pose),
            text("convention", convention),
            (count("rows", rows), count("columns", columns)),
            text("projection", projection),
            list(checked_parameters(parameters).items()),
        )
        return cls._of(native)

    @classmethod
    def from_opencv(
        cls,
        K: npt.ArrayLike,
        distortion: npt.ArrayLike | None = None,
        rvec: npt.ArrayLike | None = None,
        tvec: npt.ArrayLike | None = None,
        *,
        R: npt.ArrayLike | None = None,
        rows: int,
        columns: int,
        model: str = "pinhole",
        xi: float = 0.0,
    ) -> Self:
        """Make the camera whose pictures OpenCV's functions describe.

        A point of the world that a ray of this camera meets is one that ``cv2.projectPoints``, or
        ``cv2.fisheye.projectPoints`` or ``cv2.omnidir.projectPoints``, puts at that pixel.

        Parameters
        ----------
        K : (3, 3) or (4,) array_like
            The camera matrix, or its (fx, fy, cx, cy), in which the centre of the first pixel is at
            (0, 0). Of a fisheye ``K[0, 1]`` is ``alpha`` times fx, as ``cv2.fisheye.calibrate``
            writes it.
        distortion : (n,), (1, n) or (n, 1) array_like, optional
            OpenCV's coefficients in its order: 4, 5, 8, 12 or 14 of them; 4 of the other models.
        rvec : (3,) or (3, 3) array_like, optional
            The rotation from the world to the camera as axis times angle in radians, or as a
            matrix.
        tvec : (3,) array_like, optional
            The translation from the world to the camera.
        R : (3, 3) array_like, optional
            The rotation as a matrix, instead of ``rvec``. Without both the camera is not turned.
        rows, columns : int
            Pixels down and across.
        model : {"pinhole", "fisheye", "omnidir"}
            Whose coefficients these are.
        xi : float
            That of ``cv2.omnidir``.

        Returns
        -------
        Camera
            Its rays start at the eye.

        Raises
        ------
        ValueError
            For both ``rvec`` and ``R``, other numbers of coefficients, a skew in K with the model
            ``pinhole``, which ``cv2.projectPoints`` leaves out, and what `from_intrinsics` refuses.

        Examples
        --------
        >>> camera = fh.Camera.from_opencv([600, 600, 320, 240], (-0.2, 0.05, 0, 0),
        ...                                rows=480, columns=640)
        >>> camera.projection
        'opencv'
        """
        named = conventions.coefficients(distortion, model, xi)
        kind: Projection = "perspective"
        if model == "fisheye":
            kind = "opencv_fisheye"
        elif model == "omnidir":
            kind = "mei"
        elif any(named.values()):
            kind = "opencv"
        else:
            named = {}
        matrix = conventions.intrinsics(K)
        conventions.check_skew(model, matrix[0][1])
        turned = np.eye(3)
        if rvec is not None or R is not None:
            turned = conventions.rotation_of(rvec, R)
        moved = numbers("tvec", (0.0, 0.0, 0.0) if tvec is None else tvec)
        moved = np.array(vector("tvec", moved.ravel() if moved.size == 3 else moved))
        return cls.from_intrinsics(
            matrix,
            rows=rows,
            columns=columns,
            convention="opencv",
            pose=np.column_stack([turned, moved]),
            projection=kind,
            parameters=named,
        )

    @classmethod
    def from_projection_matrix(
        cls,
        P: npt.ArrayLike,
        *,
        rows: int,
        columns: int,
        view: npt.ArrayLike | None = None,
        convention: Convention = "opencv",
    ) -> Self:
        """Make a camera from a projection matrix.

        Parameters
        ----------
        P : (3, 4) or (4, 4) array_like
            A 3 x 4 matrix takes points of the world to pixels, ``K [R | t]``, up to its scale and
            sign. A 4 x 4 one is OpenGL's, up to a positive scale, applied to columns: from the
            camera's coordinates (right, up, backwards) to clip space. Its near and far planes count
            for nothing: rays start at the eye.
        rows, columns : int
            Pixels down and across.
        view : (4, 4) array_like, optional
            With a 4 x 4 ``P``: OpenGL's view matrix, which takes the world to the camera. The
            identity if left out.
        convention : {"opencv", "colmap"}
            With a 3 x 4 ``P``: where it puts the first pixel's centre, at (0, 0) or (0.5, 0.5).

        Returns
        -------
        Camera
            A perspective one, or of an orthographic ``P`` an orthographic one.

        Raises
        ------
        ValueError
            For a matrix that is no projection of this kind.

        Examples
        --------
        >>> camera = fh.Camera.from_projection_matrix(
        ...     [[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, -1, -0.2], [0, 0, -1, 0]], rows=10, columns=10)
        >>> camera.aim.tolist(), camera.focal_length / camera.width
        ([0.0, 0.0, -1.0], 1.0)
        """
        matrix = numbers("P", P).astype(np.float64)
        if matrix.shape == (3, 4):
            if view is not None:
                raise ValueError("view is for a 4 x 4 P; a 3 x 4 one has the pose in it")
            if convention not in ("opencv", "colmap"):
                raise ValueError(f"convention must be opencv or colmap, got {convention!r}")
            k, pose = conventions.decomposed(matrix)
            return cls.from_intrinsics(
                k, rows=rows, columns=columns, convention=convention, pose=pose
            )
        if matrix.shape != (4, 4):
            raise ValueError(f"P must be a 3 x 4 or 4 x 4 matrix, got shape {matrix.shape}")
        down, across = count("rows", rows, 1), count("columns", columns, 1)
        says = conventions.of_gl_projection(matrix, down, across)
        seen = np.array(conventions.pose4(view))
        try:
            world = np.linalg.inv(seen)
        except np.linalg.LinAlgError:
            raise ValueError("view must have an inverse") from None
        if "K" in says:
            return cls.from_intrinsics(
                says["K"], rows=down, columns=across, convention="opengl", pose=world
            )
        base = cls.from_intrinsics(
            np.eye(3), rows=down, columns=across, convention="opengl", pose=world
        )
        parameters = [("focal_length", 1.0), *says.items()]
        view_, pixels = (base.position, base.aim, base.up), (down, across)
        return cls._of_arguments(view_, pixels, ("orthographic", "eye"), parameters)

    @property
    def intrinsic_matrix(self) -> npt.NDArray[np.float64] | None:
        """The intrinsic matrix K, (3, 3) float64; ``None`` for a projection without one.

        For the camera's coordinates x to the right, y down, z forwards; the centre of the first
        pixel is at (0.5, 0.5), as in COLMAP. Distortion comes before it. `to_opencv` gives
        OpenCV's.
        """
        k, _ = self._native.matrices("colmap")
        return None if k is None else np.array(k)

    @property
    def world_from_camera(self) -> npt.NDArray[np.float64]:
        """The pose, (4, 4) float64: from right, up and backwards to the world."""
        return np.array(self._native.matrices("opengl")[1])

    def to_convention(
        self, convention: Convention
    ) -> tuple[npt.NDArray[np.float64] | None, npt.NDArray[np.float64]]:
        """Return the intrinsic matrix and the pose as another program writes them.

        Parameters
        ----------
        convention : str
            As for `from_intrinsics`, which takes both back.

        Returns
        -------
        K : (3, 3) array of float64, or None
            ``None`` where there is none, as for parallel rays and panoramas.
        pose : (4, 4) array of float64
            The matrix of the pose.
        """
        k, pose = self._native.matrices(text("convention", convention))
        return None if k is None else np.array(k), np.array(pose)

    def to_opencv(self) -> OpenCvCamera:
        """Return the camera as OpenCV's functions take it.

        Returns
        -------
        OpenCvCamera
            ``K``, ``distortion``, ``rvec``, ``tvec``, ``R``, ``model`` and ``xi``.

        Raises
        ------
        ValueError
            For a projection that OpenCV does not have, and for a skew that it leaves out.
        """
        names = {
            "perspective": ("pinhole", ()),
            "opencv": ("pinhole", conventions.OPENCV),
            "opencv_fisheye": ("fisheye", conventions.FISHEYE),
            "mei": ("omnidir", conventions.OMNIDIR),
            "equidistant": ("fisheye", ()),
        }
        k, pose = self.to_convention("opencv")
        if k is None or self.projection not in names:
            raise ValueError(f"OpenCV has no such camera: {self.projection}")
        (model, order), values = names[self.projection], self.parameters
        conventions.check_skew(model, k[0, 1])
        distortion = np.array([values[name] for name in order])
        if self.projection == "equidistant":
            # The polynomial without a distortion.
            distortion = np.zeros(len(conventions.FISHEYE))
        turned = pose[:3, :3]
        rvec = conventions.rotation_vector(turned)
        xi = values.get("xi", 0.0) if model == "omnidir" else 0.0
        return OpenCvCamera(k, distortion, rvec, pose[:3, 3], turned, model, xi)

    def to_colmap(self) -> ColmapCamera:
        """Return the camera as COLMAP's files have it.

        Returns
        -------
        ColmapCamera
            The model, its parameters, and the pose; it writes lines of the text files. COLMAP has
            no aperture: that of a thin lens is left out.

        Raises
        ------
        ValueError
            For a camera that COLMAP has no model for.
        """
        return colmap.from_camera(self)

    def to_opengl(
        self, near: float, far: float
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Return OpenGL's projection and view matrices.

        Parameters
        ----------
        near, far : float
            The distances of the planes between which OpenGL keeps what it draws; positive, and
            ``far`` may be infinite.

        Returns
        -------
        projection, view : (4, 4) array of float64
            Applied to columns: ``projection @ view @ (x, y, z, 1)`` is in clip space.

        Raises
        ------
        ValueError
            For a camera other than a perspective one without tilt, and for other planes.
        """
        k, pose = self.to_convention("opengl")
        if k is None or self.projection != "perspective":
            raise ValueError(f"OpenGL has no such camera: {self.projection}")
        planes = number("near", near), number("far", far)
        view = np.linalg.inv(pose).astype(np.float64, copy=False)
        return conventions.gl_projection(k, self.rows, self.columns, *planes), view

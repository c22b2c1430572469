"""Cameras as other programs write them: OpenCV, COLMAP, OpenGL."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import number, numbers, vector
from firsthit._base.errors import warn

if TYPE_CHECKING:
    import numpy.typing as npt

#: OpenCV's distortion coefficients, in the order in which its functions take them.
OPENCV = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4", "tau_x", "tau_y")
#: How many of them its functions take.
_COUNTS = (0, 4, 5, 8, 12, 14)
#: The coefficients of ``cv2.fisheye`` and ``cv2.omnidir``.
FISHEYE = ("k1", "k2", "k3", "k4")
OMNIDIR = ("k1", "k2", "p1", "p2")

#: The names of `Camera.intrinsic_matrix`'s numbers among a lens' parameters.
MATRIX = ("fx", "fy", "cx", "cy", "skew")


class OpenCvCamera(NamedTuple):
    """A camera as OpenCV's functions take it; the centre of the first pixel is at (0, 0).

    Attributes
    ----------
    K : (3, 3) array of float64
        The camera matrix. ``cv2.fisheye`` takes its skew as ``alpha = K[0, 1] / K[0, 0]``.
    distortion : (n,) array of float64
        The coefficients: 0, 4, 5, 8, 12 or 14 for ``cv2.projectPoints``, 4 for ``cv2.fisheye`` and
        ``cv2.omnidir``.
    rvec, tvec : (3,) array of float64
        The rotation and translation that take world coordinates to the camera's.
    R : (3, 3) array of float64
        The rotation as a matrix.
    model : {"pinhole", "fisheye", "omnidir"}
        Which of OpenCV's functions the coefficients are for.
    xi : float
        Of ``cv2.omnidir``.
    """

    K: npt.NDArray[np.float64]
    distortion: npt.NDArray[np.float64]
    rvec: npt.NDArray[np.float64]
    tvec: npt.NDArray[np.float64]
    R: npt.NDArray[np.float64]
    model: str = "pinhole"
    xi: float = 0.0


def matrix3(name: str, value: npt.ArrayLike) -> list[list[float]]:
    """Return a 3 x 3 matrix of numbers."""
    return _matrix(name, value, (3, 3))


def intrinsics(value: npt.ArrayLike) -> list[list[float]]:
    """Return a matrix K, also from (fx, fy, cx, cy)."""
    array = numbers("K", value)
    if array.shape == (4,):
        fx, fy, cx, cy = array.tolist()
        return [[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]]
    if array.shape != (3, 3):
        raise ValueError(f"K must be a 3 x 3 matrix or (fx, fy, cx, cy), got shape {array.shape}")
    return _matrix("K", array, (3, 3))


def check_skew(model: str, skew: float) -> None:
    """Refuse a skew in K where no function of OpenCV's for a model takes it."""
    if skew != 0.0 and model == "pinhole":
        raise ValueError(f"cv2.projectPoints takes no skew in K, got {skew}")


def pose4(value: npt.ArrayLike | None) -> list[list[float]]:
    """Return a 4 x 4 matrix; the last row may be missing, and a rotation be rounded."""
    if value is None:
        return np.eye(4).tolist()
    array = numbers("pose", value)
    if array.shape == (3, 4):
        array = np.vstack([array, (0.0, 0.0, 0.0, 1.0)])
    made = _matrix("pose", array, (4, 4))
    orthonormal = _firsthit.orthonormalised(made)
    if orthonormal is None:
        return made
    turned, off = orthonormal
    what = "the rotation is rounded, and the nearest one is taken: numbers change by up to"
    warn(f"pose: {what} {off:.1e}")
    return turned


def rigid(pose: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return a 4 x 4 matrix that is a rotation and a translation, to 1e-4."""
    matrix = pose4(pose)
    _firsthit.check_pose(matrix)
    return np.array(matrix)


def _matrix(name: str, value: npt.ArrayLike, shape: tuple[int, int]) -> list[list[float]]:
    array = numbers(name, value)
    if array.shape != shape:
        raise ValueError(f"{name} must be a {shape[0]} x {shape[1]} matrix, got {array.shape}")
    made: list[list[float]] = array.astype(np.float64).tolist()
    return made


def rotation_of(
    rvec: npt.ArrayLike | None, rotation: npt.ArrayLike | None
) -> npt.NDArray[np.float64]:
    """Return the rotation matrix of one of the two."""
    if (rvec is None) == (rotation is None):
        raise ValueError("one of rvec and R must be given")
    if rotation is not None:
        return np.array(matrix3("R", rotation))
    given = numbers("rvec", rvec)
    if given.shape == (3, 3):
        return np.array(matrix3("rvec", given))
    if given.shape in ((3, 1), (1, 3)):
        given = given.ravel()
    return np.array(_firsthit.rotation(vector("rvec", given)))


def rotation_vector(rotation: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the axis times the angle of a rotation matrix, the angle from 0 to pi.

    By way of the quaternion with the largest component first (Shepperd 1978), which loses no digits
    at any angle.
    """
    w, axis = quaternion(rotation)
    sine = math.hypot(*axis)
    if sine == 0.0:
        return np.zeros(3)
    angle = 2.0 * math.atan2(sine, w)
    return axis * (angle / sine)


def quaternion(rotation: npt.NDArray[np.float64]) -> tuple[float, npt.NDArray[np.float64]]:
    """Return the quaternion of a rotation: its real part, not negative, and the others."""
    r = rotation
    trace = r[0, 0] + r[1, 1] + r[2, 2]
    squares = np.array([trace, r[0, 0], r[1, 1], r[2, 2]])
    largest = int(squares.argmax())
    if largest == 0:
        made = np.array([1.0 + trace, r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]])
    else:
        i = largest - 1
        j, k = (i + 1) % 3, (i + 2) % 3
        made = np.empty(4)
        made[0] = r[k, j] - r[j, k]
        made[1 + i] = 1.0 + r[i, i] - r[j, j] - r[k, k]
        made[1 + j] = r[j, i] + r[i, j]
        made[1 + k] = r[k, i] + r[i, k]
    made /= math.sqrt(float(made @ made))
    if made[0] < 0.0:
        made = -made
    return float(made[0]), made[1:]


def coefficients(distortion: npt.ArrayLike | None, model: str, xi: float) -> dict[str, float]:
    """Return OpenCV's coefficients by their names."""
    given = np.zeros(0) if distortion is None else numbers("distortion", distortion)
    # OpenCV itself returns a row or a column.
    if given.ndim > 2 or given.size != max(given.shape, default=1):
        raise ValueError(f"distortion must be one row or column, got the shape {given.shape}")
    given = given.ravel()
    names: tuple[str, ...] = OPENCV
    counts: tuple[int, ...] = _COUNTS
    if model == "fisheye":
        names, counts = FISHEYE, (0, 4)
    elif model == "omnidir":
        names, counts = OMNIDIR, (0, 4)
    elif model != "pinhole":
        raise ValueError(f"model must be pinhole, fisheye or omnidir, got {model!r}")
    if given.size not in counts:
        *most, last = map(str, counts)
        wanted = f"{', '.join(most)} or {last}"
        raise ValueError(f"distortion must have {wanted} numbers, got {given.size}")
    named = dict(zip(names, given.astype(np.float64).tolist(), strict=False))
    if model == "omnidir":
        named["xi"] = number("xi", xi)
    elif xi:
        raise ValueError(f"xi is for the model omnidir, got {xi!r}")
    return named


def decomposed(
    projection: npt.NDArray[np.float64],
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return K and [R | t] of a 3 x 4 projection matrix ``K [R | t]``, up to its scale and sign.

    By RQ decomposition; the diagonal of K is made positive.
    """
    largest = float(np.abs(projection[:, :3]).max())
    # A power of two rounds nothing, and keeps the determinant from 0 and infinity.
    scaled = np.ldexp(projection, -math.frexp(largest)[1]) if math.isfinite(largest) else projection
    volume = np.linalg.det(scaled[:, :3]) if np.isfinite(scaled).all() else 0.0
    if volume == 0.0:
        raise ValueError("P must be finite, with a left 3 x 3 part that has an inverse")
    signed = scaled if volume > 0.0 else -scaled
    # RQ from QR: turned upside down and transposed.
    q, r = np.linalg.qr(signed[::-1, :3].T)
    upper, rotation = r.T[::-1, ::-1], q.T[::-1]
    signs = np.sign(np.diag(upper))
    upper, rotation = upper * signs, signs[:, None] * rotation
    translation = np.linalg.solve(upper, signed[:, 3])
    k = upper / upper[2, 2]
    # Rounding leaves numbers below the diagonal.
    k = np.triu(k)
    k[2, 2] = 1.0
    return k, np.column_stack([rotation, translation])


def of_gl_projection(p: npt.NDArray[np.float64], rows: int, columns: int) -> dict[str, Any]:
    """Return what an OpenGL projection matrix says: K with the first pixel's centre at 0.5.

    Parallel rays have the viewplane's size and shift instead. Near and far plane count for nothing.
    """
    if not np.isfinite(p).all() or p[0, 0] <= 0.0 or p[1, 1] <= 0.0:
        raise ValueError(
            "P must be a finite projection matrix with positive first and second diagonal elements"
        )
    # Its last row says the scale of a projective matrix.
    scale = p[3, 3] if p[3, 2] == 0.0 else -p[3, 2]
    if scale > 0.0:
        with np.errstate(over="ignore"):
            p = p / scale
    others = np.array([p[1, 0], p[3, 0], p[3, 1]])
    if others.any():
        raise ValueError("P must be an OpenGL projection matrix, applied to columns")
    if tuple(p[3]) == (0.0, 0.0, -1.0, 0.0):
        fx, fy = p[0, 0] * columns / 2.0, p[1, 1] * rows / 2.0
        skew = -p[0, 1] * columns / 2.0
        cx, cy = columns / 2.0 * (1.0 - p[0, 2]), rows / 2.0 * (1.0 + p[1, 2])
        return {"K": [[fx, skew, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]]}
    if tuple(p[3]) == (0.0, 0.0, 0.0, 1.0) and not (p[0, 1] or p[0, 2] or p[1, 2]):
        return {
            "width": 2.0 / p[0, 0],
            "height": 2.0 / p[1, 1],
            "shift_x": -p[0, 3] / p[0, 0],
            "shift_y": -p[1, 3] / p[1, 1],
        }
    raise ValueError("P must have (0, 0, -1, 0) or (0, 0, 0, 1), times a scale, as its last row")


def gl_projection(
    k: npt.NDArray[np.float64], rows: int, columns: int, near: float, far: float
) -> npt.NDArray[np.float64]:
    """Return the OpenGL projection matrix of K, whose first pixel's centre is at 0.5."""
    if not 0.0 < near < far:
        raise ValueError(f"near and far must be positive and in this order, got {near}, {far}")
    p = np.zeros((4, 4))
    p[0] = 2.0 * k[0, 0] / columns, -2.0 * k[0, 1] / columns, 1.0 - 2.0 * k[0, 2] / columns, 0.0
    p[1, 1], p[1, 2] = 2.0 * k[1, 1] / rows, 2.0 * k[1, 2] / rows - 1.0
    if math.isinf(far):
        p[2, 2:] = -1.0, -2.0 * near
    else:
        p[2, 2:] = (near + far) / (near - far), 2.0 * near * far / (near - far)
    p[3, 2] = -1.0
    return p

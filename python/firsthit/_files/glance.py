"""Answers as notebooks show them: sizes, ranges and a small picture, at one glance."""

from __future__ import annotations

import base64
import html
from typing import TYPE_CHECKING, Any

import numpy as np

from .frame import Frame

if TYPE_CHECKING:
    from collections.abc import Iterable

    import numpy.typing as npt

    from firsthit._lidar.lidar_scan import LidarScan
    from firsthit._queries.hits import Hits
    from firsthit._queries.lint import LintReport
    from firsthit._queries.section import Section
    from firsthit._scene.objects import Objects

#: The most pixels of a small picture along an edge, and the most rows of a table.
_PIXELS, _ROWS = 320, 8

#: About the most points of a section's drawing.
_POINTS = 20_000


def of_hits(hits: Hits) -> str:
    """Show how far away hits are, and of which objects; a camera's hits as two pictures."""
    met = hits.object >= 0
    rows = [("t", _range(np.asarray(hits.t)))]
    names, counts = hits.names("object"), np.bincount(np.ravel(hits.object)[np.ravel(met)])
    # The most frequent first, and of equal ones the lowest.
    order = [int(each) for each in np.argsort(-counts, kind="stable") if counts[each]]
    rows += [(f"object {k}", f"{names[k]}: {counts[k]:,} rays") for k in order[:_ROWS]]
    if len(order) > _ROWS:
        rows.append(("", f"and {len(order) - _ROWS:,} more objects"))
    small = ""
    if len(hits.shape) == 2 and met.size:
        small = _small("t", np.asarray(hits.t)) + _small("object", np.asarray(hits.object))
    return _shown(repr(hits), small, rows)


def of_frame(frame: Frame) -> str:
    """Show a frame's picture, and the type and range of each channel."""
    png = frame._png()
    rows = [(name, f"{array.dtype} {_range(array)}") for name, array in frame.items()]
    return _shown(repr(frame), "" if png is None else _image(png), rows)


def of_objects(objects: Objects) -> str:
    """Show the first objects, each with its identifier, its name and its shape."""
    rows = [(str(k), f"{each.name}: {each.shape!r}") for k, each in enumerate(objects[:_ROWS])]
    if len(objects) > _ROWS:
        rows.append(("", f"and {len(objects) - _ROWS:,} more"))
    return _shown(f"{len(objects):,} objects", "", rows)


def of_section(section: Section) -> str:
    """Show a section as a drawing, with its area and perimeter."""
    points = sum(len(curve.points) for curve in section.polylines)
    step = 1 + points // _POINTS
    flat = [curve.points_2d[::step] for curve in section.polylines]
    rows = [("area", f"{section.area:.6g}"), ("perimeter", f"{section.perimeter:.6g}")]
    if section.left_out:
        rows.append(("left out", f"{len(section.left_out):,} objects"))
    if not flat:
        return _shown(repr(section), "", rows)
    every = np.concatenate(flat)
    low, size = every.min(axis=0), np.maximum(np.ptp(every, axis=0), 1e-300)
    # Pixels from the upper left corner, a margin of four around them.
    scale = _PIXELS / size.max()
    paths = [
        "M" + "L".join(f"{x:.2f} {y:.2f}" for x, y in _pixels(curve, low, size, scale))
        for curve in flat
    ]
    closed = [curve.is_closed for curve in section.polylines]
    drawn = "".join(
        f'<path d="{path}" fill="none" stroke="currentColor"/>'
        for path, is_closed in zip(paths, closed, strict=True)
        if not is_closed
    )
    outline = "".join(
        path + "Z" for path, is_closed in zip(paths, closed, strict=True) if is_closed
    )
    drawn += f'<path d="{outline}" fill="#8899aa" fill-rule="evenodd" stroke="currentColor"/>'
    width, height = (size * scale + 8).round(1)
    drawing = f'<svg width="{width}" height="{height}" role="img">{drawn}</svg>'
    return _shown(repr(section), drawing, rows)


def of_lint(report: LintReport) -> str:
    """Show each kind of finding, how many there are, and where the first one is."""
    if report.is_clean:
        kinds = len(report.checked)
        return _shown(repr(report), "", [("clean", f"{kinds} kinds were looked for")])
    rows = []
    for finding in report:
        where = ""
        if finding.places:
            x, y, z = finding.places[0].position
            where = f", the first at {x:.6g}, {y:.6g}, {z:.6g}"
        rows.append((finding.kind, f"{finding.count:,}{where}"))
    return _shown(repr(report), "", rows)


def of_scan(scan: LidarScan) -> str:
    """Show a scan's ranges, as a picture with a row for each laser."""
    rows = [("range", _range(scan.range))]
    rows.append(("objects", f"{len(np.unique(scan.object)):,}"))
    if not len(scan):
        return _shown(repr(scan), "", rows)
    picture = _small("range", scan.to_image("range"), "width:480px;height:96px")
    return _shown(repr(scan), picture, rows)


def _pixels(
    points: npt.NDArray[np.float64],
    low: npt.NDArray[np.float64],
    size: npt.NDArray[np.float64],
    scale: float,
) -> npt.NDArray[np.float64]:
    right, up = ((points - low) * scale).T
    return np.stack([right + 4, size[1] * scale - up + 4], axis=-1)


def _range(array: npt.NDArray[Any]) -> str:
    """Say the least and the largest number of an array, of those that are finite."""
    if array.dtype.kind == "f":
        array = array[np.isfinite(array)]
    if array.dtype.kind not in "biuf" or not array.size:
        return ""
    return f"{array.min():.6g} to {array.max():.6g}"


def _small(name: str, values: npt.NDArray[Any], style: str = "") -> str:
    """Return every so many pixels of a channel, as a picture."""
    down, across = (1 + (length - 1) // _PIXELS for length in values.shape)
    step = (1, across) if style else (max(down, across),) * 2
    kept = np.ascontiguousarray(values[:: step[0], :: step[1]])
    png = Frame(kept.shape, {name: kept})._png()
    return "" if png is None else _image(png, style)


def _image(png: bytes, style: str = "") -> str:
    data = base64.b64encode(png).decode()
    how = f' style="{style};image-rendering:pixelated"' if style else ""
    return f'<img alt="" src="data:image/png;base64,{data}"{how}> '


def _shown(title: str, picture: str, rows: Iterable[tuple[str, str]]) -> str:
    """Return a title, a picture and a table; names of files are text, never HTML."""
    cells = "".join(
        f'<tr><th style="text-align:left">{html.escape(name)}</th>'
        f'<td style="text-align:left">{html.escape(said)}</td></tr>'
        for name, said in rows
    )
    return f"<div>{picture}<p>{html.escape(title)}</p><table>{cells}</table></div>"

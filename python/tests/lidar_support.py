"""Scenes that tests of scanners share."""

import firsthit as fh


def room():
    made = fh.Scene()
    made.add(fh.Box((-4, -3, -1), (4, 3, 2)), material=fh.Material(color=(0.5, 0.5, 0.5)))
    return made


def layers():
    """Sheets across the beam, at 4 and 6, and a wall at 10."""
    made = fh.Scene()
    for x, half in ((4, 1.0), (6, 2.0), (10, 50.0)):
        low, high = (x, -half, -half), (x + 0.001, half, half)
        made.add(fh.Box(low, high), material=fh.Material(color=(x / 20,) * 3))
    return made

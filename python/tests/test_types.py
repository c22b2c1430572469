"""The package as type checkers see it, from a user's script."""

import builtins
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import get_args

import firsthit as fh
import numpy as np
import pytest
from firsthit import _firsthit, typing
from support import ball

CONSUMER = Path(__file__).parent / "typed" / "consumer.py"


@pytest.fixture
def script(tmp_path):
    """A copy where nothing of the clone is beside it: what is found is what is installed."""
    return Path(shutil.copy(CONSUMER, tmp_path))


def run(command, folder):
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def test_a_user_s_script_passes_mypy_strict(script):
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", script.parent / "cache"]
    result = run([*command, script.name], script.parent)
    assert result.returncode == 0, result.stdout + result.stderr


def test_a_user_s_script_passes_pyright_strict(script):
    pytest.importorskip("basedpyright")
    settings = {"typeCheckingMode": "strict", "reportUnnecessaryTypeIgnoreComment": "error"}
    (script.parent / "pyrightconfig.json").write_text(json.dumps(settings))
    command = [sys.executable, "-m", "basedpyright", "--pythonpath", sys.executable, script.name]
    result = run(command, script.parent)
    assert result.returncode == 0, result.stdout + result.stderr


def test_a_user_s_script_runs(script):
    result = run([sys.executable, "-W", "error", script.name], script.parent)
    assert result.returncode == 0, result.stderr


def test_words_that_are_typed_are_those_that_there_are():
    channels = [name for name, _ in _firsthit.channel_names()]
    assert list(get_args(typing.ChannelName)) == channels
    parts = (
        typing.DistanceName,
        typing.AngleName,
        typing.IdentifierName,
        typing.VectorName,
        typing.MatteName,
    )
    words = [word for part in parts for word in get_args(part)]
    of_pictures = {"color", "edge", "alpha", "ao", "samples"}
    assert {"front", "valid", *of_pictures, *words} == set(channels)
    told = [
        (typing.ShaderName, natively_shaded),
        (typing.ToneMapName, natively_shown),
        (typing.ViewName, lambda word: fh.Camera.framing(ball(), 2, 2, view=word)),
        (typing.Projection, projected),
        (typing.RayStart, lambda word: small(ray_start=word)),
        (typing.FovAxis, lambda word: aimed(fov_axis=word)),
    ]
    for kind, make in told:
        for word in get_args(kind):
            make(word)
        with pytest.raises(ValueError, match=r" must be .*, got '?toon'?$") as refused:
            make("toon")
        listed = str(refused.value).split("must be ")[1].split(", got ")[0]
        words = re.findall(r"[\w-]+", listed.removeprefix("one of ").replace(" or ", " "))
        assert set(words) == set(get_args(kind))


def natively_shaded(shader):
    # Of the native half, which knows all shaders.
    shading = shader, [], None, None, 1, None
    picture = shading, None, (0, 0, 1), 1, (0, 2, 0, 2), None, None, None
    _firsthit.render(ball()._native(), small()._native, ["color"], picture, None, (0, None))


def natively_shown(tone_map):
    _firsthit.png([1, 1], "color", np.zeros(3, np.float32), (0.0, tone_map))


def projected(word):
    if word in ("perspective", "orthographic", "toon"):
        return small(projection=word)
    panoramas = ("equirectangular", "cylindrical", "cube_map", "octahedral")
    parameters = {} if word in panoramas else {"fx": 1.0, "fy": 1.0}
    lengths = None, None, None
    frame = (0, 0, 0), (0, 0, -1), (0, 1, 0)
    return fh.Camera(*frame, *lengths, 2, 3, word, "eye", parameters)


def aimed(**words):
    return fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 45, 2, 2, **words)


def small(**words):
    lengths = 1, 1, 1
    if words.get("projection") == "equirectangular":
        lengths, words = (None, None, None), {"ray_start": "eye", **words}
    return fh.Camera((0, 0, 5), (0, 0, -1), (0, 1, 0), *lengths, 2, 2, **words)


def test_arguments_are_taken_as_the_types_say_and_shown_as_tuples():
    sphere = fh.Sphere(center=[0, 1, 2], radius=1)
    assert repr(sphere) == "Sphere(center=(0.0, 1.0, 2.0), radius=1.0)"
    assert sphere == fh.Sphere((0, 1, 2), 1)
    assert repr(fh.Shading()) == (
        "Shading(shade=None, samples=None, light=None, ground=None, colors=None)"
    )
    assert repr(fh.PointLight([0, 0, 1])) == (
        "PointLight(position=(0.0, 0.0, 1.0), intensity=(1.0, 1.0, 1.0))"
    )


def test_a_star_import_leaves_python_s_own_names_in_place():
    names: dict[str, object] = {}
    exec("from firsthit import *", names)
    assert not {*names} & {*dir(builtins)} - {"__doc__", "__name__"}
    assert callable(fh.open)

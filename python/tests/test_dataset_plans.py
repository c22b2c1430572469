"""Plans of data sets: what is refused, with its line, before anything is made."""

import copy
import datetime
import json
import re
import sys
import tomllib
from typing import get_args

import firsthit as fh
import pytest
from dataset_support import PLAN, PLANS, ROOT, plan, record
from firsthit.typing import Projection

GOOD = """\
[[scenes]]
file = "yard.toml"

[[sensors]]
kind = "camera"
columns = 40
rows = 30

[poses]
kind = "sphere"
count = 3
center = [0, 0, 1]
radius = [
    2,
    4,
]
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "yard.toml").write_text((PLANS / "yard.toml").read_text())
    return tmp_path


def test_a_good_plan_is_read(folder):
    (folder / "plan.toml").write_text(GOOD)
    made = fh.Plan.load(folder / "plan.toml")
    assert (made.frames, made.scenes, made.sensors) == (3, ("yard.toml",), ("camera",))
    assert repr(made) == "Plan(3 frames: 1 scene, sensor camera)"
    with pytest.raises(TypeError, match=r"Plan\.load"):
        fh.Plan()


@pytest.mark.parametrize(
    ("before", "after", "line", "words"),
    [
        ("columns", "colums", 6, "unknown key `colums`, did you mean `columns`?"),
        ("rows = 30\n", "", 4, 'projection = "perspective" needs `rows`: a whole'),
        ("rows = 30", "rows = -1", 7, "`rows` must be a whole number from 1 to"),
        ("rows = 30", "rows = 3.5", 7, "a whole number from 1 to 268435456, got 3.5"),
        ("rows = 30", "rows = true", 7, "`rows` must be a whole number"),
        ("rows = 30", f"rows = {10**30}", 7, "`rows` must be a whole number"),
        ("count = 3", f"count = {'9' * 5000}", 11, "got a number of very many digits"),
        ("count = 3", "count = 0", 11, "`count` must be a whole number from 1 to 1000000000"),
        ("count = 3", "count = 10_000_000_000", 11, "`count` must be a whole number from 1"),
        (
            "[0, 0, 1]",
            "[0, nan, 1]",
            12,
            "`center` must be three finite numbers, [x, y, z], got nan",
        ),
        ("[0, 0, 1]", "[0, 1]", 12, "`center` must be three finite numbers, [x, y, z], got [0, 1]"),
        ("[0, 0, 1]", '"here"', 12, '`center` must be three finite numbers, [x, y, z], got "here"'),
        ("    4,", "    inf,", 13, "`radius` must be a positive, finite number, or two that do"),
        ("    4,", "    1,", 13, "or two that do not decrease, got [2, 1]"),
        ('"sphere"', '"spere"', 10, 'unknown kind "spere", did you mean "sphere"?'),
        ('"sphere"', "3", 10, '`kind` must be one of "sphere", "inside", "path", "list", got 3'),
        ("[poses]", "[[poses]]", 9, "`poses` must be a table, got an array of 1"),
        (
            "[[scenes]]",
            "[scenes]",
            1,
            "`scenes` must be an array of tables, [[scenes]], got a table",
        ),
        ('file = "yard.toml"', "", 1, "this table needs `file`: the name of a file"),
        ("count = 3", "count = 3\nyaw = [0, 90]", 12, 'unknown key `yaw`; kind = "sphere" takes '),
        ("[poses]", "[pose]", 9, "unknown key `pose`, did you mean `poses`?"),
        (
            "[[scenes]]",
            "version = 2\n[[scenes]]",
            1,
            "`version` must be a whole number from 1 to 1, got 2",
        ),
        ("[[scenes]]", "speed = 2\n[[scenes]]", 1, "unknown key `speed`"),
    ],
)
def test_mistakes_are_told_with_their_line(folder, before, after, line, words):
    assert before in GOOD
    path = folder / "plan.toml"
    path.write_text(GOOD.replace(before, after, 1))
    with pytest.raises(fh.FileFormatError) as caught:
        fh.Plan.load(path)
    said = str(caught.value)
    assert words in said
    if line is not None:
        assert said.startswith(f"{path}:{line}:")
        assert caught.value.place.startswith(f"line {line}, column ")
    assert "\n" not in said
    assert len(said) < 400


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "plan.toml:1:1: this table needs `scenes`"),
        (b"\xff\xfe", "plan.toml:1:1: the text is not UTF-8"),
        (b"[[scenes]\n", "plan.toml:1:10: this is not TOML"),
        (b"a = 1\na = 2\n", "plan.toml:2:1: this is not TOML: duplicate key"),
        (b"scenes = " + b"[" * 100_000, "plan.toml:1:90: this is not TOML"),
        (b"#" * ((16 << 20) + 1), "a plan may have 16 MiB at most"),
        ("schl\u00fcssel = 1".encode(), "plan.toml:1:5: this is not TOML"),
        ('"schl\u00fc\u202essel" = 1'.encode(), "unknown key `schl\u00fc\\u{202e}ssel`"),
        (b"scenes = [1]\nposes = 1", "`scenes` must be an array of tables, [[scenes]], got 1"),
    ],
)
def test_files_that_are_no_plans_are_refused(folder, content, words):
    path = folder / "plan.toml"
    path.write_bytes(content)
    with pytest.raises(fh.FileFormatError) as caught:
        fh.Plan.load(path)
    assert words in str(caught.value)


def test_what_cannot_be_read_is_an_error_of_reading(tmp_path):
    for path in (tmp_path / "none.toml", tmp_path, "a\0b"):
        with pytest.raises(fh.FileReadError):
            fh.Plan.load(path)


@pytest.mark.skipif(sys.platform == "win32", reason="links take a privilege there")
def test_nothing_outside_the_plan_s_folder_is_opened(folder):
    inside = folder / "plans"
    inside.mkdir()
    (inside / "linked.toml").symlink_to("../yard.toml")
    (inside / "yard.toml").symlink_to("real.toml")
    (inside / "real.toml").write_text((folder / "yard.toml").read_text())
    (inside / "folder.toml").mkdir()

    def with_file(name):
        return fh.Plan.from_dict(plan(lambda made: made["scenes"][0].update(file=name)), inside)

    assert with_file("yard.toml").frames == 7
    for name, words in [
        ("../yard.toml", r"the path has \.\.; only files in the same folder and below"),
        ("x/../../yard.toml", r"the path has \.\."),
        (str(folder / "yard.toml"), "the path is absolute"),
        ("linked.toml", "it leads outside the folder"),
        ("", "`file` must be the name of a file"),
        ("file:yard.toml", "has a scheme or a drive"),
        ("a\\yard.toml", "has a backslash"),
        ("yard.toml\0", "has a control character"),
        ("\ud800.toml", "surrogates not allowed"),
        ("folder.toml", "a folder, not a file"),
        ("none.toml", "No such file"),
        ("n" * 5000, "File name too long"),
    ]:
        with pytest.raises(ValueError, match=words):
            with_file(name)
    listed = {"kind": "list", "body": "forwards-left-up", "file": "../poses.npy"}
    with pytest.raises(ValueError, match="the path has"):
        fh.Plan.from_dict(plan(lambda made: made.update(poses=listed)), PLANS)
    given = {"body": "forwards-left-up", "file": "../drive.csv"}
    path = {"kind": "path", "trajectory": given}
    with pytest.raises(ValueError, match="the path has"):
        fh.Plan.from_dict(plan(lambda made: made.update(poses=path)), PLANS)
    lidar = {"kind": "lidar", "file": "../beams.csv"}
    with pytest.raises(ValueError, match="the path has"):
        fh.Plan.from_dict(plan(lambda made: made["sensors"].append(lidar)), PLANS)


def in_poses(**keys):
    return lambda made: made["poses"].update(keys)


def in_camera(**keys):
    return lambda made: made["sensors"][0].update(keys)


def in_lidar(**keys):
    return lambda made: made["sensors"][1].update(keys)


def in_output(**keys):
    return lambda made: made["output"].update(keys)


def only_lidar(made):
    del made["sensors"][0]


DRIVE = {"body": "forwards-left-up", "times": [0, 1], "positions": [[0, 0, 0], [1, 0, 0]]}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda made: made.update(sensors=[]), "`sensors` must be one table"),
        (lambda made: made["sensors"].append({"name": "eye", "rows": 1, "columns": 1}), "two sens"),
        (lambda made: made["scenes"].append({"file": "yard.toml"}), "two scenes have the name"),
        (lambda made: made["scenes"][0].update(classes={"*": False}), "must name a class"),
        (
            lambda made: made["scenes"][0].update(classes={"*": ""}),
            "`*` must be a text, not empty, or true or false",
        ),
        (lambda made: made["scenes"][0].update(classes={"*": 3}), "or true or false, got 3"),
        (lambda made: made["scenes"][0].update(by="name"), '`by` must be one of "object", "node"'),
        (
            lambda made: made["scenes"][0].update(up=[0, 0, 0]),
            "[x, y, z], not all zero, got [0, 0, 0]",
        ),
        (lambda made: made["scenes"][0].update(up="z"), "`up` must be three finite numbers"),
        (in_camera(name="../x"), "`name` must be letters, digits"),
        (in_camera(name="x" * 65), "`name` must be letters, digits"),
        (in_camera(kind="kamera"), 'did you mean "camera"?'),
        (in_camera(fov=180), "sensors[0]: "),
        (in_camera(fov=float("nan")), "`fov` must be a number between 0 and 180, got nan"),
        (in_camera(k1=0.1), "sensors[0]: "),
        (in_camera(projection="opencv"), "sensors[0]: "),
        (in_camera(fx=5.0), "`fov` and `fx` exclude each other"),
        (in_camera(convention="opencv"), "`convention` is for `pose` and for `fx`"),
        (in_camera(pose=[[1, 0, 0, 0]] * 3), "`pose` needs `convention` beside it"),
        (in_camera(pose=[[1, 0, 0, 0]] * 3, convention="opencv"), "sensors[0]: "),
        (in_camera(aim=[1, 0, 0], look_at=[1, 1, 1]), "exclude each other"),
        (in_camera(aim=[0, 0, 0]), "sensors[0]: "),
        (
            in_camera(focal_length=1, width=1, height=1),
            "`fov` and `focal_length` exclude each other",
        ),
        (in_camera(rows=2**31 + 1), "sensors[0]: "),
        (in_camera(readout=0.1), "unknown key `readout`"),
        (in_lidar(model="vlp-16"), "unknown key `pattern`; this table takes"),
        (in_lidar(elevations=[]), "`elevations` must be an array of at least 1, each item a fi"),
        (in_lidar(elevations=[95]), "sensors[1]: "),
        (in_lidar(dropout=2), "dropout must be from 0 to 1"),
        (in_lidar(returns="some"), '`returns` must be one of "first", "last", "strongest", "all"'),
        (in_lidar(position=[0, 0, 0], pose=[[1, 0, 0, 0]] * 3), "exclude each other"),
        (in_lidar(moving=True), 'moves while it sees: `kind` must be "path"'),
        (in_poses(seed=-1), "`seed` must be a whole number from 0 to"),
        (in_poses(seed=2**63), "`seed` must be a whole number from 0 to"),
        (in_poses(radius=0), "`radius` must be a positive, finite number, or two that do"),
        (in_poses(elevation=[-91, 0]), "a number from -90 to 90, or two that do not decrease"),
        (in_poses(up=[0, 0, 0]), "not all zero, got [0, 0, 0]"),
        (in_poses(clearance=-1), "`clearance` must be zero or a positive, finite number"),
        (in_poses(tries=0), "`tries` must be a whole number from 1"),
        (
            lambda made: made.update(poses={"kind": "inside", "count": 1, "low": [0, 0, 0]}),
            "needs `hi",
        ),
        (lambda made: made.update(poses={"kind": "list"}), "needs `body`: one of "),
        (
            lambda made: made.update(
                poses={"kind": "list", "body": "forwards-left-up", "matrices": [[[2, 0, 0, 0]] * 3]}
            ),
            "pose 0: pose must be a rotation and a translation",
        ),
        (
            lambda made: made.update(poses={"kind": "path"}),
            'kind = "path" needs `trajectory`: a table',
        ),
        (
            lambda made: made.update(poses={"kind": "path", "trajectory": DRIVE, "end": 2}),
            "`end` needs `rate` or `count` beside it",
        ),
        (
            lambda made: made.update(
                poses={"kind": "path", "trajectory": DRIVE, "rate": 1, "end": 2}
            ),
            "poses: ",
        ),
        (
            lambda made: made.update(
                poses={"kind": "path", "trajectory": DRIVE, "rate": 1, "count": 2}
            ),
            "exclude each other",
        ),
        (
            lambda made: made.update(poses={"kind": "path", "trajectory": DRIVE, "rate": 1e300}),
            "makes more than 1000000000 frames",
        ),
        (in_output(channels=["colour"]), 'unknown channels "colour", did you mean "color"?'),
        (in_output(channels=[]), "one or more"),
        (in_output(pictures=["normal"]), "'normal' is not among `channels`"),
        (in_output(frames=[]), "nothing is written of 'object'"),
        (in_output(frames=["png"]), '`frames` must be one of "npz", "exr", or an array of them'),
        (in_output(pictures=["color"]), "there is not t, range or z in a .png"),
        (in_output(clouds=[]), "one format or several"),
        (in_output(clouds=["obj"]), '`clouds` must be one of "npz", "ply", '),
        (in_output(samples=0), "`samples` must be a whole number from 1 to 65536"),
        (in_output(shade="toon"), "`shade` must be one of"),
        (in_output(background="bluee"), 'did you mean "blue"'),
        (in_output(masks=["all"]), '`masks` must be one of "visible", "amodal", or an array'),
        (in_output(coco={"masks": "both"}), "output.coco: `masks` must be one of"),
        (in_output(coco=True), "output: `coco` must be a table, got true"),
        (in_output(bop={}), "output.bop: this table needs `unit`"),
        (in_output(bop={"unit": "feet"}), "output.bop: unit must be"),
        (in_output(kitti={"unit": "m", "up": "-x"}), "different axes"),
        (in_output(kitti={"unit": "m", "occlusion": [0.1, 0.2]}), "the larger one first"),
        (in_output(yolo={"validation": 1.5}), "`validation` must be a number from 0 to 1"),
        (in_output(when=datetime.date(2026, 1, 1)), "unknown key `when`"),
        (only_lidar, "`channels` does nothing here: no sensor makes pictures"),
        (lambda made: made["sensors"].pop(1), "`clouds` does nothing here: no sensor is a lidar"),
        (lambda made: made["sensors"][0].update(kind="pushbroom"), "unknown key `rows`"),
    ],
)
def test_hostile_and_mistaken_plans_are_refused_whole(change, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        fh.Plan.from_dict(plan(change), PLANS)


@pytest.mark.parametrize("form", ["kitti", "bop"])
@pytest.mark.parametrize(
    ("lens", "words"),
    [
        ({"projection": "equidistant"}, "perspective cameras, and its projection is equidistant"),
        ({"projection": "orthographic"}, "perspective cameras, and its projection is orthographic"),
        ({"tilt_x": 5.0}, "tilted viewplane"),
    ],
)
def test_a_format_that_cannot_have_a_camera_is_told_when_the_plan_is_read(form, lens, words):
    def change(made):
        made["sensors"][0].update(lens)
        made["output"] = {form: {"unit": "m"}}

    with pytest.raises(ValueError, match=f"output: `{form}` of sensor 'eye': .*{words}") as caught:
        fh.Plan.from_dict(plan(change), PLANS)
    assert "Camera(" not in str(caught.value)


def moving_and_still(made):
    """A still camera, a rolling shutter and a pushbroom, on a path."""
    lens = {"columns": 24, "rows": 18, "fov": 60.0, "position": [0, 0, 0.6]}
    rolling = lens | {"kind": "rolling_shutter", "readout": 0.3, "annotate": True}
    swept = {key: lens[key] for key in ("columns", "fov", "position")}
    swept |= {"kind": "pushbroom", "lines": 12, "line_rate": 40, "annotate": True}
    made["sensors"] = [lens | {"name": "still"}, rolling, swept]
    held = DRIVE | {"extrapolation": "hold"}
    made["poses"] = {"kind": "path", "trajectory": held, "times": [0.2, 0.5]}
    made["output"] = {"pictures": ["color"], "masks": ["visible"], "coco": {"form": "rle"}}


def test_moving_cameras_are_annotated_if_the_plan_says_so(tmp_path):
    data = plan(moving_and_still)
    fh.dataset(fh.Plan.from_dict(data, PLANS), tmp_path / "all")
    scene, said = fh.load(PLANS / "yard.toml"), record(tmp_path / "all", 1)
    options = fh.Plan.from_dict(data, PLANS)._scenes[0].annotate_options
    assert [*said["annotations"]] == ["still", "rolling_shutter", "pushbroom"]
    made = fh.Plan.from_dict(data, PLANS)
    place = made._poses.place(3, 1, 1, scene)
    for sensor in made._sensors:
        found = fh.annotate(scene, sensor.at(place), **options)
        instances = said["annotations"][sensor.name]["instances"]
        assert [one["id"] for one in instances] == [one.id for one in found.instances]
        assert len(instances) > 1
        coco = said["annotations"][sensor.name]["coco"]["annotations"]
        assert [tuple(one["bbox"]) for one in coco] == [one.visible_box for one in found.instances]
    # Left alone, moving cameras are not annotated; and a still one need not be.
    for sensor in data["sensors"][1:]:
        del sensor["annotate"]
    fh.dataset(fh.Plan.from_dict(data, PLANS), tmp_path / "still")
    assert [*record(tmp_path / "still", 1)["annotations"]] == ["still"]
    data["sensors"][0]["annotate"], data["sensors"][2]["annotate"] = False, True
    fh.dataset(fh.Plan.from_dict(data, PLANS), tmp_path / "swept")
    assert [*record(tmp_path / "swept", 1)["annotations"]] == ["pushbroom"]


def test_annotate_is_refused_where_it_cannot_be_or_does_nothing():
    def changed(**output):
        data = plan(moving_and_still)
        data["output"] |= output
        return data

    for form in ("bop", "kitti"):
        with pytest.raises(
            ValueError, match=f"`{form}` of sensor 'rolling_shutter': it has one po"
        ):
            fh.Plan.from_dict(changed(**{form: {"unit": "m"}}), PLANS)
        # The formats are those of the cameras that are annotated.
        data = changed(**{form: {"unit": "m"}})
        for sensor in data["sensors"][1:]:
            sensor["annotate"] = False
        assert fh.Plan.from_dict(data, PLANS).frames == 2
    data = changed()
    data["output"] = {"pictures": ["color"]}
    with pytest.raises(ValueError, match="`annotate` of sensor 'rolling_shutter' does nothing"):
        fh.Plan.from_dict(data, PLANS)
    data = changed()
    data["sensors"] = data["sensors"][1:]
    for sensor in data["sensors"]:
        del sensor["annotate"]
    with pytest.raises(ValueError, match="or with `annotate = true`"):
        fh.Plan.from_dict(data, PLANS)
    data = plan(lambda made: made["sensors"][1].update(annotate=True))
    with pytest.raises(ValueError, match="unknown key `annotate`"):
        fh.Plan.from_dict(data, PLANS)


def test_a_model_of_a_lidar_has_its_name_in_any_case():
    def change(made):
        made["sensors"][1] = {"kind": "lidar", "model": "VLP-16"}

    sensor = fh.Plan.from_dict(plan(change), PLANS)._sensors[1]
    assert sensor.beams == fh.Lidar.named("Vlp-16").shape == fh.Lidar.named("vlp-16").shape
    assert repr(fh.Lidar.named("VLP-16")) == repr(fh.Lidar.named("vlp-16"))


MOVING = [
    {"kind": "rolling_shutter", "readout": 0.02, "columns": 8, "rows": 8, "name": "eye"},
    {"kind": "pushbroom", "line_rate": 100, "lines": 2, "columns": 8, "name": "eye"},
    {"kind": "lidar", "model": "vlp-16", "moving": True, "name": "eye"},
    {"kind": "lidar", "pattern": "spinning", "elevations": [0, 5], "moving": True, "name": "eye"}
    | {"firing_offsets": [0, -0.01], "columns": 4},
]


@pytest.mark.parametrize("sensor", MOVING)
@pytest.mark.parametrize("when", [{}, {"count": 5}, {"rate": 4}, {"times": [0.5, 1, 0]}])
def test_a_sensor_that_sees_beyond_the_path_is_told_when_the_plan_is_read(sensor, when):
    data = {"scenes": [{"file": "yard.toml"}], "sensors": [sensor]}
    data["poses"] = {"kind": "path", "trajectory": DRIVE} | when
    with pytest.raises(ValueError, match=r"sensor 'eye' sees from .*`extrapolation = .hold.`"):
        fh.Plan.from_dict(data, PLANS)
    data["poses"]["trajectory"] = DRIVE | {"extrapolation": "hold"}
    assert fh.Plan.from_dict(data, PLANS).frames > 1


@pytest.mark.parametrize("sensor", MOVING)
@pytest.mark.parametrize("end", [0.3, 0.7, 0.89, 0.9, 0.98, 0.99, 0.991, 1.0])
def test_a_plan_is_refused_where_its_last_frame_cannot_be_made_and_only_there(sensor, end):
    data = {"scenes": [{"file": "yard.toml"}], "sensors": [sensor]}
    held = DRIVE | {"extrapolation": "hold"}
    data["poses"] = {"kind": "path", "trajectory": held, "times": [0.2, end]}
    made = fh.Plan.from_dict(data, PLANS)
    place = made._poses.place(0, 1, 1, None)._replace(
        trajectory=fh.Trajectory(DRIVE["times"], DRIVE["positions"], body="forwards-left-up")
    )
    data["poses"]["trajectory"] = DRIVE
    try:
        made._sensors[0].at(place)
    except ValueError:
        with pytest.raises(ValueError, match="sensor 'eye' sees from"):
            fh.Plan.from_dict(data, PLANS)
    else:
        assert fh.Plan.from_dict(data, PLANS).frames == 2


def test_a_key_of_very_many_parts_is_refused_at_once(folder):
    (folder / "plan.toml").write_text("a" + ".a" * 100_000 + " = 1")
    with pytest.raises(fh.FileFormatError, match="this is not TOML: recursion limit"):
        fh.Plan.load(folder / "plan.toml")


@pytest.mark.parametrize("data", [3, None, [], "plan.toml"])
def test_what_is_no_table_is_no_plan(data):
    with pytest.raises(ValueError, match="plan: it must be a table, got"):
        fh.Plan.from_dict(data)


def test_plans_that_are_nested_too_deeply_are_refused():
    deep = {}
    for _ in range(100_000):
        deep = {"a": deep}
    with pytest.raises(ValueError, match="nested too deeply"):
        fh.Plan.from_dict(deep)


def test_a_plan_s_data_stay_as_they_are():
    data = plan()
    before = copy.deepcopy(data)
    fh.Plan.from_dict(data, PLANS)
    assert data == before == PLAN


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (in_output(channels=["color", "z", "object", "attribute:heat"]), "scene 'yard.toml': "),
        (lambda made: made["scenes"][0].update(keypoints={"cat": {"points": {}}}), "keypoints"),
        (in_poses(clearance=1e9), "none of 100 places"),
    ],
)
def test_what_does_not_fit_a_scene_is_told_before_anything_is_made(tmp_path, change, words):
    made = fh.Plan.from_dict(plan(change), PLANS)
    with pytest.raises(ValueError, match=words):
        fh.dataset(made, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_huge_picture_is_a_limit_and_not_a_crash(tmp_path):
    made = fh.Plan.from_dict(plan(in_camera(rows=2**28, columns=2**28, fov=1)), PLANS)
    assert made.cost().rays > 2**58
    with pytest.raises(MemoryError):
        fh.dataset(made, tmp_path / "out")


@pytest.mark.parametrize("projection", sorted(get_args(Projection)))
def test_every_projection_can_be_planned(projection):
    shape = {"cube_map": (24, 144), "equirectangular": (9, 18)}.get(projection, (20, 30))
    one = {"name": "lens", "kind": "camera", "rows": shape[0], "columns": shape[1]}
    one["projection"] = projection
    calibrated = {"opencv", "opencv_fisheye", "kannala_brandt", "double_sphere", "eucm", "ucm"}
    calibrated |= {"mei", "fov", "thin_prism_fisheye", "rad_tan_thin_prism_fisheye"}
    if projection in calibrated:
        one |= {"fx": 20.0, "fy": 20.0, "cx": 15.0, "cy": 10.0, "convention": "colmap"}
        more = {"kannala_brandt": {"k1": 1.0}, "eucm": {"alpha": 0.5, "beta": 1.0}}
        one |= more.get(
            projection, {"alpha": 0.5} if projection in ("ucm", "double_sphere") else {}
        )
    elif projection == "orthographic":
        one |= {"width": 6.0, "height": 4.0}
    elif projection == "octahedral":
        one |= {"rows": 20, "columns": 20}

    def with_lens(made):
        made["sensors"] = [one]
        made["poses"]["count"] = 1
        made["output"] = {"channels": ["range", "object"]}

    made = fh.Plan.from_dict(plan(with_lens), PLANS)
    scene = fh.load(PLANS / "yard.toml")
    camera = made._sensors[0].at(made._poses.place(3, 0, 0, scene))
    assert camera.projection == projection
    # Each number of the projection is a key.
    own = {"fx", "fy", "cx", "cy", "skew", "fov", "focal_length", "width", "height"}
    one |= {name: value for name, value in camera.parameters.items() if name not in own}
    again = fh.Plan.from_dict(plan(with_lens), PLANS)
    assert again._sensors[0].at(again._poses.place(3, 0, 0, scene)) == camera
    assert (fh.render(scene, camera, channels="object")["object"] > 0).any()


def test_a_plan_s_camera_has_its_numbers_and_its_thin_lens():
    one = {"name": "lens", "kind": "camera", "rows": 20, "columns": 30, "projection": "fov"}
    one |= {"fx": 20.0, "fy": 20.0, "cx": 15.0, "cy": 10.0, "convention": "colmap"}

    def with_lens(made, more):
        made["sensors"] = [one | more]
        made["output"] = {"channels": ["range", "object"]}

    more = {"omega": 0.9, "aperture": 0.3, "focus": 5.0}
    made = fh.Plan.from_dict(plan(lambda made: with_lens(made, more)), PLANS)
    parameters = made._sensors[0].camera.parameters
    assert {name: parameters[name] for name in more} == more
    with pytest.raises(ValueError, match="`aperture` needs `focus` beside it"):
        fh.Plan.from_dict(plan(lambda made: with_lens(made, {"aperture": 0.3})), PLANS)
    with pytest.raises(ValueError, match="`focus` needs `aperture` beside it"):
        fh.Plan.from_dict(plan(lambda made: with_lens(made, {"focus": 5.0})), PLANS)


def keys_of_plans():
    """Every key that the schema says a plan may have."""
    schema = json.loads((ROOT / "docs" / "plan.schema.json").read_text())
    records = [schema, *schema["$defs"].values()]
    forms = [form for record in records for form in record.get("oneOf", [record])]
    return {key for form in forms for key in form.get("properties", {})}


def test_every_key_is_in_the_document():
    keys, pages = keys_of_plans(), ("datasets.md", "scene.md")
    text = "".join((ROOT / "docs" / page).read_text() for page in pages)
    assert len(keys) > 150
    assert {"clearance", "dropout", "png_scale", "tilt_degrees", "line_rate", "k6"} <= keys
    assert [key for key in sorted(keys) if f"`{key}`" not in text] == []


def test_the_schema_takes_what_the_reader_takes_and_nothing_else():
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads((ROOT / "docs" / "plan.schema.json").read_text())
    judge = jsonschema.Draft202012Validator(schema)
    judge.check_schema(schema)
    for name in ("robot", "turntable"):
        judge.validate(tomllib.loads((PLANS / f"{name}.toml").read_text()))
    judge.validate(PLAN)
    for change in (in_camera(colums=3), in_camera(fx=5.0), in_poses(radius=0), in_lidar(model="x")):
        assert not judge.is_valid(plan(change))
        with pytest.raises(ValueError, match="plan: "):
            fh.Plan.from_dict(plan(change), PLANS)


def test_the_focus_of_a_plan_s_camera_may_be_a_point():
    def focused(focus):
        return plan(in_camera(aperture=0.1, focus=focus, position=[1, 0, 0]))

    by_distance, by_point = (
        fh.Plan.from_dict(focused(focus), PLANS)._sensors[0].camera for focus in (4.0, [5, 2, 1])
    )
    assert by_distance == by_point

"""Files that were read are not written over."""

import firsthit as fh
import numpy as np
import pytest
from firsthit.annotations import annotate

BALL = '[[objects]]\nshape = "sphere"\ncenter = [0, 0, 0]\nradius = 1\n'
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


@pytest.fixture
def mesh(tmp_path, monkeypatch):
    """A scene of a file called as all kinds of outputs are, by links."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mesh.obj").write_text(TRIANGLE)
    scene = fh.load("mesh.obj")
    for name in ["a.png", "a.npz", "a.ply", "a.svg", "a.fhs", "a.csv", "a.json", "a.html"]:
        (tmp_path / name).symlink_to("mesh.obj")
    yield scene
    assert (tmp_path / "mesh.obj").read_text() == TRIANGLE


def refused(write, name):
    with pytest.raises(fh.FileWriteError, match=f"{name}: is an input"):
        write(name)


def test_no_writer_writes_over_the_scene_s_file(mesh):
    camera = fh.Camera.look_at((0.2, 0.2, 5), (0.2, 0.2, 0), (0, 1, 0), 40, 6, 8)
    frame = fh.render(mesh, camera, channels=["color", "position", "object"])
    refused(frame.save, "a.npz")
    refused(lambda name: fh.render(mesh, camera).save(name), "a.png")
    refused(mesh.shoot([0, 0, 1], [0, 0, -1]).save, "a.npz")
    refused(mesh.section((0, 0.2, 0), (0, 1, 0)).save, "a.svg")
    refused(mesh.save, "a.fhs")
    refused(mesh.lint().save, "a.ply")
    lidar = fh.Lidar.spinning([0.0], columns=4)
    for name in ("a.ply", "a.npz", "a.csv"):
        refused(lidar.scan(mesh).save, name)
    refused(annotate(mesh, camera).save_coco, "a.json")
    refused(mesh.view(camera).save, "a.html")
    drive = fh.Trajectory([0.0, 1.0], np.zeros((2, 3)), [[0, 0, 0, 1]] * 2)
    refused(drive.save, "a.csv")


def test_files_beside_the_scene_are_inputs_too(tmp_path):
    def made(name):
        path = tmp_path / name
        return path, str(path)

    ball = fh.Scene()
    ball.add(fh.Sphere((0, 0, 0), 1))
    camera = fh.Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), 40, 6, 8)
    frame = fh.render(ball, camera, channels=["color", "t"])
    # As another run has made it.
    frame.save(tmp_path / "old.exr")
    path, name = made("eye.exr")
    path.write_bytes((tmp_path / "old.exr").read_bytes())
    assert fh.Camera.load(path) == camera
    refused(frame.save, name)
    path, name = made("drive.csv")
    path.write_text("time,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1,1,0,0,0,0,0,1\n")
    drive = fh.Trajectory.load(path, body="forwards-left-up")
    refused(drive.save, name)
    path, name = made("points.csv")
    path.write_text("0,0,1\n")
    fh.read_points(path)
    refused(drive.save, name)


def test_what_is_removed_first_or_was_made_here_may_be_written(tmp_path):
    path = tmp_path / "ball.fhs"
    ball = fh.Scene()
    ball.add(fh.Sphere((0, 0, 0), 1))
    for _ in range(2):
        ball.save(path)
        ball = fh.open(path)
    other = tmp_path / "other.fhs"
    other.write_bytes(path.read_bytes())
    ball = fh.open(other)
    refused(ball.save, str(other))
    other.unlink()
    ball.save(other)
    # Outputs are no inputs: a picture may be made anew.
    picture = tmp_path / "a.npz"
    fh.render(ball).save(tmp_path / "b.npz")
    picture.write_bytes((tmp_path / "b.npz").read_bytes())
    fh.Frame.load(picture).save(picture)

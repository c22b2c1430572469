"""A user's script, as type checkers see it: test_types.py checks it and runs it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, assert_type

import firsthit as fh
import numpy as np
import numpy.typing as npt
from firsthit.typing import (
    Asked,
    AttributeChannel,
    ChannelName,
    Projection,
    RayStart,
    Rule,
    ShaderName,
    ViewName,
)

Doubles = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int32]


def shapes() -> fh.Scene:
    """Vectors are anything array_like."""
    row = np.array([0, 0, 1])
    scene = fh.Scene()
    ball: int = scene.add(fh.Sphere(center=[0, 0, 0], radius=1), color=[1, 0.5, 0], name="ball")
    scene.add(fh.Plane(point=np.zeros(3), normal=row))
    scene.add(fh.Disc((0, 0, 0), [0, 0, 1], 2.5))
    scene.add(fh.Box(low=[-1, -1, -1], high=np.ones(3, np.float32)))
    scene.add(fh.Cylinder([0, 0, 0], row, radius=1))
    scene.add(fh.Cone([0, 0, 0], row, 1, top_radius=0.5), transform=np.eye(4))
    scene.add(fh.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]), material=fh.Material())
    scene.add_light(fh.DirectionalLight(direction=[0, 0, -1], color=[1, 1, 1]))
    scene.add_light(fh.PointLight(np.ones(3), intensity=[1, 1, 1]))
    scene.add_light(fh.SpotLight([0, 0, 9], -row, [1, 1, 1], outer_angle=0.5))
    scene.background = fh.Sky([1, 1, 1], np.zeros(3), up=row)
    scene.background = [0, 0, 0]
    scene.shading = fh.Shading(shade="lambert", ambient=[0.1, 0.1, 0.1])
    scene.up = row
    look = fh.Material(
        color=[1, 1, 1], alpha_mode="mask", texture=fh.Texture(np.zeros((2, 2, 3), "u1"))
    )
    assert_type(scene.up, tuple[float, float, float])
    assert_type(fh.Sphere(center=[0, 0, 0], radius=1).center, tuple[float, float, float])
    assert_type(look.color, tuple[float, float, float])
    assert_type(scene.objects[ball].transform, Doubles)
    scene.hide(np.unique(scene.shoot([0, 0, 9], [0, 0, -1]).object))
    scene.show(np.flatnonzero(np.ones(len(scene.objects))))
    scene.move(np.int32(ball), np.eye(4))
    return scene


def cameras(scene: fh.Scene) -> fh.Camera:
    """Words are the words there are."""
    view: ViewName = "front"
    camera = fh.Camera.framing(scene, rows=6, columns=8, view=view, up=[0, 0, 1])
    assert_type(camera.projection, Projection)
    assert_type(camera.ray_start, RayStart)
    assert_type(camera.aim, Doubles)
    fh.Camera(
        [0, 0, 5], (0, 0, -1), np.array([0, 1, 0]), 1, 2, 2, 4, 4, projection=camera.projection
    )
    return fh.Camera.look_at([0, 0, 9], np.zeros(3), [0, 1, 0], 30, rows=6, columns=8)


def hits(scene: fh.Scene, camera: fh.Camera) -> None:
    """Arrays have their types."""
    hits = scene.shoot(camera, progress=lambda done, total: None, threads=2)
    t, o = hits
    nearest: Any = t[o >= 0].min()
    assert nearest > 0
    assert_type(hits.t, npt.NDArray[np.floating[Any]])
    assert_type(hits.object, Integers)
    assert_type(hits.normal, Doubles)
    assert_type(hits.front, npt.NDArray[np.bool_])
    assert_type(hits[hits.object == 0], fh.Hits)
    assert_type(hits[hits.object == 0].z, npt.NDArray[np.floating[Any]])
    assert_type(hits[2:4, ::2], fh.Hits)
    assert_type(hits.attributes, tuple[str, ...])
    for attribute in hits.attributes:
        assert_type(hits.attribute(attribute, of="vertices"), Doubles)
    assert_type(len(hits), int)
    assert_type(hits.channel("normal", progress=True), Doubles)
    assert_type(hits.channel("face", threads=1), Integers)
    assert_type(scene.count(camera), npt.NDArray[np.int64])
    asked: list[Asked] = ["t", AttributeChannel("attribute:quality")]
    assert_type(hits.to_dict(asked[:1]), dict[str, npt.NDArray[Any]])
    assert_type(hits.to_dict(), dict[str, npt.NDArray[Any]])
    names: list[ChannelName] = [name for name, _ in hits.items()]
    assert_type(hits.channel(names[0]), npt.NDArray[Any])
    rays = scene.shoot([[0, 0, 9], [1, 0, 9]], [0, 0, -1], t_max=np.array([5, np.inf]))
    scene.shoot([0, 0, 9], [0, 0, -1], dtype=np.float32)
    assert_type(rays.position, Doubles)
    met = scene.shoot_all([[0, 0, 9], [1, 0, 9]], [0, 0, -1])
    assert_type(met, fh.AllHits)
    assert_type(met.t, Doubles)
    assert_type(met.offsets, npt.NDArray[np.int64])
    assert_type(met.hits, fh.Hits)
    assert_type(met.normal, Doubles)
    assert_type(scene.shoot_all([0, 0, 9], [0, 0, -1], k=3), fh.Hits)
    assert_type(scene.inside([0, 0, 9]), npt.NDArray[np.bool_])
    held, rules = scene.inside([[0, 0, 9]], by="object", return_rules=True)
    assert_type(held, npt.NDArray[np.bool_])
    assert_type(rules, tuple[Rule, ...])
    assert_type(scene.path_length([0, 0, 9], [0, 0, -1], by=None), Doubles)
    assert_type(scene.occluded([0, 0, 9], [0, 0, -1]), npt.NDArray[np.bool_])


def frames(scene: fh.Scene, camera: fh.Camera) -> None:
    """A frame's channels too."""
    shade: ShaderName = "normal"
    frame = fh.render(scene, camera, channels=["color", "z", "object", "front"], shade=shade)
    assert_type(frame["color"], npt.NDArray[np.float32])
    assert_type(frame["z"], Doubles)
    assert_type(frame["object"], Integers)
    assert_type(frame["front"], npt.NDArray[np.bool_])
    for name, array in frame.items():
        assert_type(name, str)
        assert_type(array, npt.NDArray[Any])
    frame.display = fh.Display(-1, tone_map="agx")
    assert_type(frame.display, fh.Display)
    fh.render(scene, camera, channels="t", background=[0, 0, 0], ambient=np.zeros(3))

    def own(hits: fh.Hits) -> Doubles:
        return np.where((hits.object < 0)[..., None], 0.0, np.abs(hits.normal))

    fh.render(scene, camera, shade=own, samples=1, progress=False)
    sky = fh.Environment.daylight(30, up=[0, 0, 1])
    fh.render(scene, camera, environment=sky, color_by="height", color_range=(0, 2), samples=1)
    steps = fh.render_progressively(scene, camera, environment=sky, samples=2)
    assert_type(next(steps), fh.Frame)
    for better in fh.render_progressively(scene, camera, shade=own, samples=3, edges=1.5):
        assert_type(better["color"], npt.NDArray[np.float32])


def truths(scene: fh.Scene, camera: fh.Camera) -> None:
    """So have annotations and flow."""
    tips = fh.annotations.Keypoints({"tip": [0, 0, 1]}, skeleton=[("tip", "tip")])
    found = fh.annotate(
        scene,
        camera,
        classes=lambda made: made.name or "rest",
        by="node",
        keypoints={"ball": tips, 0: {"tip": (0, 0, 1)}},
    )
    assert_type(found.instance, Integers)
    for one in found.instances:
        assert_type(one.visible.array, npt.NDArray[np.bool_])
        assert_type(one.visible_box, tuple[int, int, int, int] | None)
        if one.box3d is not None:
            assert_type(one.box3d.corners_in_camera, Doubles)
    fh.annotations.to_coco({"a.png": found}, form="rle", classes=["ball", "rest"])
    fh.annotations.to_coco([found])
    flow = fh.optical_flow(scene, camera, scene, camera)
    assert_type(flow.flow, Doubles)
    assert_type(flow.occluded, npt.NDArray[np.bool_])


if TYPE_CHECKING:

    def mistakes(scene: fh.Scene, camera: fh.Camera) -> None:
        """Calls that a checker refuses: a comment that is not needed is an error itself."""
        fh.render(scene, camera, channels=("depth",))  # type: ignore[arg-type]
        fh.render(scene, camera, shade="toon")  # type: ignore[arg-type]
        fh.render(scene, camera, environment="sky.hdr")  # type: ignore[arg-type]
        fh.render_progressively(scene, camera, light="neon")  # type: ignore[arg-type]
        fh.Camera.framing(scene, view="side")  # type: ignore[arg-type]
        fh.Camera([0, 0, 0], [0, 0, 1], [0, 1, 0], 1, 1, 1, 2, 2, projection="fisheye")  # type: ignore[arg-type]
        fh.Shading(shade="toon")  # type: ignore[arg-type]
        fh.Display(tone_map="toon")  # type: ignore[arg-type]
        scene.shoot(camera).channel("color2")  # type: ignore[call-overload]
        fh.Sphere(center=[0, 0, 0], radius="1")  # type: ignore[arg-type]
        scene.add("ball")  # type: ignore[call-overload]
        fh.annotate(scene, camera, by="mesh")  # type: ignore[arg-type]


def main() -> None:
    """Run it all."""
    scene = shapes()
    camera = cameras(scene)
    hits(scene, camera)
    frames(scene, camera)
    truths(scene, camera)


if __name__ == "__main__":
    main()

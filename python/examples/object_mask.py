"""A mask of one object among others, pixel by pixel."""

import firsthit as fh

scene = fh.Scene()
scene.add(fh.Plane(point=(0, 0, 0), normal=(0, 0, 1)), name="table")
ball = scene.add(fh.Sphere(center=(0, 0, 1), radius=1), name="ball")
scene.add(fh.Box(low=(-2, -2.5, 0), high=(-0.5, -1.5, 1.5)), name="box")
camera = fh.Camera.look_at((2, -8, 3), (0, 0, 1), (0, 0, 1), 35, rows=480, columns=640)
hits = scene.shoot(camera)
mask = hits.object == ball  # (480, 640) bool
print(f"the ball covers {mask.mean():.1%} of the picture")
fh.render(scene, camera, channels=("object",)).save("object_mask.png")

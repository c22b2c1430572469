"""Line of sight: what of a plan can a watchman see? Seen from above, in white."""

import firsthit as fh
import numpy as np

scene, eye = fh.Scene(), np.array([5.0, 0.5, 1.7])
for x, y in ((3, 2), (6, 6), (2, 7), (8, 3)):
    scene.add(fh.Box(low=(x - 0.6, y - 0.6, 0), high=(x + 0.6, y + 0.6, 3)))
scene.add(fh.Plane(point=(0, 0, 0), normal=(0, 0, 1)))
plan = fh.Camera((5, 5, 9), (0, 0, -1), (0, 1, 0), 1, 10, 10, 400, 400, projection="orthographic")
points = scene.shoot(plan).position  # (400, 400, 3)
seen = ~scene.occluded(eye, points - eye, t_max=1 - 1e-9)  # up to just before each point
print(f"{seen.mean():.1%} of the plan is seen")
picture = fh.render(scene, plan, shade=lambda hits: seen[..., None] * [1, 1, 1], samples=1)
picture.save("line_of_sight.png")

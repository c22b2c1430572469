"""Line of sight: what of a plan can a watchman see?"""

import firsthit as fh
import numpy as np

scene = fh.Scene()
for x, y in ((3, 2), (6, 6), (2, 7), (8, 3)):
    scene.add(fh.Box(low=(x - 0.6, y - 0.6, 0), high=(x + 0.6, y + 0.6, 3)))
ground = np.moveaxis(np.mgrid[0:10:400j, 0:10:400j, 0:1], 0, -1)[:, :, 0]
eye = np.array([5.0, 1.0, 1.7])
seen = ~scene.occluded(eye, ground - eye, t_max=1)  # (400, 400) bool
print(f"{seen.mean():.1%} of the ground is seen")
picture = np.where(seen, 255, 60).astype(np.uint8).T[::-1]
np.save("line_of_sight.npy", picture)

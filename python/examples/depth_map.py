"""A depth map: z, the distance along the camera's aim, for every pixel."""

import sys

import firsthit as fh

scene = fh.load(sys.argv[1])
middle, size = scene.bounds.mean(0), (scene.bounds[1] - scene.bounds[0]).max()
camera = fh.Camera.look_at(middle + size * 2, middle, (0, 0, 1), 30, rows=480, columns=640)
frame = fh.render(scene, camera, channels=("z",))
frame.save("depth_map.npy")  # float64, exact; infinity where nothing is
frame.save("depth_map.png")  # to look at

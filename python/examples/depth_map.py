"""A depth map: z, the distance along the camera's aim, for every pixel."""

import sys

import firsthit as fh

scene = fh.load(sys.argv[1])
camera = fh.Camera.framing(scene, rows=480, columns=640)  # upright: the file's own up
frame = fh.render(scene, camera, channels=("z",))
frame.save("depth_map.npy")  # float64, exact; infinity where nothing is
frame.save("depth_map.png")  # to look at

"""Drop-in replacements for the ray and distance queries of other packages.

`firsthit.compat.trimesh` stands in for trimesh's ``RayMeshIntersector`` and ``ProximityQuery``,
`firsthit.compat.open3d` for Open3D's ``RaycastingScene``. Neither package need be installed.
``docs/compat.md`` lists where their answers and ours differ.
"""

"""Record what pictures and rays are answered, and compare another build's answers with the record, to the byte.

recording.py OLD-PROGRAM record.json --make    records
recording.py NEW-PROGRAM record.json           compares, on every instruction set that the machine has
"""

import argparse
import hashlib
import json
import math
import os
import random
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from program import PUBLIC, ROOT

#: In the repository, then beside it, then made by `make bench`.
SCENES = [
    *(ROOT / "docs" / "scenes" / f"{name}.toml" for name in ("camera", "files", "lights", "orthographic")),
    *(ROOT / "docs" / "scenes" / f"{name}.toml" for name in ("placement", "shading", "shapes", "viewplane")),
    *(ROOT / "testdata" / name for name in ("torus_draco.glb", "cube_quads_be.ply", "prism_64gon.obj")),
    *(
        PUBLIC / "generated" / name
        for name in ("alpha_modes.gltf", "textures.glb", "orientation.gltf", "sphere_far.ply")
    ),
    *(PUBLIC / "real" / "tm" / name for name in ("CesiumMilkTruck.glb", "AlphaBlendModeTest.glb", "fuze.obj")),
    *(PUBLIC / "real" / "tm" / name for name in ("octagonal_pocket.stl", "nested.glb")),
    *(PUBLIC / "real" / "bev" / name for name in ("CornellBox/CornellBox.glb", "GltfPrimitives/gltf_primitives.glb")),
    *(ROOT / "target" / "scenes" / f"{name}.ply" for name in ("bunny", "interior")),
]

CHANNELS = "t,object,primitive,face,normal,position,barycentric,uv,front"
PICTURES = {
    "perspective": ["--view", "iso"],
    "orthographic": ["--view", "front", "--orthographic"],
    "wide": ["--view", "back", "--fov", "120", "--shader", "unlit", "--ray-start", "eye"],
    "as it asks": [],
}


def main() -> int:
    """Run it; return 1 if anything differs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=Path, help="the firsthit program")
    parser.add_argument("record", type=Path, help="the record, JSON")
    parser.add_argument("--make", action="store_true", help="make the record instead of comparing with it")
    given = parser.parse_args()
    program = given.program.resolve()
    if given.make:
        record = answers(program, None)
        given.record.write_text(json.dumps(record, indent=1) + "\n")
        print(f"recorded {len(record)} answers")
        return 0
    record = json.loads(given.record.read_text())
    different = 0
    for instruction_set in ("portable", "avx2", "avx512"):
        found = answers(program, instruction_set)
        wrong = [name for name in record if found.get(name) != record[name]]
        print(f"{instruction_set}: {len(record) - len(wrong)} answers are equal, {len(wrong)} are not {wrong[:20]}")
        different += len(wrong)
    return min(different, 1)


def answers(program: Path, instruction_set: str | None) -> dict[str, str]:
    """Compute the digests of all answers: scene, query and array."""
    environment = os.environ | ({"FIRSTHIT_ISA": instruction_set} if instruction_set else {})
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for scene in SCENES:
            if not scene.is_file():
                continue
            runs = {name: ["render", str(scene), "--size", "240x160", *words] for name, words in PICTURES.items()}
            for words in runs.values():
                words += ["--samples", "1", "--channels", f"color,range,z,{CHANNELS}"]
            rays = Path(folder) / "rays.csv"
            rays.write_text(random_rays(bounds(program, scene)))
            runs["rays"] = ["shoot", str(scene), str(rays), "--channels", CHANNELS]
            for name, words in runs.items():
                out = Path(folder) / "out.npz"
                command = [program, *words, "-q", "-o", out]
                # A camera of parallel rays has no field of view: that is an answer, too.
                if subprocess.run(command, env=environment, stderr=subprocess.DEVNULL).returncode == 0:
                    found |= digests(f"{scene.name} {name}", out)
                else:
                    found[f"{scene.name} {name}"] = "refused"
    return found


def digests(name: str, file: Path) -> dict[str, str]:
    """Compute the digest of each array; the metadata say which build it was."""
    with zipfile.ZipFile(file) as arrays:
        members = sorted(set(arrays.namelist()) - {"metadata.npy"})
        return {f"{name} {member[:-4]}": hashlib.sha256(arrays.read(member)).hexdigest() for member in members}


def bounds(program: Path, scene: Path) -> list[list[float]]:
    """Ask for the scene's box; what is unbounded ends at 10."""
    told = subprocess.run([program, "info", "--json", scene], check=True, capture_output=True, text=True)
    box = json.loads(told.stdout)["bounds"] or [[-1, -1, -1], [1, 1, 1]]
    return [[min(10.0, max(-10.0, x)) if x is None or math.isinf(x) else x for x in corner] for corner in box]


def random_rays(box: list[list[float]], count: int = 4000) -> str:
    """Make rays from around the box and from inside it to points in it, the same at every call."""
    source = random.Random(20)
    lines = []
    for number in range(count):
        outside = 2.0 if number % 2 else 0.0
        sides = [(low, high, high - low) for low, high in zip(*box, strict=True)]
        origin = [source.uniform(low - outside * side, high + outside * side) for low, high, side in sides]
        end = [source.uniform(low, high) for low, high, _ in sides]
        lines.append(",".join(repr(value) for value in [*origin, *(b - a for a, b in zip(origin, end, strict=True))]))
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.exit(main())

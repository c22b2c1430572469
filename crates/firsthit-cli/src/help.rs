//! The texts below the options in the help.

use std::fmt::Write;

use firsthit::channel::KINDS;

// Examples keep within 80 columns: broken anew, they could not be copied. Prose is one line, to be
// broken.
pub(crate) const EXAMPLES: &str = "\
Examples:
  firsthit demo                         the embedded scene, no file needed
  firsthit render bunny.ply             fits it into a picture, bunny.png
  firsthit render part.stl --position 200,300,100 --look-at 0,0,0 --fov 45 \\
      -o color.png -o all.npz --channels color,t,z,object,normal
  firsthit render scene.toml            the outputs that a scene file asks for
  firsthit shoot part.stl rays.npy -o hits.npz
  firsthit build city.glb               city.fhs, which opens in milliseconds
  firsthit nearest part.stl points.npy  the nearest points of the surface
  firsthit inside part.stl points.npy   which points are inside
  firsthit visible city.glb pairs.npy   which points see each other
  firsthit thickness part.stl points.npy
  firsthit info part.stl --json         what is in the file
  firsthit info all.npz                 its channels, camera and scene
  firsthit diff all.npz again.exr       whether two outputs are the same
  firsthit section part.stl --normal 0,0,1 -o cut.svg
  firsthit lint part.stl                whether it has holes, flipped faces, ...
  firsthit probe part.stl --pixel 360,640
  firsthit scan city.glb --lidar VLP-16 a lidar's point cloud
  firsthit dataset plan.toml -o out/    all frames and annotations of a plan
  firsthit parts out/                   which frames are there, which missing
  firsthit pack out/ -o shards/         tar files that WebDataset reads

With --json, render, shoot, nearest, inside, visible, thickness, section, lint, probe, build, scan, dataset, parts, pack, demo, info and diff print one JSON object; after a failure it has the keys error and exit_code.

Exit codes: 0 done, 1 the outputs differ (diff), something was found (lint) or parts are missing (parts), 2 wrong usage, 3 bad input, 4 the output could not be written, 5 a limit was reached, \
70 a bug in firsthit, 130 interrupted by Ctrl-C. A program that was started to ignore Ctrl-C, by nohup or in the background of a script, ignores it.";

const RENDER_EXAMPLES: &str = "\
Examples:
  firsthit render bunny.ply
  firsthit render bunny.ply --up 0,1,0 --view front --orthographic
  firsthit render part.stl --position 200,300,100 --aim -2,-3,-1 --up 0,0,1 \\
      --focal-length 35 --viewplane 36x24 --size 720x480
  firsthit render part.stl --position 200,300,100 --look-at 0,0,0 --fov 45 \\
      -o color.png -o all.npz --channels color,t,range,z,object,normal,position
  firsthit render part.stl --projection equirectangular -o panorama.png
  firsthit render part.stl --channels z,object -o 'part-{channel}.png'
  firsthit render part.stl --channels color,z,object,normal -o part.exr
  firsthit render part.stl --channels z -o depth.png --png-scale 0.001
  firsthit render part.stl --edges 1.5 --hidden-edges --shader unlit
  firsthit render part.stl --projection equirectangular -o room.ply

Vectors are X,Y,Z in scene units; negative numbers need no quotes: --position -1,2,3

A COLOR is linear red,green,blue with Rec. 709 primaries, from 0 to 1 (--color 0.2,0.3,0.5), or sRGB, which is \
decoded to linear: '#rrggbb' in quotes, or a name of CSS such as steelblue.";

pub(crate) const SHOOT_EXAMPLES: &str = "\
Examples:
  firsthit shoot part.stl rays.npy -o hits.npz
  firsthit shoot part.stl origins.npy directions.npy -o hits.npz \\
      --channels t,object,normal
  firsthit shoot part.stl rays.npy -o scan.ply
  firsthit shoot part.stl rays.npy --all -o crossings.csv
  firsthit shoot part.stl cloud.ply --from 0,0,10 -o hits.csv
  echo 0,0,10,0,0,-1 | firsthit shoot part.stl - --channels t,object,position

Rays are arrays of shape (n, 6), each an origin and a direction, or two arrays of shape (n, 3); as .npy, \
as .npz with the entries origins and directions (or origin, and direction or dir) or rays, or as .csv \
with six numbers in a line; under a header with the names ox,oy,oz,dx,dy,dz, in any order and beside other columns. Directions may have any length; t is in units of the direction's length.

A program can keep shoot running behind a pipe: it sends a line and reads the answer before it sends the next line. The header \
comes with the first answer. Comments and blank lines have no answer. A wrong line ends the run with exit code 3, after the \
answers to the lines before it. With --all or --nearest all lines are read first: a ray without hits has no line.";

pub(crate) const BUILD_EXAMPLES: &str = "\
Examples:
  firsthit build city.glb
  firsthit build city.glb -o built/city.fhs
  firsthit render built/city.fhs

A .fhs file is mapped into memory as it is, with its trees: opening it takes milliseconds, and programs that have it open at \
the same time share its memory. Rays meet the same things to the bit. It holds objects, materials, textures, cameras, lights and \
names, but not the outputs that a scene file asks for. Do not change it in place while it is open; build replaces it.";

/// The file of points.
macro_rules! points {
    () => {
        "Points are in the world's coordinates. Their format is told by the first bytes: PLY, PCD, LAS, LAZ, .npy of shape (n, 3), \
.npz and .exr with an array points or a channel position, as render, shoot and scan write them, or text (XYZ, TXT, ASC, TSV, CSV): a \
line for each point with commas, semicolons, tabs or blanks between its numbers; under a header with the names x,y,z, in any order and \
beside other columns, or without one, then the first three numbers count."
    };
}

pub(crate) const NEAREST_EXAMPLES: &str = concat!(
    "\
Examples:
  firsthit nearest part.stl points.npy -o nearest.npz
  firsthit nearest part.stl points.csv --signed
  firsthit nearest part.stl scan.las --signed --cloud compared.ply
  firsthit nearest part.stl points.npy --count 4 --radius 0.5 -o near.csv
  echo 0,0,10 | firsthit nearest part.stl -

",
    points!(),
    " The channels are distance, object, primitive, position and barycentric; with --count there is also point, the number of the \
point in the input, from 0. --cloud writes the points that were given again, with all their columns and with distance. The line at the end has the \
mean of the distances, the root of their mean square (RMS), and up to which 95 % of them are, whatever their signs."
);

pub(crate) const VISIBLE_EXAMPLES: &str = "\
Examples:
  firsthit visible city.glb pairs.npy -o visible.npy
  firsthit visible city.glb points.las --from 2,5,1.8 -o seen.npy
  echo 0,0,2,50,10,1.5 | firsthit visible city.glb -

Pairs of points are arrays of shape (n, 6), in the world's coordinates; as .npy, as .npz with the entry points, or as .csv with six \
numbers in a line; under a header with the names ax,ay,az,bx,by,bz, in any order and beside other columns. The answer for each is 1 or true if nothing is between the two points. It does not depend on which comes first. \
A surface exactly at one of them does not count. With --from points are read as by firsthit nearest.";

pub(crate) const THICKNESS_EXAMPLES: &str = concat!(
    "\
Examples:
  firsthit thickness part.stl points.npy -o thickness.npy
  echo 1,2,3 | firsthit thickness part.stl -

",
    points!(),
    " Each stands for the surface point nearest to it. The answer is the distance from there inwards to where the same object ends; of an \
 open mesh, against the normal to where it is met next: inf where it is not. firsthit nearest tells which surface points these are."
);

pub(crate) const VIEW_EXAMPLES: &str = "\
Examples:
  firsthit view part.stl
  firsthit view scene.toml --no-browser --port 8000
  ssh -L 8000:127.0.0.1:8000 server firsthit view scan.ply --no-browser --port 8000

The page's address is printed; it holds a secret, without which nobody is answered. The program ends with Ctrl-C, and by itself three minutes \
after the page was closed. It listens on this machine alone. The camera, the light and the colours that the page begins with are those \
of firsthit render with the same options.";

pub(crate) const INSIDE_EXAMPLES: &str = concat!(
    "\
Examples:
  firsthit inside part.stl points.npy -o inside.npy
  echo 1,2,3 | firsthit inside part.stl -

",
    points!(),
    " The answer for each is 1 or true if it is inside any object.

A closed mesh and a solid hold a point if their surface goes around it, which is decided exactly; so shells of a mesh that overlap are one \
solid. With --rule parity a closed mesh holds a point if a ray from it crosses the mesh an odd number of times. An open mesh \
holds the points in its box around which its winding number is above one half or below minus one half; a warning counts such \
meshes. A plane and a disc hold nothing."
);

pub(crate) const PROBE_EXAMPLES: &str = "\
Examples:
  firsthit probe part.stl --pixel 384,512
  firsthit probe part.stl --pixel 384,512 --view front --size 1024x768
  firsthit probe part.stl --ray 0,0,10,0,0,-1 --all
  firsthit probe scene.toml --pixel 30,20 --hide glass --json

Each object has one reason why it is or is not the hit. Its box is the one around it along the axes of the world. A t has all its \
digits, places as many as tell them to a millionth of the scene's size, other numbers six; --json has all digits. Exit code 0 also if the ray meets nothing.";

pub(crate) const INFO_EXAMPLES: &str = "\
Examples:
  firsthit info part.stl
  firsthit info part.stl --json | jq .triangles
  firsthit info part.exr
  firsthit info depth.png --json | jq .metadata.camera.intrinsics.k";

pub(crate) const DIFF_EXAMPLES: &str = "\
Examples:
  firsthit diff yesterday.exr today.exr
  firsthit diff all.npz depth.png --channels z --tolerance 0.0005

Channels are compared by name. Numbers are compared in the lower precision of the two files; NaN equals NaN. \
Exit codes: 0 equal within the tolerance, 1 different, 2 wrong usage, 3 a file that cannot be read.";

pub(crate) const SECTION_EXAMPLES: &str = "\
Examples:
  firsthit section part.stl
  firsthit section part.stl --origin 0,0,0.5 --normal 0,0,1 -o cut.svg
  firsthit section part.stl --normal 1,0,0 -o cut.dxf -o cut.json
  firsthit section part.stl --normal 1,1,0 --json

The curves are closed where the meshes are. A point exactly on the plane counts as on the side to which the normal points. \
Drawings are in the plane's own coordinates; the JSON file has its axes u and v. Shapes that are not meshes are left out, with a \
warning.";

pub(crate) const SCAN_EXAMPLES: &str = "\
Examples:
  firsthit scan city.glb --lidar VLP-16 --position 0,1.8,0
  firsthit scan city.ply --lidar os1-64 --trajectory drive.csv -o drive.las
  firsthit scan part.stl --elevations -25,15,64 --columns 2048 -o part.pcd
  firsthit scan hall.ply --raster 70,40 --rows 96 --columns 160 -o hall.npz
  firsthit scan yard.ply --rosette 38.4 --frequencies 121.6,-77.7 \\
      --points 10000 --point-rate 100000 --turns 5 -o yard.pcd
  firsthit scan wood.obj --lidar HDL-32E --divergence 0.003 --range-gate 0.3 \\
      --returns all --noise 0.02 --seed 1 -o wood.laz -o wood.npz

Lengths are in the unit of the 3D file. Azimuths count from forwards to the left. docs/sensors.md has the scanners' sources, and what each \
number of a return means.";

pub(crate) const DATASET_EXAMPLES: &str = "\
Examples:
  firsthit dataset plan.toml --check
  firsthit dataset plan.toml -o out/
  firsthit dataset plan.toml -o out/ --part 3/8
  firsthit dataset plan.toml -o out/ --workers 4

This command is written in Python and comes with the Python package, whose program shows all its options here: pip install . in a clone, see README.md. \
docs/datasets.md has the plan's keys.";

pub(crate) const PARTS_EXAMPLES: &str = "\
Examples:
  firsthit parts out/
  firsthit parts out/ --verify --json

Exit codes: 0 all parts are there, 1 some are missing, 2 wrong usage, 3 a folder that is that of no job.

This command is written in Python and comes with the Python package, whose program shows all its options here: pip install . in a clone, see README.md.";

pub(crate) const PACK_EXAMPLES: &str = "\
Examples:
  firsthit pack out/ -o shards/
  firsthit pack out/ -o shards/ --size 300
  firsthit pack out/ -o shards/ --parts 100

This command is written in Python and comes with the Python package, whose program shows all its options here: pip install . in a clone, see README.md. \
docs/datasets.md has what is in a tar file.";

pub(crate) const DEMO_EXAMPLES: &str = "\
Examples:
  firsthit demo
  firsthit demo --size 1920x1080 --samples 64 -o wallpaper.png";

pub(crate) const SCHEMA_EXAMPLES: &str = "\
Examples:
  firsthit schema > scene.schema.json
  firsthit schema --plan > plan.schema.json

With the line #:schema scene.schema.json at the top of a scene file, editors that know Taplo (Even Better TOML) \
complete and check it.";

pub(crate) const COMPLETIONS_EXAMPLES: &str = "\
Examples:
  source <(firsthit completions bash)
  firsthit completions zsh > ~/.zfunc/_firsthit
  firsthit completions fish > ~/.config/fish/completions/firsthit.fish";

const LINT_EXAMPLES: &str = "\
Examples:
  firsthit lint part.stl
  firsthit lint part.stl -o marked.ply
  firsthit lint part.stl --ignore units,unreferenced --json
  firsthit lint part.stl > findings.txt || echo 'not clean'

Exit codes: 0 nothing was found, 1 something was found, 2 wrong usage, 3 a file that cannot be read. Vertices in one place are one, \
whether or not faces share them. Each mesh is looked at by itself.

Kinds:";

/// The width of the table of channels.
const WIDTH: usize = 78;

/// A table of names and what each is.
fn table<'a>(rows: impl Iterator<Item = (&'a str, &'a str)>, width: usize) -> String {
    let mut text = String::new();
    for (name, about) in rows {
        // Broken here, because clap would not indent what it breaks.
        let mut line = format!("  {name:<width$} ");
        for word in about.split(' ') {
            if line.chars().count() + 1 + word.chars().count() > WIDTH {
                let _ = write!(text, "\n{line}");
                line = " ".repeat(width + 3);
            }
            line = line + " " + word;
        }
        let _ = write!(text, "\n{line}");
    }
    text
}

/// Examples, and what each kind of finding is.
pub(crate) fn lint() -> String {
    let rows = firsthit::lint::KINDS.iter();
    LINT_EXAMPLES.to_owned() + &table(rows.map(|kind| (kind.name, kind.about)), 17)
}

/// The text on channels that are no row of the table.
const ATTRIBUTES: &str = "an attribute of the meshes by its name, such as a property of a PLY (firsthit info lists them); NaN for a miss";

/// Examples, and what each channel is.
pub(crate) fn render() -> String {
    let rows = KINDS.iter().map(|kind| (&*kind.name, kind.about));
    let text = format!("{RENDER_EXAMPLES}\n\nChannels:") + &table(rows, 15);
    let attribute = [("attribute:NAME", ATTRIBUTES)];
    let text = text + &table(attribute.into_iter(), 15);
    text + "\n\nA PNG shows distances from yellow (near) to violet, other quantities from violet (small) to yellow, and misses in black; with --png-scale it holds them in 16 bits."
}

//! A camera in the words of other programs.
//!
//! The options, the call and the table make the same camera to the last bit. The matrices and COLMAP's lines are rounded.

use firsthit::camera::Convention;
use firsthit::geometry::{DMat3, DQuat};
use firsthit::{Camera, DVec3, Result};
use serde_json::{Value, json};

use crate::look::{FlatCamera, Projection, RaysStart};
use crate::viewer::Viewer;
use crate::words::{exact_number, exact_triple};

impl Viewer {
    /// A camera as options of the program, in Python, as a table of a scene file, as the matrices of `OpenCV`, and as the lines of COLMAP.
    /// Parallel rays have no matrix of pixels: then `opencv` and `colmap` are null.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](firsthit::Error::Argument) for a camera that makes no sense.
    pub fn say(&self, sight: &FlatCamera) -> Result<Value> {
        let camera = sight.camera()?;
        Ok(json!({
            "command": command(sight),
            "python": python(sight),
            "toml": toml(sight),
            "opencv": matrices(&camera, Convention::OpenCv).map(|of| opencv(sight, &of)),
            "colmap": matrices(&camera, Convention::Colmap).map(|of| colmap(sight, &of)),
        }))
    }
}

fn command(sight: &FlatCamera) -> String {
    let [position, aim, up] = vectors(sight).map(exact_triple);
    let [focal_length, width, height] = plane(sight);
    let parallel = match sight.projection {
        Projection::Perspective => "",
        Projection::Orthographic => " --orthographic",
    };
    let FlatCamera { rows, columns, .. } = sight;
    format!(
        "--position {position} --aim {aim} --up {up} --focal-length {focal_length} --viewplane {width}x{height} \
         --ray-start {}{parallel} --size {columns}x{rows}",
        start(sight)
    )
}

fn python(sight: &FlatCamera) -> String {
    let [position, aim, up] = vectors(sight).map(|v| exact_triple(v).replace(',', ", "));
    let [focal_length, width, height] = plane(sight);
    let projection = projection(sight);
    let FlatCamera { rows, columns, .. } = sight;
    format!(
        "fh.Camera(({position}), ({aim}), ({up}), {focal_length}, {width}, {height}, {rows}, {columns}, \"{projection}\", \
         ray_start=\"{}\")",
        start(sight)
    )
}

fn toml(sight: &FlatCamera) -> String {
    let [position, aim, up] = vectors(sight).map(|v| exact_triple(v).replace(',', ", "));
    let [focal_length, width, height] = plane(sight);
    let FlatCamera { rows, columns, .. } = sight;
    format!(
        "[camera]\nposition = [{position}]\naim = [{aim}]\nup = [{up}]\nfocal_length = {focal_length}\nwidth = {width}\n\
         height = {height}\nray_start = \"{}\"\nprojection = \"{}\"\nrows = {rows}\ncolumns = {columns}\n",
        start(sight),
        projection(sight)
    )
}

fn vectors(sight: &FlatCamera) -> [DVec3; 3] {
    [sight.position, sight.aim, sight.up].map(DVec3::from)
}

/// The focal length, the width and the height of the viewplane.
fn plane(sight: &FlatCamera) -> [String; 3] {
    [sight.focal_length, sight.width, sight.height].map(exact_number)
}

fn projection(sight: &FlatCamera) -> &'static str {
    match sight.projection {
        Projection::Perspective => "perspective",
        Projection::Orthographic => "orthographic",
    }
}

fn start(sight: &FlatCamera) -> &'static str {
    match sight.ray_start {
        RaysStart::Eye => "eye",
        RaysStart::Viewplane => "viewplane",
    }
}

/// The matrix of pixels, row by row, and that from the world to the camera.
struct Matrices {
    pixels: [[f64; 3]; 3],
    pose: [[f64; 4]; 4],
}

/// A perspective camera as another program has it.
fn matrices(camera: &Camera, convention: Convention) -> Option<Matrices> {
    let pixels = convention.own_pixel_matrix(camera.pixel_matrix()?).matrix();
    let pixels = [0, 1, 2].map(|row| pixels.row(row).to_array());
    let pose = convention.matrix(&camera.world_from_camera());
    let mut numbers = pixels.iter().flatten().chain(pose.iter().flatten());
    numbers
        .all(|x| x.is_finite())
        .then_some(Matrices { pixels, pose })
}

fn opencv(sight: &FlatCamera, Matrices { pixels, pose }: &Matrices) -> Value {
    json!({"k": pixels, "camera_from_world": pose, "size": [sight.columns, sight.rows]})
}

/// The lines of `cameras.txt` and `images.txt`.
fn colmap(sight: &FlatCamera, Matrices { pixels, pose }: &Matrices) -> String {
    let column = |k: usize| DVec3::new(pose[0][k], pose[1][k], pose[2][k]);
    let rotation = DQuat::from_mat3(&DMat3::from_cols(column(0), column(1), column(2)));
    let DQuat { x, y, z, w } = rotation.normalize();
    let numbers = [w, x, y, z].into_iter().chain(column(3).to_array());
    let numbers: Vec<String> = numbers.map(exact_number).collect();
    let [[fx, _, cx], [_, fy, cy], _] = *pixels;
    let lens: Vec<String> = [fx, fy, cx, cy].map(exact_number).into();
    let FlatCamera { rows, columns, .. } = sight;
    format!(
        "1 PINHOLE {columns} {rows} {}\n1 {} 1 view.png\n",
        lens.join(" "),
        numbers.join(" ")
    )
}

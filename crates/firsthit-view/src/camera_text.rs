//! A camera as text for the program, for Python, for scene files and for other programs.
//!
//! The options, the call and the table make the same camera to the last bit. The matrices and
//! COLMAP's lines are rounded.

use firsthit::camera::{ColmapCamera, Convention};
use firsthit::{Camera, DVec3, RayStart, Result};
use serde_json::{Value, json};

use crate::look::{FlatCamera, Projection, RaysStart};
use crate::viewer::Viewer;
use crate::words::{exact_number, exact_triple};

impl Viewer {
    /// A camera as options of the program, in Python, as a table of a scene file, as the matrices
    /// of `OpenCV`, and as the lines of COLMAP. Parallel rays have no matrix of pixels: then
    /// `opencv` and `colmap` are null.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](firsthit::Error::Argument) for a camera that makes no sense.
    pub fn camera_text(&self, flat: &FlatCamera) -> Result<Value> {
        let camera = flat.camera()?;
        Ok(json!({
            "command": command(flat),
            "python": python(flat),
            "toml": toml(flat),
            "opencv": opencv(&camera),
            "colmap": colmap(&camera),
        }))
    }
}

fn command(flat: &FlatCamera) -> String {
    let [position, aim, up] = vectors(flat).map(exact_triple);
    let [focal_length, width, height] = plane(flat);
    let parallel = match flat.projection {
        Projection::Perspective => "",
        Projection::Orthographic => " --orthographic",
    };
    let FlatCamera { rows, columns, .. } = flat;
    format!(
        "--position {position} --aim {aim} --up {up} --focal-length {focal_length} --viewplane {width}x{height} \
         --ray-start {}{parallel} --size {columns}x{rows}",
        start(flat)
    )
}

fn python(flat: &FlatCamera) -> String {
    let [position, aim, up] = vectors(flat).map(|v| exact_triple(v).replace(',', ", "));
    let [focal_length, width, height] = plane(flat);
    let projection = projection(flat);
    let FlatCamera { rows, columns, .. } = flat;
    format!(
        "fh.Camera(({position}), ({aim}), ({up}), {focal_length}, {width}, {height}, {rows}, {columns}, \"{projection}\", \
         ray_start=\"{}\")",
        start(flat)
    )
}

fn toml(flat: &FlatCamera) -> String {
    let [position, aim, up] = vectors(flat).map(|v| exact_triple(v).replace(',', ", "));
    let [focal_length, width, height] = plane(flat);
    let FlatCamera { rows, columns, .. } = flat;
    format!(
        "[camera]\nposition = [{position}]\naim = [{aim}]\nup = [{up}]\nfocal_length = {focal_length}\nwidth = {width}\n\
         height = {height}\nray_start = \"{}\"\nprojection = \"{}\"\nrows = {rows}\ncolumns = {columns}\n",
        start(flat),
        projection(flat)
    )
}

fn vectors(flat: &FlatCamera) -> [DVec3; 3] {
    [flat.position, flat.aim, flat.up].map(DVec3::from)
}

/// The focal length, the width and the height of the viewplane.
fn plane(flat: &FlatCamera) -> [String; 3] {
    [flat.focal_length, flat.width, flat.height].map(exact_number)
}

fn projection(flat: &FlatCamera) -> &'static str {
    match flat.projection {
        Projection::Perspective => "perspective",
        Projection::Orthographic => "orthographic",
    }
}

fn start(flat: &FlatCamera) -> &'static str {
    match flat.ray_start {
        RaysStart::Eye => "eye",
        RaysStart::Viewplane => "viewplane",
    }
}

/// The matrix of pixels, row by row, and that from the world to the camera.
fn opencv(camera: &Camera) -> Option<Value> {
    let convention = Convention::OpenCv;
    let pixels = convention.own_pixel_matrix(camera.pixel_matrix()?).matrix();
    let pixels = [0, 1, 2].map(|row| pixels.row(row).to_array());
    let pose = convention.matrix(&camera.world_from_camera());
    let size = [camera.columns(), camera.rows()];
    Some(json!({"k": pixels, "camera_from_world": pose, "size": size}))
}

/// The lines of `cameras.txt` and `images.txt`.
fn colmap(camera: &Camera) -> Option<String> {
    // COLMAP does not say where rays start.
    let camera = ColmapCamera::of(&camera.starting_at(RayStart::Eye)).ok()?;
    let image = camera.image_lines("view.png", 1, 1);
    Some(format!("{}\n{image}", camera.camera_line(1)))
}

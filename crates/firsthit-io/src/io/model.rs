//! The content of a mesh or model file.

use crate::camera::{Description, Opening, View};
use crate::geometry::DVec3;
use crate::scene::{Light, Object};

/// A model: objects, cameras and lights, and which way is up. How it looks in a picture is no part
/// of it.
#[derive(Clone, Default)]
pub struct Model {
    /// The objects, in the order of their identifiers. Those without materials got no colour from
    /// the file.
    pub objects: Vec<Object>,
    /// The cameras, in the file's order.
    pub cameras: Vec<NamedCamera>,
    /// The lights.
    pub lights: Vec<Light>,
    /// Which way is up. Zero where only the format tells.
    pub up: DVec3,
    /// Whether `up` is only a convention.
    pub up_is_guessed: bool,
}

impl Model {
    pub fn of(objects: Vec<Object>) -> Self {
        Self { objects, ..Self::default() }
    }
}

/// A camera of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedCamera {
    /// Its name; may be empty. In glTF, that of its node.
    pub name: String,
    /// Another name that it goes by; may be empty. In glTF, that of the camera itself, which nodes
    /// may share.
    pub own_name: String,
    /// Its description in numbers.
    pub view: View,
    /// Whether the file gives the number of pixels and the shape of the viewplane too. If not, only
    /// the view's height counts, and the renderer decides about the rest.
    pub has_size: bool,
    /// The camera as a scene file describes it, in part. The parts that it leaves open are decided
    /// anew when another part is replaced.
    pub description: Option<Description>,
}

impl NamedCamera {
    /// The camera as a description, for a picture of `size` columns and rows. `None`: as many as
    /// the camera asks for, or as the shape of its viewplane does. Where the file gives no size,
    /// the viewplane keeps its height, and its width follows from square pixels.
    pub fn described(&self, size: Option<[usize; 2]>) -> Description {
        let whole = || Description::of(&self.view);
        let mut described = self.description.unwrap_or_else(whole);
        if let Some([rows, columns]) = size {
            (described.rows, described.columns) = (Some(rows), Some(columns));
        }
        if !self.has_size
            && let Some(Opening::Viewplane { width, height, .. }) = &mut described.opening
            && let (Some(columns), Some(rows)) = (described.columns, described.rows)
        {
            *width = *height * columns as f64 / rows.max(1) as f64;
        }
        described
    }
}

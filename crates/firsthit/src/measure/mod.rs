//! What is inside objects: points, and stretches of rays; and how thick they are.
//!
//! An object is known from outside to inside by a [`Rule`]:
//!
//! - **Parity.** A closed mesh and a solid are entered and left in turn by every ray, since each crossing is there once
//!   ([`All`](crate::shoot::All)). So a point is inside where a ray from it crosses the object an odd number of times. This is decided
//!   exactly, however the ray meets edges, corners and planes of triangles.
//! - **Winding number.** An open mesh is taken for what it nearly encloses: see `measure/winding.rs`.
//! - **None.** A plane and a disc enclose nothing.
//!
//! Where shells of one mesh overlap, parity makes the overlap outside: shells within shells are hollows.

mod inside;
mod paths;
mod sweep;
mod thickness;
mod winding;

pub use inside::{Insides, inside};
pub use paths::path_lengths;
pub use thickness::thickness;
pub use winding::winding_number;

use crate::error::Result;
use crate::scene::{Object, Scene};
use crate::shape::Shape;

/// Whether an answer is for each object or for all together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum By {
    /// Of each object: a row of as many answers as there are objects.
    Object,
    /// Of all objects together.
    Union,
}

impl By {
    /// How many answers there are for each point or ray.
    pub fn width(self, scene: &Scene) -> usize {
        match self {
            Self::Object => scene.objects().len(),
            Self::Union => 1,
        }
    }
}

/// By what it is known whether a point is inside an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// By the parity of a ray's crossings: a closed mesh, or a solid.
    Parity,
    /// By the winding number: an open mesh, or one with parts that its material cuts out, through which rays pass.
    WindingNumber,
    /// Nothing is inside: a plane, a disc, or a hidden object.
    Nothing,
}

impl Rule {
    /// Its name: `parity`, `winding` or `none`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Parity => "parity",
            Self::WindingNumber => "winding",
            Self::Nothing => "none",
        }
    }

    /// The rule for an object. For a mesh it takes long the first time, see [`Mesh::is_closed`](crate::Mesh::is_closed).
    ///
    /// # Errors
    ///
    /// Those of [`Mesh::is_closed`](crate::Mesh::is_closed).
    pub fn of(object: &Object) -> Result<Self> {
        Ok(match object.shape() {
            _ if object.is_hidden() => Self::Nothing,
            _ if object.is_empty_mesh() => Self::Parity,
            Shape::Mesh(mesh) if object.has_cutouts() || !mesh.is_closed()? => Self::WindingNumber,
            Shape::Mesh(_)
            | Shape::Sphere(_)
            | Shape::Box(_)
            | Shape::Cylinder(_)
            | Shape::Cone(_) => Self::Parity,
            Shape::Plane(_) | Shape::Disc(_) => Self::Nothing,
        })
    }
}

/// The rule for each object of a scene.
///
/// ```
/// use firsthit::measure::{Rule, rules};
/// use firsthit::{DVec3, Object, Plane, Scene, Sphere};
///
/// let scene = Scene::new(vec![
///     Object::new(Sphere::new(DVec3::ZERO, 1.0)?),
///     Object::new(Plane::new(DVec3::ZERO, DVec3::Z)?),
/// ])?;
/// assert_eq!(rules(&scene)?, [Rule::Parity, Rule::Nothing]);
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// Those of [`Rule::of`].
pub fn rules(scene: &Scene) -> Result<Vec<Rule>> {
    scene.objects().iter().map(Rule::of).collect()
}

//! The inside of objects: the rules, and the winding numbers of points and along rays. Every
//! measure of solids asks here.
//!
//! The **winding number** of a point is how many times an object's surface goes around it: along a
//! ray from there, the crossings from the back of a triangle to its front, less those from the
//! front to the back. For a closed mesh that number does not depend on the ray. Each crossing is
//! there once ([`All`](crate::shoot::All)), also at edges, corners and in planes of triangles, and
//! which way it goes is the sign of a determinant; so it is exact. A [`FillRule`] says of which
//! numbers the points are inside.
//!
//! Some triangles of a closed mesh may be flipped. They are taken as turned to face as their
//! neighbours do; see `shape/mesh/facing.rs`. Where that is not possible, since the surface has one
//! side only, there is no winding number, and parity decides.
//!
//! An open mesh is taken for what it nearly encloses: see `winding.rs`. A plane and a disc enclose
//! nothing.

mod innermost;
mod inside;
mod sweep;
mod winding;

pub use innermost::innermost;
pub use inside::{Containment, inside, inside_with};
pub use winding::winding_number;

pub(crate) use inside::inside_by;
pub(crate) use sweep::{Met, Solids};

use crate::error::Result;
use crate::geometry::named;
use crate::scene::{Object, Scene};
use crate::shape::{Facing, Shape};

/// Whether an answer is for each object or for all together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grouping {
    /// An answer for each object: a row of as many answers as there are objects.
    Object,
    /// An answer for all objects together.
    Union,
}

impl Grouping {
    /// The number of answers for each point or ray.
    pub fn width(self, scene: &Scene) -> usize {
        match self {
            Self::Object => scene.objects().len(),
            Self::Union => 1,
        }
    }
}

named! {
    /// The rule for the points that a closed mesh holds, by how many times its surface goes around
    /// them. On meshes without overlaps, of which cavities face inwards, both rules agree.
    pub enum FillRule, "rule":
        /// Any number of times but zero, either way around. The common part of shells is inside,
        /// and so is what is in copies of a shell; a mesh that is turned inside out holds the same
        /// points.
        #[default]
        "nonzero" => Nonzero;
        /// An odd number of times: a ray from there crosses the surface an odd number of times.
        /// The common part of two shells is outside, whichever way they face.
        "parity" => Parity;
}

/// The rule that tells whether a point is inside an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// The winding number, which is whole: a closed mesh, or a solid.
    Nonzero,
    /// The parity of a ray's crossings: a closed mesh, or a solid.
    Parity,
    /// The winding number of an open mesh, or of one with parts that its material cuts out, through
    /// which rays pass.
    WindingNumber,
    /// No point is inside: a plane, a disc, or a hidden object.
    Nothing,
}

impl Rule {
    /// The name: `nonzero`, `parity`, `winding` or `none`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nonzero => FillRule::Nonzero.name(),
            Self::Parity => FillRule::Parity.name(),
            Self::WindingNumber => "winding",
            Self::Nothing => "none",
        }
    }

    /// The rule for an object, where `fill` is asked for. For a mesh it takes long the first time,
    /// see [`Mesh::is_closed`](crate::shape::Mesh::is_closed).
    ///
    /// # Errors
    ///
    /// The errors of [`Mesh::is_closed`](crate::shape::Mesh::is_closed).
    pub fn of(object: &Object, fill: FillRule) -> Result<Self> {
        let closed = match fill {
            FillRule::Nonzero => Self::Nonzero,
            FillRule::Parity => Self::Parity,
        };
        Ok(match object.shape() {
            _ if object.is_hidden() => Self::Nothing,
            _ if object.is_empty_mesh() => closed,
            Shape::Mesh(mesh) if object.has_cutouts() || !mesh.is_closed()? => Self::WindingNumber,
            Shape::Mesh(mesh) if closed == Self::Nonzero => match mesh.facing()? {
                Facing::Undecided => Self::Parity,
                Facing::AsGiven | Facing::Turned(_) => closed,
            },
            Shape::Mesh(_)
            | Shape::Sphere(_)
            | Shape::Box(_)
            | Shape::Cylinder(_)
            | Shape::Cone(_) => closed,
            Shape::Plane(_) | Shape::Disc(_) => Self::Nothing,
        })
    }

    /// Whether crossings alone tell what is inside.
    pub(crate) fn is_of_closed(self) -> bool {
        matches!(self, Self::Nonzero | Self::Parity)
    }
}

/// The rule for each object of a scene, where [`FillRule::default`] is asked for.
///
/// ```
/// use firsthit::measure::{Rule, rules};
/// use firsthit::{DVec3, Object, Plane, Scene, Sphere};
///
/// let scene = Scene::new(vec![
///     Object::new(Sphere::new(DVec3::ZERO, 1.0)?),
///     Object::new(Plane::new(DVec3::ZERO, DVec3::Z)?),
/// ])?;
/// assert_eq!(rules(&scene)?, [Rule::Nonzero, Rule::Nothing]);
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// The errors of [`Rule::of`].
pub fn rules(scene: &Scene) -> Result<Vec<Rule>> {
    rules_with(FillRule::default(), scene)
}

/// [`rules`] by a rule of the caller's choice.
///
/// # Errors
///
/// The errors of [`Rule::of`].
pub fn rules_with(fill: FillRule, scene: &Scene) -> Result<Vec<Rule>> {
    let of = |object| Rule::of(object, fill);
    scene.objects().iter().map(of).collect()
}

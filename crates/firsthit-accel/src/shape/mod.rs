//! Shapes that rays can meet: a file per shape, each in its own object space.

#![allow(clippy::inline_always, reason = "inlined into a kernel, it has the kernel's instructions")]

mod attribute;
#[doc(hidden)]
pub mod bundle;
mod cone;
mod cuboid;
mod cylinder;
mod disc;
mod interval;
mod joined;
#[doc(hidden)]
pub mod mesh;
mod nearest;
mod plane;
mod positions;
mod property;
mod sphere;
pub mod triangle;

#[cfg(test)]
mod conformance;

use std::sync::Arc;

pub use attribute::Attribute;
pub use cone::Cone;
pub use cuboid::Cuboid;
pub use cylinder::Cylinder;
pub use disc::Disc;
#[doc(hidden)]
pub use joined::{JoinedMeshes, Meshes};
#[doc(hidden)]
pub use mesh::MeshParts;
pub(crate) use mesh::are_below;
#[doc(hidden)]
pub use mesh::{Crowds, DisjointSets, Facing, Welded, edges, sorted};
pub use mesh::{Mesh, NamedAttribute};
pub use nearest::Nearest;
#[doc(hidden)]
pub use nearest::nearest_on_triangle;
pub(crate) use nearest::{nearest_on_lone_triangle, similarity};
pub use plane::Plane;
pub use positions::Positions;
pub use property::{Between, Property, PropertyOf, PropertyValues};
pub use sphere::Sphere;

pub use crate::memory::Storage;

use crate::geometry::{Bounds, DVec2, DVec3, Digest, Ray, Transform};

/// The crossing of a ray with a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// The ray's parameter.
    pub t: f64,
    /// The part of the shape.
    pub primitive: i32,
    /// The weights of corners 1 and 2 in a triangle, else NaN.
    pub barycentric: DVec2,
}

impl Crossing {
    fn at(t: f64, primitive: i32) -> Self {
        Self { t, primitive, barycentric: DVec2::NAN }
    }
}

/// The contract of every shape, in its object space.
pub trait Surface {
    /// A box around the shape; everything for an infinite one.
    fn bounds(&self) -> Bounds;

    /// The support function: the largest dot product of `direction` with a point of the shape, for
    /// a direction of any length. Infinite for an infinite shape, minus infinity for one without
    /// points.
    fn support(&self, direction: DVec3) -> f64;

    /// The first crossing that [the ray holds](Ray::holds); at the same `t` the lower primitive.
    /// Surfaces are met from both sides, closed shapes from inside too. `ray` is valid, its
    /// direction of any length whose square float64 can hold (what scenes are shot at with may have
    /// any length).
    fn intersect(&self, ray: &Ray) -> Option<Crossing>;

    /// Every crossing that the ray holds, in order. Of a solid both ends, although they may be in
    /// one place. (A mesh says the first alone: its triangles are asked one by one.)
    fn crossings(&self, ray: &Ray) -> [Option<Crossing>; 2] {
        [self.intersect(ray), None]
    }

    /// The normal at a point of the surface, of length one, outwards for closed shapes.
    fn normal(&self, point: DVec3, primitive: i32) -> DVec3;

    /// The point of the surface that `point` is, but for rounding: off the surface by a few 2^-53
    /// of the shape's coordinates and size. (Of a mesh, `point` itself: a hit's weights say more.)
    fn onto(&self, point: DVec3, primitive: i32) -> DVec3;

    /// Calls `visit` with the point of each primitive that is nearest to `from`, in the order of
    /// the primitives. `from`, those points and the distances are in the world, to which `place`
    /// takes the shape. Where several points of a primitive are equally near, it is one of them,
    /// always the same. A shape that [cannot be measured](Shape::is_measurable) there has none.
    ///
    /// Of a mesh the distance is that to the triangle whose corners are the mesh's, each taken to
    /// the world and rounded to float64: off by a few units in the last place, or by 2^-90 of the
    /// way to the triangle's corners if that is more. A triangle that is thinner than 2^-50 of its
    /// longest edge counts as its edges. Of other shapes the distance is off by a few 2^-53 of the
    /// shape's size and of itself.
    fn nearest(&self, from: DVec3, place: &Transform, visit: &mut dyn FnMut(Nearest));

    /// Adds every number that the shape is made from: two shapes that differ anywhere differ here.
    fn digest(&self, digest: &mut Digest);
}

/// Makes [`Shape`] and everything that depends on the list of shapes.
macro_rules! shapes {
    ($($(#[$doc:meta])* $name:literal => $kind:ident($held:ty) from $type:ty;)*) => {
        /// Any shape, behind a pointer: there may be a million objects.
        ///
        /// ```
        /// use firsthit::{DVec3, Shape, Sphere};
        ///
        /// let shape = Shape::from(Sphere::new(DVec3::ZERO, 1.0)?);
        /// assert_eq!(shape.name(), "sphere");
        /// # Ok::<(), firsthit::Error>(())
        /// ```
        #[derive(Debug, Clone, PartialEq)]
        pub enum Shape {
            $($(#[$doc])* $kind($held),)*
        }

        impl Shape {
            /// Every shape's name.
            pub const NAMES: &[&'static str] = &[$($name),*];

            /// The shape's name.
            pub fn name(&self) -> &'static str {
                match self { $(Self::$kind(_) => $name,)* }
            }
        }

        impl Surface for Shape {
            fn bounds(&self) -> Bounds {
                match self { $(Self::$kind(shape) => shape.bounds(),)* }
            }

            fn support(&self, direction: DVec3) -> f64 {
                match self { $(Self::$kind(shape) => shape.support(direction),)* }
            }

            fn intersect(&self, ray: &Ray) -> Option<Crossing> {
                match self { $(Self::$kind(shape) => shape.intersect(ray),)* }
            }

            fn crossings(&self, ray: &Ray) -> [Option<Crossing>; 2] {
                match self { $(Self::$kind(shape) => shape.crossings(ray),)* }
            }

            fn normal(&self, point: DVec3, primitive: i32) -> DVec3 {
                match self { $(Self::$kind(shape) => shape.normal(point, primitive),)* }
            }

            fn onto(&self, point: DVec3, primitive: i32) -> DVec3 {
                match self { $(Self::$kind(shape) => shape.onto(point, primitive),)* }
            }

            fn nearest(&self, from: DVec3, place: &Transform, visit: &mut dyn FnMut(Nearest)) {
                match self { $(Self::$kind(shape) => shape.nearest(from, place, visit),)* }
            }

            fn digest(&self, digest: &mut Digest) {
                digest.word(self.name());
                match self { $(Self::$kind(shape) => shape.digest(digest),)* }
            }
        }

        $(impl From<$type> for Shape {
            fn from(shape: $type) -> Self {
                Self::$kind(shape.into())
            }
        })*

        #[cfg(test)]
        impl Shape {
            /// Examples of every shape, for the tests that all shapes must pass.
            pub(crate) fn examples() -> Vec<Self> {
                let mut all = Vec::new();
                $(all.extend(<$type as conformance::Conforming>::examples().into_iter().map(Self::from));)*
                all
            }

            fn distance(&self, point: DVec3) -> f64 {
                use conformance::Conforming;
                match self { $(Self::$kind(shape) => shape.distance(point),)* }
            }
        }
    };
}

shapes! {
    /// Triangles over shared vertices; many objects can share one mesh.
    "mesh" => Mesh(Arc<Mesh>) from Arc<Mesh>;
    /// A sphere.
    "sphere" => Sphere(Box<Sphere>) from Sphere;
    /// An infinite plane.
    "plane" => Plane(Box<Plane>) from Plane;
    /// A flat round disc.
    "disc" => Disc(Box<Disc>) from Disc;
    /// A box, its sides along the axes of object space.
    "box" => Box(Box<Cuboid>) from Cuboid;
    /// A cylinder with both lids.
    "cylinder" => Cylinder(Box<Cylinder>) from Cylinder;
    /// A cone, or a part of one, with its lids.
    "cone" => Cone(Box<Cone>) from Cone;
}

impl Shape {
    /// Whether its surface is closed. Solids are, and [closed meshes](Mesh::is_closed), of which an
    /// empty one has no inside; planes and discs are open.
    pub fn is_closed(&self) -> bool {
        match self {
            // Without memory to find out, it is as good as open.
            Self::Mesh(mesh) => mesh.is_closed().unwrap_or(false),
            Self::Sphere(_) | Self::Box(_) | Self::Cylinder(_) | Self::Cone(_) => true,
            Self::Plane(_) | Self::Disc(_) => false,
        }
    }

    /// Whether distances to the shape can be measured in the world to which `place` takes it. Cones
    /// and cylinders must stay round there: a transform must stretch them by the same in all
    /// directions.
    pub fn is_measurable(&self, place: &Transform) -> bool {
        match self {
            Self::Cone(_) | Self::Cylinder(_) => {
                similarity(&place.world_from_object().matrix3).is_some()
            }
            _ => true,
        }
    }
}

/// The reach along each axis of a circle of radius one around `normal`, of length one: the sine of
/// the angle between them. (Not the root of 1 - cosine^2, which is rounding where the angle is
/// small.)
fn sines(normal: DVec3) -> DVec3 {
    let squares = normal * normal;
    DVec3::new(squares.y + squares.z, squares.z + squares.x, squares.x + squares.y).map(f64::sqrt)
}

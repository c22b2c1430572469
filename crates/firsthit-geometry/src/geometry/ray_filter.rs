use super::DVec2;
use super::names;

/// A part of an object's surface, by its identifiers as in a [`Hit`](super::Hit).
///
/// ```
/// use firsthit::shoot::{First, trace};
/// use firsthit::{DVec3, Disc, Filtered, Object, Ray, RayFilter, Scene, SurfaceId};
///
/// let disc = |z| Disc::new(DVec3::new(0.0, 0.0, z), DVec3::Z, 1.0).map(Object::new);
/// let scene = Scene::new(vec![disc(0.0)?, disc(1.0)?])?;
/// let rays = [Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z)];
/// let upper = SurfaceId { object: 1, primitive: 0 };
/// let but_upper = RayFilter { skip: [Some(upper), None], ..RayFilter::NONE };
/// let hits = trace(&scene, &Filtered::new(&rays, but_upper), First, &())?;
/// assert_eq!((hits.t[0], hits.object[0]), (5.0, 0));
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SurfaceId {
    /// The object's index in the scene.
    pub object: i32,
    /// The primitive: a mesh's triangle, a box's face, ...
    pub primitive: i32,
}

/// A side of a surface. The geometric normal points to the front.
///
/// ```
/// use firsthit::Side;
///
/// assert_eq!("back".parse::<Side>()?, Side::Back);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The ray comes against the normal.
    Front,
    /// The ray goes the way of the normal.
    Back,
}

names! { Side, "side": "front" => Front; "back" => Back; }

/// The point of a surface that a ray leaves: in a triangle the point with these weights, exactly;
/// on any other shape the ray's origin.
///
/// ```
/// use std::sync::Arc;
///
/// use firsthit::shoot::{First, trace};
/// use firsthit::{
///     DVec2, DVec3, Departure, Filtered, Mesh, Object, Positions, Ray, RayFilter, Scene, SurfaceId,
/// };
///
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(Positions::compact(corners), vec![[0, 1, 2]])?;
/// let scene = Scene::new(vec![Object::new(Arc::new(mesh))])?;
/// let departure = Departure {
///     surface: SurfaceId { object: 0, primitive: 0 },
///     barycentric: DVec2::new(0.1, 0.3),
///     side: None,
/// };
/// let filter = RayFilter { departure: Some(departure), ..RayFilter::NONE };
/// // From a point that rounding has put under the triangle.
/// let rays = [Ray::new(DVec3::new(0.1, 0.3, -1e-17), DVec3::Z)];
/// assert_eq!(trace(&scene, &rays, First, &())?.object, [0]);
/// assert_eq!(trace(&scene, &Filtered::new(&rays, filter), First, &())?.object, [-1]);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departure {
    /// The surface.
    pub surface: SurfaceId,
    /// The weights of a triangle's corners 1 and 2, as in a [`Hit`](super::Hit). One that is not
    /// finite counts as 0, and so does one that moves the point by less than it is rounded, so that
    /// a point next to an edge or a vertex is on it.
    pub barycentric: DVec2,
    /// The side of the surface that the ray starts on, if it starts on one. At an edge or a vertex
    /// of an open mesh a ray that goes from this side into one of the triangles around it is
    /// stopped there. `None`: it goes through.
    pub side: Option<Side>,
}

/// The filter of a ray: surfaces that it does not meet.
///
/// ```
/// use firsthit::shoot::{First, trace};
/// use firsthit::{DVec3, Filtered, Object, Ray, RayFilter, Scene, Side, Sphere};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let rays = [Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z)];
/// let backs = RayFilter { cull: Some(Side::Front), ..RayFilter::NONE };
/// let hits = trace(&scene, &Filtered::new(&rays, backs), First, &())?;
/// assert_eq!(hits.t, [6.0]);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayFilter {
    /// The ray does not meet an object whose mask has no bit in common with this.
    pub mask: u32,
    /// The ray meets only the object with this identifier, if any; its mask counts too.
    pub only: Option<i32>,
    /// The ray does not meet this side of any surface.
    pub cull: Option<Side>,
    /// The ray does not meet these: the first where it starts, the second where it ends, at
    /// `t = 1`.
    ///
    /// A triangle is not met at all. Of another shape, only the crossing that is nearest to the
    /// ray's start (or its end) is left out, for a line crosses a ball twice.
    pub skip: [Option<SurfaceId>; 2],
    /// The ray starts at a point of this surface, and meets only what is ahead of that point, in
    /// exact arithmetic: neither the surface, nor its neighbours where they touch it at the start.
    /// All else is met, however near.
    ///
    /// The ray's origin is that point, rounded to float64. That is so for a triangle and all meshes
    /// of the same transform. Other transforms round, and other shapes are met with rounding: from
    /// there, what is nearer than 2^-40 of the largest coordinate, of the start and of both
    /// objects, is not met.
    pub departure: Option<Departure>,
}

impl RayFilter {
    /// The ray meets everything.
    pub const NONE: Self =
        Self { mask: u32::MAX, only: None, cull: None, skip: [None; 2], departure: None };

    /// Whether the ray meets everything.
    #[inline]
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }
}

impl Default for RayFilter {
    fn default() -> Self {
        Self::NONE
    }
}

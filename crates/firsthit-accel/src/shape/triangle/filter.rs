//! The filter of a ray for one mesh, in the mesh's space: see
//! [`RayFilter`](crate::geometry::RayFilter).

use std::cmp::Ordering;

use super::{DeparturePoint, Doubtful, EdgeRule, Shear, TriangleHit};
use crate::geometry::orientation::along_normal;
use crate::geometry::{DVec2, DVec3, ROUNDED, Ray, Side, arrays};
use crate::shape::Meshes;

/// The number of no triangle.
const NO_TRIANGLE: u32 = u32::MAX;

/// All triangles.
const ALL: [u32; 2] = [0, NO_TRIANGLE];

/// The start at joined meshes of a ray that leaves a surface in another space. The largest rounding
/// decides (`shoot/filter.rs`), and that may be the mesh's.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct Begin {
    /// The largest number that the start is computed from.
    start: f64,
    /// The largest coordinate of the ray's direction.
    along: f64,
    latest: f64,
}

impl Begin {
    /// The start at one `t` for all meshes.
    pub(crate) const TOGETHER: Self = Self { start: 0.0, along: 1.0, latest: 0.0 };

    /// The start at meshes whose largest number is at most `farthest`.
    pub fn new(start: f64, along: f64, farthest: f64) -> Self {
        let begin = Self { start, along, latest: 0.0 };
        Self { latest: begin.at(farthest), ..begin }
    }

    /// The `t` at which the ray begins at a mesh, by the largest number of that.
    #[inline]
    pub fn at(&self, farthest: f64) -> f64 {
        ROUNDED * self.start.max(farthest) / self.along
    }
}

/// See [the module](self).
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct MeshFilter {
    /// Triangles that are not met.
    skip: [u32; 2],
    cull: Option<Side>,
    /// The ray's start, if it leaves a triangle of this mesh, or of another in its space.
    departure: Option<DeparturePoint>,
    /// The triangle that it leaves, if that is one of this mesh.
    left: u32,
    /// Whether the ray leaves any surface, be it none of this mesh's space.
    is_departing: bool,
    /// The numbers of the triangles that are met: from the first to before the second.
    within: [u32; 2],
    /// The ray's start at joined meshes.
    begin: Begin,
}

impl MeshFilter {
    /// The ray meets everything.
    pub const NONE: Self = Self {
        skip: [NO_TRIANGLE; 2],
        cull: None,
        departure: None,
        left: NO_TRIANGLE,
        is_departing: false,
        within: ALL,
        begin: Begin::TOGETHER,
    };

    /// The ray does not meet one side.
    pub fn culling(cull: Option<Side>) -> Self {
        Self { cull, ..Self::NONE }
    }

    /// The ray leaves a triangle, and meets everything else.
    pub fn leaving(point: DeparturePoint) -> Self {
        Self { departure: Some(point), is_departing: true, ..Self::NONE }
    }

    /// Sets all but the triangle that the ray leaves, for which there is [`leave`](Self::leave).
    /// `is_departing` says whether it leaves any surface. Both work in place: a filter is large,
    /// and there is one for each ray.
    #[inline(always)]
    pub fn set(&mut self, skip: [Option<u32>; 2], cull: Option<Side>, is_departing: bool) {
        self.skip = arrays::map(skip, |triangle| triangle.unwrap_or(NO_TRIANGLE));
        self.cull = cull;
        self.departure = None;
        self.left = NO_TRIANGLE;
        self.is_departing = is_departing;
        self.within = ALL;
        self.begin = Begin::TOGETHER;
    }

    /// The ray leaves a triangle at a point by the weights of its corners 1 and 2. If the triangle
    /// is one of this mesh, it has a number.
    #[inline(always)]
    pub fn leave(&mut self, triangle: Option<u32>, corners: [DVec3; 3], weights: DVec2) {
        self.departure = Some(DeparturePoint::new(corners, weights));
        self.left = triangle.unwrap_or(NO_TRIANGLE);
    }

    /// The ray meets no other triangles than those with numbers from the first to before the
    /// second.
    pub fn keep(&mut self, within: [u32; 2]) {
        self.within = within;
    }

    /// Sets a start at joined meshes that is not at one `t` for all.
    pub fn begin(&mut self, begin: Begin) {
        self.begin = begin;
    }

    /// The `t` from which on all joined meshes may be met; zero where the ray begins at one `t` for
    /// all.
    #[inline(always)]
    pub(crate) fn latest_begin(&self) -> f64 {
        self.begin.latest
    }

    /// Whether a ray that begins at each of some joined meshes at another `t` meets one of them at
    /// `t`. `farthest` is of that mesh.
    #[inline(always)]
    pub fn has_begun(&self, t: f64, farthest: impl FnOnce() -> f64) -> bool {
        self.begin.latest == 0.0 || t > self.begin.latest || t > self.begin.at(farthest())
    }

    /// Whether nothing of the mesh is known to be ahead of the start, but what stops the ray there.
    #[inline(always)]
    pub fn leaves_all_of(&self, mesh: Meshes<'_>) -> bool {
        self.left != NO_TRIANGLE && mesh.is_flat()
    }

    /// Whether a triangle is known not to be ahead: in the plane of the one that is left it is met
    /// at the start, or not at all.
    #[inline(always)]
    #[doc(hidden)]
    pub fn leaves_behind(&self, mesh: Meshes<'_>, direction: DVec3, triangle: u32) -> bool {
        let Some(point) = self.departure.as_ref().filter(|_| self.left != NO_TRIANGLE) else {
            return false;
        };
        let left = (self.left, point.weights.map(|[high, low]| high + low));
        mesh.are_in_one_plane(self.left, triangle)
            || (mesh.crowds()).is_some_and(|crowds| crowds.is_behind(direction, triangle, left))
    }

    /// Whether the ray leaves a surface: then its `t` decides as it is, since it is measured from a
    /// rounded start.
    #[inline]
    pub fn is_departing(&self) -> bool {
        self.is_departing
    }

    /// The ray's start, if it leaves a triangle.
    #[inline]
    pub fn departure(&self) -> Option<&DeparturePoint> {
        self.departure.as_ref()
    }

    /// Whether the ray meets every triangle ahead of its start that a ray without a filter meets.
    #[inline(always)]
    pub fn meets_everything(&self) -> bool {
        self.cull.is_none() && self.skip == [NO_TRIANGLE; 2] && self.within == ALL
    }

    /// Whether the ray meets every one of some triangles in one place ahead of its start that a ray
    /// without a filter meets.
    #[inline(always)]
    pub(crate) fn meets_all_of<T: Iterator<Item = u32>>(
        &self,
        triangles: impl FnOnce() -> T,
    ) -> bool {
        let skips = |triangle| self.skips(triangle);
        self.meets_everything() || self.cull.is_none() && !triangles().any(skips)
    }

    /// Intersects a triangle with the filter; `settle` is as in [`Shear::intersect_by`].
    #[inline(always)]
    pub fn intersect(
        &self,
        (ray, shear): (&Ray, &Shear),
        edges: EdgeRule,
        (triangle, corners): (u32, [DVec3; 3]),
        settle: impl FnOnce(Doubtful) -> Option<TriangleHit>,
    ) -> Option<TriangleHit> {
        if self.skips(triangle) {
            return None;
        }
        let hit = match &self.departure {
            Some(point) => point.intersect(ray, shear, edges, corners),
            None => shear.intersect_by(edges, corners, settle),
        }?;
        self.faces(ray.direction, corners).then_some(hit)
    }

    /// Whether the filter lets a ray meet a triangle that its line meets.
    pub fn admits(&self, direction: DVec3, (triangle, corners): (u32, [DVec3; 3])) -> bool {
        !self.skips(triangle) && self.faces(direction, corners)
    }

    #[inline(always)]
    fn skips(&self, triangle: u32) -> bool {
        let [first, end] = self.within;
        self.skip.contains(&triangle) || !(first..end).contains(&triangle)
    }

    /// Whether a ray comes to a side of a triangle that is not culled.
    #[inline(always)]
    fn faces(&self, direction: DVec3, corners: [DVec3; 3]) -> bool {
        (self.cull).is_none_or(|side| side != side_met(direction, corners))
    }
}

/// The side of a triangle that a ray meets, exactly: the front against the normal.
fn side_met(direction: DVec3, corners: [DVec3; 3]) -> Side {
    match along_normal(corners, direction) {
        Ordering::Less => Side::Front,
        _ => Side::Back,
    }
}

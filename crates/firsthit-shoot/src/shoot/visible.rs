//! Lines of sight: does one point see another?

use super::{Any, trace};
use crate::error::Result;
use crate::geometry::{DVec3, Ray, RayFilter, Rays, SurfaceId, require, share_at_end};
use crate::scene::Scene;
use crate::watch::Watch;

/// A point at an end of a line of sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewpoint {
    /// The position in the world.
    pub position: DVec3,
    /// The surface that it lies on, if any: that hides nothing.
    pub surface: Option<SurfaceId>,
}

impl Viewpoint {
    /// A point on no surface.
    pub const fn new(position: DVec3) -> Self {
        Self { position, surface: None }
    }
}

/// Whether the two points of each pair see each other: whether nothing is between them.
///
/// A surface at an end does not count: the points of a surface are rounded, to one side of it or
/// the other. So nothing counts within 2^-40 of the ends' largest coordinate from an end, measured
/// along the longest axis of the line; at a coordinate of 1 that is 10^-12. Nor does anything
/// nearer to an end than `tolerance`, in scene units, as for points that are rounded to float32.
/// Nor does an end's [`surface`](Viewpoint::surface), also where the line is nearly along it.
///
/// The answer does not depend on which comes first: the ray goes from the point with the lower
/// coordinates, by `x`, then `y`, then `z`. A point sees itself; one that is not finite, or beyond
/// 10^150, sees no other. The answers are in the order of the pairs.
///
/// ```
/// use firsthit::shoot::{Viewpoint, visible};
/// use firsthit::{DVec3, Object, Scene, Sphere};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let [a, b, c] = [-2.0, 2.0, 3.0].map(|x| Viewpoint::new(DVec3::new(x, 0.0, 0.0)));
/// assert_eq!(visible(&scene, &[[a, b], [b, c]], 0.0, &())?, [false, true]);
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Argument`](crate::error::Error::Argument) for a tolerance that is negative or not
/// finite, and those of [`trace`].
#[doc(alias("line of sight", "viewshed"))]
pub fn visible(
    scene: &Scene,
    pairs: &[[Viewpoint; 2]],
    tolerance: f64,
    watch: &dyn Watch,
) -> Result<Vec<bool>> {
    let is_length = tolerance >= 0.0 && tolerance.is_finite();
    require("tolerance", "0 or more, and finite", is_length, tolerance)?;
    let sights = Sights { pairs, tolerance };
    let mut answers = trace(scene, &sights, Any, watch)?;
    for (index, answer) in answers.iter_mut().enumerate() {
        let [a, b] = pairs[index].map(|end| end.position);
        // Either end could be the origin, with the same answer.
        let is_within_reach = || [a, b].into_iter().all(|end| Ray::new(end, b - a).is_valid());
        *answer = if a == b { a.is_finite() } else { is_within_reach() && !*answer };
    }
    Ok(answers)
}

/// The rays of lines of sight.
struct Sights<'a> {
    pairs: &'a [[Viewpoint; 2]],
    tolerance: f64,
}

impl Sights<'_> {
    /// The ends of a line in their own order.
    fn ordered(&self, index: usize) -> [Viewpoint; 2] {
        let [a, b] = self.pairs[index];
        let key = |end: &Viewpoint| {
            // Zero has one sign.
            let place = (end.position + 0.0).to_array().map(f64::to_bits);
            let total = place.map(|bits| bits ^ if bits >> 63 == 1 { u64::MAX } else { 1 << 63 });
            let surface = end.surface.map(|surface| (surface.object, surface.primitive));
            (total, surface)
        };
        if key(&b) < key(&a) { [b, a] } else { [a, b] }
    }
}

impl Rays for Sights<'_> {
    fn len(&self) -> usize {
        self.pairs.len()
    }

    /// The ray between the points. Its direction may be zero or infinite, and its end before its
    /// start: then it meets nothing.
    fn ray(&self, index: usize) -> Ray {
        let [from, to] = self.ordered(index).map(|end| end.position);
        let ray = Ray::new(from, to - from);
        let near = self.tolerance / (to - from).length();
        let at_end = share_at_end(from, to).max(near);
        ray.beyond(at_end).up_to(1.0 - at_end)
    }

    fn is_filtered(&self) -> bool {
        self.pairs.iter().flatten().any(|end| end.surface.is_some())
    }

    fn filter(&self, index: usize) -> RayFilter {
        RayFilter { skip: self.ordered(index).map(|end| end.surface), ..RayFilter::NONE }
    }
}

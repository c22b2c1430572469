//! How thick are objects?
//!
//! 1. Find the point of the surface that is nearest to each point.
//! 2. Send a ray inwards from there, which leaves the surface without an epsilon.
//! 3. Take where it first meets the same object; it meets no other.

use crate::error::Result;
use crate::geometry::{DVec3, Departure, Filtered, Hit, Ray, RayFilter};
use crate::memory;
use crate::nearest::{ClosestPoints, Wanted, closest_points};
use crate::scene::Scene;
use crate::shoot::{First, trace};
use crate::watch::{OnlyStops, Watch};

/// How many points are done at a time.
const PIECE: usize = 1 << 14;

/// How thick the objects are at the surface points nearest to `points`, in scene units: the distance inwards, against the normal, to where
/// a ray next meets the same object. Infinity where it does not meet it again; NaN for a point that has no surface to be near to, and where
/// the nearest is a triangle without an area: no direction is inwards.
///
/// The ray leaves the surface as [`SurfaceInteraction::leave`](crate::scene::SurfaceInteraction::leave) has it. Other objects do not count.
///
/// ```
/// use firsthit::measure::thickness;
/// use firsthit::{Cuboid, DVec3, Object, Scene};
///
/// let plate = Cuboid::new(DVec3::ZERO, DVec3::new(4.0, 4.0, 0.5))?;
/// let scene = Scene::new(vec![Object::new(plate)])?;
/// assert_eq!(thickness(&scene, &[[1.0, 1.0, 0.5], [0.0, 2.0, 0.25]], &())?, [0.5, 4.0]);
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// Those of [`closest_points`] and of [`trace`].
pub fn thickness(scene: &Scene, points: &[[f64; 3]], watch: &dyn Watch) -> Result<Vec<f64>> {
    let mut all = memory::filled(points.len(), f64::NAN)?;
    for (points, lengths) in points.chunks(PIECE).zip(all.chunks_mut(PIECE)) {
        let nearest = closest_points(scene, points, Wanted::default(), &OnlyStops(watch))?;
        measure(scene, &nearest, lengths, watch)?;
        watch.advance(points.len() as u64);
    }
    Ok(all)
}

fn measure(
    scene: &Scene,
    from: &ClosestPoints,
    lengths: &mut [f64],
    watch: &dyn Watch,
) -> Result<()> {
    let watch = &OnlyStops(watch);
    let inwards = (0..lengths.len()).map(|k| inwards(scene, from, k));
    let (rays, filters): (Vec<Ray>, Vec<RayFilter>) = inwards.unzip();
    let first = trace(scene, &Filtered::each(&rays, &filters), First, watch)?;
    let of_rays = rays.iter().zip(&first.t);
    for ((length, &object), (ray, &t)) in lengths.iter_mut().zip(&from.object).zip(of_rays) {
        if object >= 0 && ray.direction.is_finite() {
            *length = t;
        }
    }
    Ok(())
}

/// The ray inwards from a surface point, of a direction of length one.
fn inwards(scene: &Scene, from: &ClosestPoints, k: usize) -> (Ray, RayFilter) {
    let there = Ray::new(DVec3::from(from.point[k]), DVec3::Z);
    let hit = Hit {
        t: 0.0,
        object: from.object[k],
        primitive: from.primitive[k],
        barycentric: from.barycentric[k],
    };
    let Some(surface) = scene.interaction(&there, &hit) else {
        // It meets nothing.
        return (Ray::new(DVec3::NAN, DVec3::Z), RayFilter::NONE);
    };
    let (ray, mut filter) = surface.leave(-surface.normal());
    filter.only = Some(hit.object);
    // It goes through, also at edges.
    filter.departure = (filter.departure).map(|departure| Departure {
        side: None,
        ..departure
    });
    (ray, filter)
}

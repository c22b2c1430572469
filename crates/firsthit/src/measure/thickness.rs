//! How thick are objects?
//!
//! 1. Find the point of the surface that is nearest to each point.
//! 2. Send a ray inwards from there, which leaves the surface without an epsilon.
//! 3. Take where it first meets the same object. Where it meets another one before, look through all of its hits.

use crate::error::Result;
use crate::geometry::{DVec3, Filtered, Hit, Ray, RayFilter};
use crate::memory;
use crate::nearest::{ClosestPoints, Wanted, closest_points};
use crate::scene::Scene;
use crate::shoot::{All, AllHits, First, trace};
use crate::watch::Watch;

/// How many points are done at a time: all hits of some of their rays may be in memory at once.
const PIECE: usize = 1 << 14;

/// How thick the objects are at the surface points nearest to `points`, in scene units: the distance inwards, against the normal, to where
/// a ray next meets the same object. Infinity where it does not meet it again; NaN for a point that has no surface to be near to.
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

/// Points are counted, not what is done for each.
struct OnlyStops<'a>(&'a dyn Watch);

impl Watch for OnlyStops<'_> {
    fn is_stopped(&self) -> bool {
        self.0.is_stopped()
    }
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
    let mut others = Vec::new();
    for (k, length) in lengths.iter_mut().enumerate() {
        match (from.object[k], first.object[k]) {
            (-1, _) => {}
            (own, met) if met == own || met == -1 => *length = first.t[k],
            _ => others.push(k),
        }
    }
    let rays: Vec<Ray> = others.iter().map(|&k| rays[k]).collect();
    let filters: Vec<RayFilter> = others.iter().map(|&k| filters[k]).collect();
    let every = All { nearest: None };
    let AllHits { offsets, hits } = trace(scene, &Filtered::each(&rays, &filters), every, watch)?;
    for (&k, ends) in others.iter().zip(offsets.windows(2)) {
        let mut met = ends[0]..ends[1];
        let own = met.find(|&hit| hits.object[hit] == from.object[k]);
        lengths[k] = own.map_or(f64::INFINITY, |hit| hits.t[hit]);
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
    surface.leave(-surface.normal())
}

//! Measures the thickness of objects.
//!
//! 1. Find the point of the surface that is nearest to each point.
//! 2. Send a ray inwards from there, which leaves the surface without an epsilon, and find all its
//!    crossings of the same object.
//! 3. How often the object goes around the start follows from them. Take the first crossing behind
//!    which the ray is no longer inside.
//!
//! Open objects have no inside: there it is where the ray next meets them.

use crate::error::Result;
use crate::geometry::{DVec2, DVec3, Departure, Filtered, Hit, Ray, RayFilter, Rays, SurfaceId};
use crate::memory;
use crate::nearest::{ClosestPoints, NearestSettings, closest_points};
use crate::scene::Scene;
use crate::shoot::{Cpu, First, trace};
use crate::solid::{FillRule, Grouping, Solids};
use crate::watch::{OnlyStops, Watch};

/// The number of points that are done at a time.
const PIECE: usize = 1 << 14;

/// The thickness of the objects at the surface points nearest to `points`, in scene units: the
/// distance inwards, at right angles to the surface, to where the inside of that object ends. Zero
/// where it is on neither side of the surface. Of an open object it is the distance against the
/// normal to where a ray next meets it, and infinity where it does not meet it again. NaN for a
/// point that has no surface to be near to, and where the nearest is a triangle without an area: no
/// direction is inwards.
///
/// The ray leaves the surface as
/// [`SurfaceInteraction::leave`](crate::scene::SurfaceInteraction::leave) has it. Other objects do
/// not count.
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
/// The errors of [`closest_points`] and of [`trace`].
pub fn thickness(scene: &Scene, points: &[[f64; 3]], watch: &dyn Watch) -> Result<Vec<f64>> {
    thickness_with(FillRule::default(), scene, points, watch)
}

/// [`thickness`] by a rule of the caller's choice.
///
/// # Errors
///
/// The errors of [`thickness`].
pub fn thickness_with(
    rule: FillRule,
    scene: &Scene,
    points: &[[f64; 3]],
    watch: &dyn Watch,
) -> Result<Vec<f64>> {
    let mut all = memory::filled(points.len(), f64::NAN)?;
    for (points, lengths) in points.chunks(PIECE).zip(all.chunks_mut(PIECE)) {
        let nearest = closest_points(scene, points, NearestSettings::default(), &OnlyStops(watch))?;
        let inwards = (0..points.len()).map(|k| inwards(scene, &nearest, k));
        let (rays, filters): (Vec<Ray>, Vec<RayFilter>) = inwards.unzip();
        let rays_filtered = Filtered::each(&*rays, &filters);
        let t = thickness_along(rule, scene, &rays_filtered, Towards::Inside, watch)?;
        for (((length, &object), ray), t) in
            lengths.iter_mut().zip(&nearest.object).zip(&rays).zip(t)
        {
            if object >= 0 && ray.direction.is_finite() {
                *length = t;
            }
        }
    }
    Ok(all)
}

/// The direction of rays that leave surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Towards {
    /// Inwards, where the object goes around more often: a ray that begins the other way is turned
    /// around, and where both sides are outside it goes nowhere.
    Inside,
    /// The way that they have.
    Given,
}

/// The `t` at which each ray, which leaves a surface of the object that alone it meets
/// ([`RayFilter::only`]), comes out of that object or, if it starts outside, into it; of an open
/// object, at which it next meets it. Infinity where nothing of this is ahead, and zero for a ray
/// towards the inside with the outside on both sides. `t_max` is ignored.
///
/// # Errors
///
/// The errors of [`trace`] and of [`inside`](super::inside()).
pub fn thickness_along<R: Rays + ?Sized>(
    rule: FillRule,
    scene: &Scene,
    rays: &R,
    towards: Towards,
    watch: &dyn Watch,
) -> Result<Vec<f64>> {
    let solids = Solids::new(scene, rule)?;
    let mut t = memory::filled(rays.len(), f64::INFINITY)?;
    let object = |k: usize| rays.filter(k).only.and_then(|only| usize::try_from(only).ok());
    // Shapes are convex, so that what is met first is where they end.
    let is_solid = |&k: &usize| {
        object(k).is_some_and(|object| {
            let is_mesh = scene.objects().get(object).is_some_and(|it| it.mesh().is_some());
            is_mesh && solids.rules[object].is_of_closed()
        })
    };
    let (solid, other): (Vec<usize>, Vec<usize>) = (0..rays.len()).partition(is_solid);
    let these = |which: &[usize]| -> (Vec<Ray>, Vec<RayFilter>) {
        which.iter().map(|&k| (rays.ray(k), rays.filter(k))).unzip()
    };
    let (own, filters) = these(&other);
    let first = trace(scene, &Filtered::each(&*own, &filters), First, watch)?;
    for (&k, &first) in other.iter().zip(&first.t) {
        t[k] = first;
    }
    let (own, filters) = these(&solid);
    let lengths = through(&solids, &own, &filters, towards, watch)?;
    for (&k, &length) in solid.iter().zip(&lengths) {
        t[k] = length.unwrap_or(0.0);
    }
    // Along faces and edges both sides may be outside: there it is as thick as a little within the
    // triangle.
    let nowhere = (0..solid.len()).filter(|&place| lengths[place].is_none());
    let (which, within): (Vec<usize>, Vec<(Ray, RayFilter)>) = nowhere
        .filter_map(|place| Some((solid[place], within(scene, &own[place], filters[place])?)))
        .unzip();
    let (own, filters): (Vec<Ray>, Vec<RayFilter>) = within.into_iter().unzip();
    let lengths = through(&solids, &own, &filters, towards, &OnlyStops(watch))?;
    for (k, length) in which.into_iter().zip(lengths) {
        t[k] = length.unwrap_or(0.0);
    }
    Ok(t)
}

/// The distance by which a ray that leaves a vertex or an edge is moved towards the middle of its
/// triangle, as a share of the way.
const WITHIN: f64 = 1.0 / 65_536.0;

/// A ray that leaves a triangle of a mesh, moved to leave it a little within.
fn within(scene: &Scene, ray: &Ray, mut filter: RayFilter) -> Option<(Ray, RayFilter)> {
    let departure = filter.departure.as_mut()?;
    let SurfaceId { object, primitive } = departure.surface;
    let object = scene.objects().get(usize::try_from(object).ok()?)?;
    let triangle = usize::try_from(primitive).ok()?;
    let mesh = object.mesh().filter(|it| triangle < it.triangles().len())?;
    let [a, b, c] = mesh.corners(triangle);
    let DVec2 { x, y } = departure.barycentric.lerp(DVec2::splat(1.0 / 3.0), WITHIN);
    departure.barycentric = DVec2::new(x, y);
    let place = a + x * (b - a) + y * (c - a);
    let place = object.transform().world_from_object().transform_point3(place);
    Some((Ray { origin: place, ..*ray }, filter))
}

/// The parameters at which rays that each leave a closed mesh and meet no other object come out of
/// it or into it. `None` for a ray towards the inside with the outside on both sides.
fn through(
    solids: &Solids<'_>,
    rays: &[Ray],
    filters: &[RayFilter],
    towards: Towards,
    watch: &dyn Watch,
) -> Result<Vec<Option<f64>>> {
    let first = ends(solids, &Filtered::each(rays, filters), watch)?;
    let mut found: Vec<Option<f64>> = first.iter().map(|&(_, end)| Some(end)).collect();
    if towards == Towards::Given {
        return Ok(found);
    }
    let in_front = |k: usize| {
        let surface = filters[k].departure.map(|it| it.surface);
        let is_turned = surface.is_some_and(|it| {
            let object = usize::try_from(it.object).ok();
            object.is_some_and(|object| solids.is_turned(object, it.primitive))
        });
        // Behind a face the number is one more than in front of it. Where it is 0 or less behind,
        // the front is farther from 0: that is the inside.
        let turns = first[k].0;
        if is_turned { turns >= 0 } else { turns <= 0 }
    };
    let turned: Vec<usize> = (0..rays.len()).filter(|&k| in_front(k)).collect();
    let backwards = turned.iter().map(|&k| {
        let turned = Ray { direction: -rays[k].direction, ..rays[k] };
        (turned, filters[k])
    });
    let (own, filters): (Vec<Ray>, Vec<RayFilter>) = backwards.unzip();
    let ends = ends(solids, &Filtered::each(&*own, &filters), &OnlyStops(watch))?;
    for (&k, &(turns, end)) in turned.iter().zip(&ends) {
        if turns != 0 {
            found[k] = Some(end);
        } else if first[k].0 == 0 {
            found[k] = None;
        }
    }
    Ok(found)
}

/// The winding number of the start of each ray, which meets one closed mesh alone, and the
/// parameter at which the ray comes out of it, or into it.
fn ends(solids: &Solids<'_>, rays: &dyn Rays, watch: &dyn Watch) -> Result<Vec<(i32, f64)>> {
    let mut ends = memory::filled(rays.len(), (0, f64::INFINITY))?;
    let turns = || memory::filled(solids.rules.len(), 0_i32);
    solids.sweep(
        (&Cpu::default(), rays),
        (Grouping::Union, &mut ends),
        watch,
        turns,
        |turns, ray, met, end| {
            solids.wind(ray, met, turns);
            let at_start = met.objects().next().map_or(0, |object| turns[object]);
            let mut end_of: Option<f64> = None;
            for crossed in met.crossings() {
                let turns = &mut turns[crossed.object];
                *turns = solids.behind(ray, crossed, *turns);
                let is_changed = (*turns != 0) != (at_start != 0);
                match end_of {
                    None if is_changed => end_of = Some(crossed.t),
                    // Shells that touch leave no gap. (A `t` is at most one step off.)
                    Some(end) if !is_changed && crossed.t <= end.next_up().next_up() => {
                        end_of = None;
                    }
                    _ => {}
                }
            }
            end[0] = (at_start, end_of.unwrap_or(f64::INFINITY));
            Ok(())
        },
    )?;
    Ok(ends)
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
    filter.departure = (filter.departure).map(|departure| Departure { side: None, ..departure });
    (ray, filter)
}

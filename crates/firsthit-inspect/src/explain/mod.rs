//! The explanation of one ray: what it meets first, why each other object is not that, and what
//! lies behind.
//!
//! 1. The engine answers [`First`] and [`All`] for the ray. So the hit is the one that every other
//!    function gives.
//! 2. Each object is asked by itself what the ray does to it (`shoot/encounter.rs`).
//! 3. Of an object that the line of the ray does not touch, the way past its box is told
//!    (`explain/passage.rs`).

mod before_viewplane;
mod details;
mod passage;
mod pixel;
mod reason;

use std::borrow::Cow;

pub use before_viewplane::{BeforeViewplane, before_viewplane};
pub use details::{AttributeThere, CatalogEntry, HitDetails};
pub use pixel::{Pixel, explain_pixel};
pub use reason::Reason;

use crate::error::{Error, Result};
use crate::geometry::{DVec3, Filtered, Hit, Ray, RayFilter};
use crate::memory;
use crate::scene::Scene;
use crate::shoot::{All, AllHits, Encounter, Encounters, First, trace};
use crate::watch::{Watch, stop_if_asked};
use passage::{Passage, passage};

/// Settings for the explanation of a ray, see [`explain`].
#[derive(Debug, Clone, PartialEq)]
pub struct ExplainSettings {
    /// The parameter at which the ray begins, as [`Ray::t_min`]; for `None` the given ray's, and 0
    /// for a pixel.
    pub t_min: Option<f64>,
    /// The parameter at which the ray ends, as [`Ray::t_max`]; for `None` the given ray's, and
    /// infinity for a pixel.
    pub t_max: Option<f64>,
    /// The filter of the ray.
    pub filter: RayFilter,
    /// The only objects that it meets, by their identifiers; all for `None`.
    pub among: Option<Vec<usize>>,
    /// The number of crossings behind the hit that are listed; the others are counted.
    pub behind: usize,
}

impl Default for ExplainSettings {
    /// The ray keeps its ends, everything is met, and ten crossings are listed.
    fn default() -> Self {
        Self { t_min: None, t_max: None, filter: RayFilter::NONE, among: None, behind: 10 }
    }
}

/// The explanation of a ray, see [`explain`].
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Explanation<'a> {
    /// The ray, in the world, with the ends that were asked for.
    pub ray: Ray,
    /// The filter of the ray.
    pub filter: RayFilter,
    /// The fault of the ray, if it is not [valid](Ray::is_valid) and so meets nothing.
    pub fault: Option<&'static str>,
    /// The pixel that it goes through, if it is a camera's: see [`explain_pixel`].
    pub pixel: Option<Pixel>,
    /// The first hit; `None` for a miss.
    pub hit: Option<HitDetails<'a>>,
    /// The first crossings behind the hit, in order: those of [`All`] without the hit.
    pub behind: Vec<Behind<'a>>,
    /// The number of crossings behind the hit.
    pub behind_count: usize,
    /// Every object, in the order of identifiers.
    pub candidates: Vec<Candidate<'a>>,
    /// The longest side of the box around the scene.
    pub extent: f64,
}

/// A crossing behind the hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Behind<'a> {
    /// The crossing.
    pub hit: Hit,
    /// The object's name; may be empty.
    pub name: &'a str,
    /// The name of its shape.
    pub shape: &'static str,
    /// Whether the ray crosses from the front to the back.
    pub is_front: bool,
}

/// An object, and why it is or is not the hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate<'a> {
    /// The object's identifier.
    pub object: i32,
    /// The object's name; may be empty.
    pub name: &'a str,
    /// The name of its shape.
    pub shape: &'static str,
    /// The reason.
    pub reason: Reason,
    /// The first hit if the ray meets the object, otherwise the rejected crossing that `reason`
    /// describes. `None` where the line of the ray does not touch the surface.
    pub place: Option<Hit>,
}

impl Explanation<'_> {
    /// The number of objects for each reason that occurs, in the order of [`Reason::ALL`].
    pub fn counts(&self) -> Vec<(Reason, usize)> {
        let of = |&reason: &Reason| {
            let objects = self.candidates.iter();
            let count = objects.filter(|candidate| candidate.reason == reason);
            (reason, count.count())
        };
        let counts = Reason::ALL.iter().map(of);
        counts.filter(|&(_, count)| count > 0).collect()
    }
}

/// Explains a ray: what it meets first, why each other object is not that, and what lies behind. It
/// looks at every object, so that it takes time in proportion to their number.
///
/// All of it agrees to the bit with what [`trace`] answers. Whether a box is missed is decided in
/// exact arithmetic. The box is the one around the object in the world, that the tree over the
/// objects is made from; where an object is turned, its corners are rounded.
///
/// ```
/// use firsthit::explain::{ExplainSettings, Reason, explain};
/// use firsthit::{DVec3, Object, Plane, Ray, Scene, Sphere};
///
/// let scene = Scene::new(vec![
///     Object::new(Sphere::new(DVec3::new(9.0, 0.0, 1.0), 1.0)?).named("far ball"),
///     Object::new(Plane::new(DVec3::ZERO, DVec3::Z)?).named("ground"),
///     Object::new(Sphere::new(DVec3::new(0.0, 0.0, 1.0), 1.0)?).named("ball"),
/// ])?;
/// let down = Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z);
/// let story = explain(&scene, &down, &ExplainSettings::default(), &())?;
/// let hit = story.hit.as_ref().expect("the ray hits the ball");
/// assert_eq!((hit.name, hit.hit.t, hit.normal), ("ball", 3.0, DVec3::Z));
/// let reasons: Vec<Reason> = story.candidates.iter().map(|object| object.reason).collect();
/// assert_eq!(reasons, [Reason::BoxMissed, Reason::BehindHit, Reason::Hit]);
/// let behind: Vec<_> = story.behind.iter().map(|place| (place.name, place.hit.t)).collect();
/// assert_eq!(behind, [("ground", 5.0), ("ball", 5.0)]);
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Argument`] for an object of `among` that is not there, [`Error::Limit`] when memory is
/// short, [`Error::Interrupted`] when `watch` stops it.
pub fn explain<'a>(
    scene: &'a Scene,
    ray: &Ray,
    settings: &ExplainSettings,
    watch: &dyn Watch,
) -> Result<Explanation<'a>> {
    let ExplainSettings { filter, among, .. } = settings;
    let ray = &Ray {
        t_min: settings.t_min.unwrap_or(ray.t_min),
        t_max: settings.t_max.unwrap_or(ray.t_max),
        ..*ray
    };
    let out = among.as_ref().map(|among| left_out(scene, among));
    let out = out.transpose()?.unwrap_or_default();
    let seen = but(scene, &out)?;
    let rays = [*ray];
    let rays = Filtered::new(&rays, *filter);
    let hit = trace(&seen, &rays, First, watch)?.get(0);
    let all = trace(&seen, &rays, All::default(), watch)?;
    let (behind, behind_count) = behind(scene, ray, &hit, (&all, settings.behind))?;
    Ok(Explanation {
        ray: *ray,
        filter: *filter,
        fault: fault(ray),
        pixel: None,
        hit: HitDetails::new(scene, ray, &hit)?,
        behind,
        behind_count,
        candidates: candidates(scene, (ray, filter, &out), &hit, watch)?,
        extent: scene.bounds().size().max_element(),
    })
}

/// The objects that are left out, as a flag for each; empty where none is.
fn left_out(scene: &Scene, among: &[usize]) -> Result<Vec<bool>> {
    let count = scene.objects().len();
    let mut out = memory::filled(count, true)?;
    for &object in among {
        let is_out = out.get_mut(object).ok_or_else(|| {
            let got = format!("{object}; there are {count}");
            Error::argument("among", "objects of the scene", got)
        })?;
        *is_out = false;
    }
    Ok(out)
}

/// The scene without some objects.
fn but<'a>(scene: &'a Scene, out: &[bool]) -> Result<Cow<'a, Scene>> {
    let hidden = out.iter().enumerate().filter(|(_, is_out)| **is_out);
    let hidden: Vec<(usize, bool)> = hidden.map(|(object, _)| (object, true)).collect();
    if hidden.is_empty() {
        return Ok(Cow::Borrowed(scene));
    }
    let mut scene = scene.clone();
    scene.hide_objects(&hidden)?;
    Ok(Cow::Owned(scene))
}

/// The fault of a ray that is not valid.
fn fault(ray: &Ray) -> Option<&'static str> {
    if ray.is_valid() {
        return None;
    }
    let is_far = ray.origin.is_nan() || ray.origin.abs().max_element() > Ray::FARTHEST;
    Some(if is_far {
        "a coordinate of its origin is NaN or beyond 1e150"
    } else if ray.direction == DVec3::ZERO {
        "its direction is zero"
    } else if !ray.direction.is_finite() {
        "its direction is not finite"
    } else if ray.t_min.is_nan() || ray.t_max.is_nan() {
        "its t_min or its t_max is NaN"
    } else {
        "it ends before it begins"
    })
}

/// The crossings behind a hit: the first few, and how many there are.
fn behind<'a>(
    scene: &'a Scene,
    ray: &Ray,
    hit: &Hit,
    (all, most): (&AllHits, usize),
) -> Result<(Vec<Behind<'a>>, usize)> {
    let is_hit = |k: &usize| {
        let other = all.hits.get(*k);
        (other.object, other.primitive) == (hit.object, hit.primitive)
    };
    // At an edge the hit may be no crossing. A solid that is crossed twice is hit at the first end.
    let own = (0..all.hits.len()).find(is_hit);
    let count = all.hits.len() - usize::from(own.is_some());
    let mut found = Vec::new();
    let room = found.try_reserve_exact(count.min(most));
    room.map_err(|_| memory::no_room_for("what lies behind a hit"))?;
    let others = (0..all.hits.len()).filter(|&k| Some(k) != own);
    for k in others.take(most) {
        let hit = all.hits.get(k);
        if let (Some(surface), Some(object)) = (scene.interaction(ray, &hit), scene.object(&hit)) {
            let is_front = surface.is_front();
            found.push(Behind { hit, name: object.name(), shape: object.shape().name(), is_front });
        }
    }
    Ok((found, count))
}

/// Every object, and why it is or is not the hit.
fn candidates<'a>(
    scene: &'a Scene,
    (ray, filter, out): (&Ray, &RayFilter, &[bool]),
    hit: &Hit,
    watch: &dyn Watch,
) -> Result<Vec<Candidate<'a>>> {
    let mut candidates = Vec::new();
    let room = candidates.try_reserve_exact(scene.objects().len());
    room.map_err(|_| memory::no_room_for("candidates of a ray"))?;
    let mut encounters = Encounters::new(scene, ray, filter);
    for (index, object) in (0_u32..).zip(scene.objects()) {
        stop_if_asked(watch)?;
        let (reason, place) = if object.is_hidden() {
            (Reason::Hidden, None)
        } else if out.get(index as usize) == Some(&true) {
            (Reason::NotAmong, None)
        } else if let Some(encounters) = &mut encounters {
            reason(encounters, (scene, index), ray, hit)
        } else {
            (Reason::NoRay, None)
        };
        candidates.push(Candidate {
            object: index.cast_signed(),
            name: object.name(),
            shape: object.shape().name(),
            reason,
            place,
        });
    }
    Ok(candidates)
}

/// The reason why an object is or is not the hit.
fn reason(
    encounters: &mut Encounters<'_>,
    (scene, index): (&Scene, u32),
    ray: &Ray,
    hit: &Hit,
) -> (Reason, Option<Hit>) {
    match encounters.with(index) {
        Encounter::Hidden => (Reason::Hidden, None),
        Encounter::NotAsked => (Reason::NotAmong, None),
        Encounter::Masked => (Reason::Masked, None),
        Encounter::OutOfRange => (Reason::OutOfRange, None),
        Encounter::Met(_) if hit.object == index.cast_signed() => (Reason::Hit, Some(*hit)),
        Encounter::Met(place) if encounters.are_tied(&place, hit) => (Reason::Tied, Some(place)),
        Encounter::Met(place) => (Reason::BehindHit, Some(place)),
        Encounter::Rejected(place, why) => (why.into(), Some(place)),
        Encounter::Untouched => {
            let wide = scene.box_around(index as usize);
            if wide.is_empty() {
                return (Reason::Empty, None);
            }
            // The box of the tree may be wider than the object's own, which takes longer to find.
            let passage = match passage(ray, &wide, hit.t) {
                Passage::Missed => Passage::Missed,
                _ => passage(ray, &scene.smallest_box(index as usize), hit.t),
            };
            let reason = match passage {
                Passage::Missed => Reason::BoxMissed,
                Passage::BehindStart => Reason::BoxBehindStart,
                Passage::BeyondEnd => Reason::BoxBeyondEnd,
                Passage::BehindHit => Reason::BoxBehindHit,
                Passage::Met => Reason::SurfaceMissed,
            };
            (reason, None)
        }
    }
}

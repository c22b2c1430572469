//! Distances with a sign: negative inside.
//!
//! The inside is that of `measure::inside`, which decides it exactly for closed meshes as they
//! are in their own space. A transform rounds the point and the ray; shapes that are no mesh are
//! decided in float64.

use super::{Method, NearestSettings, closest_points_with};
use crate::error::{Error, Result, escape_controls};
use crate::geometry::{DVec3, require};
use crate::memory;
use crate::scene::Scene;
use crate::shoot::{BruteForce, Cpu, Engine};
use crate::solid::{FillRule, Grouping, inside_by};
use crate::watch::{OnlyStops, Watch};

/// The distance of each of `points` from the nearest surface: negative for a point inside any
/// object, positive for one outside of all, zero on a surface. Where objects overlap, the surface
/// of one within the other counts too. Infinite where [`closest_point`](super::closest_point) is
/// `None`.
///
/// ```
/// use firsthit::nearest::signed_distances;
/// use firsthit::{DVec3, Object, Scene, Sphere};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let points = [[0.0, 0.0, 0.25], [0.0, 3.0, 0.0]];
/// assert_eq!(signed_distances(&scene, &points, &())?, [-0.75, 2.0]);
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Argument`] for an object that is not [closed](crate::shape::Shape::is_closed), or of
/// which a material cuts parts out: it has no inside. Those of
/// [`closest_points`](super::closest_points).
pub fn signed_distances(scene: &Scene, points: &[[f64; 3]], watch: &dyn Watch) -> Result<Vec<f64>> {
    signed_distances_with(SignSettings::default(), scene, points, watch)
}

/// Settings for the sign of a distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SignSettings {
    /// The rule for the inside of closed meshes.
    pub rule: FillRule,
    /// Whether open objects are taken, too: points are inside of them as their winding number says,
    /// and never inside a plane or a disc.
    pub allow_open: bool,
    /// The method of the search: only times depend on it.
    pub method: Method,
}

/// The number of points that are done at a time: the crossings of all their rays are in memory at
/// once.
const PIECE: usize = 1 << 14;

/// [`signed_distances`] as the caller wants it.
///
/// # Errors
///
/// The errors of [`signed_distances`]; but with [`SignSettings::allow_open`] open objects are none.
pub fn signed_distances_with(
    settings: SignSettings,
    scene: &Scene,
    points: &[[f64; 3]],
    watch: &dyn Watch,
) -> Result<Vec<f64>> {
    require_closed(settings, scene)?;
    let mut signed = memory::filled(points.len(), f64::INFINITY)?;
    for (points, signed) in points.chunks(PIECE).zip(signed.chunks_mut(PIECE)) {
        let method = settings.method;
        let nearest =
            closest_points_with(method, scene, points, NearestSettings::default(), watch)?;
        sign(settings, (scene, points), &nearest.distance, signed, watch)?;
    }
    Ok(signed)
}

/// Gives the distances of points the signs that [`signed_distances`] has: negative inside.
/// `distances` are those to the nearest surfaces, one for each point, as
/// [`closest_points`](super::closest_points) finds them.
///
/// ```
/// use firsthit::nearest::{SignSettings, NearestSettings, closest_points, signed_distances_from};
/// use firsthit::{DVec3, Object, Scene, Sphere};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let points = [[0.0, 0.0, 0.25], [0.0, 3.0, 0.0]];
/// let nearest = closest_points(&scene, &points, NearestSettings::default(), &())?;
/// let settings = SignSettings::default();
/// let signed = signed_distances_from(settings, &scene, &points, &nearest.distance, &())?;
/// assert_eq!(signed, [-0.75, 2.0]);
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// The errors of [`signed_distances_with`], and [`Error::Argument`] for another number of distances
/// than of points.
pub fn signed_distances_from(
    settings: SignSettings,
    scene: &Scene,
    points: &[[f64; 3]],
    distances: &[f64],
    watch: &dyn Watch,
) -> Result<Vec<f64>> {
    let is_one_each = distances.len() == points.len();
    require("distances", "one for each point", is_one_each, distances.len())?;
    require_closed(settings, scene)?;
    let mut signed = memory::filled(points.len(), f64::INFINITY)?;
    let pieces = points.chunks(PIECE).zip(distances.chunks(PIECE));
    for ((points, distances), signed) in pieces.zip(signed.chunks_mut(PIECE)) {
        sign(settings, (scene, points), distances, signed, watch)?;
        watch.advance(points.len() as u64);
    }
    Ok(signed)
}

/// Refuses objects that have no inside, unless they are allowed, and says why the first has none.
fn require_closed(settings: SignSettings, scene: &Scene) -> Result<()> {
    let open = scene.first_open_object();
    let Some(open) = open.filter(|_| !settings.allow_open) else {
        return Ok(());
    };
    let object = &scene.objects()[open];
    let why = match object.mesh().map(|mesh| mesh.odd_edges()).transpose()? {
        Some(1) => ", of which one edge belongs to an odd number of triangles".to_owned(),
        Some(count) if count > 0 => {
            format!(", of which {count} edges belong to an odd number of triangles")
        }
        _ if object.has_cutouts() => ", parts of which its material cuts out".to_owned(),
        _ => String::new(),
    };
    let (name, shape) = (escape_controls(object.name()), object.shape().name());
    Err(Error::argument(
        "objects",
        "closed where signed distances are asked",
        format!("an open one: object {open} ({shape} \"{name}\"){why}"),
    ))
}

fn sign(
    settings: SignSettings,
    (scene, points): (&Scene, &[[f64; 3]]),
    distances: &[f64],
    signed: &mut [f64],
    watch: &dyn Watch,
) -> Result<()> {
    let engine: &dyn Engine = match settings.method {
        Method::BruteForce => &BruteForce,
        Method::Trees(set) => &Cpu::with(set),
    };
    let points: Vec<DVec3> = points.iter().copied().map(DVec3::from).collect();
    let asked = (&*points, Grouping::Union);
    let insides = inside_by(engine, settings.rule, scene, asked, &OnlyStops(watch))?;
    let all = signed.iter_mut().zip(distances).zip(insides.is_inside);
    for ((signed, &distance), is_inside) in all {
        // On a surface it is neither: no negative zero.
        let is_negative = is_inside && distance > 0.0 && distance < f64::INFINITY;
        *signed = if is_negative { -distance } else { distance };
    }
    Ok(())
}

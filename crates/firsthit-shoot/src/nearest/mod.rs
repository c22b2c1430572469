//! Finds the points of a scene nearest to points, and their distances.
//!
//! 1. Take the next object whose box may be near enough, from the tree over the objects.
//! 2. Of a mesh, take the triangles that may be near enough, from its tree
//!    (`accel/traverse/nearest.rs`).
//! 3. Compute the distance in float64 (`shape/nearest.rs`): it decides.
//!
//! The number that is compared is [`Nearest::squared`](crate::shape::Nearest::squared), the square
//! of the distance; of equal ones the lower (object, primitive) is nearer. Trees and lanes only
//! rule out, so the answer is that of brute force, to the last bit, for any number of threads and
//! on every instruction set.
//!
//! Distances are those of the world, also to objects whose transforms stretch. A part that a
//! material cuts out is measured like any other surface.
#![allow(
    clippy::inline_always,
    reason = "what is not inlined into a kernel is not compiled for its instruction set"
)]

mod answers;
mod best;
mod search;
mod signed;

pub use answers::{ClosestPoint, ClosestPoints};
pub use search::Method;
pub use signed::{SignSettings, signed_distances, signed_distances_from, signed_distances_with};

use crate::error::{Error, Result};
use crate::geometry::{DVec3, require};
use crate::scene::{Object, Scene};
use crate::watch::Watch;

/// The number of nearest points that are wanted, and their largest distance.
///
/// ```
/// use firsthit::nearest::NearestSettings;
///
/// let two_within_a_metre = NearestSettings { count: 2, radius: 1.0 };
/// assert_eq!(NearestSettings::default(), NearestSettings { count: 1, radius: f64::INFINITY });
/// # let _ = two_within_a_metre;
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestSettings {
    /// The number of points for each point, each of another (object, primitive): at least 1.
    pub count: usize,
    /// The largest distance that counts, itself included.
    pub radius: f64,
}

/// The nearest, wherever it is.
impl Default for NearestSettings {
    fn default() -> Self {
        Self { count: 1, radius: f64::INFINITY }
    }
}

/// The point of the scene that is nearest to `point`; at the same distance that of the lower
/// (object, primitive). `None` without objects, and for a point that is not finite, or so far away
/// that the square of its distance leaves float64.
///
/// ```
/// use firsthit::nearest::closest_point;
/// use firsthit::{DVec3, Object, Scene, Sphere};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let nearest = closest_point(&scene, DVec3::new(0.0, 0.0, 3.0))?.unwrap();
/// assert_eq!((nearest.point, nearest.distance, nearest.object), (DVec3::Z, 2.0, 0));
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// The errors of [`closest_points`].
#[doc(alias("nearest point", "distance query"))]
pub fn closest_point(scene: &Scene, point: DVec3) -> Result<Option<ClosestPoint>> {
    let all = closest_points(scene, &[point.to_array()], NearestSettings::default(), &())?;
    Ok(all.get(0, 0))
}

/// The points of the scene that are nearest to each of `points`, by all threads of the current
/// rayon pool: `wanted.count` for each, in the order of the squares of their distances, of equal
/// ones in that of (object, primitive).
///
/// ```
/// use firsthit::nearest::{NearestSettings, closest_points};
/// use firsthit::{DVec3, Object, Plane, Scene, Sphere};
///
/// let scene = Scene::new(vec![
///     Object::new(Plane::new(DVec3::ZERO, DVec3::Z)?),
///     Object::new(Sphere::new(DVec3::new(0.0, 0.0, 5.0), 1.0)?),
/// ])?;
/// let wanted = NearestSettings { count: 2, radius: 3.0 };
/// let nearest = closest_points(&scene, &[[0.0, 0.0, 3.0], [0.0, 0.0, -1.0]], wanted, &())?;
/// assert_eq!(nearest.object, [1, 0, 0, -1]);
/// assert_eq!(nearest.distance, [1.0, 3.0, 1.0, f64::INFINITY]);
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Argument`] for a count of zero, for a radius that is negative or NaN, and for a cone or
/// a cylinder whose transform does not stretch by the same in all directions; [`Error::Limit`] when
/// the answers do not fit into memory; [`Error::Interrupted`] when `watch` stops it.
pub fn closest_points(
    scene: &Scene,
    points: &[[f64; 3]],
    wanted: NearestSettings,
    watch: &dyn Watch,
) -> Result<ClosestPoints> {
    closest_points_with(Method::default(), scene, points, wanted, watch)
}

/// [`closest_points`] by a method of the caller's choice: only times depend on it.
///
/// # Errors
///
/// The errors of [`closest_points`].
pub fn closest_points_with(
    method: Method,
    scene: &Scene,
    points: &[[f64; 3]],
    wanted: NearestSettings,
    watch: &dyn Watch,
) -> Result<ClosestPoints> {
    let NearestSettings { count, radius } = wanted;
    require("count", "at least 1", count > 0, count)?;
    require("radius", "zero or positive", radius >= 0.0, radius)?;
    require_measurable(scene)?;
    let mut answers = ClosestPoints::room(points.len(), count)?;
    search::fill(method, scene, points, wanted, &mut answers, watch)?;
    Ok(answers)
}

/// Refuses objects to which no distance can be measured.
fn require_measurable(scene: &Scene) -> Result<()> {
    let mut objects = scene.objects().iter().enumerate();
    let is_odd = |object: &Object| !object.shape().is_measurable(object.transform());
    let odd = objects.find(|(_, object)| !object.is_hidden() && is_odd(object));
    let Some((index, object)) = odd else {
        return Ok(());
    };
    let (name, shape) = (object.name(), object.shape().name());
    let name = crate::error::escape_controls(name);
    Err(Error::argument(
        "transform",
        "a rotation and a uniform scale where distances to a cone or a cylinder are asked",
        format!("another one for object {index} ({shape} \"{name}\")"),
    ))
}

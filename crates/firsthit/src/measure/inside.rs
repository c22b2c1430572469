//! Which points are inside?

use super::sweep::{Met, Solids};
use super::{By, Rule};
use crate::error::Result;
use crate::geometry::DVec3;
use crate::memory;
use crate::scene::Scene;
use crate::shoot::FromPoints;
use crate::watch::Watch;

/// Which points are inside, and how that is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Insides {
    /// For each point one answer, or with [`By::Object`] one for each object, point by point.
    pub is_inside: Vec<bool>,
    /// The rule of each object.
    pub rules: Vec<Rule>,
}

/// Tells which points, in world space, are inside the scene's objects, by all threads of the current rayon pool. The answers do not
/// depend on the number of threads.
///
/// For a closed mesh without a transform the answer is exact. A transform first takes the point to object space, which rounds; it is
/// then exact about that point. About the other solids it is as exact as their crossings in float64.
///
/// A point exactly on the surface is inside if what is just ahead of it along (7, 10, 10.5) is. So of closed objects that share a face
/// or an edge, and leave no gap, exactly one holds a point there.
/// A point that is not finite, or beyond 10^150, is outside.
///
/// ```
/// use firsthit::measure::{By, inside};
/// use firsthit::{DVec3, Object, Scene, Sphere};
///
/// let ball = |radius| Sphere::new(DVec3::ZERO, radius).map(Object::new);
/// let scene = Scene::new(vec![ball(1.0)?, ball(2.0)?])?;
/// let points = [DVec3::ZERO, DVec3::new(1.5, 0.0, 0.0), DVec3::new(9.0, 0.0, 0.0)];
/// assert_eq!(inside(&scene, &points, By::Union, &())?.is_inside, [true, true, false]);
/// let by_object = inside(&scene, &points, By::Object, &())?;
/// assert_eq!(by_object.is_inside, [true, true, false, true, false, false]);
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Limit`](crate::Error::Limit) when the answers do not fit into memory,
/// [`Error::Interrupted`](crate::Error::Interrupted) when `watch` stops it.
pub fn inside(scene: &Scene, points: &[DVec3], by: By, watch: &dyn Watch) -> Result<Insides> {
    let solids = Solids::new(scene)?;
    let count = points.len().saturating_mul(by.width(scene));
    let mut is_inside = memory::filled(count, false)?;
    let objects = scene.objects().len();
    // Of a union, which objects a point is in.
    let flags = || memory::filled(if by == By::Union { objects } else { 0 }, false);
    solids.sweep(
        &FromPoints(points),
        (by, &mut is_inside),
        watch,
        flags,
        |flags, ray, met, row| {
            let point = ray.origin;
            match by {
                By::Object => {
                    solids.toggle(met, row);
                    for &object in &solids.open {
                        row[object] = solids.is_in_open(object, point, watch)?;
                    }
                }
                By::Union => {
                    solids.toggle(met, flags);
                    let mut is_inside = false;
                    for object in met.objects() {
                        is_inside |= std::mem::take(&mut flags[object]);
                    }
                    for &object in &solids.open {
                        is_inside = is_inside || solids.is_in_open(object, point, watch)?;
                    }
                    row[0] = is_inside;
                }
            }
            Ok(())
        },
    )?;
    let rules = solids.rules;
    Ok(Insides { is_inside, rules })
}

impl Solids<'_> {
    /// Toggles the flag of a closed object for each crossing.
    pub(super) fn toggle(&self, met: &Met<'_>, flags: &mut [bool]) {
        for object in met.objects() {
            flags[object] ^= self.rules[object] == Rule::Parity;
        }
    }
}

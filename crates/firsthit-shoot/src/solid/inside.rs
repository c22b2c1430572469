//! Finds the points that are inside.

use super::sweep::Solids;
use super::{FillRule, Grouping, Rule};
use crate::error::Result;
use crate::geometry::DVec3;
use crate::memory;
use crate::scene::Scene;
use crate::shoot::{Cpu, Engine, FromPoints};
use crate::watch::Watch;

/// The answers for points, and the rules behind them.
#[derive(Debug, Clone, PartialEq)]
pub struct Containment {
    /// The answers, one for each point, or with [`Grouping::Object`] one for each object, point by
    /// point.
    pub is_inside: Vec<bool>,
    /// The rule of each object.
    pub rules: Vec<Rule>,
}

/// Tells which points, in world space, are inside the scene's objects, by all threads of the
/// current rayon pool. The answers do not depend on the number of threads.
///
/// A closed mesh holds the points that it goes around, as [`FillRule::default`] has it, and for a
/// mesh without a transform that is exact. A transform first takes the point to object space, which
/// rounds; it is then exact about that point. About the other solids it is as exact as their
/// crossings in float64.
///
/// A point exactly on the surface is inside if what is just ahead of it along (7, 10, 10.5) is. So
/// of closed objects that share a face or an edge, and leave no gap, exactly one holds a point
/// there. A point that is not finite, or beyond 10^150, is outside.
///
/// ```
/// use firsthit::measure::{Grouping, inside};
/// use firsthit::{DVec3, Object, Scene, Sphere};
///
/// let ball = |radius| Sphere::new(DVec3::ZERO, radius).map(Object::new);
/// let scene = Scene::new(vec![ball(1.0)?, ball(2.0)?])?;
/// let points = [DVec3::ZERO, DVec3::new(1.5, 0.0, 0.0), DVec3::new(9.0, 0.0, 0.0)];
/// assert_eq!(inside(&scene, &points, Grouping::Union, &())?.is_inside, [true, true, false]);
/// let by_object = inside(&scene, &points, Grouping::Object, &())?;
/// assert_eq!(by_object.is_inside, [true, true, false, true, false, false]);
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Limit`](crate::error::Error::Limit) when the answers do not fit into memory,
/// [`Error::Interrupted`](crate::error::Error::Interrupted) when `watch` stops it.
#[doc(alias("point in mesh", "contains"))]
pub fn inside(
    scene: &Scene,
    points: &[DVec3],
    by: Grouping,
    watch: &dyn Watch,
) -> Result<Containment> {
    inside_with(FillRule::default(), scene, points, by, watch)
}

/// [`inside`] by a rule of the caller's choice.
///
/// # Errors
///
/// The errors of [`inside`].
pub fn inside_with(
    rule: FillRule,
    scene: &Scene,
    points: &[DVec3],
    by: Grouping,
    watch: &dyn Watch,
) -> Result<Containment> {
    inside_by(&Cpu::default(), rule, scene, (points, by), watch)
}

/// [`inside_with`] by an engine of the caller's choice: only times depend on it.
pub(crate) fn inside_by(
    engine: &dyn Engine,
    rule: FillRule,
    scene: &Scene,
    (points, by): (&[DVec3], Grouping),
    watch: &dyn Watch,
) -> Result<Containment> {
    let solids = Solids::new(scene, rule)?;
    let count = points.len().saturating_mul(by.width(scene));
    let mut is_inside = memory::filled(count, false)?;
    let objects = scene.objects().len();
    // How many times each object goes around a point; zero between two points.
    let turns = || memory::filled(objects, 0_i32);
    solids.sweep(
        (engine, &FromPoints(points)),
        (by, &mut is_inside),
        watch,
        turns,
        |turns, ray, met, row| {
            let point = ray.origin;
            solids.wind(ray, met, turns);
            match by {
                Grouping::Object => {
                    for object in met.objects() {
                        row[object] |= std::mem::take(&mut turns[object]) != 0;
                    }
                    for &object in &solids.open {
                        row[object] = solids.is_in_open(object, point, watch)?;
                    }
                }
                Grouping::Union => {
                    let mut is_inside = false;
                    for object in met.objects() {
                        is_inside |= std::mem::take(&mut turns[object]) != 0;
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
    Ok(Containment { is_inside, rules })
}

//! Finds the solids in which rays start.

use super::sweep::Solids;
use super::{FillRule, Grouping};
use crate::error::Result;
use crate::geometry::Rays;
use crate::memory;
use crate::scene::Scene;
use crate::shoot::Cpu;
use crate::watch::Watch;

/// The closed object, of those that each ray starts in, that it leaves first, by
/// [`FillRule::default`]. Open objects do not count.
///
/// ```
/// use firsthit::measure::innermost;
/// use firsthit::{DVec3, Object, Ray, Scene, Sphere};
///
/// let ball = |radius| Sphere::new(DVec3::ZERO, radius).map(Object::new);
/// let scene = Scene::new(vec![ball(2.0)?, ball(1.0)?])?;
/// let from = |x: f64| Ray::new(DVec3::X * x, DVec3::X);
/// let rays = [from(-5.0), from(-1.5), from(0.0), from(1.5), from(5.0)];
/// assert_eq!(innermost(&scene, &rays, &())?, [None, Some(0), Some(1), Some(0), None]);
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// The errors of [`inside`](super::inside()).
pub fn innermost<R: Rays>(
    scene: &Scene,
    rays: &R,
    watch: &dyn Watch,
) -> Result<Vec<Option<usize>>> {
    let solids = Solids::new(scene, FillRule::default())?;
    let mut innermost = memory::filled(rays.len(), None)?;
    let turns = || memory::filled(scene.objects().len(), 0_i32);
    solids.sweep(
        (&Cpu::default(), rays),
        (Grouping::Union, &mut innermost),
        watch,
        turns,
        |turns, ray, met, left| {
            solids.wind(ray, met, turns);
            for crossed in met.crossings() {
                let before = turns[crossed.object];
                // It does not start in there, or has left it.
                if before == 0 || !solids.rules[crossed.object].is_of_closed() {
                    continue;
                }
                let behind = solids.behind(ray, crossed, before);
                turns[crossed.object] = behind;
                if behind == 0 && left[0].is_none() {
                    left[0] = Some(crossed.object);
                }
            }
            Ok(())
        },
    )?;
    Ok(innermost)
}

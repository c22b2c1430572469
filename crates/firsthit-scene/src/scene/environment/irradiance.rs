//! The irradiance of an unoccluded surface by an environment.

use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

use super::{Environment, EnvironmentKind};
use crate::geometry::{Color, DMat3, DVec3, unit};
use crate::parallel;
use crate::sampling::{Draws, TangentFrame, warp};

/// The irradiance of one normal, computed when it is first asked for: it takes milliseconds.
#[derive(Debug, Default)]
pub(super) struct IrradianceCache(OnceLock<(DVec3, Color)>);

impl Clone for IrradianceCache {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// Caches always compare equal: they derive from the environment.
impl PartialEq for IrradianceCache {
    fn eq(&self, _other: &Self) -> bool {
        true
    }
}

impl IrradianceCache {
    fn get(&self, normal: DVec3, compute: impl Fn(DVec3) -> Color) -> Color {
        let &(known, irradiance) = parallel::once(&self.0, || (normal, compute(normal)));
        if known == normal { irradiance } else { compute(normal) }
    }
}

impl Environment {
    /// The radiance of a white matte surface that faces along `normal`, of length one, without
    /// occlusion: the irradiance divided by pi.
    #[doc(hidden)]
    pub fn irradiance(&self, normal: DVec3) -> Color {
        self.strength * self.kind_irradiance(normal)
    }

    fn kind_irradiance(&self, normal: DVec3) -> Color {
        match &self.kind {
            EnvironmentKind::Uniform(color) => *color,
            EnvironmentKind::Hemispheres { above, below, up } => {
                below.lerp(*above, normal.dot(unit(*up)).midpoint(1.0))
            }
            EnvironmentKind::Gradient { horizon, zenith, up } => {
                horizon.lerp(*zenith, both_cosines(normal.dot(unit(*up))))
            }
            EnvironmentKind::Map { map, world_from_map } => {
                // In the map's own frame: environments that turn it differently share what is kept.
                let own = Self::new(EnvironmentKind::Map {
                    map: Arc::clone(map),
                    world_from_map: DMat3::IDENTITY,
                });
                let normal = world_from_map.transpose() * normal;
                map.irradiance_cache().get(normal, |normal| own.summed(normal))
            }
            EnvironmentKind::Daylight(daylight) => daylight
                .irradiance_cache()
                .get(normal, |normal| Self::new(self.kind.clone()).summed(normal)),
        }
    }

    /// The mean over many directions, half of them by the cosine and half by the table if there is
    /// one, each weighted by how likely it is drawn in both ways (Veach and Guibas, "Optimally
    /// Combining Sampling Techniques for Monte Carlo Rendering", SIGGRAPH 1995: the balance
    /// heuristic).
    fn summed(&self, normal: DVec3) -> Color {
        const COUNT: u32 = 1 << 14;
        let brought = |towards: DVec3| {
            let cosine = towards.dot(normal).max(0.0);
            let pdf = cosine / PI + self.pdf(towards);
            if pdf > 0.0 { (cosine / (PI * pdf)) * self.radiance(towards) } else { Color::ZERO }
        };
        let mut sum = Color::ZERO;
        let frame = TangentFrame::around(normal);
        for sample in 0..COUNT {
            let u = Draws::new(0, sample).two();
            sum += brought(frame.world(warp::cosine_hemisphere(u)));
            if let Some(drawn) = self.sample(u) {
                sum += brought(unit(drawn.towards));
            }
        }
        sum / f64::from(COUNT)
    }
}

/// The integral over all directions of the product of two cosines, where both are positive, divided
/// by pi: of those to two directions with this cosine between them (Cho and Saul, "Kernel Methods
/// for Deep Learning", NIPS 2009, for three dimensions).
fn both_cosines(cosine: f64) -> f64 {
    let cosine = cosine.clamp(-1.0, 1.0);
    let angle = libm::acos(cosine);
    2.0 / (3.0 * PI) * (libm::sin(angle) + (PI - angle) * cosine)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::EnvironmentMap;
    use super::*;
    use crate::geometry::DMat3;

    /// The reference: a sum over the middles of even cells of the whole sphere, without tables.
    fn by_cells(environment: &Environment, normal: DVec3) -> Color {
        const SIDE: u32 = 1024;
        let mut sum = Color::ZERO;
        for k in 0..SIDE * SIDE {
            let [across, height] =
                [k % SIDE, k / SIDE].map(|x| (f64::from(x) + 0.5) / f64::from(SIDE));
            let y = 1.0 - 2.0 * height;
            let (sin, cos) = libm::sincos(2.0 * PI * across);
            let level = (1.0 - y * y).sqrt();
            let towards = DVec3::new(level * cos, y, level * sin);
            sum += towards.dot(normal).max(0.0) * environment.radiance(towards);
        }
        sum * (4.0 / f64::from(SIDE * SIDE))
    }

    /// A map's cache is in its own frame: environments that turn it differently share it.
    #[test]
    fn a_map_that_is_turned_keeps_nothing_of_another_turn() {
        let texels = (0..32).map(|k| [if k == 9 { 60.0 } else { 0.1 }; 3]);
        let map = Arc::new(EnvironmentMap::new(8, 4, texels.collect::<Vec<_>>()).unwrap());
        for degrees in [0.0, 90.0, 180.0] {
            let turn = crate::geometry::rotation(DVec3::X, degrees);
            let kind = EnvironmentKind::of_map(Arc::clone(&map), DVec3::Z, &turn);
            let environment = Environment::new(kind);
            let (got, expected) =
                (environment.irradiance(DVec3::Z), by_cells(&environment, DVec3::Z));
            assert!((got / expected - 1.0).length() < 0.02, "{degrees}: {got} {expected}");
        }
    }

    #[test]
    fn it_is_the_integral_over_all_directions() {
        let (up, white) = (DVec3::new(0.3, 0.9, -0.2), Color::ONE);
        let texels = (0..32).map(|k| [if k == 9 { 60.0 } else { 0.1 * k as f32 }; 3]);
        let map = EnvironmentMap::new(8, 4, texels.collect::<Vec<_>>()).unwrap();
        let kinds = [
            EnvironmentKind::Uniform(Color::new(0.2, 0.4, 0.9)),
            EnvironmentKind::Hemispheres { above: white, below: 0.2 * white, up },
            EnvironmentKind::Gradient { horizon: 0.3 * white, zenith: white, up },
            EnvironmentKind::of_map(Arc::new(map), up, &DMat3::IDENTITY),
        ];
        for kind in kinds {
            let environment = Environment { strength: 1.5, ..Environment::new(kind) };
            for normal in [unit(up), DVec3::X, DVec3::NEG_Y] {
                let (got, expected) =
                    (environment.irradiance(normal), by_cells(&environment, normal));
                assert!(
                    (got - expected).abs().max_element() < 0.003 * expected.max_element(),
                    "{environment:?} {normal}: {got} {expected}"
                );
                assert_eq!(got, environment.irradiance(normal));
            }
        }
    }
}

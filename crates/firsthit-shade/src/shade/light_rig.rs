//! Light for pictures of what has none of its own.

use std::sync::Arc;

use crate::camera::Camera;
use crate::geometry::{Color, DVec2, DVec3, named, unit};
use crate::scene::{DirectionalLight, Environment, EnvironmentKind, Light, form_factor};

named! {
    /// A set of lights that goes with the camera.
    ///
    /// All but `shoulder` are exposed so that a white matte surface that faces the first light, or
    /// without one faces upwards, is 0.8.
    pub enum LightRig, "light":
    /// A soft key light from the upper left, a sky, and a weak light on the edges from behind.
    #[default]
    "auto" => Auto;
    /// A photographer's three lights: key, fill and rim, all soft, with little light from all
    /// around.
    "studio" => Studio;
    /// A bright sky without a sun.
    "overcast" => Overcast;
    /// A sun with sharp shadows, and a sky.
    "sun" => Sun;
    /// Parallel light from the camera.
    "headlight" => Headlight;
    /// Parallel light over the camera's left shoulder.
    "shoulder" => Shoulder;
}

/// The lights of a [`LightRig`].
#[derive(Debug, Clone, PartialEq)]
pub struct Lighting {
    /// The lights with a direction.
    pub lights: Vec<Light>,
    /// The light from all directions.
    pub environment: Option<Arc<Environment>>,
}

/// A light of a rig: where it comes from, in the camera's frame (right, up, back), its share of
/// white, and its angle.
struct Lamp {
    from: [f64; 3],
    share: f64,
    angle_degrees: f64,
}

/// A sky of one colour over a ground of another, as shares of white.
struct Sky {
    above: Color,
    below: Color,
}

impl LightRig {
    /// The radiance of a white matte surface that faces the first light.
    pub const WHITE: Color = Color::splat(0.8);

    /// The lights of the rig for a camera, in a world with that direction upwards.
    pub fn lighting(self, camera: &Camera, up: DVec3) -> Lighting {
        let lamp = |from, share, angle_degrees| Lamp { from, share, angle_degrees };
        let sky = |above, below: [f64; 3]| {
            let (above, below) = (Color::splat(above), Color::from(below));
            Some(Sky { above, below })
        };
        let key = [-0.7, 0.9, 0.75];
        let (lamps, sky) = match self {
            Self::Auto => (
                vec![lamp(key, 0.6, 25.0), lamp([0.8, 0.5, -1.0], 0.15, 10.0)],
                sky(0.5, [0.25, 0.235, 0.22]),
            ),
            Self::Studio => (
                vec![
                    lamp([-0.9, 0.7, 0.8], 0.7, 35.0),
                    lamp([1.0, 0.2, 0.8], 0.2, 50.0),
                    lamp([0.5, 0.7, -1.0], 0.35, 20.0),
                ],
                sky(0.12, [0.1; 3]),
            ),
            Self::Overcast => (vec![], sky(1.0, [0.3; 3])),
            Self::Sun => (vec![lamp([-0.8, 0.9, 0.4], 0.75, 0.53)], sky(0.3, [0.12, 0.11, 0.1])),
            Self::Headlight => (vec![lamp([0.0, 0.0, 1.0], 1.0, 0.0)], None),
            Self::Shoulder => return shoulder(camera),
        };
        lit(camera, unit(up), &lamps, sky.as_ref())
    }
}

/// The light of pictures that have none of their own: parallel, from behind the camera's left
/// shoulder.
fn shoulder(camera: &Camera) -> Lighting {
    let light = DirectionalLight {
        direction: camera.aim() + 0.45 * camera.right() - 0.6 * camera.upwards(),
        color: Color::splat(0.95),
        angle_degrees: 0.0,
    };
    Lighting { lights: vec![light.into()], environment: None }
}

/// The lamps and the sky in the world, exposed for a white surface that faces the first lamp.
fn lit(camera: &Camera, up: DVec3, lamps: &[Lamp], sky: Option<&Sky>) -> Lighting {
    let light = |lamp: &Lamp, exposure: Color| {
        let [right, upwards, back] = lamp.from;
        let from = right * camera.right() + upwards * camera.upwards() - back * camera.aim();
        Light::from(DirectionalLight {
            direction: -unit(from),
            color: lamp.share * exposure,
            angle_degrees: lamp.angle_degrees,
        })
    };
    let unexposed: Vec<Light> = lamps.iter().map(|lamp| light(lamp, Color::ONE)).collect();
    let middle = |light: &Light| light.sample(DVec3::ZERO, DVec2::splat(0.5));
    let first = unexposed.first().and_then(middle);
    let faced = first.map_or(up, |arriving| unit(arriving.towards));
    let mut taken: Color =
        (unexposed.iter()).map(|light| taken_by_white(light, (DVec3::ZERO, faced), 16)).sum();
    if let Some(Sky { above, below }) = sky {
        // Half a sky and half a ground, for a surface that stands upright.
        taken += below.lerp(*above, 0.5 + 0.5 * faced.dot(up));
    }
    let exposure = LightRig::WHITE / taken;
    let kind = sky.map(|&Sky { above, below }| EnvironmentKind::Hemispheres {
        above: above * exposure,
        below: below * exposure,
        up,
    });
    let environment = kind.map(|kind| Environment { is_seen: false, ..Environment::new(kind) });
    Lighting {
        lights: lamps.iter().map(|lamp| light(lamp, exposure)).collect(),
        environment: environment.map(Arc::new),
    }
}

/// The radiance of a white matte surface by a light at a point, facing along a normal. A sun has a
/// closed form. For other lights with a size it is the mean over an even grid of their points,
/// `side` by `side`, since some may be behind the surface.
pub(super) fn taken_by_white(light: &Light, (at, normal): (DVec3, DVec3), side: u32) -> Color {
    if let Light::Directional(sun) = light {
        let cosine = -unit(sun.direction).dot(normal);
        let half = libm::sincos((0.5 * sun.angle_degrees).to_radians());
        return form_factor::of_disc_to_facing(cosine, half.into()) * sun.color;
    }
    if !light.has_size() {
        let arriving = light.sample(at, DVec2::splat(0.5));
        return arriving.map_or(Color::ZERO, |arriving| {
            unit(arriving.towards).dot(normal).max(0.0) * arriving.light
        });
    }
    let cells = (0..side * side).map(|cell| DVec2::from([cell % side, cell / side].map(f64::from)));
    let points = cells.map(|cell| (cell + 0.5) / f64::from(side));
    let arriving = points.filter_map(|point| light.sample(at, point));
    let taken = arriving.map(|arriving| {
        let cosine = unit(arriving.towards).dot(normal).max(0.0);
        cosine * arriving.light
    });
    taken.sum::<Color>() / f64::from(side * side)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Draws;

    /// A white matte surface takes the mean over the light's directions of light and cosine, and of
    /// a sky the mean over cosines.
    #[test]
    fn a_white_surface_that_faces_the_key_is_four_fifths() {
        for (aim, up) in [(DVec3::Y, DVec3::Z), (DVec3::new(1.0, -2.0, -3.0), DVec3::Y)] {
            let camera = Camera::look_at(-aim, DVec3::ZERO, up, 45.0, 3, 4).unwrap();
            for rig in LightRig::ALL.iter().filter(|&&rig| rig != LightRig::Shoulder) {
                let Lighting { lights, environment } = rig.lighting(&camera, up);
                let middle = DVec2::splat(0.5);
                let first = lights.first().and_then(|light| light.sample(DVec3::ZERO, middle));
                let faced = first.map_or(up, |arriving| unit(arriving.towards));
                // By numbers that have nothing to do with the grid that exposes.
                let mean = |light: &Light| {
                    let each = |k| {
                        let u = Draws::new(7, k).two();
                        let arriving = light.sample(DVec3::ZERO, u).unwrap();
                        unit(arriving.towards).dot(faced).max(0.0) * arriving.light
                    };
                    (0..4096).map(each).sum::<Color>() / 4096.0
                };
                let mut taken: Color = lights.iter().map(mean).sum();
                if let Some(environment) = environment {
                    let share = 0.5 + 0.5 * faced.dot(up);
                    let [above, below] = [up, -up].map(|side| environment.radiance(side));
                    taken += below.lerp(above, share);
                }
                assert!((taken - LightRig::WHITE).abs().max_element() < 0.003, "{rig:?} {taken}");
            }
        }
    }
}

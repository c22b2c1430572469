//! Lights: a file per kind, and a row.

mod directional;
mod disc;
#[doc(hidden)]
pub mod form_factor;
mod point;
mod rectangle;
mod sphere;
mod spot;

pub use directional::DirectionalLight;
#[doc(hidden)]
pub use directional::Sun;
pub use disc::DiscLight;
pub use point::PointLight;
pub use rectangle::RectangleLight;
pub use sphere::SphereLight;
pub use spot::SpotLight;

use crate::geometry::{
    Color, DVec2, DVec3, Domain, Ray, Settings, Value, kinds, share_at_end, single, unit,
};
use crate::sampling::key;

/// A point drawn of a light, as seen from a point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightSample {
    /// The direction from the point towards the light. Where [`distance`](Self::distance) is 1, it
    /// ends at the light.
    pub towards: DVec3,
    /// The distance to the light, in lengths of `towards`: 1, or infinity.
    pub distance: f64,
    /// The irradiance over pi of a surface that faces `towards`, if this direction stands for the
    /// whole light.
    pub light: Color,
    /// The probability density of this direction, per steradian. `None` for a light without a size:
    /// there is one direction.
    pub pdf: Option<f64>,
}

impl LightSample {
    /// The `t_max` of a shadow ray to the light, from the point that the sample was drawn for.
    #[inline(always)]
    #[doc(hidden)]
    pub fn ray_end(&self, at: DVec3) -> f64 {
        if self.distance == f64::INFINITY {
            self.distance
        } else {
            end_of(&Ray::new(at, self.towards), self.distance)
        }
    }
}

impl LightHit {
    /// Whether a surface that a ray with a direction of length one meets after a distance leaves
    /// the light visible.
    #[doc(hidden)]
    pub fn is_visible_before(&self, ray: &Ray, distance: f64) -> bool {
        distance == f64::INFINITY || end_of(ray, self.distance) < distance
    }
}

/// The `t_max` of a ray to a light. Surfaces within rounding of the light are at the light: the
/// ceiling that a lamp lies in, or a copy of a surface that emits.
#[inline]
fn end_of(ray: &Ray, distance: f64) -> f64 {
    if distance == f64::INFINITY {
        return distance;
    }
    let share = share_at_end(ray.origin, ray.at(distance));
    // Above 0, since a ray that ends before it begins makes no sense.
    (distance * (1.0 - share)).max(f64::MIN_POSITIVE)
}

/// The meeting of a ray with a light that has a size, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightHit {
    /// The distance to the light, in lengths of the ray's direction; infinity for a sun.
    pub distance: f64,
    /// The radiance of the light.
    pub radiance: Color,
    /// The probability density with which [`Light::sample`] draws the ray's direction, per
    /// steradian.
    pub pdf: f64,
}

/// A light for many points.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub enum PreparedLight {
    Sun(Sun),
    Other(Light),
}

impl PreparedLight {
    /// See [`Light::sample`].
    #[inline]
    pub fn sample(&self, at: DVec3, u: DVec2) -> Option<LightSample> {
        match self {
            Self::Sun(sun) => Some(sun.sample(u)),
            Self::Other(light) => light.sample(at, u),
        }
    }

    /// The sample that is the same at all points, if there is one for these numbers.
    pub fn everywhere(&self, u: DVec2) -> Option<LightSample> {
        match self {
            Self::Sun(sun) => Some(sun.sample(u)),
            Self::Other(_) => None,
        }
    }
}

impl Light {
    /// The light with the parts precomputed that do not depend on the point.
    #[doc(hidden)]
    pub fn prepared(&self) -> PreparedLight {
        match self {
            Self::Directional(light) => PreparedLight::Sun(light.prepared()),
            _ => PreparedLight::Other(*self),
        }
    }
}

/// A kind of light.
trait LightSource {
    /// Light that arrives at a point, from a direction that a point of the unit square stands for.
    /// `None` where none arrives.
    fn sample(&self, at: DVec3, u: DVec2) -> Option<LightSample>;

    /// The meeting of the ray from `at` with the light, `towards` having length one. `None` for a
    /// miss, and for a light without a size.
    fn intersect(&self, _at: DVec3, _towards: DVec3) -> Option<LightHit> {
        None
    }

    /// Whether the light has a size: whether shadows are soft.
    fn has_size(&self) -> bool;

    /// The light at `factor` times its strength.
    fn scaled(self, factor: f64) -> Self;
}

macro_rules! lights {
    ($($(#[doc = $about:literal])* $name:literal => $kind:ident($light:ty);)*) => {
        /// A light.
        ///
        /// Its numbers are the light that a matte white surface takes, so its colour in the
        /// picture: for light of irradiance `E` that is `E / pi`. Lights with a surface say its
        /// radiance.
        ///
        /// ```
        /// use firsthit::scene::DirectionalLight;
        /// use firsthit::{Color, DVec3, Light, Scene};
        ///
        /// let sun = Light::from(DirectionalLight {
        ///     direction: DVec3::new(0.5, 0.5, -1.0),
        ///     color: Color::splat(0.9),
        ///     angle_degrees: 0.53,
        /// });
        /// let scene = Scene::new(vec![])?.with_lights(vec![sun]);
        /// assert_eq!(scene.lights(), [sun]);
        /// # Ok::<(), firsthit::Error>(())
        /// ```
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum Light {
            $($(#[doc = $about])* $kind($light),)*
        }

        $(impl From<$light> for Light {
            fn from(light: $light) -> Self {
                Self::$kind(light)
            }
        })*

        kinds!("light", Light { $($(#[doc = $about])* $name => $kind($light);)* });

        impl Light {
            /// Light that arrives at a point of the world from a direction that `u`, a point of the
            /// unit square, stands for: the mean over the square is all its light. `None` where
            /// none arrives.
            #[inline]
            pub fn sample(&self, at: DVec3, u: DVec2) -> Option<LightSample> {
                match self { $(Self::$kind(light) => light.sample(at, u),)* }
            }

            /// The meeting of the ray from `at` with the light, both in the world, `towards` having
            /// length one. `None` for a miss, and for a light without a size.
            pub fn intersect(&self, at: DVec3, towards: DVec3) -> Option<LightHit> {
                match self { $(Self::$kind(light) => light.intersect(at, towards),)* }
            }

            /// Whether the light has a size: whether shadows are soft.
            pub fn has_size(&self) -> bool {
                match self { $(Self::$kind(light) => light.has_size(),)* }
            }

            /// A number that stands for it, whatever other lights there are and however strong it
            /// is.
            #[doc(hidden)]
            pub fn key(&self) -> u64 {
                match self { $(Self::$kind(light) => key_of(light),)* }
            }

            /// The light at `factor` times its strength.
            #[must_use]
            pub fn scaled(&self, factor: f64) -> Self {
                match *self { $(Self::$kind(light) => Self::$kind(light.scaled(factor)),)* }
            }
        }
    };
}

lights! {
    /// Parallel light from infinitely far away; with an angle, a sun.
    "directional" => Directional(DirectionalLight);
    /// Light from one point.
    "point" => Point(PointLight);
    /// Light from one point into a cone.
    "spot" => Spot(SpotLight);
    /// A sphere that shines.
    "sphere" => Sphere(SphereLight);
    /// A disc that shines on one side.
    "disc" => Disc(DiscLight);
    /// A rectangle, or another parallelogram, that shines on one side.
    "rectangle" => Rectangle(RectangleLight);
}

/// A number that stands for all settings but how strong the light is. Directions count in float32:
/// those of a camera's lights are rounded, and a picture of the same scene in another unit has the
/// same noise.
fn key_of<S: Settings>(light: &S) -> u64 {
    let values = S::LIST.iter().zip(light.values());
    let values = values.filter(|(setting, _)| setting.domain != Domain::Light);
    key(values.flat_map(|(setting, value)| match value {
        Value::Flag(flag) => [f64::from(flag), 0.0, 0.0],
        Value::Number(number) => [number, 0.0, 0.0],
        Value::Vector(vector) if setting.domain == Domain::Direction => {
            unit(vector).to_array().map(|x| f64::from(single(x)))
        }
        Value::Vector(vector) => vector.to_array(),
    }))
}

/// Light from a point of a flat surface of that area and radiance, whose normal has length one.
/// `None` behind it.
fn from_area(
    at: DVec3,
    point: DVec3,
    normal: DVec3,
    area: f64,
    radiance: Color,
) -> Option<LightSample> {
    let towards = point - at;
    let squared = towards.length_squared();
    let cosine = -towards.dot(normal) / squared.sqrt();
    // Written so that a NaN fails.
    (cosine > 0.0).then(|| {
        let solid_angle = area * cosine / squared;
        LightSample {
            towards,
            distance: 1.0,
            light: radiance * (solid_angle / std::f64::consts::PI),
            pdf: Some(1.0 / solid_angle),
        }
    })
}

/// The meeting of a ray with a flat surface, from the front, where `is_within` accepts the point of
/// the plane.
fn met_flat(
    at: DVec3,
    towards: DVec3,
    (center, normal): (DVec3, DVec3),
    area: f64,
    radiance: Color,
    is_within: impl Fn(DVec3) -> bool,
) -> Option<LightHit> {
    let cosine = -towards.dot(normal);
    let distance = (at - center).dot(normal) / cosine;
    let is_met = cosine > 0.0 && distance > 0.0 && is_within(at + distance * towards);
    is_met.then(|| LightHit { distance, radiance, pdf: distance * distance / (area * cosine) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Draws;

    /// Rounding of a camera's lights keeps the key, and another light changes it.
    #[test]
    fn the_key_of_a_light_is_that_of_its_place() {
        let sun = |x: f64, color: f64| {
            Light::from(DirectionalLight {
                direction: DVec3::new(x, 0.5, -1.0),
                color: Color::splat(color),
                angle_degrees: 3.0,
            })
        };
        assert_eq!(sun(0.3, 1.0).key(), sun(0.3 + 1e-16, 7.0).key());
        assert_ne!(sun(0.3, 1.0).key(), sun(0.301, 1.0).key());
    }

    /// Lights with a size, each seen from some points: the directions that are drawn meet the light
    /// where they say, with the pdf they say, and their mean is the integral over all directions.
    #[test]
    fn what_is_drawn_is_what_rays_meet() {
        let mut lights = Vec::new();
        for kind in Light::NAMES {
            let mut light = Light::named(kind).unwrap();
            if *kind == "directional" {
                light.set("angle_degrees", Value::Number(20.0)).unwrap();
            }
            if light.has_size() {
                lights.push(light);
            }
        }
        assert_eq!(lights.len(), 4);
        for light in lights {
            let mut seen = 0;
            for at in [DVec3::new(0.1, 0.2, -3.0), DVec3::new(4.0, -1.0, -2.0)] {
                for sample in 0..64 {
                    let Some(arriving) = light.sample(at, Draws::new(1, sample).two()) else {
                        continue;
                    };
                    seen += 1;
                    let length = arriving.towards.length();
                    let met = light.intersect(at, arriving.towards / length).expect("it is met");
                    let distance = arriving.distance * length;
                    assert!(
                        distance == met.distance || (distance / met.distance - 1.0).abs() < 1e-9,
                        "{light:?} {distance} {met:?}"
                    );
                    let pdf = arriving.pdf.unwrap();
                    assert!((pdf / met.pdf - 1.0).abs() < 1e-6, "{light:?}");
                    let light = met.radiance / (std::f64::consts::PI * pdf);
                    assert!((arriving.light - light).length() < 1e-9 * light.length());
                }
            }
            assert!(seen >= 64, "{light:?}");
        }
    }

    /// The mean over the drawn directions of 1 / pdf is the solid angle, which random directions
    /// know too.
    #[test]
    fn solid_angles_are_those_of_random_directions() {
        use crate::sampling::warp;
        const COUNT: u32 = 1 << 14;
        for kind in Light::NAMES {
            let mut light = Light::named(kind).unwrap();
            if *kind == "directional" {
                light.set("angle_degrees", Value::Number(60.0)).unwrap();
            }
            if !light.has_size() {
                continue;
            }
            let at = DVec3::new(0.3, 0.2, -1.5);
            let drawn = |k| light.sample(at, Draws::new(9, k).two());
            let drawn = (0..COUNT).filter_map(drawn).map(|a| 1.0 / a.pdf.unwrap());
            let drawn = drawn.sum::<f64>() / f64::from(COUNT);
            let meets = |k| {
                let towards = warp::cap(Draws::new(2, k).two(), 2.0);
                light.intersect(at, towards).is_some()
            };
            let met = (0..COUNT).filter(|&k| meets(k)).count() as f64;
            let met = 4.0 * std::f64::consts::PI * met / f64::from(COUNT);
            assert!((drawn / met - 1.0).abs() < 0.02, "{kind}: {drawn} {met}");
        }
    }
}

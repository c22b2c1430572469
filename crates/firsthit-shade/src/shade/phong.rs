//! Highlights: a share of the light around the direction of a mirror, as a power of a cosine.

use super::depth_cue::{DepthCue, depth_cued};
use super::lit::{HardLighting, Incoming, Lit, Reflection};
use super::{Points, Shading};
use crate::geometry::{Color, DVec3, Domain, unit};

depth_cued! {
    /// The settings of the shaders of Phong and Blinn. Surfaces are lit on both sides.
    pub struct Phong {
        /// Light from everywhere, which nothing blocks.
        ambient: Color, Domain::Color, default Color::splat(0.25);
        /// The share of the light that the matte part takes.
        diffuse: f64, Domain::From(0.0, 1.0), default 1.0;
        /// The colour of highlights, which is that of the light, times this.
        specular: Color, Domain::Color, default Color::splat(0.3);
        /// The exponent of highlights: the larger, the smaller they are. Blinn's are as large as
        /// Phong's with about four times as much.
        shininess: f64, Domain::Positive, default 32.0;
        /// Whether things cast shadows.
        shadows: bool, Domain::Flag, default true;
    }
}

/// Shades after Phong, "Illumination for Computer Generated Pictures", Communications of the ACM
/// 18(6), 1975.
pub(super) fn shade(
    settings: &Phong,
    shading: &Shading<'_>,
    points: &Points<'_>,
    colors: &mut [Color],
) {
    shade_by(mirrored, settings, shading, points, colors);
}

/// Shades after Blinn, "Models of Light Reflection for Computer Synthesized Pictures", SIGGRAPH
/// 1977.
pub(super) fn shade_blinn(
    settings: &Phong,
    shading: &Shading<'_>,
    points: &Points<'_>,
    colors: &mut [Color],
) {
    shade_by(halfway, settings, shading, points, colors);
}

/// The cosine between the viewer and the direction in which a mirror would send the light.
fn mirrored(point: &Lit, light: &Incoming) -> f64 {
    let mirrored = 2.0 * light.cosine * point.normal - light.towards;
    mirrored.dot(point.viewer())
}

/// The cosine between the normal and the one that a mirror would have to send the light to the
/// viewer.
fn halfway(point: &Lit, light: &Incoming) -> f64 {
    let halfway: DVec3 = unit(light.towards + point.viewer());
    halfway.dot(point.normal)
}

fn shade_by(
    highlight: fn(&Lit, &Incoming) -> f64,
    settings: &Phong,
    shading: &Shading<'_>,
    points: &Points<'_>,
    colors: &mut [Color],
) {
    let &Phong { flat, shadows, .. } = settings;
    let glossy = Glossy { settings, highlight };
    HardLighting { flat, shadows }.shade(&glossy, shading, points, colors);
    DepthCue::from(settings).fade(points, colors);
}

/// A matte part and a highlight, which is a power of some cosine.
struct Glossy<'a> {
    settings: &'a Phong,
    highlight: fn(&Lit, &Incoming) -> f64,
}

impl Reflection for Glossy<'_> {
    fn ambient(&self, point: &Lit) -> Color {
        self.settings.ambient * point.color
    }

    fn reflected(&self, point: &Lit, light: &Incoming) -> Color {
        let matte = self.settings.diffuse * light.cosine * point.color;
        let cosine = (self.highlight)(point, light);
        // Written so that a NaN fails: the light comes from where the ray goes to.
        let power = if cosine > 0.0 { libm::pow(cosine, self.settings.shininess) } else { 0.0 };
        (matte + power * self.settings.specular) * (light.share * light.light)
    }
}

//! Radiographs: how much light goes through everything on the way of a ray, as through an absorbing
//! medium (Lambert 1760, Beer 1852).

use super::crossings::Crossings;
use super::{Points, Shading};
use crate::geometry::{Color, Domain, settings};
use crate::scene::SurfaceInteraction;

settings! {
    /// The settings of the X-ray shader.
    pub struct Xray {
        /// The absorption of each scene unit inside of closed objects: of 1 there, exp(-1) is left.
        density: f64, Domain::NonNegative, default 0.0;
        /// The absorption of each surface, as of a skin: more where the ray meets it aslant.
        skin: f64, Domain::NonNegative, default 0.15;
        /// The colour where everything is absorbed.
        color: Color, Domain::Color, default Color::new(0.8, 0.93, 1.0);
    }
}

/// Shades so that, with the length inside of closed objects and the angles between the ray and the
/// normals, `exp(-density * length - skin * sum of 1 / cos)` of what is behind is seen, and the
/// rest is `color`.
pub(super) fn shade(
    settings: &Xray,
    shading: &Shading<'_>,
    points: &Points<'_>,
    colors: &mut [Color],
    coverage: &mut [f64],
) {
    let crossings = Crossings::new(shading, points);
    let surfaces = crossings.surfaces(shading.scene);
    for (k, met) in crossings.of_rays().enumerate() {
        let left = libm::exp(-settings.absorbed(&surfaces[met]));
        let behind = shading.seen_behind(points.surfaces[k].ray().direction);
        colors[k] = settings.color.lerp(behind, left);
        coverage[k] = 1.0 - left;
    }
}

impl Xray {
    /// The exponent for all that a ray meets, in order.
    fn absorbed(&self, met: &[SurfaceInteraction<'_>]) -> f64 {
        let mut absorbed = self.density * length_inside(met);
        if self.skin > 0.0 {
            let cosine = |surface: &SurfaceInteraction<'_>| {
                let direction = surface.ray().direction;
                surface.normal().dot(direction).abs() / direction.length()
            };
            let thickness: f64 = met.iter().map(|surface| 1.0 / cosine(surface)).sum();
            absorbed += self.skin * thickness;
        }
        absorbed
    }
}

/// The length of a ray inside of closed objects, in scene units; where several overlap, each
/// counts.
fn length_inside(met: &[SurfaceInteraction<'_>]) -> f64 {
    let is_solid = |surface: &&SurfaceInteraction<'_>| {
        let object = surface.object();
        !object.has_cutouts() && object.shape().is_closed()
    };
    let mut solid: Vec<&SurfaceInteraction<'_>> = met.iter().filter(is_solid).collect();
    // Of each object still in the order along the ray.
    solid.sort_by_key(|surface| surface.hit().object);
    let mut length = 0.0;
    for of_object in solid.chunk_by(|a, b| a.hit().object == b.hit().object) {
        // A ray enters and leaves in turn. It may start inside, but it ends outside, so pairs are
        // made from its end.
        for pair in of_object.rchunks(2) {
            let ray = pair[0].ray();
            let (enters, leaves) = match pair {
                [enters, leaves] => (enters.hit().t, leaves.hit().t),
                _ => (ray.t_min, pair[0].hit().t),
            };
            length += (leaves - enters) * ray.direction.length();
        }
    }
    length
}

//! Translucent surfaces: all that are on the way of a ray, in their exact order, the front ones
//! over those behind (Porter and Duff, "Compositing Digital Images", SIGGRAPH 1984).

use super::crossings::Crossings;
use super::depth_cue::depth_cued;
use super::lambert::{self, Lambert};
use super::{Points, Shading};
use crate::geometry::{Color, Domain};
use crate::scene::compute_geometry;

depth_cued! {
    /// The settings of the ghost shader.
    pub struct Ghost {
        /// The opacity of each surface, from 0 to 1.
        opacity: f64, Domain::From(0.0, 1.0), default 0.3;
        /// Light from everywhere, which nothing blocks.
        ambient: Color, Domain::Color, default Color::splat(0.25);
        /// Whether things cast shadows, those of things that are not translucent.
        shadows: bool, Domain::Flag, default false;
    }
}

/// Composes surfaces with the colours `c_1`, `c_2`, ..., `c_n` of the Lambert shader, from the
/// front to the back, and an opacity a:
/// `a c_1 + (1 - a) (a c_2 + (1 - a) (... a c_n + (1 - a) background))`.
pub(super) fn shade(
    settings: &Ghost,
    shading: &Shading<'_>,
    points: &Points<'_>,
    colors: &mut [Color],
    coverage: &mut [f64],
) {
    let crossings = Crossings::new(shading, points);
    let layers = Points { surfaces: crossings.surfaces(shading.scene), draws: Vec::new() };
    compute_geometry(shading.engine.instruction_set(), &layers.surfaces);
    let mut lit = vec![Color::ZERO; layers.surfaces.len()];
    lambert::shade(&settings.of_layers(), shading, &layers, &mut lit);
    for (k, met) in crossings.of_rays().enumerate() {
        let (mut color, mut left) = (Color::ZERO, 1.0);
        for &layer in &lit[met] {
            color += left * settings.opacity * layer;
            left *= 1.0 - settings.opacity;
        }
        let behind = shading.seen_behind(points.surfaces[k].ray().direction);
        colors[k] = color + left * behind;
        coverage[k] = 1.0 - left;
    }
}

impl Ghost {
    /// The shader of the layers.
    fn of_layers(&self) -> Lambert {
        Lambert {
            ambient: self.ambient,
            shadows: self.shadows,
            flat: self.flat,
            depth_near: self.depth_near,
            depth_far: self.depth_far,
            depth_color: self.depth_color,
        }
    }
}

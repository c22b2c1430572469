//! Depth cueing: what is farther away fades (Foley, van Dam, Feiner and Hughes, "Computer Graphics:
//! Principles and Practice", 1990, section 16.1).

use super::Points;
use crate::geometry::Color;
use crate::scene::Background;

/// The default colour that surfaces fade to: the default background.
pub(super) const COLOR: Color = match Background::NEUTRAL {
    Background::Uniform(color) => color,
    _ => Color::ZERO,
};

/// Makes the settings of a shader: its own, and those of faces and of depth cueing.
macro_rules! depth_cued {
    ($(#[$doc:meta])* pub struct $kind:ident { $($own:tt)* }) => {
        $crate::geometry::settings! {
            $(#[$doc])*
            pub struct $kind {
                $($own)*
                /// Whether faces have their own normals, in place of smooth ones.
                flat: bool, Domain::Flag, default false;
                /// The distance at which colours begin to fade, in scene units.
                depth_near: f64, Domain::NonNegative, default 0.0;
                /// The distance at which they are all `depth_color`; by default nowhere.
                depth_far: f64, Domain::PositiveOrInfinite, default f64::INFINITY;
                /// The colour that distant surfaces fade to; by default the default background.
                depth_color: Color, Domain::Color, default $crate::shade::depth_cue::COLOR;
            }
        }
    };
}
pub(super) use depth_cued;

macro_rules! cues_of {
    ($($kind:ident)*) => {$(
        impl From<&super::$kind> for DepthCue {
            fn from(of: &super::$kind) -> Self {
                Self { near: of.depth_near, far: of.depth_far, color: of.depth_color }
            }
        }
    )*};
}
// The layers of a ghost fade as Lambert's.
cues_of! { Hemisphere Lambert Matcap Phong }

/// Colours fade to another one, in proportion to how far a hit is between two distances from the
/// start of its ray.
#[derive(Debug, Clone, Copy)]
pub(super) struct DepthCue {
    /// The distance up to which colours are as they are.
    pub(super) near: f64,
    /// The distance from which on all is of one colour, also where that is nearer than `near`. No
    /// colour fades where it is infinite.
    pub(super) far: f64,
    pub(super) color: Color,
}

impl DepthCue {
    /// Fades the colours of hits.
    pub(super) fn fade(self, points: &Points<'_>, colors: &mut [Color]) {
        if self.far == f64::INFINITY {
            return;
        }
        for (surface, color) in points.surfaces.iter().zip(colors) {
            let distance = surface.hit().t * surface.ray().direction.length();
            *color = color.lerp(self.color, self.share(distance));
        }
    }

    fn share(self, distance: f64) -> f64 {
        if distance >= self.far {
            1.0
        } else if distance <= self.near {
            0.0
        } else {
            (distance - self.near) / (self.far - self.near)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_fade_in_proportion_between_two_distances() {
        let cue = DepthCue { near: 2.0, far: 6.0, color: COLOR };
        let shares = [0.0, 2.0, 3.0, 5.0, 6.0, 9.0].map(|distance| cue.share(distance));
        assert_eq!(shares, [0.0, 0.0, 0.25, 0.75, 1.0, 1.0]);
        let turned = DepthCue { near: 7.0, ..cue };
        assert_eq!([5.0, 6.5].map(|distance| turned.share(distance)), [0.0, 1.0]);
    }
}

//! A lit sphere as the light: a colour for each normal in the frame of who looks (Sloan, Martin,
//! Gooch and Gooch, "The Lit Sphere: A Model for Capturing NPR Shading from Art", Graphics
//! Interface 2001). The sphere is not a picture, but a formula.

use super::depth_cue::{DepthCue, depth_cued};
use super::{Points, Shading, seen_normal};
use crate::geometry::{Color, DVec3, Domain, unit};
use crate::sampling::TangentFrame;

depth_cued! {
    /// The settings of the matcap. The default ones are those of clay.
    pub struct Matcap {
        /// The side that is lit, from the upper left.
        bright: Color, Domain::Color, default Color::new(1.55, 1.22, 0.98);
        /// The other side.
        dark: Color, Domain::Color, default Color::new(0.1, 0.07, 0.08);
        /// The strength of the highlight.
        gloss: f64, Domain::From(0.0, 1.0), default 0.1;
        /// The darkening of edges, from 0, none, to 1, black.
        rim: f64, Domain::From(0.0, 1.0), default 0.5;
    }
}

pub(super) fn shade(
    settings: &Matcap,
    shading: &Shading<'_>,
    points: &Points<'_>,
    colors: &mut [Color],
) {
    for (surface, color) in points.surfaces.iter().zip(&mut *colors) {
        *color = surface.color();
        if surface.is_unlit() {
            continue;
        }
        let [right, up, back] = frame(surface.ray().direction, shading.upwards);
        let normal = seen_normal(surface, settings.flat);
        let in_frame = DVec3::new(normal.dot(right), normal.dot(up), normal.dot(back));
        // A triangle without an area has no normal: it faces the viewer.
        *color = settings.painted(*color, if in_frame.is_nan() { DVec3::Z } else { in_frame });
    }
    DepthCue::from(settings).fade(points, colors);
}

/// The frame of a ray, in a world with that direction upwards: right, up and back. Each ray has its
/// own, so that a sphere looks the same wherever it is in the picture. A ray straight up or down
/// has some frame.
fn frame(direction: DVec3, upwards: DVec3) -> [DVec3; 3] {
    let back = -unit(direction);
    let right = unit(upwards.cross(back));
    if right.is_finite() {
        [right, back.cross(right), back]
    } else {
        let TangentFrame { x, y, z } = TangentFrame::around(back);
        [x, y, z]
    }
}

impl Matcap {
    /// The colour of a surface with a normal of length one in the frame of the ray. With the
    /// light's direction l and the direction h half way between l and back:
    ///
    /// `((dark + (bright - dark) w^2) color + gloss max(0, n . h)^20) (1 - rim (1 - max(0, n_z))^2)`,
    /// where `w = (1 + n . l) / 2`
    fn painted(&self, color: Color, normal: DVec3) -> Color {
        let light = DVec3::new(-0.48, 0.64, 0.6);
        let halfway = unit(light + DVec3::Z);
        let wrapped = normal.dot(light).midpoint(1.0);
        let matte = self.dark.lerp(self.bright, wrapped * wrapped);
        let highlight = self.gloss * libm::pow(normal.dot(halfway).max(0.0), 20.0);
        // Smooth normals may face away.
        let away = 1.0 - normal.z.max(0.0);
        (matte * color + highlight) * (1.0 - self.rim * away * away)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_right_handed_and_upright() {
        for direction in [DVec3::new(0.0, 3.0, -1.0), DVec3::X, DVec3::NEG_Z, DVec3::Z] {
            let [right, up, back] = frame(direction, DVec3::Z);
            assert!((right.cross(up) - back).length() < 1e-15, "{direction}");
            assert!((back + unit(direction)).length() < 1e-15, "{direction}");
            assert!(up.z >= 0.0 && right.z.abs() < 1e-15, "{direction}");
        }
        assert_eq!(frame(DVec3::Y, DVec3::Z)[0], DVec3::X);
    }

    /// The light's direction, (-0.48, 0.64, 0.6), has length one, and half way to back is its sum
    /// with (0, 0, 1) over sqrt(3.2).
    #[test]
    fn the_formula_is_the_one_that_is_written_down() {
        let matcap = Matcap::default();
        let facing = matcap.painted(Color::ONE, DVec3::Z);
        let matte = matcap.dark + (matcap.bright - matcap.dark) * 0.64;
        let highlight = matcap.gloss * libm::pow(1.6 / 3.2_f64.sqrt(), 20.0);
        assert!((facing - (matte + highlight)).length() < 1e-14, "{facing}");
        // A smooth normal may look away from the viewer.
        let away = Matcap { rim: 1.0, ..matcap };
        assert_eq!(away.painted(Color::ONE, DVec3::NEG_Z), Color::ZERO);
        let edge = matcap.painted(Color::ONE, DVec3::NEG_Y);
        let matte = matcap.dark + (matcap.bright - matcap.dark) * 0.0324;
        assert!((edge - matte * (1.0 - matcap.rim)).length() < 1e-14, "{edge}");
    }
}

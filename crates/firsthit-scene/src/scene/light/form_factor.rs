//! Form factors from a point with a normal to a shape, without occlusion. A matte white surface has
//! the shape's radiance times the form factor.

use std::f64::consts::PI;

use crate::geometry::{DVec3, unit};
use crate::sampling::TangentFrame;

/// The form factor of a disc in the sky, such as a sun or a sphere: by the cosine from the normal
/// to its middle, and sine and cosine of the angle from its middle to its edge. Where the horizon
/// cuts the disc, the part above it counts (Snyder, "Area Light Sources for Real-Time Graphics",
/// Microsoft Research MSR-TR-96-11, 1996).
pub(crate) fn of_disc(cosine: f64, [edge, inner]: [f64; 2]) -> f64 {
    edge * edge * of_disc_to_facing(cosine, [edge, inner])
}

/// The form factor of a disc, divided by that of the disc when the surface faces it.
#[doc(hidden)]
pub fn of_disc_to_facing(cosine: f64, [edge, inner]: [f64; 2]) -> f64 {
    if cosine >= edge {
        // All of it is above the horizon: then it is as if all were in its middle.
        return cosine;
    }
    if cosine <= -edge {
        return 0.0;
    }
    let sine = (1.0 - cosine * cosine).sqrt();
    let x = inner / edge;
    let y = -x * cosine / sine;
    let across = sine * (1.0 - y * y).max(0.0).sqrt();
    let facing = cosine * libm::acos(y.clamp(-1.0, 1.0)) - x * across;
    (facing + libm::atan2(across, x) / (edge * edge)) / PI
}

/// The form factor of a triangle, whichever side is seen: by the corners from the point, and the
/// normal, of length one. Clips the triangle at the horizon, and sums over the edges (Lambert,
/// *Photometria*, 1760).
pub(crate) fn of_triangle(corners: [DVec3; 3], normal: DVec3) -> f64 {
    let frame = TangentFrame::around(normal);
    let corners = corners.map(|corner| frame.local(corner));
    let mut above = [DVec3::ZERO; 4];
    let mut count = 0;
    let mut push = |corner: DVec3| {
        above[count] = unit(corner);
        count += 1;
    };
    for k in 0..3 {
        let (from, to) = (corners[k], corners[(k + 1) % 3]);
        if from.z > 0.0 {
            push(from);
        }
        if (from.z > 0.0) != (to.z > 0.0) {
            let share = from.z / (from.z - to.z);
            push((from + share * (to - from)).with_z(0.0));
        }
    }
    let edge = |k: usize| {
        let (from, to) = (above[k], above[(k + 1) % count]);
        let across = from.cross(to);
        let sine = across.length();
        if sine > 0.0 { libm::atan2(sine, from.dot(to)) * across.z / sine } else { 0.0 }
    };
    let sum: f64 = (0..count).map(edge).sum();
    // NaN where the point is a corner: there is no light then.
    (sum / (2.0 * PI)).abs().max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::DVec2;
    use crate::sampling::Draws;
    use crate::sampling::warp;

    /// Above the horizon, cut by it, and below, beside the mean over a fine grid of directions.
    #[test]
    fn that_of_a_disc_is_the_mean_over_its_directions() {
        const SIDE: u32 = 400;
        for degrees in [0.25, 5.0, 30.0, 60.0, 90.0] {
            let (edge, inner) = libm::sincos(f64::to_radians(degrees));
            for share in [-1.2, -0.99, -0.5, 0.0, 0.4, 0.9, 1.2] {
                let elevation = (share * degrees).clamp(-90.0, 90.0);
                let (cosine, level) = libm::sincos(elevation.to_radians());
                let middle = DVec3::new(level, 0.0, cosine);
                let frame = TangentFrame::around(middle);
                let height = 1.0 - inner;
                let cells = (0..SIDE * SIDE).map(|cell| {
                    let cell = DVec2::from([cell % SIDE, cell / SIDE].map(f64::from));
                    (cell + 0.5) / f64::from(SIDE)
                });
                let heights = cells.map(|u| frame.world(warp::cap(u, height)).z.max(0.0));
                // Of the solid angle, over pi.
                let mean = 2.0 * height * heights.sum::<f64>() / f64::from(SIDE * SIDE);
                let got = of_disc(cosine, [edge, inner]);
                assert!(
                    (got - mean).abs() < 1e-4 * (edge * edge + mean),
                    "{degrees} {share}: {got} {mean}"
                );
            }
        }
    }

    /// Triangles above the horizon, through it and below it, from both sides, beside the mean over
    /// their area.
    #[test]
    fn that_of_a_triangle_is_the_mean_over_its_points() {
        let normal = unit(DVec3::new(0.2, -0.5, 0.8));
        let mut cut = 0;
        for k in 0..60 {
            let mut draws = Draws::new(k, 0);
            let mut corner = || DVec3::from(draws.three()) * 4.0 - 2.0;
            let corners = [corner(), corner(), corner()];
            let [a, b, c] = corners;
            let across = (b - a).cross(c - a);
            // Near the point, points of the triangle tell little.
            if across.dot(a).abs() < 0.4 * across.length() {
                continue;
            }
            let above = corners.iter().filter(|corner| corner.dot(normal) > 0.0).count();
            cut += usize::from(above == 1 || above == 2);
            let brought = |sample| {
                let u = warp::triangle(Draws::new(k, sample).two());
                let towards = a + u.x * (b - a) + u.y * (c - a);
                let length = towards.length();
                let cosines = towards.dot(normal).max(0.0) * across.dot(towards).abs();
                0.5 * cosines / (PI * length * length * length * length)
            };
            let mean = (0..1 << 14).map(brought).sum::<f64>() / f64::from(1 << 14);
            let got = of_triangle(corners, normal);
            assert!((got - mean).abs() < 0.003 + 0.01 * mean, "{k}: {got} {mean}");
            let back = of_triangle([a, c, b], normal);
            assert!((got - back).abs() < 1e-15);
        }
        assert!(cut > 10);
    }
}

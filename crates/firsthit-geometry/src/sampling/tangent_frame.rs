//! Axes around a direction.

use crate::geometry::DVec3;

/// A right-handed frame of axes of length one, around its z.
#[derive(Debug, Clone, Copy)]
#[doc(hidden)]
pub struct TangentFrame {
    pub x: DVec3,
    pub y: DVec3,
    pub z: DVec3,
}

impl TangentFrame {
    /// The frame around a direction `z` of length one (Duff and others, "Building an Orthonormal
    /// Basis, Revisited", Journal of Computer Graphics Techniques 6(1), 2017).
    #[inline(always)]
    pub fn around(z: DVec3) -> Self {
        let sign = 1.0_f64.copysign(z.z);
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        Self {
            x: DVec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x),
            y: DVec3::new(b, sign + z.y * z.y * a, -z.y),
            z,
        }
    }

    /// A direction of the world, in the frame.
    pub fn local(&self, direction: DVec3) -> DVec3 {
        DVec3::from([self.x, self.y, self.z].map(|axis| axis.dot(direction)))
    }

    /// A direction of the frame, in the world.
    #[inline(always)]
    pub fn world(&self, local: DVec3) -> DVec3 {
        local.x * self.x + local.y * self.y + local.z * self.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_right_handed_and_of_length_one() {
        for z in [DVec3::Z, DVec3::NEG_Z, DVec3::X, DVec3::new(0.48, -0.6, -0.64)] {
            let frame = TangentFrame::around(z);
            assert!((frame.x.cross(frame.y) - z).length() < 1e-14);
            assert!((frame.x.length() - 1.0).abs() < 1e-14);
            let direction = DVec3::new(0.6, -0.2, 3.0);
            assert!((frame.world(frame.local(direction)) - direction).length() < 1e-14);
        }
    }
}

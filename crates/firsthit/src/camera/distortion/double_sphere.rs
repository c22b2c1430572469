//! The double sphere model: two spheres whose centres are `xi` apart, then a pinhole beside the second one's.
//!
//! Usenko, Demmel and Cremers, "The Double Sphere Camera Model", 3DV 2018, equations 40 to 52.

use super::unified::{backmost, check_alpha};
use super::{Distortion, Limit};
use crate::camera::parameters::parameters;
use crate::camera::quick::square;
use crate::error::Result;
use crate::geometry::arithmetic::Arithmetic;
use crate::geometry::{DVec2, DVec3, require};

parameters! {
    /// The double sphere model.
    pub struct DoubleSphere {
        /// The distance between the spheres' centres; above -1.
        xi = 0.0,
        /// From 0 to 1, as in the unified model.
        alpha = 0.0,
    }
}

impl DoubleSphere {
    /// How far behind the camera directions are still seen, as -z over the length: the paper's w2.
    fn backmost(&self) -> f64 {
        let (w1, xi) = (-backmost(self.alpha), self.xi);
        (w1 + xi) / (2.0 * w1 * xi + xi * xi + 1.0).sqrt()
    }
}

impl Distortion for DoubleSphere {
    fn limit(&self, _: f64) -> Result<Limit> {
        check_alpha(self.alpha)?;
        let fine = self.xi > -1.0 && self.xi.is_finite();
        require("xi", "above -1", fine, self.xi)?;
        Ok(Limit::default())
    }

    #[inline(always)]
    fn directions<A: Arithmetic>(
        &self,
        of: A,
        _: &Limit,
        [x, y]: [A::Number; 2],
    ) -> ([A::Number; 3], A::Mask) {
        // Operation for operation what `unproject` does.
        let Self { xi, alpha } = *self;
        let r2 = of.add(of.mul(x, x), of.mul(y, y));
        let rest = of.sub(of.number(1.0), of.mul(of.number(2.0 * alpha - 1.0), r2));
        let above = of.sub(of.number(1.0), of.mul(of.number(alpha * alpha), r2));
        let below = of.add(
            of.mul(of.number(alpha), of.sqrt(rest)),
            of.number(1.0 - alpha),
        );
        let mz = of.div(above, below);
        let mz2 = of.mul(mz, mz);
        let under = of.add(mz2, of.mul(of.number(1.0 - xi * xi), r2));
        let factor = of.div(
            of.add(of.mul(mz, of.number(xi)), of.sqrt(under)),
            of.add(mz2, r2),
        );
        let z = of.sub(of.mul(factor, mz), of.number(xi));
        let direction = [of.mul(factor, x), of.mul(factor, y), z];
        let length = of.sqrt(of.add(square(of, direction[0], direction[1]), of.mul(z, z)));
        // A NaN is nowhere below.
        let known = of.lt(of.mul(of.number(-self.backmost()), length), z);
        (direction, known)
    }

    fn project(&self, _: &Limit, direction: DVec3) -> Option<DVec2> {
        let Self { xi, alpha } = *self;
        let aside = direction.truncate();
        let z = direction.z;
        let r2 = aside.length_squared();
        let d1 = (r2 + z * z).sqrt();
        // Written so that a NaN fails.
        let is_seen = z > -self.backmost() * d1;
        if !is_seen {
            return None;
        }
        let deeper = xi * d1 + z;
        let d2 = (r2 + deeper * deeper).sqrt();
        let divisor = alpha * d2 + (1.0 - alpha) * deeper;
        (divisor > 0.0).then(|| aside / divisor)
    }

    fn unproject(&self, _: &Limit, point: DVec2) -> Option<DVec3> {
        let Self { xi, alpha } = *self;
        let r2 = point.length_squared();
        let rest = 1.0 - (2.0 * alpha - 1.0) * r2;
        let is_seen = rest >= 0.0;
        if !is_seen {
            return None;
        }
        let mz = (1.0 - alpha * alpha * r2) / (alpha * rest.sqrt() + (1.0 - alpha));
        let square = mz * mz + (1.0 - xi * xi) * r2;
        let is_seen = square >= 0.0;
        if !is_seen {
            return None;
        }
        let factor = (mz * xi + square.sqrt()) / (mz * mz + r2);
        let direction = DVec3::new(factor * point.x, factor * point.y, factor * mz - xi);
        // What the formula gives beyond the model's end is seen elsewhere.
        (direction.z > -self.backmost() * direction.length()).then_some(direction)
    }
}

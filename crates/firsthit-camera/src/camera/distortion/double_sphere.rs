//! The double sphere model: two spheres whose centres are `xi` apart, then a pinhole beside the
//! second one's.
//!
//! Usenko, Demmel and Cremers, "The Double Sphere Camera Model", 3DV 2018, equations 40 to 42 and
//! 46 to 52.

use super::unified::{backmost, height};
use super::{Distortion, Limit};
use crate::camera::quick::{Known, Pair, square};
use crate::geometry::arithmetic::{Arithmetic, Scalar};
use crate::geometry::{DVec2, DVec3, Domain, settings};

settings! {
    /// The double sphere model.
    pub struct DoubleSphere {
        /// The distance between the spheres' centres. Above 1 directions are seen whose -z is below
        /// 1 / xi of their length.
        xi: f64, Domain::Above(-1.0), default 0.0;
        /// From 0, a pinhole, to 1, as in the unified model.
        alpha: f64, Domain::From(0.0, 1.0), default 0.0;
    }
}

impl Distortion for DoubleSphere {
    #[inline(always)]
    fn directions<A: Arithmetic>(&self, of: A, _: &Limit, [x, y]: Pair<A>) -> Known<A, 3> {
        let Self { xi, alpha } = *self;
        let r2 = square(of, x, y);
        let (mz, rest) = height(of, alpha, r2);
        let mz2 = of.mul(mz, mz);
        let under = of.add(mz2, of.mul(of.number(1.0 - xi * xi), r2));
        let factor = of.div(of.add(of.mul(mz, of.number(xi)), of.sqrt(under)), of.add(mz2, r2));
        let z = of.sub(of.mul(factor, mz), of.number(xi));
        let direction = [of.mul(factor, x), of.mul(factor, y), z];
        // Written so that a NaN is not known.
        let mut known = of.lt(of.number(0.0), rest) & of.lt(of.number(0.0), under);
        if xi >= 1.0 {
            known = known & of.lt(of.number(0.0), mz);
        }
        (direction, known)
    }

    fn project(&self, _: &Limit, direction: DVec3) -> Option<DVec2> {
        let Self { xi, alpha } = *self;
        let aside = direction.truncate();
        let z = direction.z;
        let r2 = aside.length_squared();
        let d1 = (r2 + z * z).sqrt();
        let deeper = xi * d1 + z;
        let d2 = (r2 + deeper * deeper).sqrt();
        // Up to the fold of the second sphere; and of the first, which has one where the second's
        // centre is outside it. The paper's w2, which takes a direction of the first sphere for one
        // of the second, is not where they are. Written so that a NaN fails.
        let is_seen = deeper > backmost(alpha) * d2 && (xi <= 1.0 || xi * z > -d1);
        if !is_seen {
            return None;
        }
        let divisor = alpha * d2 + (1.0 - alpha) * deeper;
        (divisor > 0.0).then(|| aside / divisor)
    }

    fn unproject(&self, limit: &Limit, point: DVec2) -> Option<DVec3> {
        let (direction, is_seen) = self.directions(Scalar, limit, point.to_array());
        is_seen.then(|| direction.into())
    }
}

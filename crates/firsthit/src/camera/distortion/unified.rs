//! The unified camera model and the enhanced one: a sphere or an ellipsoid, seen from a point beside its centre.
//!
//! With d = sqrt(beta (x² + y²) + z²), a direction is seen at (x, y) / (alpha d + (1 - alpha) z). The unified model has a beta of 1.
//!
//! Geyer and Daniilidis, "A Unifying Theory for Central Panoramic Systems and Practical Implications", ECCV 2000; Khomutenko, Garcia and
//! Martinet, "An Enhanced Unified Camera Model", RA-L 1(1), 2016; in the form of Usenko, Demmel and Cremers, "The Double Sphere Camera
//! Model", 3DV 2018.

use super::{Distortion, Limit};
use crate::camera::parameters::parameters;
use crate::error::Result;
use crate::geometry::arithmetic::Arithmetic;
use crate::geometry::{DVec2, DVec3, require};

parameters! {
    /// The unified camera model.
    pub struct Ucm {
        /// From 0, a pinhole, to 1.
        alpha = 0.0,
    }
}

parameters! {
    /// The enhanced unified camera model.
    pub struct Eucm {
        /// From 0, a pinhole, to 1.
        alpha = 0.0,
        /// Positive.
        beta = 1.0,
    }
}

/// Refuses an `alpha` that makes no lens.
pub(super) fn check_alpha(alpha: f64) -> Result<()> {
    require("alpha", "from 0 to 1", (0.0..=1.0).contains(&alpha), alpha)
}

/// How far behind the camera directions are still seen, as z / d.
pub(super) fn backmost(alpha: f64) -> f64 {
    if alpha <= 0.5 {
        -alpha / (1.0 - alpha)
    } else {
        -(1.0 - alpha) / alpha
    }
}

impl Distortion for Eucm {
    fn limit(&self, _: f64) -> Result<Limit> {
        check_alpha(self.alpha)?;
        require("beta", "positive", self.beta > 0.0, self.beta)?;
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
        let Self { alpha, beta } = *self;
        let r2 = of.mul(of.number(beta), of.add(of.mul(x, x), of.mul(y, y)));
        let rest = of.sub(of.number(1.0), of.mul(of.number(2.0 * alpha - 1.0), r2));
        let above = of.sub(of.number(1.0), of.mul(of.number(alpha * alpha), r2));
        let below = of.add(
            of.mul(of.number(alpha), of.sqrt(rest)),
            of.number(1.0 - alpha),
        );
        ([x, y, of.div(above, below)], of.lt(of.number(0.0), rest))
    }

    fn project(&self, _: &Limit, direction: DVec3) -> Option<DVec2> {
        let Self { alpha, beta } = *self;
        let aside = direction.truncate();
        let z = direction.z;
        let d = (beta * aside.length_squared() + z * z).sqrt();
        // Written so that a NaN fails.
        let is_seen = z > backmost(alpha) * d;
        is_seen.then(|| aside / (alpha * d + (1.0 - alpha) * z))
    }

    fn unproject(&self, _: &Limit, point: DVec2) -> Option<DVec3> {
        let Self { alpha, beta } = *self;
        let r2 = beta * point.length_squared();
        let rest = 1.0 - (2.0 * alpha - 1.0) * r2;
        let is_seen = rest >= 0.0;
        if !is_seen {
            return None;
        }
        let z = (1.0 - alpha * alpha * r2) / (alpha * rest.sqrt() + (1.0 - alpha));
        Some(point.extend(z))
    }
}

impl Ucm {
    fn enhanced(self) -> Eucm {
        Eucm {
            alpha: self.alpha,
            beta: 1.0,
        }
    }
}

impl Distortion for Ucm {
    fn limit(&self, farthest: f64) -> Result<Limit> {
        self.enhanced().limit(farthest)
    }

    #[inline(always)]
    fn directions<A: Arithmetic>(
        &self,
        of: A,
        limit: &Limit,
        point: [A::Number; 2],
    ) -> ([A::Number; 3], A::Mask) {
        self.enhanced().directions(of, limit, point)
    }

    fn project(&self, limit: &Limit, direction: DVec3) -> Option<DVec2> {
        self.enhanced().project(limit, direction)
    }

    fn unproject(&self, limit: &Limit, point: DVec2) -> Option<DVec3> {
        self.enhanced().unproject(limit, point)
    }
}

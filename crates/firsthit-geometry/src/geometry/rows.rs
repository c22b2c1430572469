//! Structures of arrays: the numbers of many points, a row for each number. The compiler turns a
//! loop over a row into lanes of the instruction set if everything that the loop calls is inlined
//! and the loop is short. So a computation is split into several loops.

use super::{DVec2, DVec3};

/// The number of points in a row: few enough that all their numbers stay in the nearest cache.
#[doc(hidden)]
pub const ROW: usize = 64;

/// A float64 for each of up to [`ROW`] points.
#[doc(hidden)]
pub struct Scalars([f64; ROW]);

impl Scalars {
    /// The row with one number for all points.
    pub const fn all(x: f64) -> Self {
        Self([x; ROW])
    }

    #[inline(always)]
    pub fn get(&self, k: usize) -> f64 {
        self.0[k]
    }

    #[inline(always)]
    pub fn set(&mut self, k: usize, x: f64) {
        self.0[k] = x;
    }
}

/// A [`DVec2`] for each of up to [`ROW`] points.
#[doc(hidden)]
pub struct Points2 {
    x: Scalars,
    y: Scalars,
}

impl Points2 {
    pub const ZERO: Self = Self { x: Scalars::all(0.0), y: Scalars::all(0.0) };

    #[inline(always)]
    pub fn get(&self, k: usize) -> DVec2 {
        DVec2::new(self.x.get(k), self.y.get(k))
    }

    #[inline(always)]
    pub fn set(&mut self, k: usize, v: DVec2) {
        self.x.set(k, v.x);
        self.y.set(k, v.y);
    }
}

/// A [`DVec3`] for each of up to [`ROW`] points.
#[doc(hidden)]
pub struct Vectors {
    x: Scalars,
    y: Scalars,
    z: Scalars,
}

impl Vectors {
    pub const ZERO: Self =
        Self { x: Scalars::all(0.0), y: Scalars::all(0.0), z: Scalars::all(0.0) };

    #[inline(always)]
    pub fn get(&self, k: usize) -> DVec3 {
        DVec3::new(self.x.get(k), self.y.get(k), self.z.get(k))
    }

    #[inline(always)]
    pub fn set(&mut self, k: usize, v: DVec3) {
        self.x.set(k, v.x);
        self.y.set(k, v.y);
        self.z.set(k, v.z);
    }
}

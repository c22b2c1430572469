//! A mesh's vertices, in float32 or float64.

use std::fmt::{self, Debug, Formatter};

use crate::error::Result;
use crate::geometry::summary::Count;
use crate::geometry::{DVec3, single};
use crate::memory::{self, Storage};

/// Points in space, in the type that holds them without loss: float32 where every coordinate is
/// one, which halves the memory, float64 otherwise.
///
/// ```
/// use firsthit::Positions;
///
/// assert!(matches!(Positions::compact(vec![[0.5, 1.0, 2.0]]), Positions::Single(_)));
/// let tenth = Positions::compact(vec![[0.1, 1.0, 2.0]]);
/// assert!(matches!(tenth, Positions::Double(_)));
/// assert_eq!(tenth.get(0).x, 0.1);
/// ```
#[derive(Clone, PartialEq)]
pub enum Positions {
    /// Every coordinate is a float32.
    Single(Storage<[f32; 3]>),
    /// Points of which at least one coordinate needs float64.
    Double(Storage<[f64; 3]>),
}

/// A summary: they are many.
impl Debug for Positions {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let kind = match self {
            Self::Single(_) => "Single",
            Self::Double(_) => "Double",
        };
        f.debug_tuple(kind).field(&Count(self.len(), "points")).finish()
    }
}

impl Positions {
    /// The points in the smaller type if that loses nothing.
    pub fn compact(points: Vec<[f64; 3]>) -> Self {
        if points.iter().flatten().all(|&x| f64::from(single(x)) == x) {
            Self::Single(points.iter().map(|point| point.map(single)).collect())
        } else {
            Self::Double(points.into())
        }
    }

    /// The points of all, side by side.
    pub(crate) fn concatenated(all: &[&Self]) -> Result<Self> {
        if let [one] = all {
            return Ok((*one).clone());
        }
        let are_single = all.iter().all(|one| matches!(one, Self::Single(_)));
        let count = all.iter().map(|one| one.len()).sum();
        if are_single {
            let mut points = memory::filled(count, [0.0; 3])?;
            let mut left = &mut points[..];
            for one in all {
                if let Self::Single(one) = one {
                    let (part, after) = left.split_at_mut(one.len());
                    part.copy_from_slice(one);
                    left = after;
                }
            }
            return Ok(Self::Single(points.into()));
        }
        let mut points = memory::filled(count, [0.0; 3])?;
        let of_all = all.iter().flat_map(|one| (0..).zip(0..one.len()).map(|(k, _)| one.get(k)));
        for (out, point) in points.iter_mut().zip(of_all) {
            *out = point.to_array();
        }
        Ok(Self::Double(points.into()))
    }

    /// The number of points.
    pub fn len(&self) -> usize {
        match self {
            Self::Single(points) => points.len(),
            Self::Double(points) => points.len(),
        }
    }

    /// Whether there are none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Three points at once, for the corners of triangles: `array::map` would be a call.
    #[inline]
    #[doc(hidden)]
    pub fn three(&self, [a, b, c]: [u32; 3]) -> [DVec3; 3] {
        match self {
            Self::Single(points) => {
                let point = |index: u32| {
                    let [x, y, z] = points[index as usize];
                    DVec3::new(f64::from(x), f64::from(y), f64::from(z))
                };
                [point(a), point(b), point(c)]
            }
            Self::Double(points) => {
                let point = |index: u32| DVec3::from(points[index as usize]);
                [point(a), point(b), point(c)]
            }
        }
    }

    /// The point `index`.
    ///
    /// # Panics
    ///
    /// When there is no such point.
    #[inline]
    pub fn get(&self, index: u32) -> DVec3 {
        match self {
            Self::Single(points) => DVec3::from(points[index as usize].map(f64::from)),
            Self::Double(points) => DVec3::from(points[index as usize]),
        }
    }
}

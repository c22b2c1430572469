//! A mesh's vertices, in float32 or float64.

use std::fmt::{self, Debug, Formatter};

use crate::geometry::summary::Count;
use crate::geometry::{DVec3, single};
use crate::memory::Storage;

/// Points in space, in the type that holds them without loss: float32 where every coordinate is one,
/// which halves the memory, float64 otherwise.
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
    /// At least one coordinate needs float64.
    Double(Storage<[f64; 3]>),
}

/// A summary: they are many.
impl Debug for Positions {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let kind = match self {
            Self::Single(_) => "Single",
            Self::Double(_) => "Double",
        };
        f.debug_tuple(kind)
            .field(&Count(self.len(), "points"))
            .finish()
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

    /// How many points there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Single(points) => points.len(),
            Self::Double(points) => points.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Three points at once, for the corners of triangles: `array::map` would be a call.
    #[inline]
    pub(crate) fn three(&self, [a, b, c]: [u32; 3]) -> [DVec3; 3] {
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

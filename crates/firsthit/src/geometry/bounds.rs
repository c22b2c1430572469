use super::{DAffine3, DVec3};

/// An axis-aligned box, both corners part of it.
///
/// ```
/// use firsthit::{Bounds, DVec3};
///
/// let bounds = Bounds::of([DVec3::ZERO, DVec3::new(4.0, -2.0, 1.0)]);
/// assert_eq!(bounds.size(), DVec3::new(4.0, 2.0, 1.0));
/// assert_eq!(bounds.centre(), DVec3::new(2.0, -1.0, 0.5));
/// assert!(bounds.contains(DVec3::X));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The corner with the smallest coordinates.
    pub low: DVec3,
    /// The corner with the largest coordinates.
    pub high: DVec3,
}

impl Bounds {
    /// The box that holds nothing, and leaves any other as it is in a union.
    pub const EMPTY: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
    };
    /// All of space.
    pub const EVERYTHING: Self = Self {
        low: DVec3::NEG_INFINITY,
        high: DVec3::INFINITY,
    };

    /// The smallest box around `points`.
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |bounds, point| Self {
            low: bounds.low.min(point),
            high: bounds.high.max(point),
        })
    }

    /// The smallest box around both.
    pub fn union(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// Whether nothing is inside.
    pub fn is_empty(&self) -> bool {
        !self.low.cmple(self.high).all()
    }

    /// Whether all corners are at finite coordinates (an infinite plane's box is not).
    pub fn is_finite(&self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// Whether `point` is inside or on the border.
    pub fn contains(&self, point: DVec3) -> bool {
        self.low.cmple(point).all() && point.cmple(self.high).all()
    }

    /// The middle.
    pub fn centre(&self) -> DVec3 {
        0.5 * self.low + 0.5 * self.high
    }

    /// The lengths of the sides; zero when empty.
    pub fn size(&self) -> DVec3 {
        (self.high - self.low).max(DVec3::ZERO)
    }

    /// The eight corners.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|k| {
            let pick = |axis: usize| {
                if k >> axis & 1 == 0 {
                    self.low[axis]
                } else {
                    self.high[axis]
                }
            };
            DVec3::new(pick(0), pick(1), pick(2))
        })
    }

    /// A box around the transformed box; empty stays empty, and infinite becomes everything.
    pub fn transformed(&self, transform: &DAffine3) -> Self {
        if self.is_empty() {
            Self::EMPTY
        } else if self.is_finite() {
            Self::of(
                self.corners()
                    .map(|corner| transform.transform_point3(corner)),
            )
        } else {
            Self::EVERYTHING
        }
    }
}

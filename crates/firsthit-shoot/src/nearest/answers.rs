//! The nearest points of many points.

use super::best::Candidate;
use crate::error::Result;
use crate::geometry::summary::summary;
use crate::geometry::{DVec2, DVec3};
use crate::memory;

/// A point of a scene that is near to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosestPoint {
    /// The position in world space.
    pub point: DVec3,
    /// The distance.
    pub distance: f64,
    /// The object's index in the scene.
    pub object: i32,
    /// The part of the object: a mesh's triangle, a box's face, ...
    pub primitive: i32,
    /// The weights of a triangle's corners 1 and 2 (corner 0 has the rest); NaN elsewhere.
    pub barycentric: DVec2,
}

/// The nearest points of many points, an array for each quantity: `count` elements for each point,
/// the nearest first. Where fewer were found there are misses: a distance of infinity, identifiers
/// of -1, else NaN.
#[derive(Clone, Default)]
pub struct ClosestPoints {
    /// The number of elements of each point.
    pub count: usize,
    /// The positions of the nearest points, in world space.
    pub point: Vec<[f64; 3]>,
    /// The distances, infinity for a miss.
    pub distance: Vec<f64>,
    /// The objects' identifiers, -1 for a miss.
    pub object: Vec<i32>,
    /// The primitives' identifiers, -1 for a miss.
    pub primitive: Vec<i32>,
    /// The weights of a triangle's corners 1 and 2, else NaN.
    pub barycentric: Vec<DVec2>,
}

// Points are many.
summary!(ClosestPoints, "ClosestPoints", |all| "count": all.count, "elements": all.distance.len());

impl ClosestPoints {
    /// Misses, `count` for each of `points` points.
    pub(super) fn room(points: usize, count: usize) -> Result<Self> {
        let length = points.saturating_mul(count);
        Ok(Self {
            count,
            point: memory::filled(length, [f64::NAN; 3])?,
            distance: memory::filled(length, f64::INFINITY)?,
            object: memory::filled(length, -1)?,
            primitive: memory::filled(length, -1)?,
            barycentric: memory::filled(length, DVec2::NAN)?,
        })
    }

    /// The number of points that were asked.
    pub fn len(&self) -> usize {
        self.distance.len().checked_div(self.count).unwrap_or(0)
    }

    /// Whether there was no point.
    pub fn is_empty(&self) -> bool {
        self.distance.is_empty()
    }

    /// The nearest point number `place`, from 0 on, of the point with an index; `None` for a miss.
    ///
    /// # Panics
    ///
    /// When there was no such point, or `place` is not below the count.
    pub fn get(&self, index: usize, place: usize) -> Option<ClosestPoint> {
        assert!(place < self.count, "{place} is not below {}", self.count);
        let k = index * self.count + place;
        (self.object[k] >= 0).then(|| ClosestPoint {
            point: DVec3::from(self.point[k]),
            distance: self.distance[k],
            object: self.object[k],
            primitive: self.primitive[k],
            barycentric: self.barycentric[k],
        })
    }
}

/// The destination of the answers of some points.
pub(super) struct AnswerSlices<'a> {
    pub(super) point: &'a mut [[f64; 3]],
    pub(super) distance: &'a mut [f64],
    pub(super) object: &'a mut [i32],
    pub(super) primitive: &'a mut [i32],
    pub(super) barycentric: &'a mut [DVec2],
}

impl AnswerSlices<'_> {
    pub(super) fn put(&mut self, k: usize, found: &Candidate) {
        self.point[k] = found.nearest.point.to_array();
        self.distance[k] = found.nearest.squared.sqrt();
        self.object[k] = found.object.cast_signed();
        self.primitive[k] = found.nearest.primitive;
        self.barycentric[k] = found.nearest.barycentric;
    }
}

//! Rules out triangles that lie on top of one another, nearly in one plane, by their heights above
//! it.
//!
//! All of them are met within a few roundings, so that each ray would compare all of them exactly.
//! But the height of a point of a triangle above the plane is between those of its corners, which
//! are known once and for all. A ray comes to the plane at a `t` that is computed once, and to
//! points at a height a little earlier or later (`triangle/place/double.rs`). That says of nearly
//! all triangles that another is met before, and of those around the start of a ray which are
//! behind it.
//!
//! 1. Take the plane of the largest triangle. To that belong all whose corners are near.
//! 2. Then that of the largest that is left, and so on, a few times.
//! 3. A crowd is what lies on top of one another: where the triangles' areas are together several
//!    times that of the box around them. Walls of many triangles are none.

use std::cmp::Ordering;

use super::Mesh;
use crate::geometry::arithmetic::Scalar;
use crate::geometry::orientation::along_normal;
use crate::geometry::{Bounds, DVec3, Ray, arrays};
use crate::memory;
use crate::shape::triangle::{Meeting, Plane};

/// The layers of a crowd, on average, at least.
const LAYERS: f64 = 4.0;
/// Planes that are looked at.
const MOST_PLANES: u32 = 16;
/// The largest distance of a corner from the plane, as a share of the mesh's size: what float32
/// tells apart, and some more.
const NEAR: f64 = 1.0 / (1 << 11) as f64;
/// The least area: products of smaller ones would lose digits.
const LEAST: f64 = 1e-30;
/// The number of no crowd.
const NONE: u32 = u32::MAX;

/// The crowds of a mesh.
pub struct Crowds {
    crowds: Vec<Crowd>,
    layers: Vec<Layer>,
}

/// Where a triangle is in a crowd.
#[derive(Debug, Clone, Copy)]
struct Layer {
    crowd: u32,
    /// The heights of its corners above the plane, in units of the plane's normal.
    heights: [f64; 3],
}

impl Layer {
    const NONE: Self = Self { crowd: NONE, heights: [0.0; 3] };

    fn least(&self) -> f64 {
        let [a, b, c] = self.heights;
        a.min(b).min(c)
    }

    fn most(&self) -> f64 {
        let [a, b, c] = self.heights;
        a.max(b).max(c)
    }
}

/// A plane, and the triangles near it.
struct Crowd {
    plane: Plane<f64>,
    /// Three points of it.
    corners: [DVec3; 3],
    /// Heights are off by less than this.
    off: f64,
    /// The axis along which areas are measured.
    axis: usize,
    /// The areas of all together, twice, and the box around them.
    area: f64,
    bounds: Bounds,
}

impl Crowds {
    /// Finds the crowds of a mesh; `None` where it has none.
    pub(super) fn find(mesh: &Mesh) -> Option<Self> {
        let count = mesh.triangles.len();
        let mut layers = memory::filled(count, Layer::NONE).ok()?;
        let mut areas = memory::filled(count, 0.0).ok()?;
        for (triangle, area) in areas.iter_mut().enumerate() {
            *area = normal(mesh.corners(triangle)).length();
        }
        let mut crowds = Vec::new();
        for number in 0..MOST_PLANES {
            let largest = (0..count).max_by(|&one, &other| areas[one].total_cmp(&areas[other]))?;
            // All the others have a plane, or no area to speak of.
            if !(areas[largest] > LEAST && areas[largest].is_finite()) {
                break;
            }
            let near = NEAR * mesh.bounds.size().max_element() * areas[largest];
            areas[largest] = 0.0;
            let mut crowd = Crowd::new(mesh.corners(largest));
            for (triangle, layer) in layers.iter_mut().enumerate() {
                if layer.crowd == NONE
                    && let Some(heights) = crowd.take(mesh.corners(triangle), near)
                {
                    *layer = Layer { crowd: number, heights };
                    areas[triangle] = 0.0;
                }
            }
            crowds.push(crowd);
        }
        for layer in &mut layers {
            if !(crowds.get(layer.crowd as usize)).is_some_and(Crowd::is_crowded) {
                *layer = Layer::NONE;
            }
        }
        let is_any = crowds.iter().any(Crowd::is_crowded);
        is_any.then_some(Self { crowds, layers })
    }

    /// The crowd that two triangles share, and their layers.
    #[inline(always)]
    fn in_crowd(&self, one: u32, other: u32) -> Option<(&Crowd, [&Layer; 2])> {
        let [one, other] = [one, other].map(|triangle| &self.layers[triangle as usize]);
        let crowd = self.crowds.get(one.crowd as usize)?;
        (one.crowd == other.crowd).then_some((crowd, [one, other]))
    }

    /// Whether two triangles are in one crowd.
    #[inline(always)]
    pub fn are_together(&self, one: u32, other: u32) -> bool {
        self.in_crowd(one, other).is_some()
    }

    /// Whether a triangle surely comes after another with these corners, which the ray meets: by
    /// the nearest `t`, and then by their numbers.
    #[inline(always)]
    pub fn is_after(&self, ray: &Ray, new: u32, (old, old_corners): (u32, [DVec3; 3])) -> bool {
        let Some((crowd, [layer, _])) = self.in_crowd(new, old) else {
            return false;
        };
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        let Some(sight) = crowd.plane.sight(&origin, &direction) else {
            return false;
        };
        let earliest = sight.earliest([layer.least() - crowd.off, layer.most() + crowd.off]);
        let nearest = Meeting::new(ray.origin, ray.direction, old_corners).nearest_t();
        (nearest, old) < (earliest, new)
    }

    /// Whether a triangle is surely behind a ray that leaves a point of another, by the weights of
    /// its corners 1 and 2.
    #[inline(always)]
    pub fn is_behind(
        &self,
        direction: DVec3,
        triangle: u32,
        (left, [v, w]): (u32, [f64; 2]),
    ) -> bool {
        let Some((crowd, [layer, from])) = self.in_crowd(triangle, left) else {
            return false;
        };
        let [a, b, c] = from.heights;
        let height = a + v * (b - a) + w * (c - a);
        // Each difference is at most twice the largest, and there are few roundings.
        let largest = from.most().max(-from.least());
        let off = 2.0 * crowd.off + 16.0 * f64::EPSILON * largest;
        match along_normal(crowd.corners, direction) {
            Ordering::Greater => layer.most() < height - off,
            Ordering::Less => layer.least() > height + off,
            Ordering::Equal => false,
        }
    }
}

/// A triangle's normal, twice as long as its area.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

impl Crowd {
    /// The plane of a triangle, without others.
    fn new(corners: [DVec3; 3]) -> Self {
        let along = normal(corners).abs().to_array();
        Self {
            plane: Plane::new(Scalar, &arrays::map(corners, |corner| corner.to_array())),
            corners,
            off: 0.0,
            axis: (0..3).fold(0, |axis, k| if along[k] > along[axis] { k } else { axis }),
            area: 0.0,
            bounds: Bounds::EMPTY,
        }
    }

    /// Takes in a triangle if it is near, and returns its heights.
    fn take(&mut self, corners: [DVec3; 3], near: f64) -> Option<[f64; 3]> {
        let mut heights = [0.0; 3];
        let mut off = self.off;
        for (out, corner) in heights.iter_mut().zip(&corners) {
            let [height, off_by] = self.plane.height(&corner.to_array());
            // A NaN is not near.
            let is_near = height.abs() <= near;
            if !is_near {
                return None;
            }
            *out = height;
            off = off.max(off_by);
        }
        self.off = off;
        self.area += normal(corners)[self.axis].abs();
        self.bounds = self.bounds.union(Bounds::of(corners));
        Some(heights)
    }

    fn is_crowded(&self) -> bool {
        let size = self.bounds.size();
        let box_area = size[(self.axis + 1) % 3] * size[(self.axis + 2) % 3];
        self.area > 2.0 * LAYERS * box_area
    }
}

//! Sixteen rays in lanes: as they are, and as the tree of a mesh sees them.
//!
//! `enter.rs` takes them into the space of an object, `prepare.rs` makes them ready for its tree,
//! and `limits.rs` says where they begin and end. [`TreeRay`] is one of them, with the meaning of
//! its numbers.

use std::mem::offset_of;
use std::ops::Index;

use super::slabs::Slabs;
use super::tree_ray::TreeRay;
use crate::geometry::{DVec3, Ray, arrays};
use crate::shape::triangle::MeshFilter;
use crate::simd::{LANES, Lanes, WIDE};

/// The number of rays in a packet.
#[doc(hidden)]
pub const RAYS: usize = LANES;

/// A mask of the lowest `count` lanes.
#[doc(hidden)]
#[inline(always)]
pub fn lowest(count: usize) -> u16 {
    u16::try_from((1_u32 << count.min(RAYS)) - 1).unwrap_or(u16::MAX)
}

/// Sixteen rays in the space of a mesh; float64 takes them in two halves.
#[derive(Debug, Clone, Default)]
#[repr(C, align(64))]
#[doc(hidden)]
pub struct Packet {
    pub(super) origin: [[f64; RAYS]; 3],
    pub(super) direction: [[f64; RAYS]; 3],
    pub(super) t_min: [f64; RAYS],
    pub(super) t_max: [f64; RAYS],
    /// Depth in a unit of `t`.
    pub(super) depth_per_t: [f64; RAYS],
    /// The depth that the start was moved by.
    pub(super) moved: [f64; RAYS],

    // See `TreeRay`.
    pub(in crate::accel) start: [[[f32; RAYS]; 2]; 3],
    pub(in crate::accel) slope: [[f32; RAYS]; 2],
    pub(in crate::accel) forwards: [f32; RAYS],
    pub(in crate::accel) blur: [f32; RAYS],
    pub(in crate::accel) inverse: [[f32; RAYS]; 3],
    pub(in crate::accel) ends: [[[f32; RAYS]; 2]; 3],

    /// The error of the depth of a hit in float32, at any depth.
    pub(super) depth_error: [f32; RAYS],
    // See `Limits`.
    pub(in crate::accel) t_max_high: [f32; RAYS],
    pub(super) t_min_low: [f32; RAYS],
    pub(super) t_min_high: [f32; RAYS],
    pub(super) t_max_low: [f32; RAYS],
    /// The rays whose direction is longest along y, and along z.
    pub(super) is_along: [u16; 2],
    /// The filters of the rays; see [`Packet::set_filter`].
    pub(in crate::accel) filters: Filters,
    /// The rays that leave a triangle.
    pub(in crate::accel) departing: u16,
    /// The node or leaf at which each ray begins: the root, or the only child of that which it
    /// meets; see [`Packet::keep_at_root`].
    pub(in crate::accel) begin: [u32; RAYS],
    /// The rays that may meet something.
    pub alive: u16,
    /// The rays that start too far away for float64; see `traverse/distant.rs`.
    pub distant: u16,
}

/// Rays in the space of the world, to be [put](Packet::put_all) into packets again and again.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
#[doc(hidden)]
pub struct WorldRays {
    pub(in crate::accel) origin: [[f64; RAYS]; 3],
    pub(in crate::accel) direction: [[f64; RAYS]; 3],
    pub(in crate::accel) t_min: [f64; RAYS],
    t_max: [f64; RAYS],
}

impl WorldRays {
    /// The first of some rays.
    pub fn new<'r>(rays: impl Iterator<Item = &'r Ray>) -> Self {
        let zero = [0.0; RAYS];
        let mut all = Self { origin: [zero; 3], direction: [zero; 3], t_min: zero, t_max: zero };
        for (lane, ray) in rays.take(RAYS).enumerate() {
            for axis in 0..3 {
                all.origin[axis][lane] = ray.origin[axis];
                all.direction[axis][lane] = ray.direction[axis];
            }
            all.t_min[lane] = ray.t_min;
            all.t_max[lane] = ray.t_max;
        }
        all
    }
}

/// A filter for each ray of a packet; only queries for filtered rays look at them.
#[derive(Debug, Clone)]
pub(in crate::accel) struct Filters(Box<[MeshFilter; RAYS]>);

impl Default for Filters {
    fn default() -> Self {
        Self(Box::new([MeshFilter::NONE; RAYS]))
    }
}

impl Index<usize> for Filters {
    type Output = MeshFilter;

    #[inline(always)]
    fn index(&self, lane: usize) -> &MeshFilter {
        &self.0[lane]
    }
}

// `Packet::put_rays` takes a ray for its numbers, in this order.
const _: () = assert!(
    offset_of!(Ray, origin) == 0
        && offset_of!(Ray, direction) == 3 * size_of::<f64>()
        && offset_of!(Ray, t_min) == 6 * size_of::<f64>()
        && offset_of!(Ray, t_max) == 7 * size_of::<f64>()
        && size_of::<Ray>() == WIDE * size_of::<f64>()
);

impl Packet {
    /// Says what the ray in a lane does not meet.
    pub fn set_filter(&mut self, lane: usize, filter: &MeshFilter) {
        *self.filter_mut(lane) = *filter;
    }

    /// The filter of the ray of a lane.
    #[inline(always)]
    pub fn filter_mut(&mut self, lane: usize) -> &mut MeshFilter {
        &mut self.filters.0[lane % RAYS]
    }

    /// Puts a ray into a lane.
    #[inline(always)]
    pub fn put(&mut self, lane: usize, ray: &Ray) {
        let lane = lane % RAYS;
        for axis in 0..3 {
            self.origin[axis][lane] = ray.origin[axis];
            self.direction[axis][lane] = ray.direction[axis];
        }
        self.t_min[lane] = ray.t_min;
        self.t_max[lane] = ray.t_max;
    }

    /// Puts rays into the first lanes: all sixteen at once, or fewer one by one.
    #[inline(always)]
    pub fn put_rays<L: Lanes>(&mut self, l: L, rays: &[Ray]) {
        let Some(rays) = rays.first_chunk::<RAYS>() else {
            for (lane, ray) in rays.iter().enumerate() {
                self.put(lane, ray);
            }
            return;
        };
        for half in 0..2 {
            let rays = of(rays, half);
            let mut rows = [l.splat64(0.0); WIDE];
            for k in 0..WIDE {
                rows[k] = l.load64(bytemuck::cast_ref(&rays[k]));
            }
            let columns = l.transpose64(rows);
            for axis in 0..3 {
                l.store64(columns[axis], of_mut(&mut self.origin[axis], half));
                l.store64(columns[3 + axis], of_mut(&mut self.direction[axis], half));
            }
            l.store64(columns[6], of_mut(&mut self.t_min, half));
            l.store64(columns[7], of_mut(&mut self.t_max, half));
        }
    }

    /// Puts rays into all lanes, each up to its limit.
    #[inline(always)]
    pub fn put_all(&mut self, rays: &WorldRays, limits: &[f64; RAYS]) {
        self.origin = rays.origin;
        self.direction = rays.direction;
        self.t_min = rays.t_min;
        let ends = limits.iter().zip(&rays.t_max);
        for (t_max, (limit, end)) in self.t_max.iter_mut().zip(ends) {
            *t_max = limit.min(*end);
        }
    }

    /// Moves the start of the ray in a lane.
    #[inline]
    pub fn set_origin(&mut self, lane: usize, origin: DVec3) {
        for axis in 0..3 {
            self.origin[axis][lane % RAYS] = origin[axis];
        }
    }

    /// The ray in a lane.
    #[inline(always)]
    pub fn ray(&self, lane: usize) -> Ray {
        let lane = lane % RAYS;
        let vector = |v: &[[f64; RAYS]; 3]| DVec3::new(v[0][lane], v[1][lane], v[2][lane]);
        Ray {
            origin: vector(&self.origin),
            direction: vector(&self.direction),
            t_min: self.t_min[lane],
            t_max: self.t_max[lane],
        }
    }

    /// `TreeRay::axes` of some rays, if they have them in common.
    #[inline(always)]
    pub(in crate::accel) fn common_axes(&self, rays: u16) -> Option<[usize; 3]> {
        let [y, z] = arrays::map(self.is_along, |along| along & rays);
        let along = usize::from(y != 0) + 2 * usize::from(z != 0);
        let all = (y == 0 || y == rays) && (z == 0 || z == rays);
        all.then_some(AXES[along])
    }

    /// The ray in a lane, made ready for the tree.
    #[inline(always)]
    pub(in crate::accel) fn tree_ray(&self, lane: usize) -> TreeRay {
        let lane = lane % RAYS;
        let [y, z] = arrays::map(self.is_along, |mask| usize::from(mask >> lane & 1));
        let z = y + 2 * z;
        let pair = |v: &[[f32; RAYS]; 2]| [v[0][lane], v[1][lane]];
        TreeRay {
            axes: AXES[z],
            start: [pair(&self.start[0]), pair(&self.start[1]), pair(&self.start[2])],
            slope: pair(&self.slope),
            forwards: self.forwards[lane],
            blur: self.blur[lane],
            slabs: Slabs {
                inverse: [self.inverse[0][lane], self.inverse[1][lane], self.inverse[2][lane]],
                ends: [pair(&self.ends[0]), pair(&self.ends[1]), pair(&self.ends[2])],
            },
        }
    }
}

/// `TreeRay::axes` by the last of them; the fourth entry is not used.
static AXES: [[usize; 3]; 4] = [[1, 2, 0], [2, 0, 1], [0, 1, 2], [0, 1, 2]];

/// A half of sixteen.
#[inline(always)]
pub(in crate::accel) fn of<T>(all: &[T; RAYS], half: usize) -> &[T; WIDE] {
    &all.as_chunks().0[half % 2]
}

/// The half of an array, to be written.
#[inline(always)]
pub(in crate::accel) fn of_mut<T>(all: &mut [T; RAYS], half: usize) -> &mut [T; WIDE] {
    &mut all.as_chunks_mut().0[half % 2]
}

/// The vectors of a half.
#[inline(always)]
pub(in crate::accel) fn vector<L: Lanes>(
    l: L,
    from: &[[f64; RAYS]; 3],
    half: usize,
) -> [L::Doubles; 3] {
    [l.load64(of(&from[0], half)), l.load64(of(&from[1], half)), l.load64(of(&from[2], half))]
}

/// The largest size of a component.
#[inline(always)]
pub(in crate::accel) fn largest_of<L: Lanes>(l: L, v: &[L::Doubles; 3]) -> L::Doubles {
    l.max64(l.max64(l.abs64(v[0]), l.abs64(v[1])), l.abs64(v[2]))
}

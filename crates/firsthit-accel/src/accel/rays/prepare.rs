//! Makes sixteen rays ready for the tree of a mesh, or for one each, eight at a time:
//! [`TreeRay`](super::tree_ray::TreeRay) says what the numbers mean.
//!
//! 1. Find the axis along which the direction is longest. The others come first, so that slopes are
//!    at most 1.
//! 2. Bring the start into the tree's space. If it is farther away than `FAR`, move it along the
//!    ray, in float64, to two units before the point that is nearest to the tree's middle.
//! 3. Compute how far rounding can put the ray off: the reach and the blur (see `bounds.rs`).
//! 4. Split the start into two float32, the second of which is what the first leaves out.
//! 5. Bound the depths at which the ray begins and ends (`limits.rs`).
//! 6. Compute what the test of a node takes, sixteen at a time in float32: one over the direction,
//!    and the start over the direction, moved by the margin.
//!
//! # Error bounds
//!
//! The margin of a box is `BOX` times the reach and two blurs. In units of `U reach`:
//!
//! - 1: the start, rounded to float32, 1: its sum with the margin, and 1: the product of that with
//!   one over the direction;
//! - 2: the direction, rounded to float32, and one over that;
//! - 1: the product of a plane with that, and 1: the difference of both;
//! - 1: the vertices, rounded to float32 when the tree is made.
//!
//! These are 8; `BOX` allows 12.

#![expect(
    clippy::needless_range_loop,
    reason = "for chains of iterators the compiler copies registers to memory"
)]

use super::packet::{Packet, RAYS, largest_of, of_mut, vector};
use super::slabs::SMALLEST;
use super::trees::Trees;
use crate::accel::bounds::{BLUR, BOX, DISTANT, FAR};
use crate::simd::{Aligned, Lanes, WIDE};

/// Between the axes of space and those of each ray, `TreeRay::axes`.
struct Axes {
    /// The rays whose direction is longest along x, and along y; of all others it is along z.
    first: u8,
    second: u8,
}

impl Axes {
    /// Finds the longest component of each direction; of equal components the first, as in the
    /// exact test.
    #[inline(always)]
    fn new<L: Lanes>(l: L, d: &[L::Doubles; 3]) -> Self {
        let [x, y, z] = [l.abs64(d[0]), l.abs64(d[1]), l.abs64(d[2])];
        let first = l.le64(y, x) & l.le64(z, x);
        let second = !first & l.le64(z, y);
        Self { first, second }
    }

    #[inline(always)]
    fn choose<L: Lanes>(&self, l: L, [a, b, c]: [L::Doubles; 3]) -> L::Doubles {
        l.select64(self.first, a, l.select64(self.second, b, c))
    }

    /// Reorders components from the axes of space to those of the rays.
    #[inline(always)]
    fn turned<L: Lanes>(&self, l: L, [x, y, z]: [L::Doubles; 3]) -> [L::Doubles; 3] {
        [self.choose(l, [y, z, x]), self.choose(l, [z, x, y]), self.choose(l, [x, y, z])]
    }

    /// Reorders components from the axes of the rays to those of space.
    #[inline(always)]
    fn restored<L: Lanes>(&self, l: L, [x, y, z]: [L::Doubles; 3]) -> [L::Doubles; 3] {
        [self.choose(l, [z, y, x]), self.choose(l, [x, z, y]), self.choose(l, [y, x, z])]
    }
}

/// The rounding errors of rays: see `bounds.rs` for the words.
pub(super) struct Rounding<L: Lanes> {
    pub(super) reach: L::Doubles,
    pub(super) blur: L::Doubles,
}

impl<L: Lanes> Rounding<L> {
    /// A share of the reach.
    #[inline(always)]
    pub(super) fn share(&self, l: L, share: f32) -> L::Doubles {
        l.mul64(l.splat64(f64::from(share)), self.reach)
    }
}

impl Packet {
    /// Makes the first `count` rays ready for the tree or trees that they are at. They are
    /// [valid](Ray::is_valid).
    #[inline(always)]
    pub fn prepare<L: Lanes>(&mut self, l: L, trees: impl Trees, count: usize) {
        self.prepare_blurred(l, trees, count, 0.0);
    }

    /// Prepares rays with [filters](Packet::set_filter). They leave triangles only where
    /// `MeshTree::is_sharp_from` says so.
    #[inline(always)]
    pub fn prepare_filtered<L: Lanes>(&mut self, l: L, trees: impl Trees, count: usize) {
        let mut off: f64 = 0.0;
        let mut departing = 0;
        for lane in 0..count.min(RAYS) {
            let filter = &self.filters[lane];
            departing |= u16::from(filter.is_departing()) << lane;
            if let Some(point) = filter.departure() {
                off = off.max(point.off * trees.scale_at(lane));
            }
        }
        self.prepare_blurred(l, trees, count, off);
        self.departing = departing;
        for lane in 0..count.min(RAYS) {
            let latest = self.filters[lane].latest_begin();
            if latest > 0.0 {
                // Before that the exact test decides.
                self.t_min_high[lane] = self.t_min_high[lane].max(self.depth_above(lane, latest));
            }
        }
    }

    /// Prepares rays that may be off by `off` across their direction, in units of the tree.
    #[inline(always)]
    pub(in crate::accel) fn prepare_blurred<L: Lanes>(
        &mut self,
        l: L,
        trees: impl Trees,
        count: usize,
        off: f64,
    ) {
        self.departing = 0;
        self.begin = [0; RAYS];
        let mut margins = Aligned([0.0; RAYS]);
        let (first, first_distant) = self.prepare_half(l, trees, (0, off), &mut margins.0);
        // One ray alone is common.
        let (second, second_distant) = if count > WIDE {
            self.prepare_half(l, trees, (1, off), &mut margins.0)
        } else {
            (0, 0)
        };
        self.set_slabs(l, &margins.0);
        self.distant = u16::from_le_bytes([first_distant, second_distant]);
        self.alive = u16::from_le_bytes([first, second]) & lowest(count) & !self.distant;
    }

    /// Makes eight ready, but for step 6, which takes their `margins`. Returns which of them may
    /// meet something, and which are distant.
    #[inline(always)]
    fn prepare_half<L: Lanes>(
        &mut self,
        l: L,
        trees: impl Trees,
        (half, off): (usize, f64),
        margins: &mut [f32; RAYS],
    ) -> (u8, u8) {
        let number = |x: f64| l.splat64(x);
        let (zero, one) = (number(0.0), number(1.0));
        let (origin, d) = (vector(l, &self.origin, half), vector(l, &self.direction, half));
        let axes = Axes::new(l, &d);
        let [across, upwards, along] = axes.turned(l, d);
        let sign = l.select64(l.lt64(along, zero), number(-1.0), one);
        let slope = [l.mul64(sign, l.div64(across, along)), l.mul64(sign, l.div64(upwards, along))];
        let scale = trees.scale(l, half);
        let mut start = [zero; 3];
        for axis in 0..3 {
            let moved = l.sub64(origin[axis], trees.origin(l, half, axis));
            start[axis] = l.mul64(moved, scale);
        }
        let mut largest = largest_of(l, &start);
        let size = l.mul64(largest_of(l, &origin), scale);
        let mut blur = l.fused_mul_add64(number(BLUR), l.add64(size, number(100.0)), number(off));
        blur = trees.with_rounding(l, half, blur);
        let mut moved = zero;
        let far = !l.le64(largest, number(FAR));
        let mut distant = 0;
        if far != 0 {
            // A little farther away than [`MeshTree::is_distant`] has it.
            distant = !l.le64(largest, number(1.000_001 * DISTANT));
            let direction = axes.restored(l, [slope[0], slope[1], sign]);
            (start, moved, blur) = nearer(l, far, &start, &direction, blur);
            largest = largest_of(l, &start);
        }
        // Written so that a NaN fails. The ray passes the tree, or leaves it behind.
        let near = l.le64(largest, number(FAR));

        let reach = l.add64(l.mul64(largest, number(1.000_001)), one);
        let rounding = Rounding { reach, blur };
        let margin = l.add64(rounding.share(l, BOX), l.add64(blur, blur));
        l.store_narrowed(margin, of_mut(margins, half));
        let start = axes.turned(l, start);
        for axis in 0..3 {
            let [high, low] = &mut self.start[axis];
            let high = of_mut(high, half);
            l.store_narrowed(start[axis], high);
            let rest = l.sub64(start[axis], l.load_widened(high));
            l.store_narrowed(rest, of_mut(low, half));
        }
        l.store_narrowed(slope[0], of_mut(&mut self.slope[0], half));
        l.store_narrowed(slope[1], of_mut(&mut self.slope[1], half));
        l.store_narrowed(sign, of_mut(&mut self.forwards, half));
        l.store_narrowed(blur, of_mut(&mut self.blur, half));
        let third = !(axes.first | axes.second);
        for (is_along, here) in self.is_along.iter_mut().zip([axes.second, third]) {
            let mut halves = is_along.to_le_bytes();
            halves[half] = here;
            *is_along = u16::from_le_bytes(halves);
        }
        let depth_per_t = l.mul64(l.abs64(along), scale);
        l.store64(depth_per_t, of_mut(&mut self.depth_per_t, half));
        l.store64(moved, of_mut(&mut self.moved, half));
        self.set_limits(l, half, &rounding);
        (near, distant)
    }

    /// Step 6: what the test of a node takes.
    #[inline(always)]
    fn set_slabs<L: Lanes>(&mut self, l: L, margins: &[f32; RAYS]) {
        let [second, third] = self.is_along;
        // Reorders components from the axes of the rays to those of space.
        macro_rules! restored {
            ($x:expr, $y:expr, $z:expr) => {{
                let [x, y, z] = [l.load($x), l.load($y), l.load($z)];
                [
                    l.select(third, x, l.select(second, y, z)),
                    l.select(third, y, l.select(second, z, x)),
                    l.select(third, z, l.select(second, x, y)),
                ]
            }};
        }
        let direction = restored!(&self.slope[0], &self.slope[1], &self.forwards);
        let start = restored!(&self.start[0][0], &self.start[1][0], &self.start[2][0]);
        let (zero, one, margin) = (l.splat(0.0), l.splat(1.0), l.load(margins));
        for axis in 0..3 {
            let back = l.lt(direction[axis], zero);
            let is_small = l.lt(l.abs(direction[axis]), l.splat(SMALLEST));
            let huge = l.splat(1.0 / SMALLEST);
            let huge = l.select(back, l.sub(zero, huge), huge);
            let over = l.select(is_small, huge, l.div(one, direction[axis]));
            let wider = l.select(back, l.sub(zero, margin), margin);
            let minus = l.sub(zero, over);
            l.store(over, &mut self.inverse[axis]);
            l.store(l.mul(l.add(start[axis], wider), minus), &mut self.ends[axis][0]);
            l.store(l.mul(l.sub(start[axis], wider), minus), &mut self.ends[axis][1]);
        }
    }
}

/// A mask of the lowest `count` lanes.
#[inline(always)]
pub(in crate::accel) fn lowest(count: usize) -> u16 {
    u16::try_from((1_u32 << count.min(RAYS)) - 1).unwrap_or(u16::MAX)
}

/// Step 2, for the rays that are `far`: their starts, moved; by which depth; and the blur after
/// that.
#[inline(always)]
fn nearer<L: Lanes>(
    l: L,
    far: u8,
    start: &[L::Doubles; 3],
    direction: &[L::Doubles; 3],
    blur: L::Doubles,
) -> ([L::Doubles; 3], L::Doubles, L::Doubles) {
    let zero = l.splat64(0.0);
    let (mut dot, mut squares) = (zero, zero);
    for axis in 0..3 {
        dot = l.add64(dot, l.mul64(start[axis], direction[axis]));
        squares = l.add64(squares, l.mul64(direction[axis], direction[axis]));
    }
    let nearest = l.sub64(zero, l.div64(dot, squares));
    let moved = l.max64(l.sub64(nearest, l.splat64(2.0)), zero);
    let moved = l.select64(far, moved, zero);
    let way = l.add64(largest_of(l, start), moved);
    let blur = l.select64(far, l.add64(blur, l.mul64(l.splat64(BLUR), way)), blur);
    let mut out = *start;
    for axis in 0..3 {
        let sum = l.add64(start[axis], l.mul64(moved, direction[axis]));
        out[axis] = l.select64(far, sum, start[axis]);
    }
    (out, moved, blur)
}

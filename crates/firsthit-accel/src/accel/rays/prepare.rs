//! Makes sixteen rays ready for the tree of a mesh, or for one each:
//! [`TreeRay`](super::tree_ray::TreeRay) says what the numbers mean. What needs float64 is computed
//! in two halves, all else in float32.
//!
//! 1. Find the axis along which the direction is longest. The others come first, so that slopes are
//!    at most 1.
//! 2. Bring the start into the tree's space, and compute how far float64's rounding can put the ray
//!    off: the blur (see `bounds.rs`).
//! 3. Split the start into two float32, the second of which is what the first leaves out.
//! 4. If it is farther away than `FAR`, move it along the ray, in float64, to two units before the
//!    point that is nearest to the tree's middle, and split it again.
//! 5. Compute what the test of a node takes (`slabs.rs`): one over the direction, and the start
//!    over the direction, moved by the margin.
//! 6. Bound the depths at which the ray begins and ends (`limits.rs`).
//!
//! # Error bounds
//!
//! The margin of a box is `BOX` times the reach and two blurs. Along an axis the depth of a plane
//! is `plane / d - (start / d + margin / |d|)`, or with the margin's other sign, where `1 / d` is
//! one number. The errors of that depth, times `|d|`, in units of `U reach`:
//!
//! - 1: the start, rounded to float32;
//! - 2: the direction, rounded to float32, and one over that: a share of `plane - start`, which is
//!   at most the reach;
//! - 1: the sum of the start and the margin over the direction;
//! - 1: the test's difference of the plane over the direction and that;
//! - 1: the vertices, rounded to float32 when the tree is made;
//! - 2, where lanes do not fuse products with sums: the start over the direction, and the plane
//!   over the direction.
//!
//! These are 6 where products are fused, and 8 where they are not; `BOX` allows 12. What is left is
//! for the terms of higher orders: the margin is rounded, so is its product with the size of one
//! over the direction, that is off by 2, and the sums are larger by the margin. Each of these few
//! is one or two `U margin`: 24 `U` of a unit, and as small a share of the blurs.

#![expect(
    clippy::needless_range_loop,
    reason = "for chains of iterators the compiler copies registers to memory"
)]

use super::packet::{Packet, RAYS, largest_of, lowest, of, of_mut, vector};
use super::slabs::narrow_slab;
use super::trees::Trees;
use crate::accel::bounds::{BLUR, BOX, DISTANT, FAR};
use crate::simd::{Lanes, WIDE};

/// `FAR` in float32.
const NARROW_FAR: f32 = 8.0;
const _: () = assert!(NARROW_FAR as f64 == FAR);

/// The rays whose direction is longest along x, and along y; of all others it is along z.
#[derive(Clone, Copy)]
struct Axes([u16; 2]);

impl Axes {
    /// Reorders components from the axes of space to those of the rays.
    #[inline(always)]
    fn turned<L: Lanes>(self, l: L, [x, y, z]: [L::Floats; 3]) -> [L::Floats; 3] {
        let Self([first, second]) = self;
        [
            l.select(first, y, l.select(second, z, x)),
            l.select(first, z, l.select(second, x, y)),
            l.select(first, x, l.select(second, y, z)),
        ]
    }
}

/// Both halves of sixteen float64.
type Both<L> = [<L as Lanes>::Doubles; 2];

/// Computes a number of each ray, half by half; zeros for a half without rays.
macro_rules! both {
    ($l:ident, $has_second:ident, $half:ident => $number:expr) => {{
        let first = {
            let $half = 0;
            $number
        };
        let second = if $has_second {
            let $half = 1;
            $number
        } else {
            $l.splat64(0.0)
        };
        [first, second]
    }};
}

pub(super) use both;

impl Packet {
    /// Makes the first `count` rays ready for the tree or trees that they are at. They are
    /// [valid](crate::geometry::Ray::is_valid).
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
        (self.departing, self.distant) = (0, 0);
        self.begin = [0; RAYS];
        // One ray alone is common.
        let has_second = count > WIDE;
        let number = |x: f64| l.splat64(x);
        // Step 1.
        let (axes, longest, direction) = self.directions(l, has_second);
        // Step 2.
        let scale = both!(l, has_second, half => trees.scale(l, half));
        let mut start = [[number(0.0); 2]; 3];
        for axis in 0..3 {
            start[axis] = both!(l, has_second, half => {
                let origin = l.load64(of(&self.origin[axis], half));
                l.mul64(l.sub64(origin, trees.origin(l, half, axis)), scale[half])
            });
        }
        let blur = both!(l, has_second, half => {
            let size = l.mul64(largest_of(l, &vector(l, &self.origin, half)), scale[half]);
            let blur =
                l.fused_mul_add64(number(BLUR), l.add64(size, number(100.0)), number(off));
            trees.with_rounding(l, half, blur)
        });
        let depth_per_t = both!(l, has_second, half => l.mul64(longest[half], scale[half]));
        let mut blur = narrow(l, blur);
        // Step 3.
        let [mut high, mut low] = split(l, &start);
        let mut largest = size(l, &high);
        // Step 4.
        let farthest = l.splat(NARROW_FAR);
        let far = lowest(count) & !l.le(largest, farthest);
        let mut moved = [number(0.0); 2];
        if far != 0 {
            let mut further = [number(0.0); 2];
            self.distant = far & self.move_nearer(l, far, (&mut start, &mut moved, &mut further));
            blur = l.add(blur, narrow(l, further));
            [high, low] = split(l, &start);
            largest = size(l, &high);
        }
        // Written so that a NaN fails. The ray passes the tree, or leaves it behind.
        let near = l.le(largest, farthest);
        self.alive = near & lowest(count) & !self.distant;

        for half in 0..2 {
            l.store64(depth_per_t[half], of_mut(&mut self.depth_per_t, half));
            l.store64(moved[half], of_mut(&mut self.moved, half));
        }
        // Step 5.
        let reach = l.mul_add(largest, l.splat(1.000_001), l.splat(1.0));
        let margin = l.mul_add(reach, l.splat(BOX), l.add(blur, blur));
        for axis in 0..3 {
            let (over, [first, last]) = narrow_slab(l, high[axis], direction[axis], margin);
            l.store(over, &mut self.inverse[axis]);
            l.store(first, &mut self.ends[axis][0]);
            l.store(last, &mut self.ends[axis][1]);
        }
        l.store(blur, &mut self.blur);
        let [across, upwards, forwards] = axes.turned(l, direction);
        l.store(across, &mut self.slope[0]);
        l.store(upwards, &mut self.slope[1]);
        l.store(forwards, &mut self.forwards);
        let (high, low) = (axes.turned(l, high), axes.turned(l, low));
        for axis in 0..3 {
            l.store(high[axis], &mut self.start[axis][0]);
            l.store(low[axis], &mut self.start[axis][1]);
        }
        let Axes([first, second]) = axes;
        self.is_along = [second, !(first | second)];
        // Step 6.
        self.set_limits(l, has_second, (reach, blur));
    }

    /// The longest component of each direction, of equal ones the first, as in the exact test; and
    /// the directions with that as 1 or -1.
    #[inline(always)]
    fn directions<L: Lanes>(&self, l: L, has_second: bool) -> (Axes, Both<L>, [L::Floats; 3]) {
        let (mut first, mut second) = ([0; 2], [0; 2]);
        let mut is_plain = u8::MAX;
        let longest = both!(l, has_second, half => {
            let d = vector(l, &self.direction, half);
            let longest = largest_of(l, &d);
            first[half] = l.le64(longest, l.abs64(d[0]));
            second[half] = !first[half] & l.le64(longest, l.abs64(d[1]));
            // Beyond these sizes a reciprocal has fewer digits.
            is_plain &= l.le64(longest, l.splat64(1e300)) & l.le64(l.splat64(1e-300), longest);
            longest
        });
        let over = both!(l, has_second, half => l.div64(l.splat64(1.0), longest[half]));
        let mut direction = [l.splat(0.0); 3];
        for axis in 0..3 {
            direction[axis] = narrow(
                l,
                both!(l, has_second, half => {
                    let along = l.load64(of(&self.direction[axis], half));
                    if is_plain == u8::MAX {
                        l.mul64(along, over[half])
                    } else {
                        l.div64(along, longest[half])
                    }
                }),
            );
        }
        (Axes([u16::from_le_bytes(first), u16::from_le_bytes(second)]), longest, direction)
    }

    /// Moves the starts of the rays that are `far`, and adds by which depth, and how much further
    /// off that puts them. Returns those that are distant.
    #[inline(always)]
    fn move_nearer<L: Lanes>(
        &self,
        l: L,
        far: u16,
        (start, moved, blur): (&mut [Both<L>; 3], &mut Both<L>, &mut Both<L>),
    ) -> u16 {
        let mut distant = [0; 2];
        for half in 0..2 {
            let far = far.to_le_bytes()[half];
            if far == 0 {
                continue;
            }
            let [mut from, mut direction] = [vector(l, &self.direction, half); 2];
            let longest = largest_of(l, &direction);
            for axis in 0..3 {
                from[axis] = start[axis][half];
                direction[axis] = l.div64(direction[axis], longest);
            }
            // A little farther away than [`MeshTree::is_distant`] has it.
            let farthest = l.splat64(1.000_001 * DISTANT);
            distant[half] = !l.le64(largest_of(l, &from), farthest);
            let to;
            (to, moved[half], blur[half]) = nearer(l, far, &from, &direction);
            for axis in 0..3 {
                start[axis][half] = to[axis];
            }
        }
        u16::from_le_bytes(distant)
    }
}

/// Sixteen float64, rounded to float32.
#[inline(always)]
fn narrow<L: Lanes>(l: L, [first, second]: Both<L>) -> L::Floats {
    l.narrow(first, second)
}

/// Vectors in two parts.
#[inline(always)]
fn split<L: Lanes>(l: L, whole: &[Both<L>; 3]) -> [[L::Floats; 3]; 2] {
    let [mut high, mut low] = [[l.splat(0.0); 3]; 2];
    for axis in 0..3 {
        let [first, second] = whole[axis];
        high[axis] = l.narrow(first, second);
        let wide = l.widen(high[axis]);
        low[axis] = l.narrow(l.sub64(first, wide[0]), l.sub64(second, wide[1]));
    }
    [high, low]
}

/// The largest size of a component.
#[inline(always)]
fn size<L: Lanes>(l: L, v: &[L::Floats; 3]) -> L::Floats {
    l.max(l.max(l.abs(v[0]), l.abs(v[1])), l.abs(v[2]))
}

/// The starts of the rays that are `far`, moved; by which depth; and what comes to the blur.
#[inline(always)]
fn nearer<L: Lanes>(
    l: L,
    far: u8,
    start: &[L::Doubles; 3],
    direction: &[L::Doubles; 3],
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
    let blur = l.select64(far, l.mul64(l.splat64(BLUR), way), zero);
    let mut out = *start;
    for axis in 0..3 {
        let sum = l.add64(start[axis], l.mul64(moved, direction[axis]));
        out[axis] = l.select64(far, sum, start[axis]);
    }
    (out, moved, blur)
}

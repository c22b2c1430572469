//! Sixteen rays made ready for a [`MeshTree`], eight at a time, a lane each. What comes out is described in `ray.rs`.

#![expect(
    clippy::needless_range_loop,
    reason = "of chains of iterators over registers the compiler makes copies in memory"
)]

use super::tree_ray::TreeRay;
use crate::accel::bounds::{FAR, U};
use crate::accel::mesh_tree::MeshTree;
use crate::accel::space::DISTANT;
use crate::geometry::{DMat3, DVec3, Ray, Transform};
use crate::simd::{LANES, Lanes, WIDE};

/// How many rays are in a packet.
pub(crate) const RAYS: usize = LANES;

/// Sixteen rays in the space of a mesh; float64 takes them in two halves.
#[derive(Debug, Clone, Default)]
#[repr(C, align(64))]
pub(crate) struct Packet {
    origin: [[f64; RAYS]; 3],
    direction: [[f64; RAYS]; 3],
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

    /// What a float32 depth is off by at most, and twice as much again.
    pub(super) depth_error: [f32; RAYS],
    /// [`Limits::last`](super::limits::Limits::last).
    pub(in crate::accel) limit: [f32; RAYS],
    // See `Limits`.
    pub(super) before: [f32; RAYS],
    pub(super) beyond: [f32; RAYS],
    pub(super) within: [f32; RAYS],
    /// The rays whose direction is longest along y, and along z.
    is_along: [u16; 2],
    /// The rays that may meet something.
    pub(crate) alive: u16,
    /// The rays that are too far away for this, see `distant.rs`.
    pub(crate) distant: u16,
}

/// Between the axes of space and those of each ray, `TreeRay::axes`.
struct Axes {
    /// The rays whose direction is longest along x, and along y; of all others it is along z.
    first: u8,
    second: u8,
}

impl Axes {
    /// The exact test's choice: of equal ones the first.
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

    /// From the axes of space to those of the rays.
    #[inline(always)]
    fn turned<L: Lanes>(&self, l: L, [x, y, z]: [L::Doubles; 3]) -> [L::Doubles; 3] {
        [
            self.choose(l, [y, z, x]),
            self.choose(l, [z, x, y]),
            self.choose(l, [x, y, z]),
        ]
    }

    /// And back.
    #[inline(always)]
    fn restored<L: Lanes>(&self, l: L, [x, y, z]: [L::Doubles; 3]) -> [L::Doubles; 3] {
        [
            self.choose(l, [z, y, x]),
            self.choose(l, [x, z, y]),
            self.choose(l, [y, x, z]),
        ]
    }
}

/// What is off by how much; see `ray.rs`.
pub(super) struct Rounding<L: Lanes> {
    pub(super) reach: L::Doubles,
    pub(super) blur: L::Doubles,
}

impl<L: Lanes> Rounding<L> {
    /// So many times float32's rounding of `reach`.
    #[inline(always)]
    pub(super) fn units(&self, l: L, units: f64) -> L::Doubles {
        l.mul64(l.splat64(units * f64::from(U)), self.reach)
    }
}

impl Packet {
    /// Puts a ray into a lane.
    #[inline(always)]
    pub(crate) fn put(&mut self, lane: usize, ray: &Ray) {
        let lane = lane % RAYS;
        for axis in 0..3 {
            self.origin[axis][lane] = ray.origin[axis];
            self.direction[axis][lane] = ray.direction[axis];
        }
        self.t_min[lane] = ray.t_min;
        self.t_max[lane] = ray.t_max;
    }

    /// The ray in a lane.
    #[inline(always)]
    pub(in crate::accel) fn ray(&self, lane: usize) -> Ray {
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
        let [y, z] = self.is_along.map(|along| along & rays);
        let along = usize::from(y != 0) + 2 * usize::from(z != 0);
        let all = (y == 0 || y == rays) && (z == 0 || z == rays);
        all.then_some(AXES[along])
    }

    /// The same as the tree sees it.
    #[inline(always)]
    pub(in crate::accel) fn tree_ray(&self, lane: usize) -> TreeRay {
        let lane = lane % RAYS;
        let [y, z] = self.is_along.map(|mask| usize::from(mask >> lane & 1));
        let z = y + 2 * z;
        let pair = |v: &[[f32; RAYS]; 2]| [v[0][lane], v[1][lane]];
        TreeRay {
            axes: AXES[z],
            start: [
                pair(&self.start[0]),
                pair(&self.start[1]),
                pair(&self.start[2]),
            ],
            slope: pair(&self.slope),
            forwards: self.forwards[lane],
            blur: self.blur[lane],
            inverse: [
                self.inverse[0][lane],
                self.inverse[1][lane],
                self.inverse[2][lane],
            ],
            ends: [
                pair(&self.ends[0]),
                pair(&self.ends[1]),
                pair(&self.ends[2]),
            ],
        }
    }

    /// Takes world rays into an object's space, and says which of them are as nearly all are: valid in both, ahead of their
    /// origins, and with a direction that can be squared. What becomes of others is of no use.
    #[inline(always)]
    pub(crate) fn enter<L: Lanes>(&mut self, l: L, transform: &Transform) -> u16 {
        u16::from_le_bytes([
            self.enter_half(l, transform, 0),
            self.enter_half(l, transform, 1),
        ])
    }

    #[inline(always)]
    fn enter_half<L: Lanes>(&mut self, l: L, transform: &Transform, half: usize) -> u8 {
        let number = |x: f64| l.splat64(x);
        let up_to = |v: &[L::Doubles; 3], most: f64| {
            // Written so that a NaN fails.
            l.le64(l.abs64(v[0]), number(most))
                & l.le64(l.abs64(v[1]), number(most))
                & l.le64(l.abs64(v[2]), number(most))
        };
        let (origin, direction) = (
            vector(l, &self.origin, half),
            vector(l, &self.direction, half),
        );
        let length = largest_of(l, &direction);
        let t_max = l.load64(of(&self.t_max, half));
        let plain = l.lt64(number(0.0), t_max)
            & l.lt64(l.load64(of(&self.t_min, half)), t_max)
            & l.le64(number(0.0), l.load64(of(&self.t_min, half)))
            & l.lt64(number(1e-99), length)
            & l.lt64(length, number(1e99))
            & up_to(&direction, f64::MAX)
            & up_to(&origin, Ray::FARTHEST);
        if transform.is_identity() {
            return plain;
        }
        // Operation for operation what `Transform::ray_in_object` does.
        let place = transform.world_from_object().translation;
        let matrix = &transform.object_from_world().matrix3;
        let moved = [
            l.sub64(origin[0], number(place.x)),
            l.sub64(origin[1], number(place.y)),
            l.sub64(origin[2], number(place.z)),
        ];
        let mut inside = [[number(0.0); 3]; 2];
        for axis in 0..3 {
            inside[0][axis] = turned(l, matrix, axis, &moved);
            inside[1][axis] = turned(l, matrix, axis, &direction);
            l.store64(inside[0][axis], of_mut(&mut self.origin[axis], half));
            l.store64(inside[1][axis], of_mut(&mut self.direction[axis], half));
        }
        let length = largest_of(l, &inside[1]);
        plain
            & up_to(&inside[0], Ray::FARTHEST)
            & up_to(&inside[1], f64::MAX)
            & l.lt64(number(0.0), length)
    }

    /// Makes the first `count` rays ready for `tree`. They are [valid](Ray::is_valid).
    #[inline(always)]
    pub(crate) fn prepare<L: Lanes>(&mut self, l: L, tree: &MeshTree, count: usize) {
        self.prepare_blurred(l, tree, count, 0.0);
    }

    /// The same for rays that are off by so much across their way, in units of the tree.
    #[inline(always)]
    pub(in crate::accel) fn prepare_blurred<L: Lanes>(
        &mut self,
        l: L,
        tree: &MeshTree,
        count: usize,
        off: f64,
    ) {
        let (first, first_distant) = self.prepare_half(l, tree, 0, off);
        // One ray alone is common.
        let (second, second_distant) = if count > WIDE {
            self.prepare_half(l, tree, 1, off)
        } else {
            (0, 0)
        };
        self.distant = u16::from_le_bytes([first_distant, second_distant]);
        self.alive = u16::from_le_bytes([first, second]) & lowest(count) & !self.distant;
    }

    /// Returns which of eight may meet something, and which are distant.
    #[inline(always)]
    #[expect(clippy::too_many_lines, reason = "one thing after the other")]
    fn prepare_half<L: Lanes>(&mut self, l: L, tree: &MeshTree, half: usize, off: f64) -> (u8, u8) {
        let number = |x: f64| l.splat64(x);
        let (zero, one) = (number(0.0), number(1.0));
        let (origin, d) = (
            vector(l, &self.origin, half),
            vector(l, &self.direction, half),
        );
        let axes = Axes::new(l, &d);
        let [across, upwards, along] = axes.turned(l, d);
        let sign = l.select64(l.lt64(along, zero), number(-1.0), one);
        let slope = [
            l.mul64(sign, l.div64(across, along)),
            l.mul64(sign, l.div64(upwards, along)),
        ];
        let direction = axes.restored(l, [slope[0], slope[1], sign]);

        let scale = number(tree.space.scale);
        let mut start = [zero; 3];
        for axis in 0..3 {
            let moved = l.sub64(origin[axis], number(tree.space.origin[axis]));
            start[axis] = l.mul64(moved, scale);
        }
        let mut largest = largest_of(l, &start);
        let size = l.mul64(largest_of(l, &origin), scale);
        let mut blur = l.fused_mul_add64(number(1e-15), l.add64(size, number(100.0)), number(off));
        if !tree.is_exact {
            blur = l.add64(blur, number(U.into()));
        }
        let mut moved = zero;
        let far = !l.le64(largest, number(FAR));
        let mut distant = 0;
        if far != 0 {
            // A little farther away than [`MeshTree::is_distant`] has it.
            distant = !l.le64(largest, number(1.000_001 * DISTANT));
            (start, moved, blur) = nearer(l, far, &start, &direction, blur);
            largest = largest_of(l, &start);
        }
        // Written so that a NaN fails. The ray passes the tree, or leaves it behind.
        let near = l.le64(largest, number(FAR));

        let reach = l.add64(l.mul64(largest, number(1.000_001)), one);
        let rounding = Rounding { reach, blur };
        self.set_ends(l, half, &start, &direction, &rounding);
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

    /// What a node's test works with.
    #[inline(always)]
    fn set_ends<L: Lanes>(
        &mut self,
        l: L,
        half: usize,
        start: &[L::Doubles; 3],
        direction: &[L::Doubles; 3],
        rounding: &Rounding<L>,
    ) {
        let zero = l.splat64(0.0);
        // In units of float32's rounding: the start is rounded by 1 and its product by 1, the direction's
        // reciprocal by 1, the plane's product and the difference by 1 each, and the tree rounded the vertices by 1.
        let blur = l.add64(rounding.blur, rounding.blur);
        let margin = l.add64(rounding.units(l, 12.0), blur);
        for axis in 0..3 {
            let back = l.lt64(direction[axis], zero);
            let over = reciprocal(l, direction[axis], back);
            let wider = l.select64(back, l.sub64(zero, margin), margin);
            let minus = l.sub64(zero, over);
            l.store_narrowed(over, of_mut(&mut self.inverse[axis], half));
            let [first, last] = &mut self.ends[axis];
            l.store_narrowed(
                l.mul64(l.add64(start[axis], wider), minus),
                of_mut(first, half),
            );
            l.store_narrowed(
                l.mul64(l.sub64(start[axis], wider), minus),
                of_mut(last, half),
            );
        }
    }
}

/// `TreeRay::axes` by the last of them; the fourth is nobody's.
static AXES: [[usize; 3]; 4] = [[1, 2, 0], [2, 0, 1], [0, 1, 2], [0, 1, 2]];

/// The lowest bits.
#[inline(always)]
fn lowest(count: usize) -> u16 {
    u16::try_from((1_u32 << count.min(RAYS)) - 1).unwrap_or(u16::MAX)
}

/// A half of sixteen.
#[inline(always)]
pub(super) fn of<T>(all: &[T; RAYS], half: usize) -> &[T; WIDE] {
    &all.as_chunks().0[half % 2]
}

#[inline(always)]
pub(super) fn of_mut<T>(all: &mut [T; RAYS], half: usize) -> &mut [T; WIDE] {
    &mut all.as_chunks_mut().0[half % 2]
}

#[inline(always)]
fn vector<L: Lanes>(l: L, from: &[[f64; RAYS]; 3], half: usize) -> [L::Doubles; 3] {
    [
        l.load64(of(&from[0], half)),
        l.load64(of(&from[1], half)),
        l.load64(of(&from[2], half)),
    ]
}

/// A component of `matrix * v`, in the order of operations that glam has.
#[inline(always)]
pub(crate) fn turned<L: Lanes>(
    l: L,
    matrix: &DMat3,
    axis: usize,
    v: &[L::Doubles; 3],
) -> L::Doubles {
    let x = l.mul64(l.splat64(matrix.x_axis[axis]), v[0]);
    let y = l.mul64(l.splat64(matrix.y_axis[axis]), v[1]);
    let z = l.mul64(l.splat64(matrix.z_axis[axis]), v[2]);
    l.add64(l.add64(x, y), z)
}

#[inline(always)]
fn largest_of<L: Lanes>(l: L, v: &[L::Doubles; 3]) -> L::Doubles {
    l.max64(l.max64(l.abs64(v[0]), l.abs64(v[1])), l.abs64(v[2]))
}

/// The starts of the rays that are `far` moved to two units before the point nearest to the middle of the tree,
/// by how much, and the blur after that.
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
    let blur = l.select64(far, l.add64(blur, l.mul64(l.splat64(1e-15), way)), blur);
    let mut out = *start;
    for axis in 0..3 {
        let sum = l.add64(start[axis], l.mul64(moved, direction[axis]));
        out[axis] = l.select64(far, sum, start[axis]);
    }
    (out, moved, blur)
}

/// One over a component of the direction, finite: along an axis where the ray moves by less than all
/// margins it is parallel, and a huge number tells inside from outside.
#[inline(always)]
fn reciprocal<L: Lanes>(l: L, x: L::Doubles, back: u8) -> L::Doubles {
    const SMALLEST: f64 = 1e-30;
    let huge = l.splat64(1.0 / SMALLEST);
    let huge = l.select64(back, l.sub64(l.splat64(0.0), huge), huge);
    let is_small = l.lt64(l.abs64(x), l.splat64(SMALLEST));
    l.select64(is_small, huge, l.div64(l.splat64(1.0), x))
}

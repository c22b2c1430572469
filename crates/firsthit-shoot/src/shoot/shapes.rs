//! Eight rays at a time against shapes that are no meshes, in lanes of float64.
//!
//! A shape is intersected by what is written once for lanes and for a single ray
//! (`shape/bundle.rs`), so the answers are those of the single rays, to the bit. Rare cases go to
//! the single-ray code: filters that tell surfaces apart, two hits that may be in one place, and
//! rays whose directions have extreme lengths.

use super::hits::HitSlices;
use super::scaled_ray::ScaledRay;
use super::scene_walk::first_of_shapes;
use crate::geometry::{DVec2, DVec3, Hit, PixelGrid, Ray};
use crate::scene::{Object, Scene};
use crate::shape::Crossing;
use crate::shape::bundle::{RayOf, crossing, minus, plus, splat, squared, times, turned};
use crate::simd::{InLanes, Lanes, WIDE, set_bits};

/// The columns of up to eight rays: one number of each in a row.
pub(super) struct Columns {
    pub(super) origin: [[f64; WIDE]; 3],
    pub(super) direction: [[f64; WIDE]; 3],
    t_min: [f64; WIDE],
    pub(super) t_max: [f64; WIDE],
}

impl Columns {
    pub(super) const NONE: Self = Self {
        origin: [[0.0; WIDE]; 3],
        direction: [[1.0; WIDE]; 3],
        t_min: [0.0; WIDE],
        t_max: [0.0; WIDE],
    };

    #[inline(always)]
    pub(super) fn put(&mut self, lane: usize, ray: &Ray) {
        for axis in 0..3 {
            self.origin[axis][lane] = ray.origin[axis];
            self.direction[axis][lane] = ray.direction[axis];
        }
        self.t_min[lane] = ray.t_min;
        self.t_max[lane] = ray.t_max;
    }

    #[inline(always)]
    pub(super) fn load<L: Lanes>(&self, l: L) -> RayOf<L::Doubles> {
        let [x, y, z] = &self.origin;
        let [u, v, w] = &self.direction;
        RayOf {
            origin: [l.load64(x), l.load64(y), l.load64(z)],
            direction: [l.load64(u), l.load64(v), l.load64(w)],
            t_min: l.load64(&self.t_min),
            t_max: l.load64(&self.t_max),
        }
    }
}

/// One of the rays.
#[inline(always)]
fn lane_of<L: Lanes>(l: L, ray: &RayOf<L::Doubles>, lane: usize) -> Ray {
    let mut columns = Columns::NONE;
    for axis in 0..3 {
        l.store64(ray.origin[axis], &mut columns.origin[axis]);
        l.store64(ray.direction[axis], &mut columns.direction[axis]);
    }
    l.store64(ray.t_min, &mut columns.t_min);
    l.store64(ray.t_max, &mut columns.t_max);
    let [x, y, z] = columns.origin;
    let [u, v, w] = columns.direction;
    Ray {
        origin: DVec3::new(x[lane], y[lane], z[lane]),
        direction: DVec3::new(u[lane], v[lane], w[lane]),
        t_min: columns.t_min[lane],
        t_max: columns.t_max[lane],
    }
}

/// The smaller of two numbers, none of which is NaN.
#[inline(always)]
fn min<L: Lanes>(l: L, a: L::Doubles, b: L::Doubles) -> L::Doubles {
    l.select64(l.lt64(a, b), a, b)
}

/// The longest component of each direction.
#[inline(always)]
pub(super) fn longest<L: Lanes>(l: L, ray: &RayOf<L::Doubles>) -> L::Doubles {
    let [u, v, w] = ray.direction;
    l.max64(l.max64(l.abs64(u), l.abs64(v)), l.abs64(w))
}

/// The rays whose directions need not be scaled: see [`moderation`](crate::geometry::moderation).
#[inline(always)]
fn is_moderate<L: Lanes>(l: L, ray: &RayOf<L::Doubles>) -> u8 {
    let longest = longest(l, ray);
    l.le64(l.splat64(1e-100), longest) & l.le64(longest, l.splat64(1e100))
}

/// Rays in an object's space, and which of them can meet anything there, as
/// [`ScaledRay::in_object`] has it.
#[inline(always)]
pub(super) fn in_object<L: Lanes>(
    l: L,
    object: &Object,
    ray: &RayOf<L::Doubles>,
) -> (RayOf<L::Doubles>, u8) {
    let of = InLanes(l);
    let transform = object.transform();
    let ray = if transform.is_identity() {
        *ray
    } else {
        let matrix = &transform.object_from_world().matrix3;
        let moved = splat(of, transform.world_from_object().translation);
        RayOf {
            origin: turned(of, matrix, minus(of, ray.origin, moved)),
            direction: turned(of, matrix, ray.direction),
            ..*ray
        }
    };
    let valid = if object.is_out_of_range() { 0 } else { ray.is_valid(of) };
    (ray, valid)
}

/// The rays through eight pixels of a row, from the column of the first `x` on, and which of them
/// are as [`PixelGrid::ray`] has them: the others are of extreme lengths.
#[inline(always)]
pub(super) fn rays_of_row<L: Lanes>(
    l: L,
    grid: &PixelGrid,
    y: f64,
    x: &[f64; WIDE],
) -> (RayOf<L::Doubles>, u8) {
    let of = InLanes(l);
    let along = times(of, l.load64(x), splat(of, grid.right));
    let up = splat(of, y * grid.upwards);
    let point = plus(of, plus(of, splat(of, grid.toward), along), up);
    let position = splat(of, grid.position);
    let mut ray = RayOf {
        origin: position,
        direction: point,
        t_min: l.splat64(0.0),
        t_max: l.splat64(f64::INFINITY),
    };
    let mut are_same = u8::MAX;
    if let Some(direction) = grid.parallel {
        let start =
            if grid.starts_on_viewplane { point } else { minus(of, point, splat(of, grid.toward)) };
        ray.origin = plus(of, position, start);
        ray.direction = splat(of, direction);
    } else {
        if grid.starts_on_viewplane {
            ray.origin = plus(of, position, point);
        }
        are_same = is_moderate(l, &ray);
        let length = l.sqrt64(squared(of, point));
        ray.direction =
            [l.div64(point[0], length), l.div64(point[1], length), l.div64(point[2], length)];
    }
    (ray, are_same)
}

/// The first hits of up to eight rays of a picture among some shapes and what they have met
/// already, at a place in `out` and after it.
pub(super) struct FirstOfShapes<'r, 'out> {
    pub(super) scene: &'r Scene,
    pub(super) objects: &'r [u32],
    pub(super) at: usize,
    pub(super) count: usize,
    pub(super) out: &'r mut HitSlices<'out>,
}

impl FirstOfShapes<'_, '_> {
    /// Intersects rays that are given one by one.
    #[inline(always)]
    pub(super) fn of_rays<L: Lanes>(self, l: L, rays: &[Ray]) {
        let mut columns = Columns::NONE;
        for (lane, ray) in rays.iter().enumerate() {
            columns.put(lane, ray);
        }
        let ray = columns.load(l);
        if self.all() & !is_moderate(l, &ray) == 0 {
            self.of_bundle(l, &ray);
        } else {
            for (at, ray) in (self.at..).zip(rays) {
                let hit = first_of_shapes(self.scene, ray, self.objects, self.out.get(at));
                self.out.put(at, &hit);
            }
        }
    }

    #[inline(always)]
    fn all(&self) -> u8 {
        u8::MAX >> (WIDE - self.count)
    }

    /// Intersects rays side by side, none of an extreme length.
    #[inline(always)]
    pub(super) fn of_bundle<L: Lanes>(self, l: L, ray: &RayOf<L::Doubles>) {
        let all = self.all() & ray.is_valid(InLanes(l));
        let Self { scene, objects, at, count, out } = self;
        let mut found = [f64::INFINITY; WIDE];
        found[..count].copy_from_slice(&out.t[at..at + count]);
        let mut t = l.load64(&found);
        for &index in objects {
            let object = &scene.objects()[index as usize];
            // As `FirstHit::t_max`.
            let beyond = l.mul64(l.splat64(8.0 * f64::EPSILON), l.abs64(t));
            let clear = l.max64(l.add64(t, beyond), l.splat64(f64::MIN_POSITIVE));
            let rest = RayOf { t_max: min(l, clear, ray.t_max), ..*ray };
            let (rest, valid) = in_object(l, object, &rest);
            let Some(crossing) = object.shape().first_of_bundle(InLanes(l), &rest) else {
                continue;
            };
            let met = crossing.is_met & valid & all;
            if met == 0 {
                continue;
            }
            // As `ScaledRay::precedes`.
            let apart = l.abs64(l.sub64(crossing.t, t));
            let smaller = min(l, l.abs64(crossing.t), l.abs64(t));
            let close = l.le64(apart, l.mul64(l.splat64(4.0 * f64::EPSILON), smaller));
            let wins = met & l.lt64(crossing.t, t) & !close;
            t = l.select64(wins, crossing.t, t);
            let (mut new_t, mut primitives) = ([0.0; WIDE], [0.0; WIDE]);
            l.store64(crossing.t, &mut new_t);
            l.store64(crossing.primitive, &mut primitives);
            for lane in set_bits(wins.into()) {
                out.put(at + lane, &hit(index, new_t[lane], primitives[lane]));
            }
            if met & close != 0 {
                for lane in set_bits((met & close).into()) {
                    let new = hit(index, new_t[lane], primitives[lane]);
                    let old = out.get(at + lane);
                    let scaled = ScaledRay::new(&lane_of(l, ray, lane));
                    if scaled.is_some_and(|scaled| scaled.precedes(scene, &new, &old)) {
                        out.put(at + lane, &new);
                    }
                }
                found[..count].copy_from_slice(&out.t[at..at + count]);
                t = l.load64(&found);
            }
        }
    }
}

/// The hit of an object at `t`, of a primitive that is a whole number.
#[inline(always)]
fn hit(object: u32, t: f64, primitive: f64) -> Hit {
    let Crossing { t, primitive, .. } = crossing(t, primitive);
    Hit { t, object: object.cast_signed(), primitive, barycentric: DVec2::NAN }
}

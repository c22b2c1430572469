//! Neighbouring rays that meet shapes, eight at a time. (A picture's own rays go by tiles: see
//! `shapes.rs`.)
//!
//! 1. List what sixteen neighbours may meet, by a box around them all ([`Beam`]).
//! 2. Of the shapes of the list, intersect each with eight rays at a time. A ray that leaves a
//!    convex shape outwards does not meet it again.
//! 3. A ray that meets something has a state from then on. Most have none, and no more to meet.
//!
//! A shape is intersected as in `shapes.rs`, so the answers are those of the single rays, to the
//! bit.

use super::filter;
use super::ray_query::RayQuery;
use super::ray_state::RayState;
use super::scaled_ray::ScaledRay;
use super::shapes::{Columns, in_object, longest};
use crate::accel::RAYS;
use crate::geometry::{Beam, DVec3, ROUNDED, Ray, RayFilter, Rays, Transform, moderation};
use crate::scene::{CandidateList, Object, Scene};
use crate::shape::bundle::crossing;
use crate::shape::{Shape, Surface};
use crate::simd::{InLanes, Kernel, Lanes, WIDE, set_bits};

/// A group of up to sixteen neighbouring rays on their way. Most of them meet no shape, and need no
/// state of their own.
pub(super) struct Neighbours<'r, Q> {
    rays: &'r [Ray],
    /// All rays, and the number of the first.
    source: (&'r dyn Rays, usize),
    states: [Option<RayState<Q>>; RAYS],
    /// The rays that can meet anything, a bit each, and those of them of a length that needs no
    /// scaling.
    valid: u16,
    plain: u16,
}

impl<'r, Q: RayQuery> Neighbours<'r, Q> {
    /// Rays that were read from `source`, from a number on.
    #[inline(always)]
    pub(super) fn new(rays: &'r [Ray], source: (&'r dyn Rays, usize)) -> Self {
        Self { rays, source, states: [const { None }; RAYS], valid: 0, plain: 0 }
    }

    #[inline(always)]
    fn is_plain(&self, index: usize) -> bool {
        self.plain >> index & 1 == 1
    }

    #[inline(always)]
    fn state(&mut self, index: usize) -> &mut RayState<Q> {
        let Self { rays, source, .. } = self;
        self.states[index].get_or_insert_with(|| begun(&rays[index], (source.0, source.1 + index)))
    }

    /// The state of a ray, if it has one.
    #[inline(always)]
    pub(super) fn known(&self, index: usize) -> Option<&RayState<Q>> {
        self.states[index].as_ref()
    }

    /// Takes the state of a ray, which continues alone.
    #[inline(always)]
    pub(super) fn take(&mut self, index: usize) -> RayState<Q> {
        let (rays, number) = self.source;
        let state = self.states[index].take();
        state.unwrap_or_else(|| begun(&self.rays[index], (rays, number + index)))
    }

    /// Lists what the rays may meet, for all of them at once, and lets them meet the shapes of the
    /// list that lanes can do. `None` where each ray does better alone. A query for all crossings
    /// meets nothing here.
    #[inline(always)]
    pub(super) fn meet_shapes<'a, L: Lanes>(
        &mut self,
        l: L,
        scene: &'a Scene,
    ) -> Option<CandidateList<'a>> {
        if !scene.lists_candidates() {
            return None;
        }
        let mut beam = Beam::EMPTY;
        for (index, ray) in self.rays.iter().enumerate() {
            let is_valid = ray.is_valid();
            let is_plain = is_valid && moderation(ray.direction) == 1.0;
            self.valid |= u16::from(is_valid) << index;
            self.plain |= u16::from(is_plain) << index;
            if is_plain {
                beam.add(ray);
            } else if let Some(scaled) = ScaledRay::new(ray) {
                beam.add(&scaled.ray);
            }
        }
        let listed = scene.list_candidates(&beam)?;
        if listed.has_lone_shapes() && !Q::ALL {
            for first in (0..self.rays.len()).step_by(WIDE) {
                let eight = MeetShapes { scene, rays: self, first, listed };
                eight.run(l);
            }
        }
        Some(listed)
    }
}

/// The state of a ray that has met nothing, by its number.
#[inline(always)]
fn begun<Q: RayQuery>(ray: &Ray, (rays, number): (&dyn Rays, usize)) -> RayState<Q> {
    RayState::new(ray, Q::begin(rays, number), f64::INFINITY)
}

/// Intersects up to eight rays on their way through a scene with the lone shapes of a list.
struct MeetShapes<'r, 'n, 'a, Q> {
    scene: &'a Scene,
    rays: &'r mut Neighbours<'n, Q>,
    /// The first of the eight.
    first: usize,
    listed: CandidateList<'a>,
}

/// The state of the rays of a [`MeetShapes`].
struct Eight {
    columns: Columns,
    /// The rays that may meet more.
    alive: u8,
    masks: [u32; WIDE],
    /// The rays that leave a surface.
    departing: u8,
    /// The object that each of these leaves, which primitive of it, and the largest coordinate of
    /// that and of its start.
    left: [i32; WIDE],
    primitive: [i32; WIDE],
    coordinate: [f64; WIDE],
}

impl<Q: RayQuery> MeetShapes<'_, '_, '_, Q> {
    fn run<L: Lanes>(mut self, l: L) {
        let mut eight = self.load();
        for index in self.listed.lone_shapes() {
            if eight.alive == 0 {
                return;
            }
            let object = &self.scene.objects()[index as usize];
            let lanes = self.lanes_at(l, &mut eight, (index, object));
            if lanes == 0 {
                continue;
            }
            let (met, t, primitives) = l.call(CrossShape { object, eight: &eight });
            for lane in set_bits((met & lanes).into()) {
                let state = self.rays.state(self.first + lane);
                state.cross(self.scene, index, crossing(t[lane], primitives[lane]));
                eight.update(lane, state);
            }
        }
    }

    /// Loads the rays. Those that cannot go in lanes meet the shapes at once, one by one.
    #[inline(always)]
    fn load(&mut self) -> Eight {
        let mut eight = Eight {
            columns: Columns::NONE,
            alive: 0,
            masks: [u32::MAX; WIDE],
            departing: 0,
            left: [-1; WIDE],
            primitive: [-1; WIDE],
            coordinate: [0.0; WIDE],
        };
        let end = self.rays.rays.len().min(self.first + WIDE);
        for (lane, index) in (self.first..end).enumerate() {
            let ray = &self.rays.rays[index];
            if self.rays.valid >> index & 1 == 0 {
                continue;
            }
            let (source, first) = self.rays.source;
            let filter =
                if Q::IS_FILTERED { source.filter(first + index) } else { RayFilter::NONE };
            let leaves_out_none = filter.mask != 0
                && filter.only.is_none()
                && filter.cull.is_none()
                && filter.skip == [None; 2];
            if !leaves_out_none || !self.rays.is_plain(index) {
                let state = self.rays.state(index);
                for shape in self.listed.lone_shapes() {
                    state.come_to(self.scene, shape);
                }
                continue;
            }
            eight.columns.put(lane, ray);
            eight.alive |= 1 << lane;
            eight.masks[lane] = filter.mask;
            if let Some(departure) = filter.departure {
                let left = departure.surface;
                eight.departing |= 1 << lane;
                eight.left[lane] = left.object;
                eight.primitive[lane] = left.primitive;
                eight.coordinate[lane] = filter::largest_of_start(self.scene, ray.origin, left);
            }
        }
        eight
    }

    /// A bit for each ray that may meet every part of an object. Rays that leave the object meet it
    /// here, one by one.
    #[inline(always)]
    fn lanes_at<L: Lanes>(
        &mut self,
        l: L,
        eight: &mut Eight,
        (index, object): (u32, &Object),
    ) -> u8 {
        let mut lanes = eight.alive;
        if !Q::IS_FILTERED {
            return lanes;
        }
        if object.mask() != u32::MAX {
            for (lane, mask) in eight.masks.iter().enumerate() {
                lanes &= !(u8::from(object.mask() & mask == 0) << lane);
            }
        }
        let mut leaving = 0;
        for (lane, &left) in eight.left.iter().enumerate() {
            leaving |= u8::from(left == index.cast_signed()) << lane;
        }
        // Of a flat shape nothing is ahead, and of a convex one only inwards.
        let is_flat = matches!(object.shape(), Shape::Plane(_) | Shape::Disc(_));
        if lanes & leaving != 0 && !is_flat {
            let inwards = eight.inwards(l, object, lanes & leaving);
            for lane in set_bits(inwards.into()) {
                let state = self.rays.state(self.first + lane);
                state.come_to(self.scene, index);
                eight.update(lane, state);
            }
        }
        lanes & !leaving
    }
}

/// Tells which of eight rays go into a shape that they leave, by the test of [`filter::crossings`].
/// The compiler makes lanes of the loop.
struct GoInwards<'r, S> {
    shape: &'r S,
    transform: &'r Transform,
    eight: &'r Eight,
}

impl<S: Surface> Kernel for GoInwards<'_, S> {
    type Output = u8;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> u8 {
        let Self { shape, transform, eight } = self;
        let ([x, y, z], [u, v, w]) = (&eight.columns.origin, &eight.columns.direction);
        let mut along = [0.0; WIDE];
        for (lane, along) in along.iter_mut().enumerate() {
            let ray = Ray::new(
                DVec3::new(x[lane], y[lane], z[lane]),
                DVec3::new(u[lane], v[lane], w[lane]),
            );
            let ray = transform.ray_in_object(&ray);
            let normal = shape.normal(ray.origin, eight.primitive[lane]);
            *along = ray.direction.dot(normal);
        }
        let mut inwards = 0;
        for (lane, along) in along.into_iter().enumerate() {
            inwards |= u8::from(along < 0.0) << lane;
        }
        inwards
    }
}

/// Intersects eight rays with a shape: the lanes that meet it, their `t`, and the primitives. A
/// function of its own, one for all queries.
struct CrossShape<'r> {
    object: &'r Object,
    eight: &'r Eight,
}

impl Kernel for CrossShape<'_> {
    type Output = (u8, [f64; WIDE], [f64; WIDE]);

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> Self::Output {
        let Self { object, eight } = self;
        let mut ray = eight.columns.load(l);
        if eight.departing != 0 {
            // As `filter::in_object`.
            let start = l.load64(&eight.coordinate);
            let coordinate = l.max64(start, l.splat64(object.farthest()));
            let beyond = l.mul64(l.splat64(ROUNDED), coordinate);
            let after = l.max64(ray.t_min, l.div64(beyond, longest(l, &ray)));
            ray.t_min = l.select64(eight.departing, after, ray.t_min);
        }
        let (ray, valid) = in_object(l, object, &ray);
        let (mut t, mut primitives) = ([0.0; WIDE], [0.0; WIDE]);
        let Some(crossing) = object.shape().first_of_bundle(InLanes(l), &ray) else {
            return (0, t, primitives);
        };
        l.store64(crossing.t, &mut t);
        l.store64(crossing.primitive, &mut primitives);
        (crossing.is_met & valid, t, primitives)
    }
}

impl Eight {
    /// The rays, of some that leave an object, that go into it, a bit each.
    #[inline(always)]
    fn inwards<L: Lanes>(&self, l: L, object: &Object, leaving: u8) -> u8 {
        macro_rules! on {
            ($shape:expr) => {
                l.call(GoInwards { shape: $shape, transform: object.transform(), eight: self })
            };
        }
        let inwards = match object.shape() {
            // Flat shapes are never asked.
            Shape::Mesh(_) | Shape::Plane(_) | Shape::Disc(_) => return leaving,
            Shape::Sphere(sphere) => on!(&**sphere),
            Shape::Box(cuboid) => on!(&**cuboid),
            Shape::Cylinder(cylinder) => on!(cylinder.cone()),
            Shape::Cone(cone) => on!(&**cone),
        };
        leaving & inwards
    }

    /// Updates a ray's limit, and whether it is still open.
    #[inline(always)]
    fn update<Q: RayQuery>(&mut self, lane: usize, state: &RayState<Q>) {
        self.columns.t_max[lane] = state.limit();
        self.alive = self.alive & !(1 << lane) | u8::from(state.is_open()) << lane;
    }
}

//! All hits of rays through Embree, in order. Embree asks a filter function about every hit that it
//! finds; ours keeps the hit and refuses it, so that the ray continues. The hits of a block are
//! sorted by ray and `t`.

use std::ffi::{c_int, c_uint, c_void};

use super::api::Arguments;
use super::device::Scene;
use super::packet::{self, INVALID, RayHits};
use super::source::{BLOCK, Source};
use super::trace::{Door, Valid};

/// A hit of a ray of a block.
#[derive(Debug, Clone, Copy)]
struct Found {
    /// The ray's number in the block, then the bits of `t`, which is not negative: it sorts by
    /// both.
    order: u64,
    /// Object, primitive, and the bits of u and v, as firsthit gives them.
    surface: [u32; 4],
}

/// All hits of all rays.
#[derive(Debug, Default)]
pub(crate) struct Gathered {
    /// The start of each ray's hits, and the number of all hits in the end.
    offsets: Vec<usize>,
    found: Vec<Found>,
}

impl Gathered {
    /// `t`, object and primitive of each hit of a ray.
    pub(crate) fn hits(&self, ray: usize) -> impl ExactSizeIterator<Item = (f32, u32, u32)> {
        let found = &self.found[self.offsets[ray]..self.offsets[ray + 1]];
        found.iter().map(|found| {
            let [object, primitive, ..] = found.surface;
            (f32::from_bits(found.order as u32), object, primitive)
        })
    }

    /// Sorts the last hits, those of a block of `rays`, and counts them.
    fn close_block(&mut self, rays: usize) {
        let mut at = *self.offsets.last().expect("it begins with a zero");
        let block = &mut self.found[at..];
        block.sort_unstable_by_key(|found| found.order);
        let mut left = block.iter().peekable();
        for ray in 0..rays as u64 {
            while left.next_if(|found| found.order >> 32 == ray).is_some() {
                at += 1;
            }
            self.offsets.push(at);
        }
    }
}

/// `RTCRayQueryContext`, and what the filter needs behind it.
#[repr(C)]
struct Context<'a> {
    instance: [u32; 2],
    found: &'a mut Vec<Found>,
}

/// `RTCFilterFunctionNArguments`.
#[repr(C)]
struct FilterArguments {
    valid: *mut c_int,
    geometry_data: *mut c_void,
    context: *mut c_void,
    rays: *const u32,
    hits: *const u32,
    lanes: c_uint,
}

/// The starts of the fields of `RTCRayN` and `RTCHitN`, in lanes.
mod field {
    pub(super) const T_FAR: usize = 8;
    pub(super) const ID: usize = 10;
    pub(super) const U: usize = 3;
    pub(super) const V: usize = 4;
    pub(super) const PRIMITIVE: usize = 5;
    pub(super) const GEOMETRY: usize = 6;
    pub(super) const INSTANCE: usize = 7;
}

/// Keeps every hit, and refuses it.
unsafe extern "C" fn keep(arguments: *const FilterArguments) {
    // SAFETY: Embree gives its arguments, alive during the call. The context is the one that
    // `gather` made, which nothing else uses meanwhile. Rays and hits have `lanes` numbers of 4
    // bytes in each field.
    unsafe {
        let FilterArguments { valid, context, rays, hits, lanes, .. } = arguments.read();
        let context = &mut *context.cast::<Context<'_>>();
        let lanes = lanes as usize;
        for lane in 0..lanes {
            if *valid.add(lane) != -1 {
                continue;
            }
            let ray = |field: usize| *rays.add(field * lanes + lane);
            let hit = |field: usize| *hits.add(field * lanes + lane);
            context.found.push(Found {
                order: u64::from(ray(field::ID)) << 32 | u64::from(ray(field::T_FAR)),
                surface: [
                    packet::object(hit(field::INSTANCE), hit(field::GEOMETRY)),
                    hit(field::PRIMITIVE),
                    hit(field::U),
                    hit(field::V),
                ],
            });
            *valid.add(lane) = 0;
        }
    }
}

impl Scene<'_> {
    /// All hits of all rays. The scene is one for filter functions.
    pub(crate) fn all_hits(&self, source: &impl Source, door: Door, gathered: &mut Gathered) {
        match (door, self.width) {
            // SAFETY (of each call): the scene is committed and alive, and packets, valid masks and
            // arguments are as in `first_hits`.
            (Door::Single, _) => gather::<1>(source, door, gathered, |_, packet, arguments| {
                // SAFETY: see above.
                unsafe { (self.api.intersect1)(self.handle, packet, arguments) }
            }),
            (_, 16) => gather::<16>(source, door, gathered, |valid, packet, arguments| {
                // SAFETY: see above.
                unsafe { (self.api.intersect16)(valid.0.as_ptr(), self.handle, packet, arguments) }
            }),
            _ => gather::<8>(source, door, gathered, |valid, packet, arguments| {
                // SAFETY: see above.
                unsafe { (self.api.intersect8)(valid.0.as_ptr(), self.handle, packet, arguments) }
            }),
        }
    }
}

fn gather<const N: usize>(
    source: &impl Source,
    door: Door,
    gathered: &mut Gathered,
    call: impl Fn(&Valid<N>, &mut RayHits<N>, *mut Arguments),
) {
    gathered.offsets.clear();
    gathered.offsets.push(0);
    gathered.found.clear();
    let mut packet = RayHits::EMPTY;
    for block in 0..source.len().div_ceil(BLOCK) {
        let rays = BLOCK.min(source.len() - block * BLOCK);
        let mut context = Context { instance: [INVALID; 2], found: &mut gathered.found };
        let context = (&raw mut context).cast();
        let mut arguments =
            Arguments::filtered(door == Door::Coherent, keep as *mut c_void, context);
        for first in (0..rays).step_by(N) {
            packet.reset();
            source.fill(block, first, &mut packet.rays);
            packet.rays.id = std::array::from_fn(|k| (first + k) as u32);
            call(&Valid::below(rays - first), &mut packet, &raw mut arguments);
        }
        gathered.close_block(rays);
    }
}

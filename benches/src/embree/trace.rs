//! Rays through Embree's doors, results into planes.

use std::ffi::c_int;

use super::api::Arguments;
use super::device::Scene;
use super::packet::{INVALID, RayHits, Rays};
use super::plane::{Line, Plane, settle};
use super::source::{BLOCK, Source};

/// The function of Embree that rays are handed to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Door {
    /// `rtcIntersect1`, `rtcOccluded1`: one by one, as `Open3D`, trimesh and embreex do.
    Single,
    /// `rtcIntersect16`, `rtcOccluded16` (8 where 16 are not native) without a flag.
    Packet,
    /// The functions of packets with the flag for coherent rays.
    Coherent,
}

/// Embree's hit of each ray: `t`, object, primitive, u, v.
#[derive(Debug)]
pub(crate) struct Answers([Plane; 5]);

impl Answers {
    /// Room for `rays` answers.
    pub(crate) fn new(rays: usize) -> Self {
        Self(std::array::from_fn(|number| Plane::new(rays.next_multiple_of(BLOCK), number)))
    }

    /// `t`, object and primitive of the first hit of ray `index`, if any.
    pub(crate) fn hit(&self, index: usize) -> Option<(f32, u32, u32)> {
        let [t, object, primitive, ..] = &self.0;
        let object = object.get(index);
        (object != INVALID).then(|| (f32::from_bits(t.get(index)), object, primitive.get(index)))
    }

    /// Whether ray `index` was found to meet anything.
    pub(crate) fn is_occluded(&self, index: usize) -> bool {
        f32::from_bits(self.0[0].get(index)) < 0.0
    }
}

/// The mask of a packet's rays that count, -1 for yes.
#[repr(C, align(64))]
pub(super) struct Valid<const N: usize>(pub(super) [c_int; N]);

impl<const N: usize> Valid<N> {
    #[inline(always)]
    pub(super) fn below(rays: usize) -> Self {
        Self(std::array::from_fn(|k| if k < rays { -1 } else { 0 }))
    }
}

impl Scene<'_> {
    /// The first hits of all rays.
    pub(crate) fn first_hits(&self, source: &impl Source, door: Door, answers: &mut Answers) {
        let mut arguments = Arguments::new(door == Door::Coherent);
        let arguments = &raw mut arguments;
        // SAFETY (of the calls below): the scene is committed and alive; packets and valid masks
        // are laid out and aligned as Embree's headers want them; the arguments outlive the calls.
        match (door, self.width) {
            (Door::Single, _) => {
                first_hits::<1, _>(source, answers, |_, packet| {
                    // SAFETY: see above.
                    unsafe { (self.api.intersect1)(self.handle, packet, arguments) }
                });
            }
            (_, 16) => {
                first_hits::<16, _>(source, answers, |valid, packet| {
                    // SAFETY: see above.
                    unsafe {
                        (self.api.intersect16)(valid.0.as_ptr(), self.handle, packet, arguments);
                    }
                });
            }
            _ => {
                first_hits::<8, _>(source, answers, |valid, packet| {
                    // SAFETY: see above.
                    unsafe {
                        (self.api.intersect8)(valid.0.as_ptr(), self.handle, packet, arguments);
                    }
                });
            }
        }
        settle();
    }

    /// Whether the rays meet anything.
    pub(crate) fn any_hits(&self, source: &impl Source, door: Door, answers: &mut Answers) {
        let mut arguments = Arguments::new(door == Door::Coherent);
        let arguments = &raw mut arguments;
        // SAFETY (of the calls below): as in `first_hits`.
        match (door, self.width) {
            (Door::Single, _) => {
                any_hits::<1, _>(source, answers, |_, rays| {
                    // SAFETY: see above.
                    unsafe { (self.api.occluded1)(self.handle, rays, arguments) }
                });
            }
            (_, 16) => {
                any_hits::<16, _>(source, answers, |valid, rays| {
                    // SAFETY: see above.
                    unsafe {
                        (self.api.occluded16)(valid.0.as_ptr(), self.handle, rays, arguments);
                    }
                });
            }
            _ => {
                any_hits::<8, _>(source, answers, |valid, rays| {
                    // SAFETY: see above.
                    unsafe {
                        (self.api.occluded8)(valid.0.as_ptr(), self.handle, rays, arguments);
                    }
                });
            }
        }
        settle();
    }
}

/// Defines `$name` as `$slow`, run with the processor's wide registers where it has them: filling
/// packets must not hold Embree up.
macro_rules! wide {
    ($name:ident, $slow:ident, $packet:ident) => {
        fn $name<const N: usize, S: Source>(
            source: &S,
            answers: &mut Answers,
            call: impl Fn(&Valid<N>, &mut $packet<N>),
        ) {
            #[cfg(target_arch = "x86_64")]
            {
                use std::arch::is_x86_feature_detected as has;
                #[target_feature(enable = "avx2,fma")]
                fn wide<const N: usize, S: Source>(
                    source: &S,
                    answers: &mut Answers,
                    call: impl Fn(&Valid<N>, &mut $packet<N>),
                ) {
                    $slow(source, answers, call);
                }
                if has!("avx2") && has!("fma") {
                    // SAFETY: the processor was just asked for both.
                    return unsafe { wide(source, answers, call) };
                }
            }
            $slow(source, answers, call);
        }
    };
}

wide!(first_hits, first_hits_of_blocks, RayHits);
wide!(any_hits, any_hits_of_blocks, Rays);

#[inline(always)]
fn first_hits_of_blocks<const N: usize, S: Source>(
    source: &S,
    answers: &mut Answers,
    call: impl Fn(&Valid<N>, &mut RayHits<N>),
) {
    let mut packet = RayHits::EMPTY;
    for block in 0..source.len().div_ceil(BLOCK) {
        let mut local = [[0_u32; BLOCK]; 5];
        let rays = BLOCK.min(source.len() - block * BLOCK);
        for first in (0..rays).step_by(N) {
            packet.reset();
            source.fill(block, first, &mut packet.rays);
            call(&Valid::below(rays - first), &mut packet);
            let hits = &packet.hits;
            S::place(first, &packet.rays.t_far.map(f32::to_bits), &mut local[0]);
            S::place(first, &hits.objects(), &mut local[1]);
            S::place(first, &hits.primitive, &mut local[2]);
            S::place(first, &hits.u.map(f32::to_bits), &mut local[3]);
            S::place(first, &hits.v.map(f32::to_bits), &mut local[4]);
        }
        for (plane, results) in answers.0.iter_mut().zip(&local) {
            flush(source, block, results, plane);
        }
    }
}

#[inline(always)]
fn any_hits_of_blocks<const N: usize, S: Source>(
    source: &S,
    answers: &mut Answers,
    call: impl Fn(&Valid<N>, &mut Rays<N>),
) {
    let mut packet = RayHits::EMPTY;
    for block in 0..source.len().div_ceil(BLOCK) {
        let mut local = [0_u32; BLOCK];
        let rays = BLOCK.min(source.len() - block * BLOCK);
        for first in (0..rays).step_by(N) {
            packet.rays.t_near = [0.0; N];
            source.fill(block, first, &mut packet.rays);
            call(&Valid::below(rays - first), &mut packet.rays);
            S::place(first, &packet.rays.t_far.map(f32::to_bits), &mut local);
        }
        flush(source, block, &local, &mut answers.0[0]);
    }
}

#[inline(always)]
fn flush<S: Source>(source: &S, block: usize, results: &[u32; BLOCK], plane: &mut Plane) {
    for (line, numbers) in results.as_chunks::<16>().0.iter().enumerate() {
        plane.write(source.line(block, line), &Line(*numbers));
    }
}

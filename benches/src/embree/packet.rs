//! Embree's packets: `RTCRay`, `RTCRay8`, `RTCRay16` and what belongs to them, by their number of
//! rays.

/// The number of no geometry.
pub(super) const INVALID: u32 = u32::MAX;

/// `RTCRayN`: for `N` = 1, 8, 16 its size is a multiple of the alignment Embree asks for.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub(crate) struct Rays<const N: usize> {
    pub(super) origin: [[f32; N]; 3],
    pub(super) t_near: [f32; N],
    pub(super) direction: [[f32; N]; 3],
    time: [f32; N],
    pub(super) t_far: [f32; N],
    mask: [u32; N],
    pub(super) id: [u32; N],
    flags: [u32; N],
}

/// `RTCHitN`.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub(super) struct Hits<const N: usize> {
    normal: [[f32; N]; 3],
    pub(super) u: [f32; N],
    pub(super) v: [f32; N],
    pub(super) primitive: [u32; N],
    pub(super) geometry: [u32; N],
    pub(super) instance: [[u32; N]; 2],
}

impl<const N: usize> Hits<N> {
    /// The objects: instances, and geometries that are in none.
    #[inline(always)]
    pub(super) fn objects(&self) -> [u32; N] {
        std::array::from_fn(|k| object(self.instance[0][k], self.geometry[k]))
    }
}

/// The object that a hit is of.
#[inline(always)]
pub(super) fn object(instance: u32, geometry: u32) -> u32 {
    if instance == INVALID { geometry } else { instance }
}

/// `RTCRayHitN`.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct RayHits<const N: usize> {
    pub(super) rays: Rays<N>,
    pub(super) hits: Hits<N>,
}

impl<const N: usize> RayHits<N> {
    /// Rays from nowhere to nowhere.
    pub(super) const EMPTY: Self = Self {
        rays: Rays {
            origin: [[0.0; N]; 3],
            t_near: [0.0; N],
            direction: [[0.0; N]; 3],
            time: [0.0; N],
            t_far: [f32::INFINITY; N],
            mask: [u32::MAX; N],
            id: [0; N],
            flags: [0; N],
        },
        hits: Hits {
            normal: [[0.0; N]; 3],
            u: [0.0; N],
            v: [0.0; N],
            primitive: [INVALID; N],
            geometry: [INVALID; N],
            instance: [[INVALID; N]; 2],
        },
    };

    /// Makes ready for the next rays: nothing may be left of the hits before.
    #[inline(always)]
    pub(super) fn reset(&mut self) {
        self.rays.t_near = [0.0; N];
        self.hits.primitive = [INVALID; N];
        self.hits.geometry = [INVALID; N];
        self.hits.instance[0] = [INVALID; N];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::{offset_of, size_of};

    #[test]
    fn a_hit_in_an_instance_is_a_hit_of_that_object() {
        let mut packet = RayHits::<8>::EMPTY;
        packet.hits.geometry[..2].fill(0);
        packet.hits.instance[0][1] = 7;
        assert_eq!(packet.hits.objects()[..3], [0, 7, INVALID]);
        packet.reset();
        assert_eq!(packet.hits.objects(), [INVALID; 8]);
    }

    #[test]
    fn packets_are_laid_out_as_in_the_headers() {
        assert_eq!(size_of::<Rays<1>>(), 48);
        assert_eq!(size_of::<Rays<8>>(), 384);
        assert_eq!(size_of::<Rays<16>>(), 768);
        assert_eq!(offset_of!(RayHits<1>, hits), 48);
        assert_eq!(offset_of!(RayHits<16>, hits), 768);
        assert_eq!(offset_of!(Rays<16>, t_far), 8 * 64);
        assert_eq!(offset_of!(Hits<16>, geometry), 6 * 64);
    }
}

//! Sixteen rays from the world into the space of an object, eight at a time.
//!
//! 1. Test that each ray is an ordinary one: valid, ahead of its origin, and with a direction that
//!    can be squared.
//! 2. Transform its origin and its direction, operation for operation as
//!    [`Transform::ray_in_object`] does, so that the bits are the same.
//! 3. Test the transformed rays in the same way.

#![expect(
    clippy::needless_range_loop,
    reason = "for chains of iterators the compiler copies registers to memory"
)]

use super::packet::{Packet, largest_of, of, of_mut, vector};
use crate::geometry::{DMat3, Ray, Transform};
use crate::simd::Lanes;

impl Packet {
    /// Takes world rays into an object's space. Returns the ordinary ones: valid in both spaces,
    /// ahead of their origins, and with a direction that can be squared. The others are undefined
    /// afterwards.
    #[inline(always)]
    pub fn enter<L: Lanes>(&mut self, l: L, transform: &Transform) -> u16 {
        u16::from_le_bytes([self.enter_half(l, transform, 0), self.enter_half(l, transform, 1)])
    }

    #[inline(always)]
    fn enter_half<L: Lanes>(&mut self, l: L, transform: &Transform, half: usize) -> u8 {
        let number = |x: f64| l.splat64(x);
        let (origin, direction) = (vector(l, &self.origin, half), vector(l, &self.direction, half));
        let length = largest_of(l, &direction);
        let t_max = l.load64(of(&self.t_max, half));
        let plain = l.lt64(number(0.0), t_max)
            & l.lt64(l.load64(of(&self.t_min, half)), t_max)
            & l.le64(number(0.0), l.load64(of(&self.t_min, half)))
            & l.lt64(number(1e-99), length)
            & l.lt64(length, number(1e99))
            & up_to(l, &direction, f64::MAX)
            & up_to(l, &origin, Ray::FARTHEST);
        if transform.is_identity() {
            return plain;
        }
        // Operation for operation what `Transform::ray_in_object` does.
        let translation = transform.world_from_object().translation;
        let matrix = &transform.object_from_world().matrix3;
        let moved = [
            l.sub64(origin[0], number(translation.x)),
            l.sub64(origin[1], number(translation.y)),
            l.sub64(origin[2], number(translation.z)),
        ];
        let mut inside = [[number(0.0); 3]; 2];
        for axis in 0..3 {
            inside[0][axis] = product_along(l, matrix, axis, &moved);
            inside[1][axis] = product_along(l, matrix, axis, &direction);
            l.store64(inside[0][axis], of_mut(&mut self.origin[axis], half));
            l.store64(inside[1][axis], of_mut(&mut self.direction[axis], half));
        }
        let length = largest_of(l, &inside[1]);
        plain
            & up_to(l, &inside[0], Ray::FARTHEST)
            & up_to(l, &inside[1], f64::MAX)
            & l.lt64(number(0.0), length)
    }
}

/// The lanes in which no component of a vector exceeds `most`. Written so that a NaN fails.
#[inline(always)]
fn up_to<L: Lanes>(l: L, v: &[L::Doubles; 3], most: f64) -> u8 {
    let most = l.splat64(most);
    l.le64(l.abs64(v[0]), most) & l.le64(l.abs64(v[1]), most) & l.le64(l.abs64(v[2]), most)
}

/// A component of `matrix * v`, in the order of operations that glam has.
#[inline(always)]
#[doc(hidden)]
pub fn product_along<L: Lanes>(
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

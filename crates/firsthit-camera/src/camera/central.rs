//! Lenses through which all rays start at the camera's position: a direction for each point of the
//! picture.

#![allow(
    clippy::inline_always,
    reason = "inlined into a kernel, it is compiled for the kernel's instruction set"
)]

use super::lens::{Model, Reach};
use super::pose::Pose;
use super::quick::{Known, Pair, square};
use crate::error::Result;
use crate::geometry::arithmetic::{Arithmetic, PairOfMasks, Pairs, Scalar};
use crate::geometry::{DVec2, DVec3, PixelGrid, Ray, arrays};
use crate::simd::{InLanes, InstructionSet, Kernel, Lanes, WIDE, run};

/// The contract of every such lens. Directions are in the camera's coordinates x to the right, y
/// down, z ahead, as in OpenCV; pixel coordinates are counted from the picture's upper left corner,
/// to the right and down. `size` is rows and columns.
pub(super) trait Central: Send + Sync {
    /// Whether its directions have length one, but for rounding.
    const IS_UNIT: bool = false;

    /// Checks its numbers for a picture of a size, and computes what depends on them alone.
    fn prepare(&mut self, _size: [usize; 2]) -> Result<()> {
        Ok(())
    }
    /// The direction that is seen at a point of the picture, of any length; `None` where nothing
    /// is.
    fn direction(&self, size: [usize; 2], pixel: DVec2) -> Option<DVec3>;
    /// The directions for a single point or for several at once, with a mask of where they are
    /// known. Elsewhere [`direction`](Self::direction) decides.
    #[inline(always)]
    fn directions<A: Arithmetic>(&self, of: A, _size: [usize; 2], _pixel: Pair<A>) -> Known<A, 3>
    where
        Self: Sized,
    {
        let nothing = of.number(0.0);
        ([nothing; 3], of.lt(nothing, nothing))
    }
    /// The point of the picture at which a direction is seen, be it beyond its edges; `None` for
    /// none.
    fn pixel(&self, size: [usize; 2], direction: DVec3) -> Option<DVec2>;
    /// The lens of a part of the picture from a row and a column on, where there is one.
    fn cropped(&self, _first: [usize; 2]) -> Option<Self>
    where
        Self: Sized,
    {
        None
    }
    /// The lens for the same picture at `factors` times its rows and columns.
    fn scaled(&self, factors: [f64; 2]) -> Self
    where
        Self: Copy;
}

/// A direction in the camera's coordinates to one in the world's, of length one.
#[inline(always)]
fn in_world<C: Central, A: Arithmetic>(
    of: A,
    pose: &Pose,
    [x, y, z]: [A::Number; 3],
) -> [A::Number; 3] {
    // A closure would not be compiled for the instruction set.
    macro_rules! along {
        ($axis:ident) => {{
            let across = of.mul(x, of.number(pose.right.$axis));
            let down = of.mul(y, of.number(pose.upwards.$axis));
            let ahead = of.mul(z, of.number(pose.aim.$axis));
            of.add(of.sub(across, down), ahead)
        }};
    }
    let [x, y, z] = [along!(x), along!(y), along!(z)];
    if C::IS_UNIT {
        return [x, y, z];
    }
    let length = of.sqrt(of.add(square(of, x, y), of.mul(z, z)));
    let inverse = of.div(of.number(1.0), length);
    [of.mul(x, inverse), of.mul(y, inverse), of.mul(z, inverse)]
}

/// The direction of the ray through a point of the picture; NaN where nothing is seen.
#[inline(always)]
fn direction_at<C: Central>(lens: &C, pose: &Pose, size: [usize; 2], pixel: DVec2) -> DVec3 {
    let (quick, is_known) = lens.directions(Scalar, size, pixel.to_array());
    let direction = if is_known {
        Some(quick)
    } else {
        lens.direction(size, pixel).map(|direction| direction.to_array())
    };
    let direction = direction.map(|direction| in_world::<C, _>(Scalar, pose, direction).into());
    direction.unwrap_or(DVec3::NAN)
}

/// The coordinates of a pixel's point: offsets run upwards, rows downwards.
#[inline(always)]
fn pixel_at([row, column]: [usize; 2], offset: DVec2) -> DVec2 {
    DVec2::new(column as f64 + offset.x, row as f64 + (1.0 - offset.y))
}

/// Makes the directions of some pixels of a row.
struct RowOfDirections<'a, C> {
    lens: &'a C,
    pose: &'a Pose,
    size: [usize; 2],
    first: [usize; 2],
    offset: DVec2,
    directions: [&'a mut [f64]; 3],
}

impl<C: Central> Kernel for RowOfDirections<'_, C> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let [row, first] = self.first;
        let [x, y, z] = self.directions;
        if !L::HAS_PACKETS {
            for k in 0..x.len() {
                let pixel = pixel_at([row, first + k], self.offset);
                (x[k], y[k], z[k]) = slow(self.lens, self.pose, self.size, pixel).into();
            }
            return;
        }
        let down = l.splat64(pixel_at([row, first], self.offset).y);
        // Iterators of several slices would be calls.
        for start in (0..x.len()).step_by(AT_ONCE) {
            let end = x.len().min(start + AT_ONCE);
            let [x, y, z] = [&mut x[start..end], &mut y[start..end], &mut z[start..end]];
            let column = first + start;
            let across: [f64; AT_ONCE] =
                arrays::from_fn(|k| pixel_at([row, column + k], self.offset).x);
            let (halves, _) = across.as_chunks();
            let of = Pairs(InLanes(l));
            let across = [l.load64(&halves[0]), l.load64(&halves[1])];
            let (direction, known) = self.lens.directions(of, self.size, [across, [down; 2]]);
            let direction = in_world::<C, _>(of, self.pose, direction);
            store(l, direction[0], x);
            store(l, direction[1], y);
            store(l, direction[2], z);
            let PairOfMasks([low, high]) = known;
            let known = u16::from_le_bytes([low, high]);
            if known != u16::MAX {
                for k in (0..x.len()).filter(|k| known >> k & 1 == 0) {
                    let pixel = pixel_at([row, column + k], self.offset);
                    let direction = slow(self.lens, self.pose, self.size, pixel);
                    (x[k], y[k], z[k]) = direction.into();
                }
            }
        }
    }
}

/// Pixels that are computed together: twice as many as there are lanes, for each step waits for the
/// one before.
const AT_ONCE: usize = 2 * WIDE;

/// Stores as many of sixteen numbers as there is room for.
#[inline(always)]
fn store<L: Lanes>(l: L, [low, high]: [L::Doubles; 2], to: &mut [f64]) {
    if let (halves, []) = to.as_chunks_mut()
        && let [first, second] = halves
    {
        l.store64(low, first);
        l.store64(high, second);
        return;
    }
    let mut lanes = [[0.0; WIDE]; 2];
    l.store64(low, &mut lanes[0]);
    l.store64(high, &mut lanes[1]);
    for k in 0..to.len() {
        to[k] = lanes[k / WIDE][k % WIDE];
    }
}

/// [`direction_at`] as a function of its own: it is rarely called.
#[inline(never)]
fn slow<C: Central>(lens: &C, pose: &Pose, size: [usize; 2], pixel: DVec2) -> DVec3 {
    direction_at(lens, pose, size, pixel)
}

impl<C: Central> Model for C {
    fn prepare(&mut self, size: [usize; 2]) -> Result<()> {
        Central::prepare(self, size)
    }

    fn ray(&self, pose: &Pose, size: [usize; 2], pixel: [usize; 2], offset: DVec2) -> Ray {
        let direction = direction_at(self, pose, size, pixel_at(pixel, offset));
        Ray::new(pose.position, direction)
    }

    fn directions(
        &self,
        set: InstructionSet,
        pose: &Pose,
        size: [usize; 2],
        first: [usize; 2],
        offset: DVec2,
        directions: [&mut [f64]; 3],
    ) {
        let row = RowOfDirections { lens: self, pose, size, first, offset, directions };
        run(set, row);
    }

    fn project(&self, size: [usize; 2], point: DVec3) -> Option<DVec2> {
        // The camera itself is in no direction, for which an arc tangent would give one.
        if point == DVec3::ZERO {
            return None;
        }
        let pixel = self.pixel(size, point)?;
        pixel.is_finite().then_some(pixel)
    }

    fn reach(&self, pose: &Pose, size: [usize; 2], pixel: [usize; 2]) -> Reach {
        let ray = self.ray(pose, size, pixel, PixelGrid::CENTRE);
        Reach { offset: 0.0, cosine: ray.direction.dot(pose.aim) }
    }
}

//! Lenses through which all rays start at the camera's position: a direction for each point of the picture.

#![allow(
    clippy::inline_always,
    reason = "inlined into a kernel, it is compiled for the kernel's instruction set"
)]

use super::lens::{Model, Reach};
use super::parameters::Parameters;
use super::pose::Pose;
use super::quick::square;
use crate::error::Result;
use crate::geometry::arithmetic::{Arithmetic, Scalar};
use crate::geometry::{DVec2, DVec3, PixelGrid, Ray};
use crate::simd::{InLanes, InstructionSet, Kernel, Lanes, WIDE, run};

/// What every such lens can do. Directions are in the camera's coordinates x to the right, y down, z ahead, as in OpenCV; pixel
/// coordinates are counted from the picture's upper left corner, to the right and down. `size` is rows and columns.
pub(super) trait Central: Parameters + Send + Sync {
    /// Checks its numbers for a picture of a size, and computes what depends on them alone.
    fn prepare(&mut self, size: [usize; 2]) -> Result<()>;
    /// The direction that is seen at a point of the picture, of any length; `None` where nothing is.
    fn direction(&self, size: [usize; 2], pixel: DVec2) -> Option<DVec3>;
    /// The same for a single point or for several at once, and where it is known: there it is what counts, elsewhere
    /// [`direction`](Self::direction) is.
    #[inline(always)]
    fn directions<A: Arithmetic>(
        &self,
        of: A,
        _size: [usize; 2],
        _pixel: [A::Number; 2],
    ) -> ([A::Number; 3], A::Mask)
    where
        Self: Sized,
    {
        let nothing = of.number(0.0);
        ([nothing; 3], of.lt(nothing, nothing))
    }
    /// Where in the picture a direction is seen, be it beyond its edges; `None` for nowhere.
    fn pixel(&self, size: [usize; 2], direction: DVec3) -> Option<DVec2>;
    /// The lens of a part of the picture from a row and a column on, where there is one.
    fn cropped(&self, _first: [usize; 2]) -> Option<Self>
    where
        Self: Sized,
    {
        None
    }
    /// The lens of the same picture with so many times the rows and columns.
    fn scaled(&self, factors: [f64; 2]) -> Self
    where
        Self: Sized;
}

/// A direction in the camera's coordinates to one in the world's, of length one.
#[inline(always)]
fn in_world<A: Arithmetic>(of: A, pose: &Pose, [x, y, z]: [A::Number; 3]) -> [A::Number; 3] {
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
    let length = of.sqrt(of.add(square(of, x, y), of.mul(z, z)));
    let inverse = of.div(of.number(1.0), length);
    [of.mul(x, inverse), of.mul(y, inverse), of.mul(z, inverse)]
}

/// The ray through a point of the picture.
#[inline(always)]
fn ray_at<C: Central>(lens: &C, pose: &Pose, size: [usize; 2], pixel: DVec2) -> Ray {
    let (quick, is_known) = lens.directions(Scalar, size, pixel.to_array());
    let direction = if is_known {
        Some(quick)
    } else {
        lens.direction(size, pixel)
            .map(|direction| direction.to_array())
    };
    let direction = direction.map(|direction| in_world(Scalar, pose, direction).into());
    Ray::new(pose.position, direction.unwrap_or(DVec3::NAN))
}

/// The coordinates of a pixel's point: offsets run upwards, rows downwards.
#[inline(always)]
fn pixel_at([row, column]: [usize; 2], offset: DVec2) -> DVec2 {
    DVec2::new(column as f64 + offset.x, row as f64 + (1.0 - offset.y))
}

/// Makes the rays of some pixels of a row.
struct RowOfRays<'a, C> {
    lens: &'a C,
    pose: &'a Pose,
    size: [usize; 2],
    first: [usize; 2],
    offset: DVec2,
    rays: &'a mut [Ray],
}

impl<C: Central> Kernel for RowOfRays<'_, C> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let [row, first] = self.first;
        for (group, rays) in self.rays.chunks_mut(WIDE).enumerate() {
            let column = first + group * WIDE;
            let mut across = [0.0; WIDE];
            for (k, x) in across.iter_mut().enumerate() {
                *x = pixel_at([row, column + k], self.offset).x;
            }
            let down = l.splat64(pixel_at([row, column], self.offset).y);
            let (direction, known) =
                self.lens
                    .directions(InLanes(l), self.size, [l.load64(&across), down]);
            let direction = in_world(InLanes(l), self.pose, direction);
            let mut lanes = [[0.0; WIDE]; 3];
            for (lanes, direction) in lanes.iter_mut().zip(direction) {
                l.store64(direction, lanes);
            }
            for (k, ray) in rays.iter_mut().enumerate() {
                *ray = if known >> k & 1 == 1 {
                    let direction = DVec3::new(lanes[0][k], lanes[1][k], lanes[2][k]);
                    Ray::new(self.pose.position, direction)
                } else {
                    let pixel = pixel_at([row, column + k], self.offset);
                    slow(self.lens, self.pose, self.size, pixel)
                };
            }
        }
    }
}

/// [`ray_at`] as a function of its own: it is rarely called.
#[inline(never)]
fn slow<C: Central>(lens: &C, pose: &Pose, size: [usize; 2], pixel: DVec2) -> Ray {
    ray_at(lens, pose, size, pixel)
}

impl<C: Central> Model for C {
    fn prepare(&mut self, size: [usize; 2]) -> Result<()> {
        Central::prepare(self, size)
    }

    fn ray(&self, pose: &Pose, size: [usize; 2], pixel: [usize; 2], offset: DVec2) -> Ray {
        ray_at(self, pose, size, pixel_at(pixel, offset))
    }

    fn row(
        &self,
        set: InstructionSet,
        pose: &Pose,
        size: [usize; 2],
        first: [usize; 2],
        offset: DVec2,
        rays: &mut [Ray],
    ) {
        let row = RowOfRays {
            lens: self,
            pose,
            size,
            first,
            offset,
            rays,
        };
        run(set, row);
    }

    fn project(&self, size: [usize; 2], point: DVec3) -> Option<DVec2> {
        let pixel = self.pixel(size, point)?;
        pixel.is_finite().then_some(pixel)
    }

    fn reach(&self, pose: &Pose, size: [usize; 2], pixel: [usize; 2]) -> Reach {
        let ray = self.ray(pose, size, pixel, PixelGrid::CENTRE);
        Reach {
            offset: 0.0,
            cosine: ray.direction.dot(pose.aim),
        }
    }
}

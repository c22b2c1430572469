//! Calibrated cameras: a distortion, which takes directions to a normalised image, and the matrix that takes that to pixels.

#![allow(
    clippy::inline_always,
    reason = "inlined into a kernel, it is compiled for the kernel's instruction set"
)]

use super::central::Central;
use super::distortion::{Distortion, Limit};
use super::parameters::Parameters;
use super::pixel_matrix::PixelMatrix;
use crate::error::Result;
use crate::geometry::arithmetic::Arithmetic;
use crate::geometry::{DVec2, DVec3};

/// A calibrated camera with one of the models of [`distortion`](super::distortion). Rays start at the camera.
///
/// ```
/// use firsthit::camera::{Calibrated, PixelMatrix, distortion::OpenCv};
/// use firsthit::{Camera, Lens, View};
///
/// let matrix = PixelMatrix { fx: 600.0, fy: 600.0, cx: 320.0, cy: 240.0, skew: 0.0 };
/// let barrel = OpenCv { k1: -0.2, k2: 0.05, ..OpenCv::default() };
/// let lens = Lens::OpenCv(Calibrated::new(matrix, barrel));
/// let camera = Camera::new(View { lens, ..View::default() })?;
/// let pixel = camera.project(camera.ray(3, 5).at(7.0)).unwrap();
/// assert!((pixel.x - 5.5).abs() < 1e-9 && (pixel.y - 3.5).abs() < 1e-9);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, Default)]
pub struct Calibrated<D> {
    /// From the normalised image to pixels.
    pub matrix: PixelMatrix,
    /// From directions to the normalised image.
    pub distortion: D,
    limit: Limit,
}

impl<D> Calibrated<D> {
    /// The two together. [`Camera::new`](super::Camera::new) checks them.
    pub fn new(matrix: PixelMatrix, distortion: D) -> Self {
        let limit = Limit::default();
        Self {
            matrix,
            distortion,
            limit,
        }
    }
}

/// The lens whose limit, as a circle around the middle, touches the longer edges of the picture.
pub(super) fn within<D: Distortion>(
    distortion: D,
    [rows, columns]: [usize; 2],
) -> Result<Calibrated<D>> {
    let radius = distortion.limit(0.0)?.distorted;
    let focal_length = 0.5 * rows.min(columns).max(1) as f64 / radius;
    let matrix = PixelMatrix {
        fx: focal_length,
        fy: focal_length,
        cx: 0.5 * columns as f64,
        cy: 0.5 * rows as f64,
        skew: 0.0,
    };
    Ok(Calibrated::new(matrix, distortion))
}

/// The limit follows from the others.
impl<D: PartialEq> PartialEq for Calibrated<D> {
    fn eq(&self, other: &Self) -> bool {
        self.matrix == other.matrix && self.distortion == other.distortion
    }
}

impl<D: Parameters> Parameters for Calibrated<D> {
    fn each(&mut self, visit: &mut dyn FnMut(&'static str, &mut f64)) {
        self.matrix.each(visit);
        self.distortion.each(visit);
    }
}

impl<D: Distortion> Central for Calibrated<D> {
    const IS_UNIT: bool = D::IS_UNIT;

    fn prepare(&mut self, [rows, columns]: [usize; 2]) -> Result<()> {
        self.matrix.check()?;
        let mut fine = Ok(());
        self.distortion.each(&mut |name, value| {
            if fine.is_ok() {
                fine = crate::geometry::require(name, "finite", value.is_finite(), *value);
            }
        });
        fine?;
        let ends = |count: usize| [0.0, count as f64];
        let corners = ends(columns).map(|x| ends(rows).map(|y| DVec2::new(x, y)));
        let corners = corners.iter().flatten();
        let radii = corners.map(|&corner| self.matrix.point(corner).length());
        self.limit = self.distortion.limit(radii.fold(0.0, f64::max))?;
        Ok(())
    }

    #[inline(always)]
    fn directions<A: Arithmetic>(
        &self,
        of: A,
        _: [usize; 2],
        [u, v]: [A::Number; 2],
    ) -> ([A::Number; 3], A::Mask) {
        // Operation for operation what `PixelMatrix::point` does.
        let PixelMatrix {
            fx,
            fy,
            cx,
            cy,
            skew,
        } = self.matrix;
        let y = of.mul(of.sub(v, of.number(cy)), of.number(fy.recip()));
        let across = of.sub(of.sub(u, of.number(cx)), of.mul(of.number(skew), y));
        let x = of.mul(across, of.number(fx.recip()));
        self.distortion.directions(of, &self.limit, [x, y])
    }

    fn direction(&self, _: [usize; 2], pixel: DVec2) -> Option<DVec3> {
        self.distortion
            .unproject(&self.limit, self.matrix.point(pixel))
    }

    fn pixel(&self, _: [usize; 2], direction: DVec3) -> Option<DVec2> {
        let point = self.distortion.project(&self.limit, direction)?;
        Some(self.matrix.pixel(point))
    }

    fn cropped(&self, first: [usize; 2]) -> Option<Self> {
        let matrix = self.matrix.cropped(first);
        Some(Self { matrix, ..*self })
    }

    fn scaled(&self, factors: [f64; 2]) -> Self {
        let matrix = self.matrix.scaled(factors);
        Self { matrix, ..*self }
    }
}

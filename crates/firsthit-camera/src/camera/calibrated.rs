//! Calibrated cameras: a distortion, which takes directions to a normalised image, and the matrix
//! that takes that to pixels.

#![allow(
    clippy::inline_always,
    reason = "inlined into a kernel, it is compiled for the kernel's instruction set"
)]

use super::central::Central;
use super::distortion::{Distortion, Limit};
use super::parameters::Parameters;
use super::pixel_matrix::PixelMatrix;
use super::quick::{Known, Pair, square};
use super::thin_lens::{THIN_LENS, check_thin_lens};
use crate::error::Result;
use crate::geometry::arithmetic::{Arithmetic, Scalar};
use crate::geometry::{DVec2, DVec3, Setting, Settings, Value, require};

/// A calibrated camera with one of the models of [`distortion`](super::distortion). Rays start at
/// the camera.
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
    /// The map from the normalised image to pixels.
    pub matrix: PixelMatrix,
    /// The map from directions to the normalised image.
    pub distortion: D,
    /// The diameter of the lens, for the colours of pictures with several samples; 0 is a pinhole.
    /// See [`Camera::thin_lens`](super::Camera::thin_lens).
    pub aperture: f64,
    /// The distance along the aim from the camera to the plane in focus; 0 by default, as of a
    /// pinhole.
    pub focus: f64,
    limit: Limit,
    /// The shear of directions, subtracted from x / z and y / z, where the camera is at a point of
    /// a lens.
    shear: DVec2,
}

impl<D> Calibrated<D> {
    /// The two together. [`Camera::new`](super::Camera::new) checks them.
    pub fn new(matrix: PixelMatrix, distortion: D) -> Self {
        Self {
            matrix,
            distortion,
            aperture: 0.0,
            focus: 0.0,
            limit: Limit::default(),
            shear: DVec2::ZERO,
        }
    }
}

/// The lens whose limit, as a circle around the middle, touches the longer edges of the picture.
pub(super) fn within<D: Distortion + Settings>(
    distortion: D,
    [rows, columns]: [usize; 2],
) -> Result<Calibrated<D>> {
    distortion.check()?;
    let radius = distortion.limit(0.0).distorted;
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
        let lens = |of: &Self| (of.aperture, of.focus, of.shear);
        self.matrix == other.matrix
            && self.distortion == other.distortion
            && lens(self) == lens(other)
    }
}

impl<D: Distortion + Settings> Parameters for Calibrated<D> {
    fn each(&mut self, visit: &mut dyn FnMut(&'static Setting, &mut f64)) {
        self.matrix.each(visit);
        self.distortion.each(visit);
        if D::IS_PERSPECTIVE {
            let [aperture, focus] = &THIN_LENS;
            visit(aperture, &mut self.aperture);
            visit(focus, &mut self.focus);
        }
    }

    /// Cameras without a lens do not speak of one, nor polynomials that see all around of an end.
    fn is_silent(&self, name: &str) -> bool {
        let has_lens = self.aperture != 0.0 || self.focus != 0.0;
        let all_around = ("fov", Value::Number(360.0));
        match name {
            "aperture" | "focus" => !has_lens,
            "fov" => D::LIST.len() > 1 && self.distortion.named_values().contains(&all_around),
            _ => false,
        }
    }
}

impl<D: Copy> Calibrated<D> {
    /// The lens as it is from a point of its aperture, so much to the right and upwards of the
    /// camera's position: what is in focus is seen at the same places. It is a pinhole's.
    ///
    /// Let a pixel's ray go to the point `focus (x, y, 1)`. From the point (a, -b, 0) that is in
    /// the direction of (x - a / focus, y + b / focus, 1).
    pub(super) fn seen_from(&self, point: DVec2) -> Self {
        Self {
            aperture: 0.0,
            focus: 0.0,
            shear: DVec2::new(point.x, -point.y) / self.focus,
            ..*self
        }
    }

    /// A direction of the distortion's to one of the camera at its point of the lens.
    #[inline(always)]
    fn sheared<A: Arithmetic>(&self, of: A, [x, y, z]: [A::Number; 3]) -> [A::Number; 3]
    where
        D: Distortion,
    {
        if self.shear == DVec2::ZERO {
            return [x, y, z];
        }
        let x = of.sub(x, of.mul(of.number(self.shear.x), z));
        let y = of.sub(y, of.mul(of.number(self.shear.y), z));
        if !D::IS_UNIT {
            return [x, y, z];
        }
        let length = of.sqrt(of.add(square(of, x, y), of.mul(z, z)));
        let inverse = of.div(of.number(1.0), length);
        [of.mul(x, inverse), of.mul(y, inverse), of.mul(z, inverse)]
    }
}

impl<D: Distortion> Central for Calibrated<D> {
    const IS_UNIT: bool = D::IS_UNIT;

    fn prepare(&mut self, [rows, columns]: [usize; 2]) -> Result<()> {
        check_thin_lens(self.aperture, self.focus)?;
        let expected = "zero for a tilted sensor: what is in focus would be tilted too";
        let fine = self.aperture == 0.0 || !self.distortion.is_tilted();
        require("aperture", expected, fine, self.aperture)?;
        let ends = |count: usize| [0.0, count as f64];
        let corners = ends(columns).map(|x| ends(rows).map(|y| DVec2::new(x, y)));
        let corners = corners.iter().flatten();
        let radii = corners.map(|&corner| self.matrix.point(corner).length());
        self.limit = self.distortion.limit(radii.fold(0.0, f64::max));
        Ok(())
    }

    #[inline(always)]
    fn directions<A: Arithmetic>(&self, of: A, _: [usize; 2], [u, v]: Pair<A>) -> Known<A, 3> {
        // Operation for operation what `PixelMatrix::point` does.
        let PixelMatrix { fx, fy, cx, cy, skew } = self.matrix;
        let y = of.mul(of.sub(v, of.number(cy)), of.number(fy.recip()));
        let across = of.sub(of.sub(u, of.number(cx)), of.mul(of.number(skew), y));
        let x = of.mul(across, of.number(fx.recip()));
        let (direction, known) = self.distortion.directions(of, &self.limit, [x, y]);
        (self.sheared(of, direction), known)
    }

    fn direction(&self, _: [usize; 2], pixel: DVec2) -> Option<DVec3> {
        let point = self.matrix.point(pixel);
        let direction = self.distortion.unproject(&self.limit, point)?;
        Some(self.sheared(Scalar, direction.to_array()).into())
    }

    fn pixel(&self, _: [usize; 2], direction: DVec3) -> Option<DVec2> {
        let whole = direction + (self.shear * direction.z).extend(0.0);
        let point = self.distortion.project(&self.limit, whole)?;
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

//! A flat viewplane: perspective where rays run through the camera's position, orthographic where they are parallel.

use super::lens::{Model, Reach};
use super::pose::Pose;
use crate::error::Result;
use crate::geometry::{DVec2, PixelGrid, Ray, named, require_positive};

/// A flat viewplane in front of the camera. Lengths are in scene units.
///
/// ```
/// use firsthit::{Camera, DVec3, Lens, View, Viewplane};
///
/// // Parallel rays, ten units from the lower to the upper edge.
/// let viewplane = Viewplane { width: 16.0, height: 10.0, parallel: true, ..Viewplane::default() };
/// let camera = Camera::new(View { lens: Lens::Flat(viewplane), ..View::default() })?;
/// assert_eq!(camera.ray(0, 0).direction, DVec3::NEG_Z);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewplane {
    /// Its distance from the camera, `z_p`.
    pub focal_length: f64,
    /// Its width, `w`.
    pub width: f64,
    /// Its height, `h`.
    pub height: f64,
    /// Whether all rays are parallel to the aim; else they run through the camera's position.
    pub parallel: bool,
    /// Where rays start.
    pub ray_start: RayStart,
}

impl Default for Viewplane {
    /// Of 4/3 by 1, at distance one; rays run through the camera's position and start on the viewplane.
    fn default() -> Self {
        Self {
            focal_length: 1.0,
            width: 4.0 / 3.0,
            height: 1.0,
            parallel: false,
            ray_start: RayStart::Viewplane,
        }
    }
}

named! {
    /// Where a camera's rays start.
    ///
    /// ```
    /// use firsthit::{Camera, DVec3, Lens, RayStart, View, Viewplane};
    ///
    /// let lens = Lens::Flat(Viewplane { focal_length: 2.0, ..Viewplane::default() });
    /// let camera = Camera::new(View { lens, ..View::default() })?;
    /// assert_eq!(camera.ray(240, 320).origin.z, -2.0);
    /// assert_eq!(camera.starting_at(RayStart::Eye).ray(240, 320).origin, DVec3::ZERO);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub enum RayStart, "ray_start":
    /// On the viewplane: what lies between the camera and the viewplane is not seen.
    #[default]
    "viewplane" => Viewplane;
    /// At the camera's position; for parallel rays, on the plane through it.
    "eye" => Eye;
}

impl Viewplane {
    fn pixels(&self, pose: &Pose, [rows, columns]: [usize; 2], offset: DVec2) -> PixelGrid {
        PixelGrid {
            rows,
            columns,
            first: [0, 0],
            whole: [rows, columns],
            position: pose.position,
            toward: self.focal_length * pose.aim,
            right: pose.right,
            upwards: pose.upwards,
            width: self.width,
            height: self.height,
            parallel: self.parallel.then_some(pose.aim),
            starts_on_viewplane: self.ray_start == RayStart::Viewplane,
            offset,
        }
    }
}

impl Model for Viewplane {
    fn check(&self) -> Result<()> {
        require_positive("focal_length", self.focal_length)?;
        require_positive("width", self.width)?;
        require_positive("height", self.height)?;
        Ok(())
    }

    fn ray(&self, pose: &Pose, size: [usize; 2], [row, column]: [usize; 2], offset: DVec2) -> Ray {
        self.pixels(pose, size, offset).ray(row, column)
    }

    fn reach(&self, pose: &Pose, size: [usize; 2], [row, column]: [usize; 2]) -> Reach {
        let grid = self.pixels(pose, size, PixelGrid::CENTRE);
        let (distance, cosine) = if self.parallel {
            (self.focal_length, 1.0)
        } else {
            let distance = grid.point(row, column).length();
            (distance, self.focal_length / distance)
        };
        let offset = if grid.starts_on_viewplane {
            distance
        } else {
            0.0
        };
        Reach { offset, cosine }
    }

    fn grid(&self, pose: &Pose, size: [usize; 2], offset: DVec2) -> Option<PixelGrid> {
        Some(self.pixels(pose, size, offset))
    }
}

//! Places a camera so that a scene, given by its support function, fills the picture.
//!
//! A scene is inside a half-space if its support along the plane's normal is at most the plane's
//! offset. For a perspective camera:
//!
//! 1. The left and the right plane of the view frustum, and likewise the upper and the lower one,
//!    make a wedge of known slope. Two values of the support function say from which depth on the
//!    scene fits into a wedge.
//! 2. The eye is put at the smaller of the two wedges' depths: there the scene touches both planes
//!    of one wedge.
//! 3. The other wedge has room. The eye is centred in it by narrowing the wedge until it touches on
//!    both sides, by false position.
//!
//! An orthographic viewplane is the scene's extent along the two axes of the picture.

use super::Viewplane;
use super::pose::Pose;
use crate::error::Result;
use crate::geometry::{DVec3, require};

/// The ratio of the picture's size to that of the scene in it.
pub(super) const MARGIN: f64 = 1.05;

/// The scene's extent along an axis.
#[derive(Clone, Copy)]
struct Extent {
    low: f64,
    high: f64,
}

impl Extent {
    fn of(axis: DVec3, support: &impl Fn(DVec3) -> f64) -> Result<Self> {
        Ok(Self { low: -finite(-axis, support)?, high: finite(axis, support)? })
    }

    fn middle(self) -> f64 {
        0.5 * self.low + 0.5 * self.high
    }

    fn length(self) -> f64 {
        self.high - self.low
    }

    fn farthest(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }
}

/// Two planes through the eye that open to both sides by `slope` for each unit of depth, with the
/// scene's support along their normals.
struct Wedge {
    slope: f64,
    right: f64,
    left: f64,
}

impl Wedge {
    fn of(
        (across, aim): (DVec3, DVec3),
        slope: f64,
        support: &impl Fn(DVec3) -> f64,
    ) -> Result<Self> {
        Ok(Self {
            slope,
            right: finite(across - slope * aim, support)?,
            left: finite(-across - slope * aim, support)?,
        })
    }

    /// The largest depth at which the scene fits into the wedge.
    fn depth(&self) -> f64 {
        -(self.right + self.left) / (2.0 * self.slope)
    }

    /// The excess of the scene's width over the wedge of an eye at `depth`; negative where there is
    /// room.
    fn excess(&self, depth: f64) -> f64 {
        self.right + self.left + 2.0 * self.slope * depth
    }

    /// The position across at which both planes have the same room.
    fn middle(&self) -> f64 {
        0.5 * (self.right - self.left)
    }

    /// The positions across at which the scene fits into the wedge of an eye at `depth`: the first
    /// and the last.
    fn range(&self, depth: f64) -> (f64, f64) {
        let opening = self.slope * depth;
        (self.right + opening, -self.left - opening)
    }
}

impl Pose {
    /// The eye from where the scene touches the margin at two opposite edges of a viewplane and is
    /// centred between the others.
    pub(super) fn perspective(
        &self,
        viewplane: &Viewplane,
        support: &impl Fn(DVec3) -> f64,
    ) -> Result<DVec3> {
        let slope = |size: f64| 0.5 * size / viewplane.focal_length / MARGIN;
        let deep = Extent::of(self.aim, support)?;
        let wide = Wedge::of((self.right, self.aim), slope(viewplane.width), support)?;
        let high = Wedge::of((self.upwards, self.aim), slope(viewplane.height), support)?;
        let farthest = deep.farthest().max(wide.right.abs()).max(high.right.abs());
        // The eye stays off the scene, also where that is a line along the aim.
        let nearest = deep.low - smallest(farthest).max(1e-6 * deep.length());
        let depth = wide.depth().min(high.depth()).min(nearest);
        let x = self.centred(self.right, (&wide, depth), deep, support)?;
        let y = self.centred(self.upwards, (&high, depth), deep, support)?;
        Ok(x * self.right + y * self.upwards + depth * self.aim)
    }

    /// The position across, for an eye at `depth`, at which the scene is centred.
    ///
    /// Narrows the wedge of sight by false position until the scene touches both of its planes, and
    /// takes the middle. Three steps leave less than a hundredth of half the picture.
    fn centred(
        &self,
        across: DVec3,
        (wedge, depth): (&Wedge, f64),
        deep: Extent,
        support: &impl Fn(DVec3) -> f64,
    ) -> Result<f64> {
        let room = wedge.excess(depth);
        let (least, most) = wedge.range(depth);
        // The wedge touches already, or rounding has left nothing of the depth.
        if room >= -1e-9 * wedge.slope * (deep.high - depth) || least >= most {
            return Ok(wedge.middle());
        }
        let (mut slope, mut excess) = (wedge.slope, room);
        let mut rate = 2.0 * (deep.middle() - depth);
        let mut position = wedge.middle();
        for _ in 0..3 {
            // A wedge keeps a positive slope.
            let next = (slope + excess / rate).max(1e-3 * slope);
            let narrower = Wedge::of((across, self.aim), next, support)?;
            position = narrower.middle();
            let left = narrower.excess(depth);
            let measured = (left - excess) / (slope - next);
            (slope, excess) = (next, left);
            if measured.is_nan() || measured <= 0.0 || left.abs() < 1e-3 * room.abs() {
                break;
            }
            rate = measured;
        }
        Ok(position.clamp(least, most))
    }

    /// A viewplane of the same shape with the scene in its middle, and an eye well in front of the
    /// scene.
    pub(super) fn orthographic(
        &self,
        viewplane: Viewplane,
        support: &impl Fn(DVec3) -> f64,
    ) -> Result<(DVec3, Viewplane)> {
        let wide = Extent::of(self.right, support)?;
        let high = Extent::of(self.upwards, support)?;
        let deep = Extent::of(self.aim, support)?;
        let aspect = viewplane.width / viewplane.height;
        let farthest = [wide, high, deep].map(Extent::farthest);
        let smallest = smallest(farthest.into_iter().fold(0.0, f64::max));
        let smallest = smallest.max(1e-6 * deep.length());
        let height = MARGIN * high.length().max(wide.length() / aspect).max(smallest);
        let width = height * aspect;
        let depth = deep.low - 0.5 * width.max(height).max(deep.length());
        let eye = wide.middle() * self.right + high.middle() * self.upwards + depth * self.aim;
        let viewplane = Viewplane { width, height, ..viewplane };
        Ok((eye, viewplane))
    }
}

/// The smallest size that a scene this far from the origin counts as: well above the rounding of
/// its coordinates.
pub(super) fn smallest(farthest: f64) -> f64 {
    1e-12 * farthest.max(1e-30)
}

fn finite(direction: DVec3, support: &impl Fn(DVec3) -> f64) -> Result<f64> {
    let reach = support(direction);
    let got = format!("{reach} along {direction}");
    require("support", "finite, to be framed", reach.is_finite(), got)?;
    Ok(reach)
}

//! Cameras as people describe them: what they leave open, the scene decides.

use super::{Camera, Projection, RayStart, View, require};
use crate::error::{Error, Result};
use crate::geometry::{Bounds, DVec3, unit};

/// A camera in the words of the command line and of scene files, each of which may be missing.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Description {
    /// Where it is; else so far away that everything is seen.
    pub position: Option<DVec3>,
    /// Where it looks; else at the middle of the scene.
    pub aim: Option<Aim>,
    /// Which way is up; else the scene's.
    pub up: Option<DVec3>,
    /// How much it sees; else [`Description::FOV`].
    pub lens: Option<Lens>,
    /// How it makes rays; else perspective.
    pub projection: Option<Projection>,
    /// Where rays start; else on a viewplane whose distance is given, and otherwise at the eye.
    pub ray_start: Option<RayStart>,
    /// Pixels across; else as many as the rows and the viewplane's shape ask, or 1024.
    pub columns: Option<usize>,
    /// Pixels down; else as many as the columns and the viewplane's shape ask.
    pub rows: Option<usize>,
}

/// Where a camera looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Aim {
    /// In a direction, of any length but zero.
    Along(DVec3),
    /// At a point.
    At(DVec3),
    /// At the middle of the scene.
    Centre,
}

/// How much a camera sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Lens {
    /// Degrees from the picture's lower to its upper edge, with square pixels: for perspective cameras.
    Fov(f64),
    /// A viewplane of a size.
    Viewplane {
        /// Its width.
        width: f64,
        /// Its height.
        height: f64,
        /// Its distance from the camera, which parallel rays can do without.
        focal_length: Option<f64>,
    },
}

impl Description {
    /// The vertical field of view where nothing is said, in degrees.
    pub const FOV: f64 = 45.0;

    /// The camera for a scene with these `bounds`, in which `up` is up.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a point to look at without a position or at it, for the viewplane of a
    /// perspective camera without its distance, for a field of view of an orthographic one, and for all
    /// that [`Camera::new`] refuses.
    pub fn camera(&self, bounds: Bounds, up: DVec3) -> Result<Camera> {
        // With nothing to see, any place is as good.
        let nothing = bounds.is_empty() || !bounds.is_finite();
        let bounds = if nothing {
            Bounds {
                low: DVec3::NEG_ONE,
                high: DVec3::ONE,
            }
        } else {
            bounds
        };
        let (columns, rows) = self.size();
        let up = self.up.unwrap_or(up);
        let view = self.through_lens(View {
            up,
            rows,
            columns,
            ..View::default()
        })?;
        let camera = match self.position {
            Some(position) => {
                let view = self.aimed(View { position, ..view }, bounds)?;
                let view = self.upright(view);
                let is_open = view.projection == Projection::Orthographic && self.lens.is_none();
                Camera::new(if is_open { sized(view, bounds)? } else { view })?
            }
            None => self.framed(view, bounds)?,
        };
        Ok(camera.starting_at(self.ray_start.unwrap_or(view.ray_start)))
    }

    /// Columns and rows of pixels.
    pub fn size(&self) -> (usize, usize) {
        let aspect = match self.lens {
            Some(Lens::Viewplane { width, height, .. }) => width / height,
            _ => 4.0 / 3.0,
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped"
        )]
        let pixels = |count: f64| count.round().clamp(1.0, 16_384.0) as usize;
        match (self.columns, self.rows) {
            (Some(columns), Some(rows)) => (columns, rows),
            (Some(columns), None) => (columns, pixels(columns as f64 / aspect)),
            (None, Some(rows)) => (pixels(rows as f64 * aspect), rows),
            (None, None) => (1024, pixels(1024.0 / aspect)),
        }
    }

    /// The viewplane: by its own size, or by an angle.
    fn through_lens(&self, view: View) -> Result<View> {
        let projection = self.projection.unwrap_or_default();
        let is_parallel = projection == Projection::Orthographic;
        let view = View {
            projection,
            ray_start: RayStart::Eye,
            ..view
        };
        match self.lens {
            None => view.with_vertical_fov(Self::FOV),
            Some(Lens::Fov(degrees)) => {
                let expected = "left out of an orthographic camera, which has a width and a height";
                require("fov", expected, !is_parallel, degrees)?;
                view.with_vertical_fov(degrees)
            }
            Some(Lens::Viewplane {
                width,
                height,
                focal_length,
            }) => {
                let expected = "given with the viewplane of a perspective camera";
                let is_known = is_parallel || focal_length.is_some();
                require("focal_length", expected, is_known, "none")?;
                Ok(View {
                    width,
                    height,
                    focal_length: focal_length.unwrap_or(1.0),
                    ray_start: match focal_length {
                        Some(_) => RayStart::Viewplane,
                        // Parallel rays are the same wherever the viewplane is.
                        None => RayStart::Eye,
                    },
                    ..view
                })
            }
        }
    }

    /// The view from a position that is given.
    fn aimed(&self, view: View, bounds: Bounds) -> Result<View> {
        let target = match self.aim {
            Some(Aim::Along(aim)) => return Ok(View { aim, ..view }),
            Some(Aim::At(target)) => target,
            Some(Aim::Centre) | None => bounds.centre(),
        };
        let expected = "another point than position";
        require("look_at", expected, target != view.position, target)?;
        Ok(view.aimed_at(target))
    }

    /// The view with another way up where the custom says nothing: straight from above or below.
    fn upright(&self, view: View) -> View {
        let is_along = unit(view.aim).cross(view.up).length() < 1e-9;
        if self.up.is_some() || !is_along {
            return view;
        }
        // What maps do: north is up, and x goes to the right.
        let up = if view.up.z == 0.0 {
            DVec3::NEG_Z
        } else {
            DVec3::Y
        };
        View { up, ..view }
    }

    /// The view from where everything is seen.
    fn framed(&self, view: View, bounds: Bounds) -> Result<Camera> {
        let aim = match self.aim {
            Some(Aim::Along(aim)) => aim,
            Some(Aim::At(_)) => {
                return Err(Error::argument(
                    "position",
                    "given with a point to look at",
                    "none",
                ));
            }
            Some(Aim::Centre) | None => three_quarters(view.up),
        };
        let view = self.upright(View { aim, ..view });
        let camera = Camera::framing(view, bounds)?;
        match self.lens {
            // A viewplane that was asked for stays as it was asked for.
            Some(Lens::Viewplane { width, height, .. }) => Camera::new(View {
                width,
                height,
                ..*camera.view()
            }),
            _ => Ok(camera),
        }
    }
}

/// The view with a viewplane for parallel rays that shows everything from where it is.
fn sized(view: View, bounds: Bounds) -> Result<View> {
    let View { width, height, .. } = *Camera::framing(view, bounds)?.view();
    Ok(View {
        width,
        height,
        ..view
    })
}

/// A view a little from the right and from above, on the front: with z up that faces -y, with y up +z.
fn three_quarters(up: DVec3) -> DVec3 {
    let up = unit(up);
    if up.is_nan() {
        // The camera refuses it, by its name.
        return DVec3::NEG_Z;
    }
    let front = if up.y.abs() < 0.9 {
        DVec3::NEG_Y
    } else {
        DVec3::Z
    };
    let front = front.reject_from_normalized(up);
    let right = up.cross(front);
    -(front + 0.35 * right + 0.35 * up)
}

//! Cameras as people describe them: what they leave open, the scene decides.

#![allow(
    clippy::large_types_passed_by_value,
    reason = "a view is handed on a few times for each camera"
)]

use super::framing::{MARGIN, smallest};
use super::{Camera, FovAxis, Lens, Projection, RayStart, StandardView, View, Viewplane};
use crate::error::{Error, Result};
use crate::geometry::{Bounds, DVec3, require, unit};

/// A camera in the words of the command line and of scene files, each of which may be missing.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Description {
    /// The position; else where the scene fills the picture.
    pub position: Option<DVec3>,
    /// The aim; else the middle of the scene, or [`StandardView::Iso`] where there is no position
    /// either.
    pub aim: Option<Aim>,
    /// The direction upwards; else the scene's.
    pub up: Option<DVec3>,
    /// The field of view; else [`Description::FOV`], or of a fisheye 180 degrees.
    pub opening: Option<Opening>,
    /// The axis of a perspective camera's field of view; else vertical.
    pub fov_axis: Option<FovAxis>,
    /// The projection; else perspective. A panorama needs no opening, and stands in the middle of
    /// the scene.
    pub projection: Option<Projection>,
    /// The start of rays; else on a viewplane whose distance is given, and otherwise at the eye.
    pub ray_start: Option<RayStart>,
    /// The diameter of the lens; else that of the opening's lens, or a pinhole.
    pub aperture: Option<f64>,
    /// The focus; else that of the opening's lens.
    pub focus: Option<Focus>,
    /// Pixels across; else as many as the rows and the viewplane's shape ask, or 1024.
    pub columns: Option<usize>,
    /// Pixels down; else as many as the columns and the viewplane's shape ask.
    pub rows: Option<usize>,
}

/// The aim of a camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Aim {
    /// A direction, of any length but zero.
    Along(DVec3),
    /// A point to look at.
    At(DVec3),
    /// The middle of the scene.
    Centre,
    /// The aim of a standard view.
    View(StandardView),
}

/// The focus of a camera with an aperture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Focus {
    /// A distance along the aim.
    Distance(f64),
    /// The distance along the aim of a point.
    At(DVec3),
}

/// The field of view of a camera, or its lens.
#[expect(clippy::large_enum_variant, reason = "a description is made once for a camera")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Opening {
    /// Degrees along [`Description::fov_axis`], with square pixels: for perspective cameras. Of
    /// fisheyes those of a circle that touches the longer edges, of panoramas those from the left
    /// to the right edge.
    Fov(f64),
    /// A viewplane of a size.
    Viewplane {
        /// The width.
        width: f64,
        /// The height.
        height: f64,
        /// The distance from the camera, which parallel rays can do without.
        focal_length: Option<f64>,
    },
    /// A lens with all its numbers, whatever the projection is said to be.
    Lens {
        /// The lens of a picture of `size`; in other sizes its intrinsic matrix follows.
        lens: Lens,
        /// Rows and columns.
        size: [usize; 2],
    },
}

impl Description {
    /// The field of view where nothing is said, in degrees.
    pub const FOV: f64 = 45.0;

    /// The camera for a scene with these `bounds` and this support function (see `Scene::support`),
    /// in which `up` is up. An empty or infinite scene counts as the box from -1 to 1.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a point to look at without a position or at it, for the viewplane of
    /// a perspective camera without its distance, for a field of view of an orthographic one, and
    /// for all that [`Camera::new`] refuses.
    pub fn camera(
        &self,
        bounds: Bounds,
        support: impl Fn(DVec3) -> f64,
        up: DVec3,
    ) -> Result<Camera> {
        if bounds.is_empty() || !bounds.is_finite() {
            let bounds = Bounds { low: DVec3::NEG_ONE, high: DVec3::ONE };
            let support = |direction: DVec3| direction.abs().element_sum();
            return self.of_finite(bounds, &support, up);
        }
        self.of_finite(bounds, &support, up)
    }

    fn of_finite(
        &self,
        bounds: Bounds,
        support: &dyn Fn(DVec3) -> f64,
        up: DVec3,
    ) -> Result<Camera> {
        let [rows, columns] = self.size();
        let up = self.up.unwrap_or(up);
        let lens = self.lens([rows, columns])?;
        let view = View { up, rows, columns, lens, ..View::default() };
        let camera = match (self.position, lens) {
            (Some(position), _) => self.at_position(View { position, ..view }, bounds)?,
            (None, lens) if lens.is_panorama() => self.in_the_middle(view, bounds)?,
            (None, _) => self.framed(view, support)?,
        };
        let camera = self.focused(camera)?;
        let Some(viewplane) = lens.viewplane() else {
            return Ok(camera);
        };
        Ok(camera.starting_at(self.ray_start.unwrap_or(viewplane.ray_start)))
    }

    /// The camera with the lens that is described.
    fn focused(&self, camera: Camera) -> Result<Camera> {
        let given = |own: f64| (own > 0.0).then_some(own);
        let aperture = self.aperture.or(given(camera.lens().aperture()));
        let focus = self.focus.map(|focus| match focus {
            Focus::Distance(distance) => distance,
            Focus::At(point) => camera.depth(point),
        });
        let focus = focus.or(given(camera.lens().focus()));
        match (aperture, focus) {
            // A pinhole needs no focus.
            (None | Some(0.0), None) => Ok(camera),
            (None, Some(focus)) => {
                let expected = "given with an aperture alone";
                Err(Error::argument("focus", expected, focus))
            }
            (Some(aperture), None) => {
                let expected = "given with a focus";
                Err(Error::argument("aperture", expected, aperture))
            }
            (Some(aperture), Some(focus)) => camera.thin_lens(aperture, focus),
        }
    }

    /// The camera of a view, at as many pixels as its viewplane's shape asks.
    pub fn of(view: &View) -> Self {
        let viewplane = view.lens.viewplane();
        Self {
            position: Some(view.position),
            aim: Some(Aim::Along(view.aim)),
            up: Some(view.up),
            opening: Some(match viewplane {
                Some(viewplane) if viewplane.is_centred() => Opening::Viewplane {
                    width: viewplane.width,
                    height: viewplane.height,
                    focal_length: Some(viewplane.focal_length),
                },
                _ => Opening::Lens { lens: view.lens, size: [view.rows, view.columns] },
            }),
            fov_axis: None,
            projection: Some(view.lens.projection()),
            ray_start: viewplane.map(|viewplane| viewplane.ray_start),
            aperture: Some(view.lens.aperture()).filter(|&aperture| aperture > 0.0),
            focus: Some(view.lens.focus()).filter(|&focus| focus > 0.0).map(Focus::Distance),
            columns: None,
            rows: None,
        }
    }

    /// Rows and columns of pixels.
    pub fn size(&self) -> [usize; 2] {
        if let (None, None, Some(Opening::Lens { size, .. })) =
            (self.columns, self.rows, self.opening)
        {
            return size;
        }
        let aspect = match self.opening {
            Some(Opening::Viewplane { width, height, .. }) => width / height,
            Some(Opening::Lens { size: [rows, columns], .. }) => {
                columns as f64 / rows.max(1) as f64
            }
            _ => match self.projection {
                Some(Projection::Equirectangular) => 2.0,
                Some(Projection::Cylindrical) => 3.0,
                Some(Projection::CubeMap) => 1.5,
                Some(Projection::Octahedral) => 1.0,
                _ => 4.0 / 3.0,
            },
        };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
        let pixels = |count: f64| count.round().clamp(1.0, 16_384.0) as usize;
        match (self.columns, self.rows) {
            (Some(columns), Some(rows)) => [rows, columns],
            (None, None) if self.projection == Some(Projection::CubeMap) => [684, 1026],
            (Some(columns), None) => [pixels(columns as f64 / aspect), columns],
            (None, Some(rows)) => [rows, pixels(rows as f64 * aspect)],
            (None, None) => [pixels(1024.0 / aspect), 1024],
        }
    }

    /// Refuses an axis where no angle is measured along one.
    fn check_fov_axis(&self, projection: Projection) -> Result<()> {
        let Some(axis) = self.fov_axis else {
            return Ok(());
        };
        let has_fov = matches!(self.opening, None | Some(Opening::Fov(_)));
        let is_fine = has_fov && projection == Projection::Perspective;
        let expected =
            "left out of a camera that is not perspective, with an angle for its field of view";
        require("fov_axis", expected, is_fine, axis.name())
    }

    /// The lens: a viewplane by its own size or by an angle, or another one.
    fn lens(&self, [rows, columns]: [usize; 2]) -> Result<Lens> {
        let projection = self.projection.unwrap_or_default();
        self.check_fov_axis(projection)?;
        if let Some(Opening::Lens { lens, size }) = self.opening {
            let factors =
                [rows as f64 / size[0].max(1) as f64, columns as f64 / size[1].max(1) as f64];
            return Ok(lens.scaled(factors));
        }
        if !projection.has_viewplane() {
            let expected = "left out of a camera without a viewplane, whose rays start at the eye";
            let is_fine = self.ray_start != Some(RayStart::Viewplane);
            require("ray_start", expected, is_fine, "viewplane")?;
            return self.lens_without_viewplane(projection, [rows, columns]);
        }
        let parallel = projection == Projection::Orthographic;
        let axis = self.fov_axis.unwrap_or_default();
        let square = |degrees| Viewplane::with_fov(degrees, axis, rows, columns);
        let viewplane = match self.opening {
            None => square(Self::FOV)?,
            Some(Opening::Fov(degrees)) => {
                let expected = "left out of an orthographic camera, which has a width and a height";
                require("fov", expected, !parallel, degrees)?;
                square(degrees)?
            }
            Some(Opening::Lens { .. }) => unreachable!("it has returned"),
            Some(Opening::Viewplane { width, height, focal_length }) => {
                let expected = "given with the viewplane of a perspective camera";
                let is_known = parallel || focal_length.is_some();
                require("focal_length", expected, is_known, "none")?;
                Viewplane {
                    focal_length: focal_length.unwrap_or(1.0),
                    width,
                    height,
                    ray_start: match focal_length {
                        Some(_) => RayStart::Viewplane,
                        // Parallel rays are the same wherever the viewplane is.
                        None => RayStart::Eye,
                    },
                    parallel,
                    ..Viewplane::default()
                }
            }
        };
        Ok(Lens::Flat(Viewplane { parallel, ..viewplane }))
    }

    /// A panorama or a fisheye; a calibrated lens is not known without its numbers.
    fn lens_without_viewplane(
        &self,
        projection: Projection,
        [rows, columns]: [usize; 2],
    ) -> Result<Lens> {
        match self.opening {
            Some(Opening::Fov(degrees)) => Lens::with_fov(projection, degrees, rows, columns),
            Some(_) => {
                let expected = "left out of a camera without one";
                Err(Error::argument("viewplane", expected, projection.name()))
            }
            None => match projection {
                Projection::Equidistant
                | Projection::Equisolid
                | Projection::Stereographic
                | Projection::OrthographicFisheye => {
                    Lens::with_fov(projection, 180.0, rows, columns)
                }
                _ => {
                    let lens = Lens::named(projection, &[])?;
                    let expected = "given with a calibrated lens";
                    require("intrinsics", expected, lens.is_panorama(), projection.name())?;
                    Ok(lens)
                }
            },
        }
    }

    /// The camera at a position that is given.
    fn at_position(&self, view: View, bounds: Bounds) -> Result<Camera> {
        let view = self.upright(self.aimed(view, bounds)?);
        let is_open = self.opening.is_none();
        match view.lens {
            Lens::Flat(viewplane) if viewplane.parallel && is_open => {
                sized(view, viewplane, bounds)
            }
            _ => Camera::new(view),
        }
    }

    /// The camera in the middle of the scene, looking ahead unless it is told where.
    fn in_the_middle(&self, view: View, bounds: Bounds) -> Result<Camera> {
        let position = bounds.centre();
        let view = View { position, ..view };
        let view = match self.aim {
            None | Some(Aim::Centre) => view.standard(StandardView::Front),
            Some(_) => self.aimed(view, bounds)?,
        };
        Camera::new(self.upright(view))
    }

    /// The view from a position that is given.
    fn aimed(&self, view: View, bounds: Bounds) -> Result<View> {
        let target = match self.aim {
            Some(Aim::Along(aim)) => return Ok(View { aim, ..view }),
            Some(Aim::View(standard)) => return Ok(view.standard(standard)),
            Some(Aim::At(target)) => target,
            // From the middle there is no way to the middle.
            Some(Aim::Centre) | None if bounds.centre() == view.position => {
                return Ok(view.standard(StandardView::Front));
            }
            Some(Aim::Centre) | None => bounds.centre(),
        };
        let expected = "another point than position";
        require("look_at", expected, target != view.position, target)?;
        Ok(view.aimed_at(target))
    }

    /// The view with another way up where the convention says nothing: straight from above or
    /// below.
    fn upright(&self, view: View) -> View {
        let is_along = unit(view.aim).cross(view.up).length() < 1e-9;
        if self.up.is_some() || !is_along {
            return view;
        }
        // As on maps, north is up, and x goes to the right.
        let up = if view.up.z == 0.0 { DVec3::NEG_Z } else { DVec3::Y };
        View { up, ..view }
    }

    /// The camera that the scene fills.
    fn framed(&self, view: View, support: &dyn Fn(DVec3) -> f64) -> Result<Camera> {
        let view = match self.aim {
            Some(Aim::Along(aim)) => self.upright(View { aim, ..view }),
            Some(Aim::At(_)) => {
                let expected = "given with a point to look at";
                return Err(Error::argument("position", expected, "none"));
            }
            Some(Aim::View(standard)) => view.standard(standard),
            Some(Aim::Centre) | None => view.standard(StandardView::default()),
        };
        // A lens without a viewplane is placed as a pinhole would be that sees about as much.
        let seen_by = match Camera::new(view)?.pixel_matrix() {
            Some(matrix) if view.lens.viewplane().is_none() => View {
                lens: Lens::Flat(Viewplane::from_pixel_matrix(&matrix, view.rows, view.columns)?),
                ..view
            },
            _ => view,
        };
        let camera = Camera::framing(seen_by, support)?;
        match self.opening {
            // A given opening stays as it is.
            Some(Opening::Viewplane { .. } | Opening::Lens { .. }) => {
                Camera::new(View { lens: view.lens, ..*camera.view() })
            }
            _ if view.lens.viewplane().is_none() => {
                Camera::new(View { lens: view.lens, ..*camera.view() })
            }
            _ => Ok(camera),
        }
    }
}

/// The camera with a viewplane of the same shape on which the scene's box fits around its middle.
fn sized(view: View, viewplane: Viewplane, bounds: Bounds) -> Result<Camera> {
    let camera = Camera::new(view)?;
    let aspect = viewplane.width / viewplane.height;
    let centre = bounds.centre();
    let corners = bounds.corners().map(|corner| {
        let corner = corner - centre;
        let x = corner.dot(camera.right()).abs();
        corner.dot(camera.upwards()).abs().max(x / aspect)
    });
    let smallest = smallest(centre.abs().max_element());
    let height = 2.0 * MARGIN * corners.into_iter().fold(smallest, f64::max);
    Camera::new(View {
        lens: Lens::Flat(Viewplane { width: height * aspect, height, ..viewplane }),
        ..view
    })
}

//! The camera.

use firsthit::camera::Description;
use firsthit::camera::{Equirectangular, Projection};
use firsthit::render::{framing_camera, sample_ray};
use firsthit::watch::Watch;
use firsthit::{DVec3, Lens, Ray, RayStart, Rays, View, Viewplane};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::{collected, not_contiguous};
use crate::errors::raise;
use crate::run::run;
use crate::scene::Scene;
use crate::shoot::FEW;

/// A checked camera.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct Camera(pub(crate) firsthit::Camera);

/// The camera's frame: position, aim, right, upwards.
type CameraFrame = ([f64; 3], [f64; 3], [f64; 3], [f64; 3]);

#[pymethods]
impl Camera {
    /// The camera of a view; `again` where that was taken from a camera, and is to stay as it is to the last bit.
    #[new]
    #[expect(
        clippy::too_many_arguments,
        reason = "a camera's words, sent by the Python half alone"
    )]
    fn new(
        py: Python<'_>,
        position: [f64; 3],
        aim: [f64; 3],
        up: [f64; 3],
        focal_length: f64,
        size: [f64; 2],
        pixels: [usize; 2],
        projection: &str,
        ray_start: &str,
        again: bool,
    ) -> PyResult<Self> {
        let ray_start = match ray_start {
            "viewplane" => RayStart::Viewplane,
            "eye" => RayStart::Eye,
            other => {
                let text = format!("ray_start must be viewplane or eye, got {other}");
                return Err(PyValueError::new_err(text));
            }
        };
        let make = if again {
            firsthit::Camera::again
        } else {
            firsthit::Camera::new
        };
        let flat = |parallel| {
            Lens::Flat(Viewplane {
                focal_length,
                width: size[0],
                height: size[1],
                parallel,
                ray_start,
            })
        };
        let camera = projection.parse().and_then(|projection| {
            make(View {
                position: DVec3::from(position),
                aim: DVec3::from(aim),
                up: DVec3::from(up),
                rows: pixels[0],
                columns: pixels[1],
                lens: match projection {
                    Projection::Perspective => flat(false),
                    Projection::Orthographic => flat(true),
                    Projection::Equirectangular => Lens::Equirectangular(Equirectangular {}),
                },
            })
        });
        camera.map(Self).map_err(|error| raise(py, &error))
    }

    /// The camera that sees all of a scene; rows and columns that are left out are the usual ones.
    #[staticmethod]
    fn framing(
        py: Python<'_>,
        scene: &Scene,
        up: [f64; 3],
        view: &str,
        rows: Option<usize>,
        columns: Option<usize>,
    ) -> PyResult<Self> {
        let view = view.parse().map_err(|error| raise(py, &error))?;
        let sized = Description {
            rows,
            columns,
            ..Description::default()
        };
        let (columns, rows) = sized.size();
        let up = DVec3::from(up);
        run(py, 0, |_| {
            framing_camera(&scene.0, up, view, [rows, columns])
        })
        .map(Self)
    }

    /// What the camera is made from.
    fn view(&self) -> ViewOut {
        view_out(self.0.view())
    }

    /// The viewplane of a field of view: focal length, width, height.
    #[staticmethod]
    fn lens(
        py: Python<'_>,
        vertical_fov_degrees: f64,
        rows: usize,
        columns: usize,
    ) -> PyResult<(f64, f64, f64)> {
        let viewplane = Viewplane::with_vertical_fov(vertical_fov_degrees, rows, columns);
        let viewplane = viewplane.map_err(|error| raise(py, &error))?;
        Ok((viewplane.focal_length, viewplane.width, viewplane.height))
    }

    /// Position, aim, right, upwards.
    fn frame(&self) -> CameraFrame {
        let Self(camera) = self;
        let vectors = [
            camera.position(),
            camera.aim(),
            camera.right(),
            camera.upwards(),
        ];
        let [position, aim, right, upwards] = vectors.map(|vector| vector.to_array());
        (position, aim, right, upwards)
    }

    /// Origins and directions of the rays of some rows, through the point that a sample of each pixel is at; the first is the
    /// centre.
    #[expect(clippy::type_complexity, reason = "two arrays")]
    fn rays<'py>(
        &self,
        py: Python<'py>,
        rows: (usize, usize),
        sample: u32,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>)> {
        let columns = self.0.columns();
        let last_row = rows.1.min(self.0.rows());
        let (first, last) = (
            rows.0.saturating_mul(columns),
            last_row.saturating_mul(columns),
        );
        let ray = |index| sample_ray(&self.0, first + index, sample);
        ray_arrays(py, last.saturating_sub(first), ray)
    }

    /// Origins and directions of the rays through the centres of some pixels, counted row by row.
    #[expect(clippy::type_complexity, reason = "two arrays")]
    fn rays_of<'py>(
        &self,
        py: Python<'py>,
        pixels: PyReadonlyArray1<'py, i64>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>)> {
        let pixels: Vec<usize> = self.checked(&pixels)?.collect();
        ray_arrays(py, pixels.len(), |k| Rays::ray(&self.0, pixels[k]))
    }

    /// `range` or `z` of the hits at `t` of some pixels, counted row by row.
    fn distances<'py>(
        &self,
        py: Python<'py>,
        is_range: bool,
        pixels: PyReadonlyArray1<'py, i64>,
        t: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let camera = &self.0;
        let distance = |(pixel, &t): (usize, &f64)| {
            let (row, column) = (pixel / camera.columns(), pixel % camera.columns());
            if is_range {
                camera.range(row, column, t)
            } else {
                camera.z(row, column, t)
            }
        };
        let t = t.as_slice().map_err(not_contiguous)?;
        let distances = self.checked(&pixels)?.zip(t).map(distance).collect();
        Ok(PyArray1::from_vec(py, distances))
    }
}

impl Camera {
    /// Pixels, all of which the camera has.
    fn checked(
        &self,
        pixels: &PyReadonlyArray1<'_, i64>,
    ) -> PyResult<impl ExactSizeIterator<Item = usize>> {
        let pixels = pixels.as_slice().map_err(not_contiguous)?;
        let checked = pixels.iter().map(|&pixel| usize::try_from(pixel));
        let checked: Result<Vec<usize>, _> = checked.collect();
        let checked = checked.ok().filter(|pixels| {
            let largest = pixels.iter().max();
            largest.is_none_or(|&largest| largest < self.0.pixels())
        });
        let outside = || PyValueError::new_err("expected pixels of the camera");
        Ok(checked.ok_or_else(outside)?.into_iter())
    }
}

/// The two arrays of so many rays, which are made in pieces by all threads; few by the calling thread alone.
#[expect(clippy::type_complexity, reason = "two arrays")]
fn ray_arrays(
    py: Python<'_>,
    count: usize,
    ray: impl Fn(usize) -> Ray + Sync,
) -> PyResult<(Bound<'_, PyArray2<f64>>, Bound<'_, PyArray2<f64>>)> {
    /// Rays that are made between two looks at whether to stop.
    const PIECE: usize = 1 << 14;
    let zeros = || collected(count, std::iter::repeat_n([0.0; 3], count));
    let (mut origins, mut directions) = (zeros()?, zeros()?);
    let make = |first: usize, origins: &mut [[f64; 3]], directions: &mut [[f64; 3]]| {
        let ends = origins.iter_mut().zip(directions);
        for (index, (origin, direction)) in (first..).zip(ends) {
            let ray = ray(index);
            (*origin, *direction) = (ray.origin.to_array(), ray.direction.to_array());
        }
    };
    if count < FEW {
        make(0, &mut origins, &mut directions);
    } else {
        run(py, 0, |stop| {
            let origins = origins.par_chunks_mut(PIECE);
            let pieces = origins.zip(directions.par_chunks_mut(PIECE)).enumerate();
            pieces.for_each(|(k, (origins, directions))| {
                // The interruption is raised by whoever asked to stop.
                if !stop.is_stopped() {
                    make(k * PIECE, origins, directions);
                }
            });
            Ok(())
        })?;
    }
    let array =
        |values: Vec<[f64; 3]>| PyArray1::from_vec(py, values.into_flattened()).reshape([count, 3]);
    Ok((array(origins)?, array(directions)?))
}

/// Position, aim and up; focal length, width and height; rows and columns; projection and ray start.
pub(crate) type ViewOut = (
    [[f64; 3]; 3],
    [Option<f64>; 3],
    [usize; 2],
    [&'static str; 2],
);

pub(crate) fn view_out(view: &View) -> ViewOut {
    let &View {
        position,
        aim,
        up,
        rows,
        columns,
        lens,
    } = view;
    let viewplane = lens.viewplane();
    let lengths =
        viewplane.map(|viewplane| [viewplane.focal_length, viewplane.width, viewplane.height]);
    let lengths = [0, 1, 2].map(|k| lengths.map(|lengths| lengths[k]));
    let ray_start = viewplane.map_or(RayStart::Eye, |viewplane| viewplane.ray_start);
    (
        [position, aim, up].map(|vector| vector.to_array()),
        lengths,
        [rows, columns],
        [lens.projection().name(), ray_start.name()],
    )
}

//! The camera.

use firsthit::{DVec3, RayStart, View};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::prelude::*;

use crate::errors::raise;

/// A checked camera.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct Camera(pub(crate) firsthit::Camera);

/// The camera's frame: position, aim, right, upwards.
type CameraFrame = ([f64; 3], [f64; 3], [f64; 3], [f64; 3]);

#[pymethods]
impl Camera {
    #[new]
    #[pyo3(signature = (position, aim, up, focal_length, size, pixels, projection, ray_start))]
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
    ) -> PyResult<Self> {
        let ray_start = match ray_start {
            "viewplane" => RayStart::Viewplane,
            "eye" => RayStart::Eye,
            other => {
                let text = format!("ray_start must be viewplane or eye, got {other}");
                return Err(PyValueError::new_err(text));
            }
        };
        let camera = projection.parse().and_then(|projection| {
            firsthit::Camera::new(View {
                position: DVec3::from(position),
                aim: DVec3::from(aim),
                up: DVec3::from(up),
                focal_length,
                width: size[0],
                height: size[1],
                rows: pixels[0],
                columns: pixels[1],
                projection,
                ray_start,
            })
        });
        camera.map(Self).map_err(|error| raise(py, &error))
    }

    /// The viewplane of a field of view: focal length, width, height.
    #[staticmethod]
    fn lens(
        py: Python<'_>,
        vertical_fov_degrees: f64,
        rows: usize,
        columns: usize,
    ) -> PyResult<(f64, f64, f64)> {
        let view = View {
            rows,
            columns,
            ..View::default()
        }
        .with_vertical_fov(vertical_fov_degrees);
        let view = view.map_err(|error| raise(py, &error))?;
        Ok((view.focal_length, view.width, view.height))
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

    /// Origins and directions of the rays of some rows: through the pixels' centres, or through the
    /// sample point `k` of `count`.
    #[expect(clippy::type_complexity, reason = "two arrays")]
    fn rays<'py>(
        &self,
        py: Python<'py>,
        rows: (usize, usize),
        sample: Option<(u32, u32)>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>)> {
        let columns = self.0.columns();
        let last_row = rows.1.min(self.0.rows());
        let (first, last) = (
            rows.0.saturating_mul(columns),
            last_row.saturating_mul(columns),
        );
        let mut origins = Vec::new();
        let mut directions = Vec::new();
        for values in [&mut origins, &mut directions] {
            let room = values.try_reserve_exact(last.saturating_sub(first).saturating_mul(3));
            room.map_err(|_| PyMemoryError::new_err("the rays of so many pixels"))?;
        }
        for index in first..last {
            let (k, count) = sample.unwrap_or((0, 1));
            let ray = firsthit::render::sample_ray(&self.0, index, k, count);
            origins.extend(ray.origin.to_array());
            directions.extend(ray.direction.to_array());
        }
        let count = origins.len() / 3;
        let array = |values| PyArray1::from_vec(py, values).reshape([count, 3]);
        Ok((array(origins)?, array(directions)?))
    }
}

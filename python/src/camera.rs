//! The camera.

use std::path::PathBuf;

use firsthit::camera::{ColmapCamera, Convention, Description, PixelMatrix, Projection};
use firsthit::geometry::DMat3;
use firsthit::image::CameraRecord;
use firsthit::load::{colmap_files, read_colmap};
use firsthit::render::{Sample, framing_camera};
use firsthit::sensor::{Sensor, camera_of};
use firsthit::watch::Watch;
use firsthit::{DVec3, Lens, Ray, RayStart, Rays, View, Viewplane};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::collected;
use crate::errors::{Outcome, Raised};
use crate::run::{FEW, run};
use crate::scene::Scene;

/// A checked camera.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct Camera(pub(crate) firsthit::Camera);

/// The camera's frame: position, aim, right, upwards.
/// Cameras by the names of their images, and the images of other models, with these.
type ColmapOut = (Vec<(String, Camera)>, Vec<(String, &'static str)>, PathBuf);

type CameraFrame = ([f64; 3], [f64; 3], [f64; 3], [f64; 3]);

#[pymethods]
impl Camera {
    /// The camera of a view; `is_exact` where that was taken from a camera, and is to stay as it is
    /// to the last bit.
    #[new]
    #[expect(
        clippy::too_many_arguments,
        reason = "a camera's words, sent by the Python half alone"
    )]
    fn new(
        position: [f64; 3],
        aim: [f64; 3],
        up: [f64; 3],
        pixels: [usize; 2],
        projection: &str,
        ray_start: &str,
        parameters: Vec<(String, f64)>,
        is_exact: bool,
    ) -> Outcome<Self> {
        let make = if is_exact { firsthit::Camera::from_view_exact } else { firsthit::Camera::new };
        let camera = make(View {
            position: DVec3::from(position),
            aim: DVec3::from(aim),
            up: DVec3::from(up),
            rows: pixels[0],
            columns: pixels[1],
            lens: lens_in(projection, ray_start, &parameters)?,
        });
        Ok(Self(camera?))
    }

    /// The camera of a matrix K and a matrix of a pose, row by row, as a convention has them; with
    /// the parameters of a projection that distorts.
    #[staticmethod]
    fn from_intrinsics(
        k: [[f64; 3]; 3],
        pose: [[f64; 4]; 4],
        convention: &str,
        pixels: [usize; 2],
        projection: &str,
        parameters: Vec<(String, f64)>,
    ) -> Outcome<Self> {
        let convention: Convention = convention.parse()?;
        let columns = [0, 1, 2].map(|column| DVec3::from([0, 1, 2].map(|row| k[row][column])));
        let k = DMat3::from_cols(columns[0], columns[1], columns[2]);
        let matrix = convention.pixel_matrix(PixelMatrix::from_matrix(k)?);
        let pose = convention.pose(pose)?;
        let others = parameters.iter();
        let others: Vec<(&str, f64)> = others.map(|(name, value)| (&**name, *value)).collect();
        let lens = matrix.lens(projection.parse()?, &others, pixels)?;
        let [rows, columns] = pixels;
        Ok(Self(firsthit::Camera::at_pose(&pose, lens, rows, columns)?))
    }

    /// The matrix K, if there is one, and the matrix of the pose, row by row, as a convention has
    /// them.
    #[expect(clippy::type_complexity, reason = "two matrices")]
    fn matrices(&self, convention: &str) -> Outcome<(Option<[[f64; 3]; 3]>, [[f64; 4]; 4])> {
        let convention: Convention = convention.parse()?;
        let matrix = self.0.pixel_matrix();
        let k = matrix.map(|matrix| convention.own_pixel_matrix(matrix).matrix());
        let k = k.map(|k| [0, 1, 2].map(|row| k.row(row).to_array()));
        Ok((k, convention.matrix(&self.0.world_from_camera())))
    }

    /// The camera in COLMAP's words: the model's name, its parameters, the quaternion and the
    /// translation.
    #[expect(clippy::type_complexity, reason = "four parts of one line")]
    fn to_colmap(&self) -> Outcome<(&'static str, Vec<f64>, [f64; 4], [f64; 3])> {
        let camera = ColmapCamera::of(&self.0)?;
        Ok((camera.model.name, camera.params, camera.qvec, camera.tvec))
    }

    /// The cameras of a reconstruction by COLMAP, with their images' names: of its folder, or of
    /// two files; and the file of images.
    #[staticmethod]
    fn of_colmap(py: Python<'_>, cameras: PathBuf, images: Option<PathBuf>) -> Outcome<ColmapOut> {
        let read = || -> firsthit::Result<ColmapOut> {
            let [cameras, of_images] = match images {
                Some(images) => [cameras, images],
                None => colmap_files(&cameras)?,
            };
            let images = read_colmap([&cameras, &of_images])?;
            let (mut made, mut unsupported) = (Vec::new(), Vec::new());
            let cameras = images.cameras().zip(images.unsupported());
            for (name, (camera, unsupported_model)) in images.names().zip(cameras) {
                match unsupported_model {
                    Some(model) => unsupported.push((name.to_owned(), model)),
                    None => made.push((name.to_owned(), Self(camera?))),
                }
            }
            Ok((made, unsupported, of_images))
        };
        Ok(py.detach(read)?)
    }

    /// The expectation for an aperture with a projection that has no thin lens.
    #[staticmethod]
    fn no_thin_lens(projection: &str) -> Option<&'static str> {
        let known: Option<Projection> = projection.parse().ok();
        let has = known.is_some_and(Projection::has_thin_lens);
        (!has).then_some(Projection::NO_THIN_LENS)
    }

    /// The names of a projection's numbers.
    #[staticmethod]
    fn settings(projection: &str) -> Vec<&'static str> {
        let known: Option<Projection> = projection.parse().ok();
        let settings = known.map_or_else(Vec::new, Projection::settings);
        settings.into_iter().map(|setting| setting.name).collect()
    }

    /// The camera that made an output, from the JSON of its record.
    #[staticmethod]
    fn of_record(json: &str) -> Outcome<Self> {
        let record: CameraRecord = serde_json::from_str(json)?;
        Ok(Self(camera_of(&record)?))
    }

    /// The parameters of a fisheye or a panorama of `fov` degrees.
    #[staticmethod]
    fn with_fov(
        projection: &str,
        fov: f64,
        pixels: [usize; 2],
    ) -> Outcome<Vec<(&'static str, f64)>> {
        let [rows, columns] = pixels;
        let lens = Lens::with_fov(projection.parse()?, fov, rows, columns)?;
        Ok(lens.parameters())
    }

    /// The camera of a part of the picture: from a row to a row, from a column to a column.
    fn crop(&self, region: [usize; 4]) -> Outcome<Self> {
        let [top, bottom, left, right] = region;
        Ok(Self(self.0.crop(top..bottom, left..right)?))
    }

    /// The camera of the picture with other numbers of rows and columns.
    fn resize(&self, rows: usize, columns: usize) -> Outcome<Self> {
        Ok(Self(self.0.resize(rows, columns)?))
    }

    /// The camera with a thin lens.
    fn thin_lens(&self, aperture: f64, focus: f64) -> Outcome<Self> {
        Ok(Self(self.0.thin_lens(aperture, focus)?))
    }

    /// The distance of a point ahead along the aim.
    fn depth(&self, point: [f64; 3]) -> f64 {
        self.0.depth(DVec3::from(point))
    }

    /// The places in the picture where points are seen: columns and rows for each, NaN for nowhere.
    fn project<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray1<'py, f64>,
    ) -> Outcome<Bound<'py, PyArray1<f64>>> {
        let points = points.as_slice()?;
        let (points, _) = points.as_chunks::<3>();
        let camera = &self.0;
        let pixel = |point: &[f64; 3]| {
            let pixel = camera.project(DVec3::from(*point));
            pixel.map_or([f64::NAN; 2], |pixel| pixel.to_array())
        };
        let pixels: Vec<[f64; 2]> = if points.len() < FEW {
            points.iter().map(pixel).collect()
        } else {
            run(py, 0, |_| Ok(points.par_iter().map(pixel).collect()))?
        };
        Ok(PyArray1::from_vec(py, pixels.into_flattened()))
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
    ) -> Outcome<Self> {
        let view = view.parse()?;
        let sized = Description { rows, columns, ..Description::default() };
        let up = DVec3::from(up);
        run(py, 0, |_| framing_camera(&scene.0, up, view, sized.size())).map(Self)
    }

    /// The view that the camera is made from.
    fn view(&self) -> ViewOut {
        view_out(self.0.view())
    }

    /// The viewplane of a field of view: focal length, width, height.
    #[staticmethod]
    fn lens(fov: f64, fov_axis: &str, rows: usize, columns: usize) -> Outcome<(f64, f64, f64)> {
        let viewplane = Viewplane::with_fov(fov, fov_axis.parse()?, rows, columns)?;
        Ok((viewplane.focal_length, viewplane.width, viewplane.height))
    }

    /// Position, aim, right, upwards.
    fn frame(&self) -> CameraFrame {
        let Self(camera) = self;
        let vectors = [camera.position(), camera.aim(), camera.right(), camera.upwards()];
        let [position, aim, right, upwards] = vectors.map(|vector| vector.to_array());
        (position, aim, right, upwards)
    }

    /// Origins and directions of the rays of some rows, through the point that a sample of each
    /// pixel is at; the first is the centre.
    fn rays<'py>(
        &self,
        py: Python<'py>,
        rows: (usize, usize),
        sample: u32,
    ) -> Outcome<RayArraysOut<'py>> {
        rays_of_rows(py, &self.0, rows, sample)
    }

    /// Origins and directions of the rays through the centres of some pixels, counted row by row.
    fn rays_of<'py>(
        &self,
        py: Python<'py>,
        pixels: PyReadonlyArray1<'py, i64>,
    ) -> Outcome<RayArraysOut<'py>> {
        let pixels: Vec<usize> = checked_pixels(&pixels, self.0.pixels())?.collect();
        ray_arrays(py, pixels.len(), |k| Rays::ray(&self.0, pixels[k]))
    }

    /// `range` or `z` of the hits at `t` of some pixels, counted row by row.
    fn distances<'py>(
        &self,
        py: Python<'py>,
        is_range: bool,
        pixels: PyReadonlyArray1<'py, i64>,
        t: PyReadonlyArray1<'py, f64>,
    ) -> Outcome<Bound<'py, PyArray1<f64>>> {
        distances_of(py, &self.0, is_range, &pixels, &t)
    }

    /// The camera carried by a body, by the matrix of its pose.
    fn moved(&self, world_from_body: [[f64; 4]; 4]) -> Outcome<Self> {
        let pose = Convention::OpenGl.pose(world_from_body)?;
        Ok(Self(self.0.moved(&pose)?))
    }
}

/// Origins and directions.
pub(crate) type RayArraysOut<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

/// The rays of some rows of a sensor, through the point that a sample of each pixel is at.
pub(crate) fn rays_of_rows<'py>(
    py: Python<'py>,
    sensor: &(dyn Sensor + Send + Sync),
    rows: (usize, usize),
    sample: u32,
) -> Outcome<RayArraysOut<'py>> {
    let [all_rows, columns] = sensor.shape();
    let last_row = rows.1.min(all_rows);
    let (first, last) = (rows.0.saturating_mul(columns), last_row.saturating_mul(columns));
    let sample = Sample::new(sensor, sample);
    ray_arrays(py, last.saturating_sub(first), |index| sample.ray(first + index))
}

/// `range` or `z` of the hits at `t` of some pixels of a sensor.
pub(crate) fn distances_of<'py>(
    py: Python<'py>,
    sensor: &(dyn Sensor + Send + Sync),
    is_range: bool,
    pixels: &PyReadonlyArray1<'py, i64>,
    t: &PyReadonlyArray1<'py, f64>,
) -> Outcome<Bound<'py, PyArray1<f64>>> {
    let t = t.as_slice()?;
    let pixels = checked_pixels(pixels, sensor.len())?;
    let distance = |(pixel, &t): (usize, &f64)| {
        let [range, z] = sensor.range_and_z(pixel, t);
        if is_range { range } else { z }
    };
    Ok(PyArray1::from_vec(py, pixels.zip(t).map(distance).collect()))
}

/// Checks the numbers of pixels against a sensor of `count` pixels.
pub(crate) fn checked_pixels(
    pixels: &PyReadonlyArray1<'_, i64>,
    count: usize,
) -> Outcome<impl ExactSizeIterator<Item = usize>> {
    let pixels = pixels.as_slice()?;
    let checked = pixels.iter().map(|&pixel| usize::try_from(pixel));
    let checked: Result<Vec<usize>, _> = checked.collect();
    let checked = checked.ok().filter(|pixels| {
        let largest = pixels.iter().max();
        largest.is_none_or(|&largest| largest < count)
    });
    let outside = || Raised::value("expected pixels of the camera");
    Ok(checked.ok_or_else(outside)?.into_iter())
}

/// The two arrays of `count` rays, which are made in pieces by all threads; few by the calling
/// thread alone.
pub(crate) fn ray_arrays(
    py: Python<'_>,
    count: usize,
    ray: impl Fn(usize) -> Ray + Sync,
) -> Outcome<RayArraysOut<'_>> {
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
                // The caller that asked to stop raises the interruption.
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

/// The lens of a projection's name, of where its rays start, and of its numbers.
fn lens_in(
    projection: &str,
    ray_start: &str,
    parameters: &[(String, f64)],
) -> firsthit::Result<Lens> {
    let parameters = parameters.iter();
    let parameters: Vec<(&str, f64)> =
        parameters.map(|(name, value)| (name.as_str(), *value)).collect();
    let mut lens = Lens::named(projection.parse()?, &parameters)?;
    let start: RayStart = ray_start.parse()?;
    if let Lens::Flat(viewplane) = &mut lens {
        viewplane.ray_start = start;
    }
    Ok(lens)
}

/// The rotation about an axis by its length, as `cv2.Rodrigues` has it, row by row.
#[pyfunction]
pub(crate) fn rotation(vector: [f64; 3]) -> [[f64; 3]; 3] {
    let rotation = firsthit::camera::rotation(DVec3::from(vector));
    [0, 1, 2].map(|row| rotation.row(row).to_array())
}

/// Refuses a pose that is no rotation and translation.
#[pyfunction]
pub(crate) fn check_pose(pose: [[f64; 4]; 4]) -> Outcome<()> {
    Convention::OpenGl.pose(pose)?;
    Ok(())
}

/// A pose with a rounded rotation: with the nearest one, and how far off it was.
#[pyfunction]
pub(crate) fn orthonormalised(pose: [[f64; 4]; 4]) -> Option<([[f64; 4]; 4], f64)> {
    firsthit::camera::orthonormalised(pose)
}

/// Position, aim and up; rows and columns; projection and ray start; the lens' numbers by their
/// names.
pub(crate) type ViewOut = ([[f64; 3]; 3], [usize; 2], [&'static str; 2], Vec<(&'static str, f64)>);

pub(crate) fn view_out(view: &View) -> ViewOut {
    let &View { position, aim, up, rows, columns, lens } = view;
    let viewplane = lens.viewplane();
    let ray_start = viewplane.map_or(RayStart::Eye, |viewplane| viewplane.ray_start);
    (
        [position, aim, up].map(|vector| vector.to_array()),
        [rows, columns],
        [lens.projection().name(), ray_start.name()],
        lens.parameters(),
    )
}

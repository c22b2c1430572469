//! The camera.

use std::path::PathBuf;

use firsthit::camera::{ColmapCamera, Convention, Description, PixelMatrix, Projection};
use firsthit::geometry::DMat3;
use firsthit::image::CameraRecord;
use firsthit::load::{colmap_files, read_colmap};
use firsthit::render::framing_camera;
use firsthit::sensor::camera_of;
use firsthit::{DVec3, Lens, RayStart, View, Viewplane};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::errors::Outcome;
use crate::run::{FEW, run};
use crate::scene::Scene;

/// A checked camera.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct Camera(pub(crate) firsthit::Camera);

/// Cameras by the names of their images, and the images of other models, with these.
type ColmapOut = (Vec<(String, Camera)>, Vec<(String, &'static str)>, PathBuf);

/// The camera's frame: position, aim, right, upwards.
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

    /// The camera carried by a body, by the matrix of its pose.
    fn moved(&self, world_from_body: [[f64; 4]; 4]) -> Outcome<Self> {
        let pose = Convention::OpenGl.pose(world_from_body)?;
        Ok(Self(self.0.moved(&pose)?))
    }
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

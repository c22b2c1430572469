//! Cameras as sensors, and from their records.

use super::moving::rows_of;
use super::{Record, Sensor};
use crate::camera::{Camera, Lens, Projection, View};
use crate::error::Result;
use crate::geometry::{DMat3, DVec2, DVec3, PixelGrid, Ray};
use crate::image::{CameraRecord, Intrinsics, Pose};

/// The camera that made an output, bit for bit, from what the output's metadata say.
///
/// # Errors
///
/// [`Error::Argument`](crate::error::Error::Argument) for a record that describes no camera.
pub fn camera_of(record: &CameraRecord) -> Result<Camera> {
    let projection: Projection = record.projection.parse()?;
    let mut lens = if record.parameters.is_empty() {
        let lengths = [
            ("focal_length", record.focal_length),
            ("width", record.width),
            ("height", record.height),
        ];
        let lengths = lengths.into_iter();
        let lengths: Vec<(&str, f64)> =
            lengths.filter_map(|(name, length)| Some((name, length?))).collect();
        Lens::named(projection, &lengths)?
    } else {
        let parameters = record.parameters.iter();
        let parameters: Vec<(&str, f64)> =
            parameters.map(|(name, &value)| (&**name, value)).collect();
        Lens::named(projection, &parameters)?
    };
    if let Lens::Flat(viewplane) = &mut lens {
        viewplane.ray_start = record.ray_start.parse()?;
    }
    let count = |count: u64| usize::try_from(count).unwrap_or(usize::MAX);
    Camera::from_view_exact(View {
        position: record.position.into(),
        aim: record.aim.into(),
        up: record.up.into(),
        rows: count(record.rows),
        columns: count(record.columns),
        lens,
    })
}

impl Sensor for Camera {
    fn shape(&self) -> [usize; 2] {
        [self.rows(), self.columns()]
    }

    fn ray_within(&self, pixel: usize, offset: DVec2) -> Ray {
        let (row, column) = (pixel / self.columns(), pixel % self.columns());
        Camera::ray_within(self, row, column, offset)
    }

    fn row_within(&self, first: usize, offset: DVec2, rays: &mut [Ray]) {
        let (row, column) = (first / self.columns(), first % self.columns());
        Camera::row_within(self, row, column, offset, rays);
    }

    fn directions_within(&self, first: usize, offset: DVec2, directions: [&mut [f64]; 3]) {
        let (row, column) = (first / self.columns(), first % self.columns());
        Camera::directions_within(self, row, column, offset, directions);
    }

    fn grid_within(&self, offset: DVec2) -> Option<PixelGrid> {
        Camera::grid_within(self, offset)
    }

    fn through(&self, point: DVec2) -> Option<Box<dyn Sensor>> {
        Some(Box::new(Camera::through(self, point)?))
    }

    fn range_and_z(&self, pixel: usize, t: f64) -> [f64; 2] {
        let (row, column) = (pixel / self.columns(), pixel % self.columns());
        [self.range(row, column, t), self.z(row, column, t)]
    }

    fn camera(&self) -> Option<&Camera> {
        Some(self)
    }

    fn place(&self, _pixel: usize) -> (DVec3, Option<DVec3>) {
        (self.position(), Some(self.aim()))
    }

    fn record(&self) -> Record {
        Record::Camera(Box::new(camera_record(self)))
    }
}

/// The record of a camera in files.
pub fn camera_record(camera: &Camera) -> CameraRecord {
    let view = camera.view();
    let row = |m: &DMat3, k: usize| m.row(k).to_array();
    let viewplane = view.lens.viewplane();
    let named = |parameters: Vec<(&str, f64)>| {
        let parameters = parameters.into_iter();
        parameters.map(|(name, value)| (name.to_owned(), value)).collect()
    };
    let intrinsics = |k: DMat3| Intrinsics {
        k: [0, 1, 2].map(|row_index| row(&k, row_index)),
        first_pixel_center: 0.5,
        axes: "right, down, forwards".to_owned(),
    };
    CameraRecord {
        position: view.position.to_array(),
        aim: view.aim.to_array(),
        up: view.up.to_array(),
        focal_length: viewplane.map(|viewplane| viewplane.focal_length),
        width: viewplane.map(|viewplane| viewplane.width),
        height: viewplane.map(|viewplane| viewplane.height),
        rows: view.rows as u64,
        columns: view.columns as u64,
        projection: view.lens.projection().name().to_owned(),
        ray_start: viewplane.map_or("eye", |viewplane| viewplane.ray_start.name()).to_owned(),
        parameters: named(view.lens.parameters()),
        intrinsics: camera.intrinsic_matrix().map(intrinsics),
        pose: Pose {
            world_from_camera: rows_of(&camera.world_from_camera()),
            axes: "right, up, backwards".to_owned(),
        },
    }
}

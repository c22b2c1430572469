//! What makes frames: rays in rows and columns, with distances of their own and a record for files.

use std::fmt::Debug;

use crate::camera::{Camera, Lens, Projection, View};
use crate::error::Result;
use crate::geometry::{DMat3, DVec2, PixelGrid, Ray, Rays};
use crate::image::{CameraRecord, Intrinsics, Pose};

/// A ray for every pixel, row by row from the top, and for every point of a pixel. A [`Camera`] is one.
pub trait Sensor: Rays + Debug {
    /// Rows and columns.
    fn shape(&self) -> [usize; 2];

    /// The ray through a point of a pixel, pixels counted row by row from the top. `offset` runs from 0 to 1 rightwards and
    /// upwards; [`Rays::ray`] is the one at (0.5, 0.5).
    fn ray_within(&self, pixel: usize, offset: DVec2) -> Ray;

    /// Fills `rays` with those through a point of pixels that lie in one row, from `first` on: what [`ray_within`](Self::ray_within)
    /// gives, sooner than one by one.
    fn row_within(&self, first: usize, offset: DVec2, rays: &mut [Ray]) {
        for (pixel, ray) in (first..).zip(rays) {
            *ray = self.ray_within(pixel, offset);
        }
    }

    /// What [`ray_within`](Self::ray_within) gives for one offset has in common, as [`Rays::grid`] says.
    fn grid_within(&self, offset: DVec2) -> Option<PixelGrid>;

    /// The distance from the sensor along the ray, and that along its aim, of what the ray through a pixel's centre meets at
    /// its parameter `t`.
    fn range_and_z(&self, pixel: usize, t: f64) -> [f64; 2];

    /// What files say about it.
    fn record(&self) -> CameraRecord;
}

/// The camera that made an output, bit for bit, from what the output's metadata say.
///
/// # Errors
///
/// [`Error::Argument`](crate::Error::Argument) for a record that describes no camera.
pub fn camera_of(record: &CameraRecord) -> Result<Camera> {
    let projection: Projection = record.projection.parse()?;
    let mut lens = if record.parameters.is_empty() {
        let lengths = [
            ("focal_length", record.focal_length),
            ("width", record.width),
            ("height", record.height),
        ];
        let lengths = lengths.into_iter();
        let lengths: Vec<(&str, f64)> = lengths
            .filter_map(|(name, length)| Some((name, length?)))
            .collect();
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
    Camera::again(View {
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

    fn grid_within(&self, offset: DVec2) -> Option<PixelGrid> {
        Camera::grid_within(self, offset)
    }

    fn range_and_z(&self, pixel: usize, t: f64) -> [f64; 2] {
        let (row, column) = (pixel / self.columns(), pixel % self.columns());
        [self.range(row, column, t), self.z(row, column, t)]
    }

    fn record(&self) -> CameraRecord {
        let view = self.view();
        let row = |m: &DMat3, k: usize| m.row(k).to_array();
        let pose = self.world_from_camera();
        let pose_row = |k: usize| {
            let [x, y, z] = row(&pose.matrix3, k);
            [x, y, z, pose.translation[k]]
        };
        let viewplane = view.lens.viewplane();
        let named = |parameters: Vec<(&str, f64)>| {
            let parameters = parameters.into_iter();
            parameters
                .map(|(name, value)| (name.to_owned(), value))
                .collect()
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
            ray_start: viewplane
                .map_or("eye", |viewplane| viewplane.ray_start.name())
                .to_owned(),
            parameters: named(view.lens.parameters()),
            intrinsics: self.intrinsic_matrix().map(intrinsics),
            pose: Pose {
                world_from_camera: [pose_row(0), pose_row(1), pose_row(2), [0.0, 0.0, 0.0, 1.0]],
                axes: "right, up, backwards".to_owned(),
            },
        }
    }
}

//! A camera as the matrices that other programs take.

use super::{Camera, Lens, PixelMatrix};
use crate::geometry::{DAffine3, DMat3};

impl Camera {
    /// The pose: from the camera's coordinates (right, up, backwards, as in OpenGL and glTF) to the
    /// world's.
    pub fn world_from_camera(&self) -> DAffine3 {
        let rotation = DMat3::from_cols(self.right(), self.upwards(), -self.aim());
        DAffine3::from_mat3_translation(rotation, self.position())
    }

    /// The intrinsic matrix K, for camera coordinates (x right, y down, z forwards, as in OpenCV
    /// and COLMAP): `K (x, y, z) / z` is `(u, v, 1)`, u columns from the picture's left edge and v
    /// rows from its upper one. The centre of the first pixel is at (0.5, 0.5), as in COLMAP; for
    /// OpenCV, where it is at (0, 0), subtract 0.5 from the last column. Where the lens distorts, K
    /// comes after that. `None` for parallel rays, tilted viewplanes, and panoramas.
    pub fn intrinsic_matrix(&self) -> Option<DMat3> {
        self.pixel_matrix().map(|matrix| matrix.matrix())
    }

    /// The numbers of the intrinsic matrix.
    pub fn pixel_matrix(&self) -> Option<PixelMatrix> {
        match self.lens() {
            Lens::Flat(viewplane) => viewplane.pixel_matrix(self.size()),
            lens => {
                let given = lens.parameters();
                let of = |name| given.iter().find(|(own, _)| *own == name).map(|&(_, value)| value);
                Some(PixelMatrix {
                    fx: of("fx")?,
                    fy: of("fy")?,
                    cx: of("cx")?,
                    cy: of("cy")?,
                    skew: of("skew")?,
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{View, Viewplane};
    use crate::geometry::DVec3;

    /// Both matrices take the point at `t` on a pixel's ray to that pixel's centre.
    #[test]
    fn the_matrices_take_hits_back_to_their_pixels() {
        let camera = Camera::new(View {
            position: DVec3::new(3.0, -2.0, 5.0),
            aim: DVec3::new(-1.0, 0.5, -2.0),
            up: DVec3::new(0.1, 1.0, 0.3),
            rows: 7,
            columns: 11,
            lens: Lens::Flat(Viewplane {
                focal_length: 0.7,
                width: 1.9,
                height: 0.8,
                ..Viewplane::default()
            }),
        })
        .unwrap();
        let k = camera.intrinsic_matrix().unwrap();
        for (row, column) in [(0, 0), (0, 10), (6, 0), (3, 5), (6, 10)] {
            let point = camera.ray(row, column).at(4.0);
            let flip = DVec3::new(1.0, -1.0, -1.0);
            let in_camera = flip * camera.world_from_camera().inverse().transform_point3(point);
            let pixel = k * in_camera / in_camera.z;
            let expected = DVec3::new(column as f64 + 0.5, row as f64 + 0.5, 1.0);
            assert!((pixel - expected).length() < 1e-12, "{pixel}");
            assert!((in_camera.z - camera.z(row, column, 4.0)).abs() < 1e-12);
        }
    }

    #[test]
    fn parallel_rays_have_no_intrinsic_matrix() {
        let view = View {
            lens: Lens::Flat(Viewplane { parallel: true, ..Viewplane::default() }),
            ..View::default()
        };
        assert_eq!(Camera::new(view).unwrap().intrinsic_matrix(), None);
    }
}

//! The cameras and the light of a scene.

use std::str::SplitWhitespace;

use firsthit::camera::distortion::OpenCv;
use firsthit::camera::{Calibrated, FovAxis, View};
use firsthit::{Camera, DVec3, Lens, Projection, RayStart, Viewplane};

/// The places of the cameras and the light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Look {
    pub(crate) eye: DVec3,
    pub(crate) target: DVec3,
    pub(crate) up: DVec3,
    pub(crate) light: DVec3,
    pub(crate) fov: f64,
    /// The height that the orthographic camera sees, in scene units.
    pub(crate) height: f64,
    /// The distance up to which ambient occlusion reaches, in scene units.
    pub(crate) reach: f64,
}

impl Look {
    /// A camera of square pixels, its rays starting at the eye.
    pub(crate) fn camera(&self, parallel: bool, side: usize) -> Result<Camera, String> {
        let viewplane = if parallel {
            Ok(Viewplane {
                width: self.height,
                height: self.height,
                parallel,
                ray_start: RayStart::Eye,
                ..Viewplane::default()
            })
        } else {
            Viewplane::with_fov(self.fov, FovAxis::Vertical, side, side)
        };
        let lens = viewplane.map(Lens::Flat).map_err(|error| error.to_string())?;
        self.through(&lens, side)
    }

    /// The perspective camera with the distortion of a usual wide-angle lens: at the corners 12 %
    /// of the radius.
    pub(crate) fn distorted(&self, side: usize) -> Result<Camera, String> {
        let camera = self.camera(false, side)?;
        let matrix = camera.pixel_matrix().ok_or("the camera has no matrix")?;
        // As a share of the radius at the corners, whatever the field of view.
        let across = side as f64 / matrix.fx;
        let corner = 0.5 * across * across;
        let barrel = OpenCv {
            k1: -0.18 / corner,
            k2: 0.06 / (corner * corner),
            p1: 0.001,
            p2: -0.0005,
            ..OpenCv::default()
        };
        self.through(&Lens::OpenCv(Calibrated::new(matrix, barrel)), side)
    }

    /// A fisheye that sees half of the sphere in a circle that touches the edges, and more in the
    /// corners: Embree takes a pixel without a ray for one that may meet everything.
    pub(crate) fn fisheye(&self, side: usize) -> Result<Camera, String> {
        let said = |error: firsthit::Error| error.to_string();
        let half = Lens::with_fov(Projection::Equidistant, 180.0, side, side).map_err(said)?;
        let mut numbers = half.parameters();
        for (name, value) in &mut numbers {
            if *name == "fov" {
                *value = 360.0;
            }
        }
        let lens = Lens::named(Projection::Equidistant, &numbers).map_err(said)?;
        self.through(&lens, side)
    }

    fn through(&self, lens: &Lens, side: usize) -> Result<Camera, String> {
        let view = View {
            position: self.eye,
            aim: self.target - self.eye,
            up: self.up,
            rows: side,
            columns: side,
            lens: *lens,
        };
        Camera::new(view).map_err(|error| error.to_string())
    }
}

/// Reads what `benches/scenes.py` writes beside a mesh.
pub(super) fn parse(text: &str) -> Option<Look> {
    fn vector(words: &mut SplitWhitespace) -> Option<DVec3> {
        let mut number = || words.next()?.parse().ok();
        Some(DVec3::new(number()?, number()?, number()?))
    }
    let mut words = text.split_whitespace();
    let [eye, target, up, light, rest] = [(); 5].map(|()| vector(&mut words));
    let rest = rest?;
    Some(Look {
        eye: eye?,
        target: target?,
        up: up?,
        light: light?,
        fov: rest.x,
        height: rest.y,
        reach: rest.z,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_file_is_read_and_a_short_one_refused() {
        let text = "1 2 3\n4 5 6\n0 0 1\n7 8 9\n40 2.5 0.1\n";
        let look = parse(text).unwrap();
        assert_eq!(look.light, DVec3::new(7.0, 8.0, 9.0));
        assert_eq!((look.fov, look.height, look.reach), (40.0, 2.5, 0.1));
        assert_eq!(parse(text.trim_end_matches("0.1\n")), None);
        assert_eq!(parse(&text.replace("2.5", "high")), None);
    }
}

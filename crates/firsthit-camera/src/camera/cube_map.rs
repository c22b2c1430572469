//! The whole sphere on the six faces of a cube, each a perspective picture of 90 degrees seen from
//! inside.
//!
//! The picture's shape says how the faces lie, R(ight), L(eft), U(p), D(own), F(ront), B(ack):
//!
//! ```text
//! 6:1  R L U D F B      1:6  the same, from the top to the bottom
//! 3:2  R L U            4:3  . U . .
//!      D F B                 L F R B
//!                            . D . .
//! ```
//!
//! In rows this is the order of OpenGL's +x, -x, +y, -y, +z, -z where z is the aim. The faces
//! around have up at their upper edge; the lower edge of U and the upper edge of D touch F. In the
//! cross what is no face sees nothing.

use super::central::Central;
use crate::error::Result;
use crate::geometry::{DVec2, DVec3, require, settings};

settings! {
    /// See [`Projection::CubeMap`](super::Projection::CubeMap). Rays start at the camera.
    pub struct CubeMap {}
}

/// The letter of each face; to the right in its picture, down, and to its middle; the camera's x to
/// the right, y down, z ahead.
const FACES: [(u8, [DVec3; 3]); 6] = [
    (b'R', [DVec3::NEG_Z, DVec3::Y, DVec3::X]),
    (b'L', [DVec3::Z, DVec3::Y, DVec3::NEG_X]),
    (b'U', [DVec3::X, DVec3::Z, DVec3::NEG_Y]),
    (b'D', [DVec3::X, DVec3::NEG_Z, DVec3::Y]),
    (b'F', [DVec3::X, DVec3::Y, DVec3::Z]),
    (b'B', [DVec3::NEG_X, DVec3::Y, DVec3::NEG_Z]),
];

/// Rows and columns of faces, and the letters of those, row by row.
const LAYOUTS: [([usize; 2], &[u8]); 4] =
    [([1, 6], b"RLUDFB"), ([6, 1], b"RLUDFB"), ([2, 3], b"RLUDFB"), ([3, 4], b".U..LFRB.D..")];

/// The layout of a picture, and how many pixels the side of a face has.
fn layout([rows, columns]: [usize; 2]) -> Option<([usize; 2], &'static [u8], usize)> {
    LAYOUTS.iter().find_map(|&([down, across], faces)| {
        let side = rows / down;
        let fits = side >= 1 && rows == side * down && columns == side * across;
        fits.then_some(([down, across], faces, side))
    })
}

impl Central for CubeMap {
    fn prepare(&mut self, size: [usize; 2]) -> Result<()> {
        let [rows, columns] = size;
        let expected = "6 faces wide and 1 high, 1 and 6, 3 and 2, or 4 and 3";
        let got = format!("{columns} x {rows} pixels");
        require("columns and rows", expected, layout(size).is_some(), got)
    }

    fn direction(&self, size: [usize; 2], pixel: DVec2) -> Option<DVec3> {
        let ([rows, columns], letters, side) = layout(size)?;
        let at = pixel / side as f64;
        // Written so that what is beyond the edges belongs to the nearest face.
        let last = DVec2::new(columns as f64 - 1.0, rows as f64 - 1.0);
        let place = at.floor().clamp(DVec2::ZERO, last);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
        let index = place.y as usize * columns + place.x as usize;
        let letter = letters.get(index)?;
        let (_, [right, down, middle]) = FACES.iter().find(|(own, _)| own == letter)?;
        let within = 2.0 * (at - place) - DVec2::ONE;
        Some(middle + within.x * right + within.y * down)
    }

    fn pixel(&self, size: [usize; 2], direction: DVec3) -> Option<DVec2> {
        let ([_, columns], letters, side) = layout(size)?;
        // The face whose axis is nearest; of equal ones the first.
        let along = FACES.map(|(_, [_, _, middle])| direction.dot(middle));
        let largest = along.iter().copied().fold(0.0, f64::max);
        let is_nearest = |&along: &f64| along > 0.0 && along == largest;
        let (letter, [right, down, _]) = FACES[along.iter().position(is_nearest)?];
        let place = letters.iter().position(|&own| own == letter)?;
        let (row, column) = (place / columns, place % columns);
        let within = DVec2::new(direction.dot(right), direction.dot(down)) / largest;
        let corner = DVec2::new(column as f64, row as f64);
        Some(side as f64 * (corner + 0.5 * (within + DVec2::ONE)))
    }

    fn scaled(&self, _factors: [f64; 2]) -> Self {
        *self
    }
}

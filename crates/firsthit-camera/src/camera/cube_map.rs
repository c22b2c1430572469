//! The whole sphere on the six faces of a cube, each a perspective picture of 90 degrees seen from inside.
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
//! In rows this is the order of OpenGL's +x, -x, +y, -y, +z, -z where z is the aim. The faces around have up at their upper edge; the
//! lower edge of U and the upper edge of D touch F. In the cross what is no face sees nothing.

use super::central::Central;
use crate::error::Result;
use crate::geometry::{DVec2, DVec3, require, settings};

settings! {
    /// See [`Projection::CubeMap`](super::Projection::CubeMap). Rays start at the camera.
    pub struct CubeMap {}
}

/// A face: to the right in its picture, down, and to its middle; the camera's x to the right, y down, z ahead.
struct Face {
    right: DVec3,
    down: DVec3,
    middle: DVec3,
}

const FACES: [Face; 6] = [
    Face {
        right: DVec3::NEG_Z,
        down: DVec3::Y,
        middle: DVec3::X,
    },
    Face {
        right: DVec3::Z,
        down: DVec3::Y,
        middle: DVec3::NEG_X,
    },
    Face {
        right: DVec3::X,
        down: DVec3::Z,
        middle: DVec3::NEG_Y,
    },
    Face {
        right: DVec3::X,
        down: DVec3::NEG_Z,
        middle: DVec3::Y,
    },
    Face {
        right: DVec3::X,
        down: DVec3::Y,
        middle: DVec3::Z,
    },
    Face {
        right: DVec3::NEG_X,
        down: DVec3::Y,
        middle: DVec3::NEG_Z,
    },
];

/// Rows and columns of faces, and which face is where.
struct Layout {
    rows: usize,
    columns: usize,
    faces: &'static [Option<usize>],
}

const LAYOUTS: [Layout; 4] = [
    Layout {
        rows: 1,
        columns: 6,
        faces: &[Some(0), Some(1), Some(2), Some(3), Some(4), Some(5)],
    },
    Layout {
        rows: 6,
        columns: 1,
        faces: &[Some(0), Some(1), Some(2), Some(3), Some(4), Some(5)],
    },
    Layout {
        rows: 2,
        columns: 3,
        faces: &[Some(0), Some(1), Some(2), Some(3), Some(4), Some(5)],
    },
    Layout {
        rows: 3,
        columns: 4,
        faces: &[
            None,
            Some(2),
            None,
            None,
            Some(1),
            Some(4),
            Some(0),
            Some(5),
            None,
            Some(3),
            None,
            None,
        ],
    },
];

/// The layout of a picture, and how many pixels the side of a face has.
fn layout([rows, columns]: [usize; 2]) -> Option<(&'static Layout, usize)> {
    LAYOUTS.iter().find_map(|layout| {
        let side = rows / layout.rows;
        let fits = side >= 1 && rows == side * layout.rows && columns == side * layout.columns;
        fits.then_some((layout, side))
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
        let (layout, side) = layout(size)?;
        let at = pixel / side as f64;
        // Written so that what is beyond the edges belongs to the nearest face.
        let last = DVec2::new(layout.columns as f64 - 1.0, layout.rows as f64 - 1.0);
        let place = at.floor().clamp(DVec2::ZERO, last);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped"
        )]
        let index = place.y as usize * layout.columns + place.x as usize;
        let face = &FACES[(*layout.faces.get(index)?)?];
        let within = 2.0 * (at - place) - DVec2::ONE;
        Some(face.middle + within.x * face.right + within.y * face.down)
    }

    fn pixel(&self, size: [usize; 2], direction: DVec3) -> Option<DVec2> {
        let (layout, side) = layout(size)?;
        // The face whose axis is nearest; of equal ones the first.
        let along = FACES.each_ref().map(|face| direction.dot(face.middle));
        let largest = along.iter().copied().fold(0.0, f64::max);
        let number = along
            .iter()
            .position(|&along| along > 0.0 && along == largest)?;
        let face = &FACES[number];
        let place = layout.faces.iter().position(|&own| own == Some(number))?;
        let (row, column) = (place / layout.columns, place % layout.columns);
        let within = DVec2::new(direction.dot(face.right), direction.dot(face.down)) / largest;
        let corner = DVec2::new(column as f64, row as f64);
        Some(side as f64 * (corner + 0.5 * (within + DVec2::ONE)))
    }

    fn scaled(&self, _: [f64; 2]) -> Self {
        *self
    }
}

//! Colours of a PLY file.

use super::header::Type;
use crate::io::sanitize::linear;

/// The encoding of a colour's levels in a property of some type: as sRGB, up to the type's largest
/// number.
pub(super) struct Levels {
    largest: f64,
    /// The linear values of the levels 0 to 255, where those are all.
    table: Vec<f32>,
}

impl Levels {
    pub(super) fn new(kind: Type) -> Self {
        let largest = match kind {
            Type::Int8 => f64::from(i8::MAX),
            Type::Uint8 => f64::from(u8::MAX),
            Type::Int16 => f64::from(i16::MAX),
            Type::Uint16 => f64::from(u16::MAX),
            Type::Int32 => f64::from(i32::MAX),
            Type::Uint32 => f64::from(u32::MAX),
            Type::Float32 | Type::Float64 => 1.0,
        };
        let table = match kind {
            Type::Uint8 => (0..=u8::MAX).map(|k| linear(f64::from(k) / largest)).collect(),
            _ => Vec::new(),
        };
        Self { largest, table }
    }

    pub(super) fn linear(&self, level: f64) -> f32 {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "saturates; a level that is not whole is not from the table"
        )]
        let tabled = self.table.get(level as usize);
        match tabled {
            Some(&tabled) if level.fract() == 0.0 => tabled,
            _ => linear(level / self.largest),
        }
    }
}

use super::srgb::{srgb, unpremultiplied};
use crate::geometry::{Color, DisplayTransform, ToneMap};

/// The mapping from colours to bytes: a display transform, ready for many of them, and the sRGB
/// curve.
pub(super) struct Tones {
    gain: f64,
    tone_map: ToneMap,
}

impl Tones {
    pub(super) fn of(display: DisplayTransform) -> Self {
        Self { gain: display.gain(), tone_map: display.tone_map }
    }

    /// Fills `bytes` from colours, three for each.
    pub(super) fn apply(&self, values: &[f64], bytes: &mut [u8]) {
        if self.tone_map == ToneMap::None {
            // The most frequent picture, and the only one whose bytes need not know their pixel.
            let srgb = srgb();
            for (byte, &value) in bytes.iter_mut().zip(values) {
                *byte = srgb.byte(value * self.gain);
            }
            return;
        }
        let (pixels, _) = bytes.as_chunks_mut::<3>();
        let (values, _) = values.as_chunks::<3>();
        for (pixel, value) in pixels.iter_mut().zip(values) {
            *pixel = self.rgb(*value);
        }
    }

    /// Fills `bytes` from premultiplied colours, four for each. The colour shown is the one that
    /// alpha is divided out of.
    pub(super) fn apply_to_transparent(&self, values: &[f64], bytes: &mut [u8]) {
        let (pixels, _) = bytes.as_chunks_mut::<4>();
        let (values, _) = values.as_chunks::<4>();
        for (pixel, value) in pixels.iter_mut().zip(values) {
            *pixel = unpremultiplied(*value, |color| self.rgb(color));
        }
    }

    fn rgb(&self, color: [f64; 3]) -> [u8; 3] {
        let shown = self.tone_map.apply(Color::from(color) * self.gain);
        shown.to_array().map(|level| srgb().byte(level))
    }
}

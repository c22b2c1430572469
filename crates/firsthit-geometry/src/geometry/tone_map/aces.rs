use super::rows;
use crate::geometry::{Color, DMat3};

/// Linear Rec. 709 to ACES primaries (AP1), with the saturation of the reference rendering
/// transform (RRT).
const FROM_REC_709: DMat3 =
    rows([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]]);

/// ACES primaries to linear Rec. 709, with the saturation of the output device transform (ODT).
const TO_REC_709: DMat3 = rows([
    [1.60475, -0.53108, -0.07367],
    [-0.10208, 1.10813, -0.00605],
    [-0.00327, -0.07276, 1.07602],
]);

/// The ACES RRT and the ODT of sRGB in Stephen Hill's fit: "ACES.hlsl" in Matt Pettineo's Baking
/// Lab (2016). No factor comes before it: some programs divide by 0.6 to make the middle as bright
/// as without it.
pub(super) fn aces(color: Color) -> Color {
    TO_REC_709 * (FROM_REC_709 * color).map(fit)
}

/// The curve that fits both transforms.
fn fit(x: f64) -> f64 {
    (x * (x + 0.024_578_6) - 0.000_090_537) / (x * (0.983_729 * x + 0.432_951) + 0.238_081)
}

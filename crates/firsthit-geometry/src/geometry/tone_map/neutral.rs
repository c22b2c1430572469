use crate::geometry::Color;

/// The value where the compression of highlights starts: 0.8, less what is taken off for the
/// reflection of light from dielectrics.
const START: f64 = 0.8 - OFFSET;

/// The reflectance of dielectrics at normal incidence.
const OFFSET: f64 = 0.04;

/// The rate at which compressed highlights lose their colour.
const DESATURATION: f64 = 0.15;

/// Khronos PBR Neutral: "Khronos PBR Neutral Tone Mapper", specification, Khronos Group (2024).
pub(super) fn neutral(color: Color) -> Color {
    let least = color.min_element();
    let offset = if least < 2.0 * OFFSET { least - 6.25 * least * least } else { OFFSET };
    let color = color - offset;
    let peak = color.max_element();
    if peak < START {
        return color;
    }
    let room = 1.0 - START;
    let compressed = 1.0 - room * room / (peak + room - START);
    let color = color * (compressed / peak);
    let whiteness = 1.0 - 1.0 / (DESATURATION * (peak - compressed) + 1.0);
    color.lerp(Color::splat(compressed), whiteness)
}

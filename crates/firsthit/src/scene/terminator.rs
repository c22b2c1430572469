//! The edge of the light on smooth normals.

/// How much counts of light that has the cosines `smooth` to a shading normal and `flat` to the geometric one, both positive, where
/// `between` is the cosine between the normals. It is 1 where the light is high, and goes to 0 smoothly where the faces of a mesh, which
/// are flat, would cut the light of their smooth normals off (Chiang, Li and Burley, "Taming the Shadow Terminator", SIGGRAPH Talks 2019).
#[inline(always)]
pub(crate) fn softened(smooth: f64, flat: f64, between: f64) -> f64 {
    let share = flat / (smooth * between);
    if share < 1.0 {
        share * (1.0 + share * (1.0 - share))
    } else {
        1.0
    }
}

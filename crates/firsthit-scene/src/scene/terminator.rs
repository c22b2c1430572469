//! The edge of the light on smooth normals.

/// Factor on light whose cosines to the shading and geometric normals are `smooth` and `flat`, both
/// positive, where `between` is the cosine between the normals. It is 1 where the light is high,
/// and goes to 0 smoothly where the flat faces of a mesh would cut off the light of their smooth
/// normals (Chiang, Li and Burley, "Taming the Shadow Terminator", SIGGRAPH Talks 2019).
#[inline(always)]
#[doc(hidden)]
pub fn terminator_factor(smooth: f64, flat: f64, between: f64) -> f64 {
    let share = flat / (smooth * between);
    if share < 1.0 { share * (1.0 + share * (1.0 - share)) } else { 1.0 }
}

use super::DVec2;

/// The first hit of a ray: how far away, which object, and where on it.
///
/// ```
/// use firsthit::{DVec3, Hit, Object, Scene, Sphere, shoot};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let hit = shoot(&scene, DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z);
/// assert_eq!((hit.t, hit.object), (4.0, 0));
/// let miss = shoot(&scene, DVec3::new(0.0, 0.0, 5.0), DVec3::Z);
/// assert_eq!((miss.t, miss.object), (f64::INFINITY, -1));
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The ray's parameter, `t_min < t <= t_max`; infinity for a miss.
    pub t: f64,
    /// The object's index in the scene; -1 for a miss.
    pub object: i32,
    /// The part of the object: a mesh's triangle, a box's face, ...; -1 for a miss.
    pub primitive: i32,
    /// The weights of a triangle's corners 1 and 2 (corner 0 has the rest); NaN elsewhere.
    pub barycentric: DVec2,
}

impl Hit {
    /// The ray met nothing.
    pub const MISS: Self =
        Self { t: f64::INFINITY, object: -1, primitive: -1, barycentric: DVec2::NAN };

    /// Whether the ray met nothing.
    #[inline]
    pub fn is_miss(&self) -> bool {
        self.t == f64::INFINITY
    }
}

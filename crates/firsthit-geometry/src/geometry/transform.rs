use super::{DAffine3, DMat3, DVec3, Ray, unit};
use crate::error::{Error, Result};

/// The place of an object in the world: any affine map that can be undone, mirrored ones included.
///
/// ```
/// use firsthit::{DAffine3, DQuat, DVec3, Object, Scene, Sphere, Transform};
///
/// // An egg: twice as high as wide, leaning, at x = 10.
/// let egg = Transform::new(DAffine3::from_scale_rotation_translation(
///     DVec3::new(1.0, 1.0, 2.0),
///     DQuat::from_rotation_x(0.3),
///     DVec3::new(10.0, 0.0, 0.0),
/// ))?;
/// let object = Object::new(Sphere::new(DVec3::ZERO, 1.0)?).placed(egg);
/// let scene = Scene::new(vec![object])?;
/// assert!((scene.support(DVec3::X) - 11.0).abs() < 1e-12);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    world_from_object: DAffine3,
    /// The inverse's matrix. Its translation follows from both maps.
    object_from_world: DMat3,
    /// See [`Transform::rounding`]; a float32, which fills one place with the flag after it.
    rounding: f32,
    is_identity: bool,
}

impl Transform {
    /// The object's coordinates are the world's. Rays pass through it without any rounding.
    pub const IDENTITY: Self = Self {
        world_from_object: DAffine3::IDENTITY,
        object_from_world: DMat3::IDENTITY,
        // `f64::EPSILON`.
        rounding: 1.0 / (1_u64 << 52) as f32,
        is_identity: true,
    };

    /// The transform that takes object space to the world.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] when the map flattens space to working precision (what float64 finds as
    /// its inverse does not undo it) or holds a NaN or an infinity.
    pub fn new(world_from_object: DAffine3) -> Result<Self> {
        let object_from_world = world_from_object.inverse();
        let (there, back) = (world_from_object.matrix3, object_from_world.matrix3);
        // How far the inverse is from undoing the map.
        let left = norm(there * back - DMat3::IDENTITY);
        // Written so that a NaN fails.
        let undone = left < 1e-3;
        if !(world_from_object.is_finite() && object_from_world.is_finite() && undone) {
            let expected = "an affine map that can be undone";
            let rows = world_from_object.matrix3.transpose().to_cols_array_2d();
            let moved = world_from_object.translation.to_array();
            let got = format!("rows {rows:?}, moved by {moved:?}");
            return Err(Error::argument("transform", expected, got));
        }
        Ok(Self {
            world_from_object,
            object_from_world: back,
            rounding: at_least(left + f64::EPSILON * norm(there) * norm(back)),
            is_identity: world_from_object == DAffine3::IDENTITY,
        })
    }

    /// Moved by `offset`.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] when `offset` is not finite.
    pub fn translation(offset: DVec3) -> Result<Self> {
        Self::new(DAffine3::from_translation(offset))
    }

    /// The map from object space to the world.
    #[inline]
    pub fn world_from_object(&self) -> &DAffine3 {
        &self.world_from_object
    }

    /// The map from the world to object space.
    #[inline]
    pub fn object_from_world(&self) -> DAffine3 {
        let matrix3 = self.object_from_world;
        DAffine3 { matrix3, translation: -(matrix3 * self.world_from_object.translation) }
    }

    /// The error of a point that goes to the object and back, as a share of its coordinates, or a
    /// little more.
    #[doc(hidden)]
    #[inline]
    pub fn rounding(&self) -> f64 {
        self.rounding.into()
    }

    /// Whether this is exactly the identity.
    #[inline(always)]
    pub fn is_identity(&self) -> bool {
        self.is_identity
    }

    /// Whether both are the same map.
    #[inline]
    #[doc(hidden)]
    pub fn is_same_as(&self, other: &Self) -> bool {
        // That of nearly all objects, at a glance.
        self.is_identity && other.is_identity || self.world_from_object == other.world_from_object
    }

    /// Whether a box stays a box: every axis goes to an axis.
    pub fn keeps_axes(&self) -> bool {
        let m = self.world_from_object.matrix3;
        [m.x_axis, m.y_axis, m.z_axis]
            .iter()
            .all(|column| column.to_array().iter().filter(|&&x| x != 0.0).count() == 1)
    }

    /// A world ray in object space. Its `t` is the same: the direction is not normalised.
    #[inline(always)]
    pub fn ray_in_object(&self, ray: &Ray) -> Ray {
        if self.is_identity {
            return *ray;
        }
        Ray {
            // The translation first: far from the world's origin it would cancel what the matrix
            // rounds.
            origin: self.object_from_world * (ray.origin - self.world_from_object.translation),
            direction: self.object_from_world * ray.direction,
            t_min: ray.t_min,
            t_max: ray.t_max,
        }
    }

    /// An object-space point in the world.
    #[inline(always)]
    pub fn point_in_world(&self, point: DVec3) -> DVec3 {
        if self.is_identity {
            return point;
        }
        self.world_from_object.transform_point3(point)
    }

    /// An object-space normal in the world, of length one if `normal` is. (Without a transform it
    /// is `normal` as it stands.)
    ///
    /// It goes by the inverse transpose, not by the cofactors: so a mirrored object keeps its
    /// outside.
    #[inline(always)]
    pub fn normal_in_world(&self, normal: DVec3) -> DVec3 {
        if self.is_identity() {
            return normal;
        }
        unit(self.object_from_world.transpose() * normal)
    }
}

/// The least float32 that is not smaller.
#[expect(clippy::cast_possible_truncation, reason = "the next one is taken where it is smaller")]
fn at_least(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) < x { near.next_up() } else { near }
}

/// The largest growth of the largest coordinate by the map.
fn norm(m: DMat3) -> f64 {
    (m.x_axis.abs() + m.y_axis.abs() + m.z_axis.abs()).max_element()
}

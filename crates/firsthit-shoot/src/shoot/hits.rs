//! The hits of many rays.

use crate::error::Result;
use crate::geometry::summary::summary;
use crate::geometry::{DVec2, Hit};
use crate::memory::fit;

/// The hits of many rays, an array for each quantity; see [`Hit`] for their meaning.
///
/// ```
/// use firsthit::{Camera, Object, Scene, Sphere, DVec3, View, shoot::{First, trace}};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::new(0.0, 0.0, -5.0), 1.0)?)])?;
/// let camera = Camera::new(View::default())?;
/// let hits = trace(&scene, &camera, First, &())?;
/// assert_eq!(hits.len(), camera.pixels());
/// // Row 240, column 320.
/// assert_eq!(hits.object[240 * camera.columns() + 320], 0);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Clone, Default, PartialEq)]
pub struct Hits {
    /// The rays' parameters, infinity for a miss.
    pub t: Vec<f64>,
    /// The objects' identifiers, -1 for a miss.
    pub object: Vec<i32>,
    /// The primitives' identifiers, -1 for a miss.
    pub primitive: Vec<i32>,
    /// The weights of a triangle's corners 1 and 2, else NaN.
    pub barycentric: Vec<DVec2>,
}

// Rays are many.
summary!(Hits, "Hits", |hits| "rays": hits.len(), "hit": hits.count_hit());

impl Hits {
    /// The number of rays that hit something.
    pub fn count_hit(&self) -> usize {
        self.t.iter().filter(|&&t| t < f64::INFINITY).count()
    }

    /// Makes room for `count` hits, whatever they are.
    pub(super) fn fit(&mut self, count: usize) -> Result<()> {
        fit(&mut self.t, count)?;
        fit(&mut self.object, count)?;
        fit(&mut self.primitive, count)?;
        fit(&mut self.barycentric, count)
    }

    pub(super) fn slices(&mut self) -> HitSlices<'_> {
        HitSlices {
            t: &mut self.t,
            object: &mut self.object,
            primitive: &mut self.primitive,
            barycentric: &mut self.barycentric,
        }
    }

    /// The number of rays.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether there were none.
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// The hit of the ray `index`.
    ///
    /// # Panics
    ///
    /// When there was no such ray.
    pub fn get(&self, index: usize) -> Hit {
        Hit {
            t: self.t[index],
            object: self.object[index],
            primitive: self.primitive[index],
            barycentric: self.barycentric[index],
        }
    }
}

/// The destination of hits: [`Hits`] in memory of the caller's, all of one length.
#[derive(Debug)]
pub struct HitSlices<'a> {
    /// The rays' parameters, infinity for a miss.
    pub t: &'a mut [f64],
    /// The objects' identifiers, -1 for a miss.
    pub object: &'a mut [i32],
    /// The primitives' identifiers, -1 for a miss.
    pub primitive: &'a mut [i32],
    /// The weights of a triangle's corners 1 and 2, else NaN.
    pub barycentric: &'a mut [DVec2],
}

impl HitSlices<'_> {
    /// The number of hits that fit; `None` where the lengths differ.
    pub fn count(&self) -> Option<usize> {
        let count = self.t.len();
        let others = [self.object.len(), self.primitive.len(), self.barycentric.len()];
        (others == [count; 3]).then_some(count)
    }

    /// Writes a hit.
    ///
    /// # Panics
    ///
    /// When there is no place `index`.
    #[inline(always)]
    pub fn put(&mut self, index: usize, hit: &Hit) {
        self.t[index] = hit.t;
        self.object[index] = hit.object;
        self.primitive[index] = hit.primitive;
        self.barycentric[index] = hit.barycentric;
    }

    /// Splits the slices at an index.
    pub(super) fn split_at(self, index: usize) -> (Self, Self) {
        let (t, later_t) = self.t.split_at_mut(index);
        let (object, later_object) = self.object.split_at_mut(index);
        let (primitive, later_primitive) = self.primitive.split_at_mut(index);
        let (barycentric, later_barycentric) = self.barycentric.split_at_mut(index);
        let before = Self { t, object, primitive, barycentric };
        let after = Self {
            t: later_t,
            object: later_object,
            primitive: later_primitive,
            barycentric: later_barycentric,
        };
        (before, after)
    }

    #[inline(always)]
    pub(super) fn get(&self, index: usize) -> Hit {
        Hit {
            t: self.t[index],
            object: self.object[index],
            primitive: self.primitive[index],
            barycentric: self.barycentric[index],
        }
    }
}

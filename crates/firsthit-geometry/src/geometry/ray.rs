use bytemuck::{Pod, Zeroable};

use super::{DVec3, PixelGrid, RayFilter};

/// The points `origin + t * direction` with `t_min < t <= t_max`, in world space unless said
/// otherwise.
///
/// `direction` need not be of length one: `t` is in units of its length, a distance only when that
/// is one (as it is for every camera's rays).
///
/// ```
/// use firsthit::{DVec3, Ray};
///
/// let ray = Ray::new(DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.0, 2.0, 0.0)).up_to(10.0);
/// assert_eq!(ray.at(3.0), DVec3::new(1.0, 6.0, 0.0));
/// ```
// Kernels load a ray as eight numbers. So it is `Pod`, which is no promise to users, and the order
// of its fields is that of these numbers: `accel/rays/packet.rs` asserts it.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Ray {
    /// The point where `t` is zero; not itself part of the ray.
    pub origin: DVec3,
    /// The direction; any vector but zero.
    pub direction: DVec3,
    /// The parameter after which the ray begins: the largest `t` that does not yet count. Zero
    /// leaves out a surface that the ray starts on; any negative number lets it be met, and what is
    /// behind the origin down to there.
    pub t_min: f64,
    /// The largest `t` that counts.
    pub t_max: f64,
}

impl Ray {
    /// Coordinates up to here have squares that float64 can hold.
    #[doc(hidden)]
    pub const FARTHEST: f64 = 1e150;

    /// The ray from its origin on, without an end.
    #[inline(always)]
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction, t_min: 0.0, t_max: f64::INFINITY }
    }

    /// The ray, beginning at `t_min` (which does not yet count). A ray that begins at the `t` of a
    /// hit on an edge may meet the neighbouring triangle a last digit later. A negative `t_min`
    /// begins behind the origin, which takes longer: rays go one by one, and each triangle that
    /// they may meet is tested in float64.
    #[inline]
    pub fn beyond(self, t_min: f64) -> Self {
        Self { t_min, ..self }
    }

    /// The ray, ending at `t_max` (which still counts).
    #[inline(always)]
    pub fn up_to(self, t_max: f64) -> Self {
        Self { t_max, ..self }
    }

    /// The point at the parameter `t`.
    #[inline(always)]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }

    /// Whether what is at `t` is on the ray.
    #[inline]
    pub fn holds(&self, t: f64) -> bool {
        t > self.t_min && t <= self.t_max
    }

    /// Whether the ray is all that is ahead of its origin.
    #[inline]
    #[doc(hidden)]
    pub fn is_whole(&self) -> bool {
        self.t_min == 0.0 && self.t_max == f64::INFINITY
    }

    /// Whether this ray can meet anything: its origin's coordinates from -10^150 to 10^150, its
    /// direction finite and not zero, `t_max` above `t_min`, and positive unless that is negative.
    /// Any other ray is a miss, and only that.
    #[inline]
    pub fn is_valid(&self) -> bool {
        // Written so that a NaN fails.
        self.origin.abs().max_element() <= Self::FARTHEST
            && !self.origin.is_nan()
            && self.direction.is_finite()
            && self.direction != DVec3::ZERO
            && (self.t_max > 0.0 || self.t_min < 0.0)
            && self.t_min < self.t_max
    }
}

/// Rays by number, made when they are needed.
///
/// ```
/// use firsthit::shoot::{First, trace};
/// use firsthit::{DVec3, Object, Ray, Scene, Sphere};
///
/// // An array of rays is one; so is a camera.
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let rays: Vec<Ray> = (0..5)
///     .map(|k| Ray::new(DVec3::new(0.5 * f64::from(k), 0.0, 5.0), DVec3::NEG_Z))
///     .collect();
/// assert_eq!(trace(&scene, &rays, First, &())?.object, [0, 0, 0, -1, -1]);
/// # Ok::<(), firsthit::Error>(())
/// ```
pub trait Rays: Sync {
    /// The number of rays.
    fn len(&self) -> usize;

    /// The ray `index`, below [`Rays::len`].
    fn ray(&self, index: usize) -> Ray;

    /// Fills `rays` with those from `first` on, at most up to [`Rays::len`]: what [`Rays::ray`]
    /// gives, sooner than one by one.
    fn read(&self, first: usize, rays: &mut [Ray]) {
        if let Some(grid) = self.grid() {
            return grid.read(first, rays);
        }
        for (index, ray) in (first..).zip(rays) {
            *ray = self.ray(index);
        }
    }

    /// The rays as a slice, if they are one: its element `index` is that of [`Rays::ray`]. Rays are
    /// prefetched from it. A view that reorders or changes rays returns `None`.
    fn array(&self) -> Option<&[Ray]> {
        None
    }

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The grid of pixels, if the rays are those of one, row by row from the top: then they are
    /// shot in tiles, which is many times faster. Then [`Rays::ray`] gives just the grid's rays,
    /// with neither `t_min` nor `t_max`.
    fn grid(&self) -> Option<PixelGrid> {
        None
    }

    /// Rows and columns, if the rays all start in one point and are those of a picture, row by row,
    /// whose neighbours go nearly the same way, though through no flat grid of pixels: those of a
    /// fisheye, say. Then they are shot in tiles too. Asked for where there is no [`Rays::grid`].
    ///
    /// Then [`Rays::ray`] gives rays with neither `t_min` nor `t_max`, whose directions have
    /// lengths between 1e-80 and 1e80. One whose direction is zero or NaN is a miss.
    fn picture(&self) -> Option<[usize; 2]> {
        None
    }

    /// Fills the slices with x, y and z of the directions from `first` on, all in one row of
    /// the [`Rays::picture`]: what [`Rays::ray`] gives, sooner than one by one.
    fn read_directions(&self, first: usize, [x, y, z]: [&mut [f64]; 3]) {
        for (index, ((x, y), z)) in (first..).zip(x.iter_mut().zip(y).zip(z)) {
            (*x, *y, *z) = self.ray(index).direction.into();
        }
    }

    /// Whether some of the rays do not meet everything. They are traced in packets or one by one
    /// then, never in tiles.
    fn is_filtered(&self) -> bool {
        false
    }

    /// The filter of the ray `index`; asked for where [`Rays::is_filtered`].
    fn filter(&self, _index: usize) -> RayFilter {
        RayFilter::NONE
    }
}

/// Rays that do not meet everything: one filter for all of them, or one for each.
///
/// ```
/// use firsthit::shoot::{First, trace};
/// use firsthit::{DVec3, Filtered, Object, Ray, RayFilter, Scene, Sphere};
///
/// let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0)?).masked(0b10);
/// let scene = Scene::new(vec![ball])?;
/// let ray = Ray::new(DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z);
/// let filters = [0b01, 0b10, 0b11].map(|mask| RayFilter { mask, ..RayFilter::NONE });
/// let hits = trace(&scene, &Filtered::each(&[ray; 3], &filters), First, &())?;
/// assert_eq!(hits.object, [-1, 0, 0]);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Filtered<'a, R: ?Sized> {
    rays: &'a R,
    common: RayFilter,
    each: &'a [RayFilter],
}

impl<'a, R: Rays + ?Sized> Filtered<'a, R> {
    /// One filter for all rays.
    pub fn new(rays: &'a R, filter: RayFilter) -> Self {
        let common = filter;
        Self { rays, common, each: &[] }
    }

    /// A filter for each ray; those beyond the end of `filters` meet everything.
    pub fn each(rays: &'a R, filters: &'a [RayFilter]) -> Self {
        Self { each: filters, ..Self::new(rays, RayFilter::NONE) }
    }
}

impl<R: Rays + ?Sized> Rays for Filtered<'_, R> {
    fn len(&self) -> usize {
        self.rays.len()
    }

    fn ray(&self, index: usize) -> Ray {
        self.rays.ray(index)
    }

    fn read(&self, first: usize, rays: &mut [Ray]) {
        self.rays.read(first, rays);
    }

    fn array(&self) -> Option<&[Ray]> {
        self.rays.array()
    }

    fn grid(&self) -> Option<PixelGrid> {
        self.rays.grid()
    }

    fn picture(&self) -> Option<[usize; 2]> {
        self.rays.picture()
    }

    fn read_directions(&self, first: usize, directions: [&mut [f64]; 3]) {
        self.rays.read_directions(first, directions);
    }

    fn is_filtered(&self) -> bool {
        !self.common.is_none() || !self.each.is_empty()
    }

    fn filter(&self, index: usize) -> RayFilter {
        self.each.get(index).copied().unwrap_or(self.common)
    }
}

/// An array of rays, and whatever holds one.
impl<R: AsRef<[Ray]> + Sync + ?Sized> Rays for R {
    fn len(&self) -> usize {
        self.as_ref().len()
    }

    fn ray(&self, index: usize) -> Ray {
        self.as_ref()[index]
    }

    fn read(&self, first: usize, rays: &mut [Ray]) {
        rays.copy_from_slice(&self.as_ref()[first..first + rays.len()]);
    }

    fn array(&self) -> Option<&[Ray]> {
        Some(self.as_ref())
    }
}

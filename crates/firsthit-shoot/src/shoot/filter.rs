//! Filters of rays, object by object: a [`RayFilter`] brought into an object's space.

use super::scaled_ray::ScaledRay;
use crate::geometry::{DVec3, Ray, RayFilter, Side, SurfaceId, arrays};
use crate::scene::{Group, Object, Scene};
use crate::shape::triangle::{Begin, MeshFilter};
use crate::shape::{Crossing, Shape, Surface};

/// The numbering of an object's primitives.
#[derive(Clone, Copy)]
pub(super) enum Place {
    /// The object's primitives are numbered by themselves.
    Object(u32),
    /// The primitives are numbered with those of the objects that this one leads, as rays come to
    /// them.
    Leader(u32),
}

impl Place {
    #[inline(always)]
    fn index(self) -> u32 {
        match self {
            Self::Object(index) | Self::Leader(index) => index,
        }
    }

    /// The number of a surface, if it is one of this object or of those that it leads.
    #[inline(always)]
    pub(super) fn number(self, scene: &Scene, surface: SurfaceId) -> Option<u32> {
        let object = u32::try_from(surface.object).ok()?;
        let primitive = u32::try_from(surface.primitive).ok()?;
        match self {
            Self::Object(index) => (index == object).then_some(primitive),
            Self::Leader(index) => {
                (scene.leader_of(object) == index).then(|| scene.number_of(object, primitive))
            }
        }
    }
}

/// Whether a ray sees an object, or one of those that it leads.
#[inline(always)]
pub(super) fn sees_any(scene: &Scene, filter: &RayFilter, index: u32, object: &Object) -> bool {
    let leads = |only: i32| u32::try_from(only).is_ok_and(|only| scene.leader_of(only) == index);
    let is_asked_for = filter.only.is_none_or(leads);
    is_asked_for && !object.is_hidden() && object.mask() & filter.mask != 0
}

/// Whether a ray sees an object at all.
#[inline(always)]
pub(super) fn sees(filter: &RayFilter, index: u32, object: &Object) -> bool {
    let is_asked_for = filter.only.is_none_or(|only| only == index.cast_signed());
    is_asked_for && !object.is_hidden() && object.mask() & filter.mask != 0
}

/// Whether a filter may hide the first of several objects in one place and leave another. Where it
/// does not, the first answers for all.
#[inline(always)]
pub(super) fn tells_copies_apart(filter: &RayFilter, index: u32, object: &Object) -> bool {
    let is_of_it = |surface: &SurfaceId| is_of(surface, index);
    // A ray that leaves a triangle does not meet its copies either: see `triangle::departure`.
    // Other shapes have no such rule.
    !sees(filter, index, object)
        || filter.skip.iter().flatten().any(is_of_it)
        || (filter.departure.is_some() && object.mesh().is_none())
}

/// The filter of a ray at an object's mesh.
fn mesh_filter(scene: &Scene, filter: &RayFilter, place: Place) -> MeshFilter {
    let mut of_mesh = MeshFilter::NONE;
    set_mesh_filter(&mut of_mesh, scene, filter, place);
    of_mesh
}

/// Sets the filter of a ray at an object's mesh in place.
#[inline(always)]
pub(super) fn set_mesh_filter(
    of_mesh: &mut MeshFilter,
    scene: &Scene,
    filter: &RayFilter,
    place: Place,
) {
    let of_object = |surface: SurfaceId| place.number(scene, surface);
    let skip = arrays::map(filter.skip, |surface| surface.and_then(of_object));
    of_mesh.set(skip, filter.cull, filter.departure.is_some());
    if let Some(departure) = &filter.departure
        && let Some(corners) = corners_left(scene, departure.surface, place.index())
    {
        of_mesh.leave(of_object(departure.surface), corners, departure.barycentric);
    }
    if let (Some(only), Place::Leader(_)) = (filter.only, place)
        && let Some(numbers) = scene.numbers_of(only.cast_unsigned())
    {
        of_mesh.keep(numbers);
    }
}

/// The corners of the triangle that a ray leaves, if it is one in the space of this object.
#[inline(always)]
fn corners_left(scene: &Scene, surface: SurfaceId, index: u32) -> Option<[DVec3; 3]> {
    let left = (scene.objects()).get(usize::try_from(surface.object).ok()?)?;
    let here = &scene.objects()[index as usize];
    let mesh = left.mesh()?;
    let triangle = usize::try_from(surface.primitive).ok()?;
    let is_same_space =
        surface.object.cast_unsigned() == index || left.transform().is_same_as(here.transform());
    (is_same_space && triangle < mesh.triangles().len()).then(|| mesh.corners(triangle))
}

/// The largest number that the place of a start in the world is computed from.
#[inline(always)]
pub(super) fn largest_of_start(scene: &Scene, start: DVec3, left: SurfaceId) -> f64 {
    let left = usize::try_from(left.object).ok();
    let left = left.and_then(|left| scene.objects().get(left));
    let start = start.abs().max_element();
    start.max(left.map_or(0.0, Object::farthest))
}

/// A ray in an object's space, and what it does not meet of the object's mesh.
pub(super) fn in_object(
    scene: &Scene,
    (scaled, from): (&ScaledRay, &RayFilter),
    place: Place,
    t_max: f64,
) -> Option<(Ray, MeshFilter)> {
    let object = &scene.objects()[place.index() as usize];
    let mut ray = scaled.in_object(object, t_max)?;
    let mut filter = match object.mesh() {
        Some(_) => mesh_filter(scene, from, place),
        None => MeshFilter::NONE,
    };
    if let Some(point) = filter.departure() {
        ray.origin = point.rounded;
    } else if let Some(departure) = from.departure {
        let start = largest_of_start(scene, scaled.ray.origin, departure.surface);
        let along = scaled.ray.direction.abs().max_element();
        let group = match place {
            Place::Leader(index) => scene.group_led_by(index),
            Place::Object(_) => None,
        };
        let [least, most] = group.map_or([object.farthest(); 2], Group::farthest);
        let begin = Begin::new(start, along, most);
        let earliest = begin.at(least);
        ray.t_min = ray.t_min.max(earliest);
        if earliest < begin.at(most) {
            filter.begin(begin);
        }
    }
    ray.is_valid().then_some((ray, filter))
}

/// Whether a ray meets all of an object that is no mesh and that it sees.
#[inline(always)]
pub(super) fn meets_all_of(filter: &RayFilter, index: u32) -> bool {
    let is_elsewhere = |surface: SurfaceId| !is_of(&surface, index);
    filter.cull.is_none()
        && filter.skip.iter().flatten().all(|&surface| is_elsewhere(surface))
        && filter.departure.is_none_or(|departure| is_elsewhere(departure.surface))
}

#[inline(always)]
fn is_of(surface: &SurfaceId, index: u32) -> bool {
    surface.object == index.cast_signed()
}

/// The crossings of a ray in object space with a shape that is no mesh; its `t` times `t_scale` is
/// the caller's.
pub(super) fn crossings(
    filter: &RayFilter,
    index: u32,
    shape: &Shape,
    (ray, t_scale): (&Ray, f64),
) -> [Option<Crossing>; 2] {
    let left = filter.departure.map(|departure| departure.surface);
    let left = left.filter(|surface| is_of(surface, index));
    let is_skipped = |surface: &SurfaceId| is_of(surface, index);
    if left.is_none() && !filter.skip.iter().flatten().any(is_skipped) {
        return shape.crossings(ray).map(|crossing| {
            crossing.filter(|crossing| is_not_culled(filter, shape, ray, crossing))
        });
    }
    if let Some(surface) = left {
        // Out of a convex shape nothing more of it is ahead; into one, the far end. A flat shape is
        // left behind.
        let normal = shape.normal(ray.origin, surface.primitive);
        let is_inwards = ray.direction.dot(normal) < 0.0;
        if !is_inwards {
            return [None; 2];
        }
    }
    let line = Ray { t_min: f64::NEG_INFINITY, t_max: f64::INFINITY, ..*ray };
    let mut crossings = shape.crossings(&line);
    if left.is_some() {
        crossings[0] = None;
    }
    leave_out_skipped(filter, index, &mut crossings, t_scale);
    crossings.map(|crossing| {
        crossing
            .filter(|crossing| ray.holds(crossing.t) && is_not_culled(filter, shape, ray, crossing))
    })
}

/// Leaves out the crossings of a line with a shape that is no mesh that the ray is told to skip;
/// `t` times `t_scale` is the caller's.
pub(super) fn leave_out_skipped(
    filter: &RayFilter,
    index: u32,
    crossings: &mut [Option<Crossing>; 2],
    t_scale: f64,
) {
    for (surface, end) in filter.skip.iter().zip([0.0, 1.0 / t_scale]) {
        if let Some(surface) = surface.filter(|surface| is_of(surface, index)) {
            leave_out(crossings, surface.primitive, end);
        }
    }
}

/// Leaves out the crossing of a part of a shape that is nearest to a parameter.
fn leave_out(crossings: &mut [Option<Crossing>; 2], primitive: i32, end: f64) {
    let distance = |crossing: &Option<Crossing>| {
        let same = crossing.filter(|crossing| crossing.primitive == primitive);
        same.map_or(f64::INFINITY, |crossing| (crossing.t - end).abs())
    };
    let [first, second] = crossings.each_ref().map(distance);
    if first.min(second) < f64::INFINITY {
        crossings[usize::from(second < first)] = None;
    }
}

pub(super) fn is_not_culled(
    filter: &RayFilter,
    shape: &Shape,
    ray: &Ray,
    crossing: &Crossing,
) -> bool {
    filter.cull.is_none_or(|culled| {
        let point: DVec3 = ray.at(crossing.t);
        let along = ray.direction.dot(shape.normal(point, crossing.primitive));
        let side = if along < 0.0 { Side::Front } else { Side::Back };
        side != culled
    })
}

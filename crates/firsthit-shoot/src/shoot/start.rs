//! Rays that leave an edge or a corner of an open mesh, and are stopped there: see
//! `shape/triangle/fan.rs`.

use std::cell::Cell;

use super::filter::Place;
use crate::accel::{EachCandidate, InstructionSet, Scratch};
use crate::geometry::orientation::projection_axis;
use crate::geometry::{DVec3, Ray, RayFilter, SurfaceId};
use crate::scene::Scene;
use crate::shape::triangle::{DeparturePoint, Fan, MeshFilter};
use crate::shape::{Crossing, Mesh};
use crate::simd;

/// The crossing that stops a ray, given in the space of an object, at the point of that object
/// which it leaves. `t` is the least above zero.
///
/// Closed meshes stop no ray: it crosses them as often as its start says.
#[inline(always)]
pub(super) fn met_at_start(
    scene: &Scene,
    whole: &RayFilter,
    (place, ray, filter): (Place, &Ray, &MeshFilter),
) -> Option<Crossing> {
    let is_possible = filter.departure().is_some_and(DeparturePoint::is_at_edge);
    if is_possible { search(scene, whole, (place, ray, filter)) } else { None }
}

#[cold]
#[inline(never)]
fn search(
    scene: &Scene,
    whole: &RayFilter,
    (place, ray, filter): (Place, &Ray, &MeshFilter),
) -> Option<Crossing> {
    let departure = whole.departure?;
    let side = departure.side?;
    let point = filter.departure()?;
    let SurfaceId { object, primitive } = departure.surface;
    place.number(scene, departure.surface)?;
    let (index, left) = (object.cast_unsigned(), primitive.cast_unsigned());
    let object = &scene.objects()[index as usize];
    let mesh = object.mesh()?;
    // Without memory to find out, it is as good as closed: nothing is stopped.
    if mesh.is_closed().unwrap_or(true) {
        return None;
    }
    let fan = Fan {
        triangles: around(scene, (index, mesh), (left, point)),
        is_of_one_way: mesh.edges_are_of_one_way().unwrap_or(false),
    };
    let triangle = point.stopped_by(ray.direction, side, &fan)?;
    let corners = mesh.corners(triangle as usize);
    let met = SurfaceId { primitive: triangle.cast_signed(), ..departure.surface };
    let number = place.number(scene, met)?;
    let crossing = Crossing {
        t: f64::MIN_POSITIVE,
        primitive: number.cast_signed(),
        barycentric: point.weights_in(corners),
    };
    let is_met = filter.admits(ray.direction, (number, corners))
        && !object.is_cut_out(mesh, triangle as usize, crossing.barycentric);
    (is_met && ray.holds(crossing.t)).then_some(crossing)
}

/// The most triangles that are compared each with each.
const FEW: usize = 16;

thread_local! {
    /// Memory for [`around`], to be used again.
    static SCRATCH: Cell<Option<Scratch>> = const { Cell::new(None) };
}

/// The triangles of an object's mesh that hold a point of one: those with an area, and of those in
/// one place the lowest.
fn around(
    scene: &Scene,
    (index, mesh): (u32, &Mesh),
    (left, point): (u32, &DeparturePoint),
) -> Vec<(u32, [DVec3; 3])> {
    let mut around = Vec::with_capacity(8);
    let mut look_at = |triangle: u32| {
        let corners = mesh.corners(triangle as usize);
        if point.is_held_by(&corners) && projection_axis(&corners).is_some() {
            around.push((triangle, corners));
        }
    };
    let leader = scene.leader_of(index);
    let at_mesh = scene.at_mesh(leader);
    // The tree leaves out copies, of which there may be thousands.
    let rings = if at_mesh.is_some_and(|(_, tree)| tree.has_copies()) {
        None
    } else {
        mesh.around(left, point.first_corner())
    };
    if let Some(ring) = rings {
        ring.for_each(look_at);
    } else if let Some((meshes, tree)) = at_mesh {
        let is_joined = meshes.one().is_none();
        // Any ray from there comes to all of them.
        let ray = Ray::new(point.rounded, DVec3::new(7.0, 10.0, 10.5)).up_to(f64::MIN_POSITIVE);
        let mut scratch = SCRATCH.take().unwrap_or_default();
        let each = EachCandidate {
            scratch: &mut scratch,
            at_mesh: (tree, meshes),
            ray: &ray,
            off: point.off,
            // A lower one may be another object's.
            with_copies: is_joined,
            visit: &mut |triangle, t_max| {
                let surface = scene.surface_at(leader, triangle.cast_signed());
                if surface.object == index.cast_signed() {
                    look_at(surface.primitive.cast_unsigned());
                }
                t_max
            },
        };
        let set = InstructionSet::current().unwrap_or(InstructionSet::Portable);
        simd::run(set, each);
        SCRATCH.set(Some(scratch));
    } else {
        let triangles = 0..u32::try_from(mesh.triangles().len()).unwrap_or(u32::MAX);
        triangles.for_each(look_at);
    }
    keep_lowest(&mut around);
    around
}

/// Keeps of triangles in one place the lowest: a face that a file has twice is one face, whatever
/// the order of its corners. All have an area.
fn keep_lowest(triangles: &mut Vec<(u32, [DVec3; 3])>) {
    if triangles.len() > FEW {
        // Equal corners come together, the lowest number first.
        let key = |(number, corners): &(u32, [DVec3; 3])| (sorted(*corners), *number);
        triangles.sort_by_cached_key(key);
        triangles.dedup_by_key(|(_, corners)| sorted(*corners));
        return;
    }
    let mut kept = 0;
    for at in 0..triangles.len() {
        let triangle = triangles[at];
        let is_here = |(_, other): &(u32, [DVec3; 3])| other.iter().all(|p| triangle.1.contains(p));
        if let Some(other) = triangles[..kept].iter_mut().find(|other| is_here(other)) {
            if triangle.0 < other.0 {
                *other = triangle;
            }
        } else {
            triangles.swap(kept, at);
            kept += 1;
        }
    }
    triangles.truncate(kept);
}

/// The corners of a triangle as numbers, in one order for all orders.
fn sorted(corners: [DVec3; 3]) -> [[u64; 3]; 3] {
    // Zeros of both signs are one.
    let mut numbers = corners.map(|corner| (corner + DVec3::ZERO).to_array().map(f64::to_bits));
    numbers.sort_unstable();
    numbers
}

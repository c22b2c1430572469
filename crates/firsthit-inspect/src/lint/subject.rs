//! A mesh made ready for checks: vertices welded, edges with the triangles at them.

use std::sync::OnceLock;

use rayon::prelude::*;

use super::shells::{Shell, closed_shells};
use crate::error::Result;
use crate::geometry::orientation::projection_axis;
use crate::geometry::{DVec3, Transform};
use crate::memory;
use crate::parallel;
use crate::shape::{Mesh, Welded, edges, sorted};
use crate::watch::{Watch, stop_if_asked};

/// The number of triangles that are looked at between two questions whether to stop.
pub(super) const CHUNK: usize = 1 << 12;

/// The most memory for a triangle while it is looked at, in bytes: welded corners, three sorted
/// edges, places in lists.
const TRIANGLE_BYTES: usize = 12 + 3 * (size_of::<EdgeUse>() + 12) + 8;

/// A mesh, and what is known about its triangles.
pub(super) struct Subject<'a> {
    /// The number among the distinct meshes of the scene.
    pub(super) index: usize,
    /// The first object that has the mesh.
    pub(super) object: i32,
    pub(super) mesh: &'a Mesh,
    pub(super) transform: &'a Transform,
    /// The corners of each triangle as numbers of places: vertices in one place have one number.
    pub(super) welded: Vec<[u32; 3]>,
    /// A vertex in each place.
    pub(super) vertices: Vec<u32>,
    /// Whether each triangle has an area, exactly.
    pub(super) has_area: Vec<bool>,
    /// The triangles whose corners are in the same places, in any order: each group in order.
    pub(super) copies: Vec<Vec<u32>>,
    /// The uses of edges, those of one edge side by side, by triangles with three places that are
    /// not repeated.
    pub(super) edges: Vec<EdgeUse>,
    /// The closed shells, once they are asked for.
    shells: OnceLock<Vec<Shell>>,
}

/// An edge of a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct EdgeUse {
    /// The places of its ends, the lower number first.
    pub(super) ends: [u32; 2],
    pub(super) triangle: u32,
    /// Whether the triangle goes from the lower number to the higher one.
    pub(super) is_forward: bool,
}

impl EdgeUse {
    /// One number in the order of edges and triangles: it is compared in two instructions.
    fn key(&self) -> u128 {
        packed([self.ends[0], self.ends[1], self.triangle, u32::from(self.is_forward)])
    }
}

/// Four numbers as one, in whose order the first counts most.
fn packed([a, b, c, d]: [u32; 4]) -> u128 {
    u128::from(a) << 96 | u128::from(b) << 64 | u128::from(c) << 32 | u128::from(d)
}

impl<'a> Subject<'a> {
    pub(super) fn new(
        [index, object]: [usize; 2],
        mesh: &'a Mesh,
        transform: &'a Transform,
        watch: &dyn Watch,
    ) -> Result<Self> {
        let count = mesh.triangles().len();
        memory::check("the check of a mesh", count.saturating_mul(TRIANGLE_BYTES))?;
        let Welded { triangles: welded, vertices } = mesh.welded()?;
        stop_if_asked(watch)?;
        let has_area = parallel::gather((0..count).step_by(CHUNK), |first| {
            let triangles = first..count.min(first + CHUNK);
            let corners = triangles.map(|triangle| mesh.corners(triangle));
            corners.map(|corners| projection_axis(&corners).is_some()).collect()
        });
        let copies = copies(&welded, watch)?;
        let edges = uses_of_edges(&welded, &repeated(&welded, &copies), watch)?;
        Ok(Self {
            index,
            object: i32::try_from(object).unwrap_or(i32::MAX),
            mesh,
            transform,
            welded,
            vertices,
            has_area,
            copies,
            edges,
            shells: OnceLock::new(),
        })
    }

    /// The closed shells. Remembered once they are found.
    pub(super) fn shells(&self, watch: &dyn Watch) -> Result<&[Shell]> {
        if let Some(shells) = self.shells.get() {
            return Ok(shells);
        }
        let shells = closed_shells(self, watch)?;
        let shells: &Vec<Shell> = parallel::once(&self.shells, || shells);
        Ok(shells)
    }

    /// The number of triangles.
    pub(super) fn len(&self) -> u32 {
        u32::try_from(self.welded.len()).unwrap_or(u32::MAX)
    }

    /// The corners of a triangle, in object space.
    pub(super) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.mesh.corners(triangle as usize)
    }

    /// A point of a place, in object space.
    pub(super) fn point(&self, place: u32) -> DVec3 {
        self.mesh.positions().get(self.vertices[place as usize])
    }

    pub(super) fn in_world(&self, point: DVec3) -> DVec3 {
        if self.transform.is_identity() {
            return point;
        }
        self.transform.world_from_object().transform_point3(point)
    }

    /// The middle of a triangle, in object space.
    pub(super) fn middle(&self, triangle: u32) -> DVec3 {
        let [a, b, c] = self.corners(triangle);
        a / 3.0 + b / 3.0 + c / 3.0
    }

    /// The uses of each edge.
    pub(super) fn edge_uses(&self) -> impl Iterator<Item = &[EdgeUse]> {
        self.edges.chunk_by(|a, b| a.ends == b.ends)
    }
}

/// See [`Subject::copies`].
fn copies(welded: &[[u32; 3]], watch: &dyn Watch) -> Result<Vec<Vec<u32>>> {
    let with_number = |(k, &places): (u32, &[u32; 3])| {
        let [a, b, c] = sorted(places).0;
        packed([a, b, c, k])
    };
    let mut order: Vec<u128> = (0..).zip(welded).map(with_number).collect();
    sort_by_key(&mut order, |&key| key, watch)?;
    let same = order.chunk_by(|a, b| a >> 32 == b >> 32);
    let copies = same.filter(|same| same.len() > 1);
    Ok(copies.map(|same| same.iter().map(|&key| lowest(key)).collect()).collect())
}

/// Sorts by keys that all differ, part by part, so that a stop is soon noticed.
fn sort_by_key<T: Send>(
    all: &mut [T],
    key: impl Fn(&T) -> u128 + Copy + Sync,
    watch: &dyn Watch,
) -> Result<()> {
    /// The number of entries that are sorted between two questions whether to stop.
    const PART: usize = 1 << 20;
    stop_if_asked(watch)?;
    if all.len() <= PART {
        all.par_sort_unstable_by_key(key);
        return Ok(());
    }
    let (low, _, high) = all.select_nth_unstable_by_key(all.len() / 2, key);
    let (low, high) =
        rayon::join(|| sort_by_key(low, key, watch), || sort_by_key(high, key, watch));
    low.and(high)
}

#[expect(clippy::cast_possible_truncation, reason = "the low bits are meant")]
fn lowest(key: u128) -> u32 {
    key as u32
}

/// Whether each triangle has the corners of an earlier one in the same sense.
fn repeated(welded: &[[u32; 3]], copies: &[Vec<u32>]) -> Vec<bool> {
    let mut is_repeated = vec![false; welded.len()];
    for same in copies {
        let mut is_known = [false; 2];
        for &k in same {
            let is_even = sorted(welded[k as usize]).1;
            is_repeated[k as usize] = std::mem::replace(&mut is_known[usize::from(is_even)], true);
        }
    }
    is_repeated
}

/// The edges of triangles with three places, but for repeated ones, those of one edge side by side.
fn uses_of_edges(
    welded: &[[u32; 3]],
    is_repeated: &[bool],
    watch: &dyn Watch,
) -> Result<Vec<EdgeUse>> {
    let triangles = (0..).zip(welded).zip(is_repeated);
    let wanted = triangles
        .filter(|((_, [a, b, c]), is_repeated)| !**is_repeated && a != b && b != c && c != a);
    let of_triangle = |((triangle, &places), _): ((u32, &[u32; 3]), &bool)| {
        edges(places).map(move |(ends, is_forward)| EdgeUse { ends, triangle, is_forward })
    };
    let mut edges: Vec<EdgeUse> = wanted.flat_map(of_triangle).collect();
    sort_by_key(&mut edges, EdgeUse::key, watch)?;
    Ok(edges)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

    use super::*;
    use crate::error::Error;

    /// Stops at the third question.
    #[derive(Default)]
    struct Third(AtomicUsize);

    impl Watch for Third {
        fn is_stopped(&self) -> bool {
            self.0.fetch_add(1, Relaxed) >= 2
        }
    }

    #[test]
    fn a_long_sort_is_a_sort_and_ends_when_it_is_stopped() {
        let mixed = |k: u128| k.wrapping_mul(0x9e37_79b9_7f4a_7c15_f39c_c060_5ced_c835);
        let keys: Vec<u128> = (0..3 << 20).map(mixed).collect();
        let (mut sorted, mut by_parts) = (keys.clone(), keys.clone());
        sorted.sort_unstable();
        sort_by_key(&mut by_parts, |&key| key, &()).unwrap();
        assert!(sorted == by_parts);
        by_parts = keys;
        let stopped = sort_by_key(&mut by_parts, |&key| key, &Third::default());
        assert!(matches!(stopped, Err(Error::Interrupted)));
    }
}

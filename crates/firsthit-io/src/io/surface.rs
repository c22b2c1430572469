//! Makes a mesh of a file's faces.

use std::sync::Arc;

use super::fault::Checked;
use super::memory_budget::check_free;
use super::polygon;
use super::report::Report;
use crate::error::{Error, Result};
use crate::geometry::DVec3;
use crate::shape::{Attribute, Mesh, Positions};

/// Coordinates from here on are garbage: their products would leave the range of float64.
pub const TOO_FAR: f64 = 1e30;

/// A file's vertices, shared by all of its objects.
pub(super) struct Vertices {
    pub(super) positions: Arc<Positions>,
    all_usable: bool,
}

impl Vertices {
    pub(super) fn new(positions: Positions) -> Self {
        let all_usable = match &positions {
            Positions::Single(points) => {
                points.iter().flatten().all(|&x| f64::from(x).abs() < TOO_FAR)
            }
            Positions::Double(points) => points.iter().flatten().all(|&x| x.abs() < TOO_FAR),
        };
        Self { positions: Arc::new(positions), all_usable }
    }

    fn is_usable(&self, corners: &[u32; 3]) -> bool {
        self.all_usable
            || corners.iter().all(|&corner| {
                let far = self.positions.get(corner).abs().max_element();
                // `max_element` passes over NaN.
                far < TOO_FAR && self.positions.get(corner).is_finite()
            })
    }
}

/// The faces of one object, cut into triangles as they come.
#[derive(Debug, Default)]
pub(super) struct Surface {
    triangles: Vec<[u32; 3]>,
    /// The face of each triangle; `None` while it is the triangle's own index.
    faces: Option<Vec<u32>>,
    face_count: u32,
    /// The polygons whose fan may have to be replaced, once the vertices are known.
    polygons: Vec<Polygon>,
    /// The triangles' indices into other values: empty, or as long as `triangles`.
    pub(super) corners: [Vec<[u32; 3]>; 2],
}

#[derive(Debug)]
struct Polygon {
    first: usize,
    triangles: usize,
}

impl Surface {
    /// The surface of triangles each of which is a face of its own.
    pub(super) fn of(triangles: Vec<[u32; 3]>) -> Self {
        Self {
            face_count: u32::try_from(triangles.len()).unwrap_or(u32::MAX),
            triangles,
            ..Self::default()
        }
    }

    /// Makes room for triangles.
    pub(super) fn reserve(&mut self, triangles: usize) -> Checked<()> {
        check_free(triangles.saturating_mul(size_of::<[u32; 3]>()))?;
        self.triangles.reserve(triangles);
        Ok(())
    }

    /// The size in bytes.
    pub(super) fn bytes(&self) -> usize {
        let [a, b] = &self.corners;
        let faces = self.faces.as_deref().map_or(0, size_of_val);
        let corners = size_of_val(a.as_slice()) + size_of_val(b.as_slice());
        let polygons = size_of_val(self.polygons.as_slice());
        size_of_val(self.triangles.as_slice()) + faces + corners + polygons
    }

    /// Whether there are no triangles.
    pub(super) fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The number of faces so far, those of less than three corners too.
    pub(super) fn face_count(&self) -> u32 {
        self.face_count
    }

    /// Adds a triangle that is a face of its own.
    pub(super) fn push_triangle(&mut self, corners: [u32; 3]) {
        self.triangles.push(corners);
        if let Some(faces) = &mut self.faces {
            faces.push(self.face_count);
        }
        self.face_count = self.face_count.saturating_add(1);
    }

    /// Adds a face of any number of corners: as a fan, for now.
    pub(super) fn push(&mut self, ring: &[u32]) {
        if let &[a, b, c] = ring {
            return self.push_triangle([a, b, c]);
        }
        let (first, triangles) = (self.triangles.len(), ring.len().saturating_sub(2));
        let faces = self.faces.get_or_insert_with(|| (0..self.face_count).collect());
        faces.extend(std::iter::repeat_n(self.face_count, triangles));
        push_fan(&mut self.triangles, ring);
        if triangles > 0 {
            self.polygons.push(Polygon { first, triangles });
        }
        self.face_count = self.face_count.saturating_add(1);
    }

    /// The mesh over `vertices`: concave polygons cut rightly, unusable triangles dropped. With it
    /// come the triangles' other indices.
    ///
    /// Every corner must be one of the vertices.
    pub(super) fn finish(
        mut self,
        vertices: &Vertices,
        name: &str,
        report: &mut Report,
    ) -> Checked<(Mesh, [Vec<[u32; 3]>; 2])> {
        self.cut_polygons(vertices);
        self.drop_unusable(vertices, name, report);
        let mut mesh = Mesh::new(Arc::clone(&vertices.positions), self.triangles)?;
        if let Some(faces) = self.faces {
            mesh = mesh.with_faces(faces)?;
        }
        Ok((mesh, self.corners))
    }

    fn cut_polygons(&mut self, vertices: &Vertices) {
        let [corners_a, corners_b] = &mut self.corners;
        for &Polygon { first, triangles } in &self.polygons {
            let range = first..first + triangles;
            let Some(fan) = self.triangles.get_mut(range.clone()) else {
                continue;
            };
            if let &mut [[a, b, c], [.., d]] = fan
                && polygon::is_plainly_convex([a, b, c, d].map(|k| vertices.positions.get(k)))
            {
                continue;
            }
            if !fan.iter().all(|triangle| vertices.is_usable(triangle)) {
                continue;
            }
            let ring = ring_of(fan).into_iter();
            let corners: Vec<DVec3> = ring.map(|k| vertices.positions.get(k)).collect();
            let Some(cut) = polygon::triangulate(&corners) else {
                continue;
            };
            replace_fan(fan, &cut);
            for other in [&mut *corners_a, &mut *corners_b] {
                if let Some(fan) = other.get_mut(range.clone()) {
                    replace_fan(fan, &cut);
                }
            }
        }
    }

    fn drop_unusable(&mut self, vertices: &Vertices, name: &str, report: &mut Report) {
        if vertices.all_usable {
            return;
        }
        let keep: Vec<bool> =
            self.triangles.iter().map(|triangle| vertices.is_usable(triangle)).collect();
        let Some(first) = keep.iter().position(|&keep| !keep) else {
            return;
        };
        let dropped = keep.iter().filter(|&&keep| !keep).count() as u64;
        report.warnings.drop_triangles(dropped, || format!("triangle {first} of '{name}'"));
        // Those that stay keep their faces.
        let count = self.face_count;
        let faces = self.faces.get_or_insert_with(|| (0..count).collect());
        retain(faces, &keep);
        retain(&mut self.triangles, &keep);
        for corners in &mut self.corners {
            retain(corners, &keep);
        }
    }
}

/// The triangles of polygons over `points`, and of each triangle the polygon that it is part of:
/// concave polygons are cut rightly, and every corner is in a triangle. `corners` has the indices
/// of all polygons one after the other, `sizes` how many each has.
///
/// # Errors
///
/// [`Error::Argument`] for a polygon of less than three corners, for sizes that are not those of
/// all corners, and for an index without a point.
pub fn polygons(
    points: Positions,
    corners: &[u32],
    sizes: &[u32],
) -> Result<(Vec<[u32; 3]>, Vec<u32>)> {
    let expected = "indices of points";
    if let Some(&corner) = corners.iter().find(|&&corner| corner as usize >= points.len()) {
        let got = format!("{corner} for {} points", points.len());
        return Err(Error::argument("corners", expected, got));
    }
    let expected = "three corners or more for each polygon, and all of them";
    let mut surface = Surface::default();
    let mut rest = corners;
    for &size in sizes {
        let ring = rest.split_at_checked(size as usize).filter(|_| size >= 3);
        let Some((ring, others)) = ring else {
            let got = format!("{size} with {} left", rest.len());
            return Err(Error::argument("sizes", expected, got));
        };
        surface.push(ring);
        rest = others;
    }
    if !rest.is_empty() {
        let got = format!("{} corners more", rest.len());
        return Err(Error::argument("sizes", expected, got));
    }
    surface.cut_polygons(&Vertices::new(points));
    let count = surface.face_count;
    let faces = surface.faces.unwrap_or_else(|| (0..count).collect());
    Ok((surface.triangles, faces))
}

fn retain<T>(values: &mut Vec<T>, keep: &[bool]) {
    let mut keep = keep.iter();
    values.retain(|_| keep.next().copied().unwrap_or(false));
}

/// Adds the triangles (0, k, k + 1) of a ring.
pub(super) fn push_fan(triangles: &mut Vec<[u32; 3]>, ring: &[u32]) {
    if let Some((&hub, rim)) = ring.split_first() {
        let pairs = rim.iter().zip(rim.iter().skip(1));
        triangles.extend(pairs.map(|(&a, &b)| [hub, a, b]));
    }
}

/// The ring whose fan this is.
fn ring_of(fan: &[[u32; 3]]) -> Vec<u32> {
    let start = fan.first().map(|&[hub, a, _]| [hub, a]);
    let rim = fan.iter().map(|&[_, _, b]| b);
    start.into_iter().flatten().chain(rim).collect()
}

/// Puts in a fan's place the triangles of the same ring that `cut` describes.
fn replace_fan(fan: &mut [[u32; 3]], cut: &[[u32; 3]]) {
    let ring = ring_of(fan);
    for (triangle, corners) in fan.iter_mut().zip(cut) {
        *triangle = corners.map(|k| ring.get(k as usize).copied().unwrap_or_default());
    }
}

/// Colours of whole faces, for a mesh whose faces they are.
pub(super) fn face_attribute(mesh: &Mesh, values: Vec<[f32; 3]>) -> Attribute<3> {
    #[expect(clippy::cast_possible_truncation, reason = "faces are counted in u32")]
    let corners =
        (0..mesh.triangles().len()).map(|triangle| [mesh.face(triangle) as u32; 3]).collect();
    Attribute { values: values.into(), corners: Some(corners) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::LoadSettings;

    #[test]
    fn dropped_triangles_take_their_faces_and_corners_along() {
        let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [f64::NAN, 0.0, 0.0]];
        let vertices = Vertices::new(Positions::compact(points));
        let mut surface = Surface::default();
        surface.push(&[0, 1, 2, 3]);
        surface.push(&[0, 1]);
        surface.push(&[2, 1, 0]);
        surface.corners[0] = vec![[5; 3], [6; 3], [7; 3]];
        let mut report = Report::new("x".as_ref(), LoadSettings::default(), &());
        let (mesh, corners) = surface.finish(&vertices, "x", &mut report).unwrap();
        assert_eq!(mesh.triangles(), [[0, 1, 2], [2, 1, 0]]);
        assert_eq!([mesh.face(0), mesh.face(1)], [0, 2]);
        assert_eq!(corners[0], [[5; 3], [7; 3]]);
        let [line] = &report.take_lines()[..] else { panic!("one warning") };
        assert!(line.contains("dropped: 1 triangle has"), "{line}");
    }
}

//! Counts the nodes and leaves that a ray visits, by a plain traversal, and fits their costs to the
//! rows' times.
//!
//! The trees are read from the built scene as `docs/fhs.md` describes it. Where the scene is not
//! one mesh in its place, nothing is counted: built scenes do not have the tree over the objects.

use firsthit::world::World;
use firsthit::{DVec3, Ray, Scene, fhs};

/// The means over rays.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Visits {
    pub(crate) nodes: f64,
    pub(crate) leaves: f64,
    pub(crate) hits: f64,
    /// The bytes of the tree's nodes and leaves.
    pub(crate) bytes: usize,
}

/// The largest trees for the fit: in larger ones a visit is a wait for memory, and costs something
/// else.
const MOST_BYTES: usize = 64 << 20;

/// The tree over the one mesh of a scene.
pub(crate) struct Tree {
    nodes: Vec<[u8; NODE]>,
    leaves: Vec<[u8; LEAF]>,
    /// The mesh's place of the tree's origin, and units of the tree in one of the mesh.
    origin: DVec3,
    scale: f64,
}

const VERSION: u32 = 5;
const NODE: usize = 448;
const LEAF: usize = 256;
const LANES: usize = 16;
/// Marks a child that is a leaf.
const IS_LEAF: u32 = 1 << 31;
/// Rays that are counted of a row.
const SAMPLE: usize = 100_000;

impl Tree {
    pub(crate) fn of(scene: &Scene) -> Option<Self> {
        let [object] = scene.objects() else {
            return None;
        };
        let bounds = object.mesh()?.bounds();
        if !object.transform().is_identity() {
            return None;
        }
        let world = World { objects: scene.objects().to_vec(), ..World::default() };
        let file = fhs::encode(scene, &world, &()).ok()?;
        assert_eq!(word(&file, 8), VERSION, "docs/fhs.md has changed");
        let sections = long(&file, 24);
        let section = |kind: u32| {
            let mut entries = (0..sections).map(|k| 64 + 64 * k);
            let entry = entries.find(|&entry| word(&file, entry) == kind)?;
            let (start, length) = (long(&file, entry + 8), long(&file, entry + 16));
            Some(&file[start..start + length])
        };
        let nodes = section(12)?.as_chunks().0.to_vec();
        let leaves = section(13)?.as_chunks().0.to_vec();
        // The tree's space is the mesh's, moved and scaled by a power of two, so the root's boxes
        // tell how.
        let ends = |axis: usize| {
            let of = |plane: usize| (0..LANES).map(move |lane| plane * LANES + lane);
            let low = of(2 * axis).map(|k| number(nodes.first(), k));
            let high = of(2 * axis + 1).map(|k| number(nodes.first(), k));
            (low.fold(f64::INFINITY, f64::min), high.fold(f64::NEG_INFINITY, f64::max))
        };
        let [x, y, z] = [0, 1, 2].map(ends);
        let (low, high) = (DVec3::new(x.0, y.0, z.0), DVec3::new(x.1, y.1, z.1));
        let ratio = (high - low).max_element() / bounds.size().max_element();
        let scale = libm::exp2(libm::log2(ratio).round());
        Some(Self { nodes, leaves, origin: bounds.centre() - 0.5 / scale * (low + high), scale })
    }

    /// Counts the visits of the first hits of a sample of `rays`.
    pub(crate) fn count(&self, rays: &[Ray]) -> Visits {
        let mut sum = Visits {
            nodes: 0.0,
            leaves: 0.0,
            hits: 0.0,
            bytes: NODE * self.nodes.len() + LEAF * self.leaves.len(),
        };
        let step = rays.len().div_ceil(SAMPLE).max(1);
        let sample = rays.iter().step_by(step);
        let share = 1.0 / sample.len().max(1) as f64;
        for ray in sample {
            self.first_hit(ray, &mut sum);
        }
        Visits {
            nodes: share * sum.nodes,
            leaves: share * sum.leaves,
            hits: share * sum.hits,
            ..sum
        }
    }

    /// Nearest first, and nothing that begins beyond the hit so far.
    fn first_hit(&self, ray: &Ray, sum: &mut Visits) {
        let origin = self.scale * (ray.origin - self.origin);
        let direction = self.scale * ray.direction;
        let mut limit = ray.t_max;
        let mut stack = vec![(0.0, 0_u32)];
        while let Some((entry, child)) = stack.pop() {
            if entry > limit {
                continue;
            }
            let index = (child & !IS_LEAF) as usize;
            if child & IS_LEAF == 0 {
                sum.nodes += 1.0;
                let node = &self.nodes[index];
                let first = stack.len();
                for lane in 0..LANES {
                    let ends = |plane: usize| number(Some(node), plane * LANES + lane);
                    let low = DVec3::new(ends(0), ends(2), ends(4));
                    let high = DVec3::new(ends(1), ends(3), ends(5));
                    let (a, b) = ((low - origin) / direction, (high - origin) / direction);
                    let (near, far) = (a.min(b).max_element().max(0.0), a.max(b).min_element());
                    if low.x <= high.x && near <= far.min(limit) {
                        stack.push((near, word(node, 4 * (6 * LANES + lane))));
                    }
                }
                stack[first..].sort_by(|(a, _), (b, _)| b.total_cmp(a));
            } else {
                sum.leaves += 1.0;
                let leaf = &self.leaves[index];
                for lane in (0..LANES).filter(|lane| leaf[252 + lane / 8] >> (lane % 8) & 1 == 1) {
                    let corner = |k: usize| {
                        let vertex = usize::from(leaf[192 + LANES * k + lane]);
                        let along = |axis: usize| number(Some(leaf), LANES * axis + vertex);
                        DVec3::new(along(0), along(1), along(2)) - origin
                    };
                    limit = meet([0, 1, 2].map(corner), direction, limit);
                }
            }
        }
        sum.hits += f64::from(limit < ray.t_max);
    }
}

/// The parameter at which a ray from the origin meets a triangle, if that is before `limit`, and
/// else `limit`.
fn meet([a, b, c]: [DVec3; 3], direction: DVec3, limit: f64) -> f64 {
    let volumes = [b.cross(c), c.cross(a), a.cross(b)].map(|normal| normal.dot(direction));
    let is_met = volumes.iter().all(|&v| v >= 0.0) || volumes.iter().all(|&v| v <= 0.0);
    let normal = (b - a).cross(c - a);
    let t = a.dot(normal) / direction.dot(normal);
    if is_met && t >= 0.0 && t < limit { t } else { limit }
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(std::array::from_fn(|k| bytes[at + k]))
}

fn long(bytes: &[u8], at: usize) -> usize {
    word(bytes, at) as usize | (word(bytes, at + 4) as usize) << 32
}

/// The float32 in place `index` of a node or leaf.
fn number<const N: usize>(bytes: Option<&[u8; N]>, index: usize) -> f64 {
    bytes.map_or(f64::NAN, |bytes| f64::from(f32::from_bits(word(bytes, 4 * index))))
}

/// The costs of a ray, a node, a leaf and a hit: the least squares over visits and times of rows
/// whose trees caches may hold; then how much longer each row took. `None` where there are no more
/// such rows than numbers.
pub(crate) fn fit(rows: &[(Visits, f64)]) -> Option<([f64; 4], Vec<f64>)> {
    let terms = |v: &Visits| [1.0, v.nodes, v.leaves, v.hits];
    let fitted = rows.iter().filter(|(v, _)| v.bytes <= MOST_BYTES);
    if fitted.clone().count() < 5 {
        return None;
    }
    // The normal equations, by Gauss and Jordan.
    let mut system = [[0.0; 5]; 4];
    for (visits, time) in fitted {
        let terms = terms(visits);
        for (equation, term) in system.iter_mut().zip(terms) {
            for (k, factor) in terms.into_iter().chain([*time]).enumerate() {
                equation[k] += term * factor;
            }
        }
    }
    for column in 0..4 {
        let size = |row: &usize| system[*row][column].abs();
        let pivot = (column..4).max_by(|a, b| size(a).total_cmp(&size(b)))?;
        system.swap(column, pivot);
        let row = system[column].map(|x| x / system[column][column]);
        system =
            std::array::from_fn(|k| {
                let factor = if k == column { 0.0 } else { system[k][column] };
                std::array::from_fn(|j| {
                    if k == column { row[j] } else { system[k][j] - factor * row[j] }
                })
            });
    }
    let costs = system.map(|equation| equation[4]);
    let off = |(visits, time): &(Visits, f64)| {
        let sum: f64 = terms(visits).iter().zip(costs).map(|(a, b)| a * b).sum();
        time - sum
    };
    let off = rows.iter().map(off).collect();
    costs.iter().all(|cost| cost.is_finite()).then_some((costs, off))
}

#[cfg(test)]
mod tests {
    use firsthit::scene::BuildSettings;

    use super::*;
    use crate::scenes;

    #[test]
    fn a_fit_finds_the_costs_that_times_were_made_from() {
        let row = |k: f64| Visits {
            nodes: 3.0 + k,
            leaves: 1.0 + 0.1 * k * k,
            hits: 1.0 / (1.0 + k),
            bytes: 1000,
        };
        let time = |v: Visits| 20.0 + 19.0 * v.nodes + 39.0 * v.leaves + 68.0 * v.hits;
        let rows: Vec<_> = (0..6).map(|k| row(f64::from(k))).map(|v| (v, time(v))).collect();
        let (costs, off) = fit(&rows).unwrap();
        assert!(off.iter().all(|off| off.abs() < 1e-6), "{off:?}");
        for (cost, expected) in costs.iter().zip([20.0, 19.0, 39.0, 68.0]) {
            assert!((cost - expected).abs() < 1e-6, "{costs:?}");
        }
        assert!(fit(&rows[..4]).is_none());
        let large = Visits { bytes: 1 << 30, ..row(2.0) };
        let with_large = [&*rows, &[(large, time(large) + 50.0)]].concat();
        let (again, off) = fit(&with_large).unwrap();
        assert_eq!(again, costs);
        assert!((off[6] - 50.0).abs() < 1e-6, "{off:?}");
    }

    #[test]
    fn rays_that_hit_are_counted_as_the_library_says() {
        let folder = std::path::Path::new("no such folder");
        let scene = scenes::find("room", folder).unwrap();
        let scene = Scene::build(scene.objects, BuildSettings::default()).unwrap();
        let tree = Tree::of(&scene).unwrap();
        let from = |k: u32| {
            let aim = DVec3::new(f64::from(k % 9) - 4.0, f64::from(k % 11) - 5.0, 1.3);
            Ray::new(DVec3::new(6.0, 5.0, 2.0), aim).up_to(0.9)
        };
        let rays: Vec<Ray> = (0..99).map(from).collect();
        let mut hits = firsthit::Hits::default();
        crate::firsthit_side::first_hits(&scene, &*rays, &mut hits);
        let expected = (0..99).filter(|&k| !hits.get(k).is_miss()).count();
        let visits = tree.count(&rays);
        assert!((visits.hits * 99.0 - expected as f64).abs() < 1e-9);
        assert!(visits.nodes >= 1.0 && visits.leaves >= visits.hits);
    }
}

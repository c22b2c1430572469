//! Makes the top-level tree over boxes, and fits it to boxes that move, come and go.

use super::binary::{Binary, Primitives, binary};
use super::binned_sah::{Block, Box32, Item};
use super::collapse::{Wide, collapse};
use super::mesh::Building;
use super::refit::{boxes, expected_visits};
use crate::accel::bvh::{BoxSpace, Bvh, FARTHEST_BOX, NOWHERE, Places};
use crate::accel::node::{LEAF, Node, WIDTH};
use crate::accel::space::CHUNK;
use crate::error::Result;
use crate::geometry::{Bounds, DVec3};
use crate::parallel;
use crate::watch::Watch;

/// Boxes without anything in them that the builder must know. A ray comes to all boxes of a leaf,
/// and to enter the mesh of one takes longer than to test more boxes of the tree: so a leaf is one
/// box.
struct Boxes<'a>(&'a Building<'a>);

impl Primitives for Boxes<'_> {
    fn block(&self) -> Block {
        Block(0)
    }

    fn is_leaf(&self, items: &[Item]) -> bool {
        items.len() <= 1
    }

    fn is_stopped(&self) -> bool {
        self.0.is_stopped()
    }
}

impl Bvh {
    /// The tree over the boxes `bounds(0)` to `bounds(count - 1)`, which are finite. Empty ones are
    /// left out. `bounds` is called once for each. `slack` is what the test of a candidate rounds,
    /// as a share of the coordinates it works with.
    ///
    /// Built by all threads of the current rayon pool, and the same for any number of them. Fewer
    /// than 65,536 boxes are the calling thread's alone, and need no pool.
    pub fn build(count: u32, bounds: impl Fn(u32) -> Bounds + Sync, slack: f64) -> Self {
        Self::over(gathered(count, bounds), slack, &Building::new(&()))
    }

    /// As [`build`](Self::build), of boxes that are at hand.
    #[doc(hidden)]
    pub fn of(boxes: Vec<Bounds>, slack: f64) -> Self {
        Self::over(boxes, slack, &Building::new(&()))
    }

    /// As [`build`](Self::build); `watch` may end it.
    ///
    /// # Errors
    ///
    /// [`Error::Interrupted`](crate::error::Error::Interrupted).
    #[doc(hidden)]
    pub fn build_watched(
        count: u32,
        bounds: impl Fn(u32) -> Bounds + Sync,
        slack: f64,
        watch: &dyn Watch,
    ) -> Result<Self> {
        let building = Building::new(watch);
        let tree = Self::over(gathered(count, bounds), slack, &building);
        building.end(0).map(|()| tree)
    }

    fn over(boxes: Vec<Bounds>, slack: f64, building: &Building<'_>) -> Self {
        let all = boxes.iter().copied().fold(Bounds::EMPTY, Bounds::union);
        let origin = if all.is_empty() { DVec3::ZERO } else { middle(&boxes) };
        let extent = (all.high - origin).max(origin - all.low).max_element();
        let mut tree = Self {
            space: BoxSpace::new(origin, extent),
            extent: extent.max(0.0),
            slack,
            nodes: Vec::new(),
            places: None,
        };
        let filled = (0..).zip(boxes).filter(|(_, bounds)| !bounds.is_empty());
        let mut items: Vec<Item> =
            filled.map(|(index, bounds)| Item::new(tree.rounded_outwards(bounds), index)).collect();
        if items.is_empty() {
            return tree;
        }
        let Binary { nodes, order } = binary(&mut items, &Boxes(building));
        drop(items);
        if building.is_stopped() {
            return tree;
        }
        let Wide { mut nodes, ranges } = collapse(nodes, || building.is_stopped());
        for child in nodes.iter_mut().flat_map(|node| &mut node.children) {
            if let Some(&(first, _)) = ranges.get((*child ^ LEAF) as usize) {
                *child = LEAF | order[first as usize];
            }
        }
        tree.nodes = nodes;
        tree
    }

    /// Fits the tree to one box that has changed: it moved to a finite place, is new, or is empty
    /// now. From its leaf up to the root the boxes around it change. `false` where the box is too
    /// far away, or is new and finds no place, so that the tree must be built anew.
    #[doc(hidden)]
    pub fn refit(&mut self, moved: u32, bounds: Bounds) -> bool {
        let origin = self.space.origin;
        let reach = (bounds.high - origin).max(origin - bounds.low);
        let extent = self.extent.max(reach.max_element());
        if extent * self.space.scale > FARTHEST_BOX {
            return false;
        }
        self.extent = extent;
        let mut around = self.rounded_outwards(bounds);
        let mut places = self.places.take().unwrap_or_else(|| self.find_places());
        let known = places.boxes.get(moved as usize).filter(|&&place| place != NOWHERE);
        let place = known.copied().or_else(|| {
            let vacant = self.vacant_place(around).filter(|_| !bounds.is_empty())?;
            let child = &mut self.nodes[vacant as usize / WIDTH].children[vacant as usize % WIDTH];
            places.give(vacant, *child & !LEAF, moved);
            *child = LEAF | moved;
            Some(vacant)
        });
        let mut next = place;
        while let Some(place) = next {
            let index = place as usize / WIDTH;
            let node = &mut self.nodes[index];
            node.set_child_box(place as usize % WIDTH, around);
            around = boxes(node).fold(Box32::EMPTY, Box32::union);
            next = (index > 0).then(|| places.nodes[index]);
        }
        self.places = Some(places);
        place.is_some() || bounds.is_empty()
    }

    /// A place for a leaf that is new: of the nodes on the way down to where boxes grow the least,
    /// one of the lowest that has any.
    fn vacant_place(&self, around: Box32) -> Option<u32> {
        let (mut found, mut next) = (None, (!self.nodes.is_empty()).then_some(0));
        while let Some(index) = next {
            let node = &self.nodes[index];
            // A place that once held a node may have leaves below that come again.
            let is_free = |&k: &usize| node.is_vacant(k) && node.children[k] & LEAF != 0;
            let free = (0..WIDTH).find(is_free);
            found = free.and_then(|k| u32::try_from(index * WIDTH + k).ok()).or(found);
            let below = (0..WIDTH).filter(|&k| node.children[k] & LEAF == 0);
            let grown = below.filter_map(|k| {
                let bounds = node.child_box(k)?;
                Some((bounds.union(around).half_area() - bounds.half_area(), node.children[k]))
            });
            next = grown.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, child)| child as usize);
        }
        found
    }

    fn find_places(&self) -> Places {
        let boxes = self.children().filter(|(_, child)| child & LEAF != 0);
        let last = boxes.map(|(_, child)| child & !LEAF).max();
        let mut places = Places {
            boxes: vec![NOWHERE; last.map_or(0, |last| last as usize + 1)],
            nodes: vec![0; self.nodes.len()],
        };
        for (place, child) in self.children() {
            if child & LEAF == 0 {
                places.nodes[child as usize] = place;
            } else {
                places.boxes[(child & !LEAF) as usize] = place;
            }
        }
        places
    }

    /// The children of all nodes, each with its [place](Places).
    #[doc(hidden)]
    pub fn children(&self) -> impl Iterator<Item = (u32, u32)> {
        let of_node = |(first, node): (u32, &Node)| {
            let children = (first..).zip(node.children).zip(0..WIDTH);
            let node = *node;
            children.filter(move |&(_, k)| !node.is_vacant(k)).map(|(child, _)| child)
        };
        (0..).step_by(WIDTH).zip(&self.nodes).flat_map(of_node)
    }

    /// See [`expected_visits`].
    #[doc(hidden)]
    pub fn expected_visits(&self) -> f64 {
        expected_visits(&self.nodes)
    }

    fn rounded_outwards(&self, bounds: Bounds) -> Box32 {
        if bounds.is_empty() {
            return Box32::EMPTY;
        }
        let [low, high] = self.space.outwards(bounds);
        Box32::new(low, high)
    }
}

/// The boxes `bounds(0)` to `bounds(count - 1)`.
#[expect(clippy::cast_possible_truncation, reason = "below `count`")]
fn gathered(count: u32, bounds: impl Fn(u32) -> Bounds + Sync) -> Vec<Bounds> {
    parallel::gather_each(count as usize, CHUNK, |index| bounds(index as u32))
}

impl Places {
    /// Gives a box a place that may have been another's.
    fn give(&mut self, place: u32, before: u32, to: u32) {
        if let Some(known) = self.boxes.get_mut(before as usize).filter(|known| **known == place) {
            *known = NOWHERE;
        }
        let count = self.boxes.len().max(to as usize + 1);
        self.boxes.resize(count, NOWHERE);
        self.boxes[to as usize] = place;
    }
}

/// The number of boxes in the sample that the middle is found by.
const SAMPLE: usize = 1021;

/// The middle of most boxes: along each axis the median of their centres, or of those of a sample.
/// The centre of everything may be far from all of them but one, where float32 could not tell the
/// others apart. At least one box is not empty.
fn middle(boxes: &[Bounds]) -> DVec3 {
    let filled = || boxes.iter().filter(|bounds| !bounds.is_empty());
    let step = filled().count().div_ceil(SAMPLE).max(1);
    let sample: Vec<DVec3> = filled().step_by(step).map(Bounds::centre).collect();
    let median = |axis: usize| {
        let mut along: Vec<f64> = sample.iter().map(|centre| centre[axis]).collect();
        let half = along.len() / 2;
        *along.select_nth_unstable_by(half, f64::total_cmp).1
    };
    DVec3::new(median(0), median(1), median(2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::build::binary::SAH_DEPTH;
    use crate::accel::walks::Walks;
    use crate::geometry::Ray;
    use crate::simd::{self, InstructionSet, Kernel, Lanes};

    fn depth(bvh: &Bvh) -> usize {
        let mut deepest = 0;
        let mut stack = vec![(0_u32, 1_usize)];
        while let Some((index, depth)) = stack.pop() {
            let node = &bvh.nodes[index as usize];
            deepest = deepest.max(depth);
            let below = node.children.iter().filter(|&child| child & LEAF == 0);
            stack.extend(below.map(|&child| (child, depth + 1)));
        }
        deepest
    }

    fn indices(bvh: &Bvh) -> Vec<u32> {
        let mut all: Vec<u32> = bvh.children().map(|(_, child)| child).collect();
        all.retain(|child| child & LEAF != 0);
        for child in &mut all {
            *child &= !LEAF;
        }
        all.sort_unstable();
        all
    }

    /// The boxes that a ray may meet, up to its `t_max`: alone, and together with itself.
    fn met(bvh: &Bvh, ray: &Ray) -> Vec<u32> {
        struct Met<'r>(&'r Bvh, &'r Ray, usize);
        impl Kernel for Met<'_> {
            type Output = Vec<Vec<u32>>;

            #[inline(always)]
            fn run<L: Lanes>(self, l: L) -> Vec<Vec<u32>> {
                let Self(bvh, ray, count) = self;
                let mut walks = Walks::default();
                let mut met = vec![Vec::new(); count];
                let places: Vec<u32> = met.iter().map(|_| walks.begin(bvh, ray)).collect();
                let mut left: Vec<usize> = (0..count).collect();
                while !left.is_empty() {
                    for &k in &left {
                        walks.send(places[k], ray.t_max);
                    }
                    walks.advance(l, bvh);
                    left.retain(|&k| {
                        let next = walks.arrived(places[k]);
                        met[k].extend(next);
                        next.is_some()
                    });
                }
                met
            }
        }
        let set = InstructionSet::current().unwrap();
        let [alone, together] = [1, 19].map(|count| simd::run(set, Met(bvh, ray, count)));
        let sorted = |list: &Vec<u32>| {
            let mut list = list.clone();
            list.sort_unstable();
            list
        };
        for list in &together {
            assert_eq!(sorted(list), sorted(&alone[0]), "{ray:?}");
        }
        alone[0].clone()
    }

    /// More boxes wait for a ray than its list has room for at first.
    #[test]
    fn a_ray_meets_all_of_many_boxes_in_one_place() {
        let bounds = |k: u32| Bounds::of([DVec3::ZERO, DVec3::splat(1.0 + f64::from(k % 7))]);
        let bvh = Bvh::build(3_000, bounds, Bvh::OBJECTS);
        let mut met = met(&bvh, &Ray::new(DVec3::splat(-1.0), DVec3::new(1.0, 1.1, 1.2)));
        met.sort_unstable();
        assert_eq!(met, (0..3_000).collect::<Vec<_>>());
    }

    #[test]
    fn identical_boxes_make_a_balanced_tree() {
        let bounds = Bounds::of([DVec3::ZERO, DVec3::ONE]);
        let bvh = Bvh::build(20_000, |_| bounds, Bvh::OBJECTS);
        assert_eq!(indices(&bvh), (0..20_000).collect::<Vec<_>>());
        assert!(depth(&bvh) <= 16, "{}", depth(&bvh));
    }

    /// Sizes that shrink by a constant factor make the heuristic peel off one box after the other.
    #[test]
    fn no_geometry_makes_the_tree_deeper_than_the_stack() {
        let spiral = |k: u32| {
            let x = libm::pow(0.7, f64::from(k % 250));
            Bounds::of([DVec3::splat(x), DVec3::splat(x * 1.01)])
        };
        let bvh = Bvh::build(50_000, spiral, Bvh::OBJECTS);
        assert!(depth(&bvh) <= SAH_DEPTH as usize + 32, "{}", depth(&bvh));
    }

    #[test]
    fn the_tree_is_the_same_for_any_number_of_threads() {
        let bounds = |k: u32| {
            let x = DVec3::new(f64::from(k % 1009), f64::from(k % 997), f64::from(k % 89));
            Bounds::of([x, x + DVec3::splat(f64::from(k % 13))])
        };
        let trees = [1, 2, 7].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| Bvh::build(100_000, bounds, Bvh::OBJECTS))
        });
        for tree in &trees[1..] {
            assert_eq!(tree.nodes, trees[0].nodes);
        }
    }

    /// A box at 1e8 left float32 steps of 8 for all the others, so that they were one to every ray.
    #[test]
    fn one_box_far_away_does_not_blur_the_others() {
        let bounds = |k: u32| {
            let low = match k {
                0 => DVec3::ZERO,
                5000 => DVec3::new(1e8, -1e8, 1e8),
                _ => DVec3::new(f64::from(k % 100), f64::from(k / 100), 0.0),
            };
            Bounds::of([low, low + 0.9])
        };
        let bvh = Bvh::build(10_000, bounds, Bvh::OBJECTS);
        for k in (1..10_000).step_by(37).filter(|&k| k != 5000) {
            let start = bounds(k).centre() + DVec3::new(0.0, 0.0, 9.0);
            let met = met(&bvh, &Ray::new(start, DVec3::NEG_Z));
            assert_eq!(met, [k]);
            let mut candidates = 0;
            bvh.any_overlapping(bounds(k), &mut Vec::new(), |_| {
                candidates += 1;
                false
            });
            assert!(candidates <= 4, "{k}: {candidates}");
        }
        let towards = Ray::new(bounds(5000).centre() + 9.0, -DVec3::ONE);
        assert!(met(&bvh, &towards).contains(&5000));
    }

    /// Whether a ray meets a box in float64, between a `t_min` of its own or its origin and its
    /// `t_max`.
    fn meets(ray: &Ray, bounds: &Bounds) -> bool {
        let inverse = ray.direction.recip();
        let (a, b) = ((bounds.low - ray.origin) * inverse, (bounds.high - ray.origin) * inverse);
        let entry = a.min(b).max_element().max(ray.t_min.min(0.0));
        entry <= a.max(b).min_element().min(ray.t_max)
    }

    /// Whether the boxes that a ray is said to meet are those of the exact test and others; how
    /// many both are.
    fn judged(bvh: &Bvh, boxes: &[Bounds], ray: &Ray) -> [usize; 2] {
        let met = met(bvh, ray);
        for (k, bounds) in (0..).zip(boxes) {
            assert!(met.contains(&k) || !meets(ray, bounds), "{ray:?} {bounds:?}");
        }
        let exact = boxes.iter().filter(|bounds| meets(ray, bounds));
        [met.len(), exact.count()]
    }

    #[test]
    fn no_box_that_a_ray_meets_is_missed() {
        let mut state = 1_u64;
        let mut number = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let mut point = || DVec3::new(number(), number(), number());
        let (mut found, mut exact) = (0, 0);
        for (scale, away, outlier) in [
            (1.0, 0.0, 1.0),
            (1e-40, 1e3, 1e6),
            (1e3, 5e6, 1e9),
            (1e140, 0.0, 1.0),
            (1.0, 0.0, 1e200),
        ] {
            let middle = scale * away * DVec3::new(0.3, -1.0, 0.1);
            let mut boxes: Vec<Bounds> = (0..400)
                .map(|_| {
                    let corner = middle + scale * point();
                    Bounds::of([corner, corner + 0.1 * scale * point()])
                })
                .collect();
            boxes.push(Bounds::of([middle, middle + scale * outlier]));
            let mut bvh = Bvh::build(401, |k| boxes[k as usize], Bvh::OBJECTS);
            for k in 0..1200 {
                if k == 600 && scale == 1.0 {
                    // Some move, not too far away.
                    for moved in (0..400_u32).step_by(7) {
                        let corner = boxes[moved as usize].low + 30.0 * point();
                        boxes[moved as usize] = Bounds::of([corner, corner + 0.1 * point()]);
                        assert!(bvh.refit(moved, boxes[moved as usize]));
                    }
                }
                let target = boxes[k % 401].centre() + 0.02 * scale * point();
                let distance = [0.5, 0.0, 2.0, 1e3, 1e7, 1e20, 1e30][k % 7];
                let start = middle + scale * distance * point();
                let mut direction = (target - start) / scale;
                if k % 3 == 0 {
                    direction[k % 2] = [0.0, -0.0, 1e-33, -1e-300][k % 4];
                }
                if direction == DVec3::ZERO || !start.is_finite() {
                    continue;
                }
                let t_min = if k % 11 == 0 { -3.0 } else { 0.0 };
                // In the middle of what is there, for starts nearby and far away.
                let t_max = if k % 4 == 0 { 1.0 } else { f64::INFINITY };
                let ray = Ray { t_min, t_max, ..Ray::new(start, direction) };
                let [met, truly] = judged(&bvh, &boxes, &ray);
                // Beside a box of 1e200, or from afar, float64 cannot tell the others apart.
                if outlier < 1e100 && distance < 1e8 {
                    found += met;
                    exact += truly;
                }
            }
        }
        assert!(found < exact + exact / 4, "{found}, {exact} in float64");
    }

    /// Wherever the origin is, also where float32 has no digit left for a box, or the distance
    /// leaves its range.
    #[test]
    fn boxes_far_from_the_origin_are_rounded_outwards() {
        for scale in [1e-50, 1e-30, 1.0, 1e8, 1e30, 1e50, 1e300] {
            for k in 0..200 {
                let x = scale * (1.0 + f64::from(k) / 7.0);
                let low = DVec3::new(x, -x, x / 3.0);
                let bounds = Bounds::of([low, low + 0.01 * f64::from(k % 3)]);
                for origin in [DVec3::ZERO, DVec3::splat(0.1), -low, DVec3::splat(-1e20)] {
                    let reach = (low - origin).abs().max_element() + 0.02;
                    for extent in [reach, 0.5 * reach / FARTHEST_BOX] {
                        let space = BoxSpace::new(origin, extent);
                        let [a, b] = space.outwards(bounds).map(|end| end.map(f64::from));
                        // The difference is rounded here too.
                        let low = space.point(bounds.low).map(f64::next_down);
                        let high = space.point(bounds.high).map(f64::next_up);
                        assert!(DVec3::from(a).cmple(low).all(), "{bounds:?} {origin}");
                        assert!(high.cmple(DVec3::from(b)).all(), "{bounds:?} {origin}");
                    }
                }
            }
        }
    }

    #[test]
    fn empty_boxes_are_left_out() {
        let bvh = Bvh::build(
            3,
            |k| {
                if k == 1 { Bounds::of([DVec3::ONE]) } else { Bounds::EMPTY }
            },
            0.0,
        );
        assert_eq!(indices(&bvh), [1]);
        assert!(Bvh::build(0, |_| Bounds::EMPTY, 0.0).nodes.is_empty());
    }
}

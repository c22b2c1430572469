//! The trees over meshes: how good they are to be, and which a scene has already.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use super::joined::{self, ObjectTree};
use super::{Object, Scene};
use crate::accel::MeshTree;
use crate::error::Result;
use crate::geometry::named;
use crate::memory;
use crate::parallel;
use crate::shape::Mesh;
use crate::watch::{Watch, stop_if_asked};

named! {
    /// Trade-off between the time to build the trees of meshes and the time of each ray. No answer
    /// depends on it.
    ///
    /// ```
    /// use firsthit::scene::{Build, BuildSettings};
    /// use firsthit::{Object, Scene, Sphere, DVec3};
    ///
    /// let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0)?);
    /// let settings = BuildSettings { build: "fast".parse::<Build>()?, ..BuildSettings::default() };
    /// assert_eq!(Scene::build(vec![ball], settings)?.objects().len(), 1);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub enum Build, "build":
    /// `Fast` where few rays will be shot for each triangle; `Best` where many will, or their
    /// number is unknown.
    #[default]
    "auto" => Auto;
    /// A build in a third of the time, or half of it where sizes of triangles differ much. A ray
    /// may meet twice as many boxes.
    "fast" => Fast;
    /// The tree that rays go through in the least time.
    "best" => Best;
}

/// Settings for building the trees of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BuildSettings {
    /// The trade-off between building and tracing.
    pub build: Build,
    /// About how many rays will be shot, where that is known: pixels times samples, and those from
    /// there to lights.
    pub rays: Option<u64>,
}

/// The least number of rays for each triangle at which [`Build::Auto`] makes the full build. That
/// takes about 200 ns more for a triangle; a ray takes 20 to 100 ns more after the fast one.
const RAYS_PER_TRIANGLE: u64 = 2;

impl BuildSettings {
    /// Whether the trees over `triangles` triangles in all are built fast.
    pub(super) fn is_fast(self, triangles: usize) -> bool {
        match self.build {
            Build::Fast => true,
            Build::Best => false,
            Build::Auto => {
                let most = (triangles as u64).saturating_mul(RAYS_PER_TRIANGLE);
                self.rays.is_some_and(|rays| rays < most)
            }
        }
    }
}

/// Upper bound on the memory of building a tree, in bytes for each triangle. It is reached where no
/// vertices are shared: four triangles have a leaf, its share of a wide node, two binary nodes with
/// their plans, and each has three points and a place in the order.
const TREE_BYTES: usize = 160;

/// As [`TREE_BYTES`], for the fast build, where leaves are put together from parts that have them
/// too.
const FAST_TREE_BYTES: usize = 280;

/// Meshes with fewer triangles are built side by side.
const SMALL: usize = 1 << 14;

/// Builds trees as a scene asks for them.
pub(super) struct TreeBuilder<'a> {
    is_fast: bool,
    watch: &'a dyn Watch,
    /// The triangles that the watch was not told of.
    left: AtomicU64,
}

impl Watch for TreeBuilder<'_> {
    /// A group's may be built twice, and are told of once.
    fn advance(&self, count: u64) {
        let less = |left: u64| Some(left.saturating_sub(count));
        let (Ok(left) | Err(left)) = self.left.fetch_update(Relaxed, Relaxed, less);
        self.watch.advance(count.min(left));
    }

    fn is_stopped(&self) -> bool {
        self.watch.is_stopped()
    }
}

impl<'a> TreeBuilder<'a> {
    /// Chooses the builder for the meshes of `objects`, each of which has one that needs a tree.
    pub(super) fn new<'b>(
        build: BuildSettings,
        objects: impl Iterator<Item = &'b Object>,
        watch: &'a dyn Watch,
    ) -> Self {
        let triangles = objects.map(Object::triangles).sum();
        if triangles > 0 {
            watch.begin("building trees", triangles as u64, "triangles");
        }
        Self { is_fast: build.is_fast(triangles), watch, left: AtomicU64::new(triangles as u64) }
    }

    /// The tree over a mesh.
    pub(super) fn build(&self, mesh: &Mesh) -> Result<MeshTree> {
        let has_room_for = |bytes_each: usize| {
            let bytes = mesh.triangles().len().saturating_mul(bytes_each);
            memory::check("the tree over a mesh", bytes)
        };
        // The full build takes less memory.
        let is_fast = self.is_fast && has_room_for(FAST_TREE_BYTES).is_ok();
        if !is_fast {
            has_room_for(TREE_BYTES)?;
        }
        MeshTree::build_watched(mesh, is_fast, self)
    }
}

/// The tree of each object: that of a group, or one for each mesh, however many objects share it.
/// Trees of the scene before are used again, unless better ones are asked for.
pub(super) fn object_trees(
    objects: &[Object],
    build: BuildSettings,
    before: Option<&Scene>,
    watch: &dyn Watch,
) -> Result<Vec<ObjectTree>> {
    // Fast, if there were triangles enough.
    let may_be_quick = build.is_fast(usize::MAX);
    let is_good_enough = |tree: &MeshTree| may_be_quick || !tree.is_quick();
    let known = before.into_iter().flat_map(|scene| scene.objects.iter().zip(&scene.trees));
    let known = known.filter_map(|(object, tree)| Some((object.mesh()?, tree.own()?)));
    let mut built: HashMap<*const Mesh, Arc<MeshTree>> = known
        .filter(|(_, tree)| is_good_enough(tree))
        .map(|(mesh, tree)| (Arc::as_ptr(mesh), Arc::clone(tree)))
        .collect();
    let mut trees = vec![ObjectTree::None; objects.len()];
    if let Some(before) = before {
        for group in joined::kept(objects, before, is_good_enough) {
            group.join(&mut trees);
        }
    }
    // The objects whose meshes have no tree yet. Instances mostly stand side by side.
    let mut seen = HashSet::new();
    let mut last = None;
    let missing = (0..objects.len()).filter(|&k| {
        let mesh = objects[k].mesh().map(Arc::as_ptr);
        if trees[k].any().is_some() || mesh == last {
            return false;
        }
        last = mesh;
        mesh.is_some_and(|mesh| !built.contains_key(&mesh) && seen.insert(mesh))
    });
    let missing: Vec<usize> = missing.collect();
    let builder = TreeBuilder::new(build, missing.iter().map(|&k| &objects[k]), watch);
    let fitted = |k: usize| before?.fitted(k, objects[k].mesh()?, is_good_enough);
    // A tree that is fitted, as of something that bends from step to step, stays one of its own.
    let is_fittable = |k: usize| before.is_some_and(|before| before.may_fit(k, &objects[k]));
    let is_missing = |object: u32| missing.binary_search(&(object as usize)).is_ok();
    let may_join = |object| is_missing(object) && !is_fittable(object as usize);
    for group in joined::found(objects, may_join, &|mesh| builder.build(mesh))? {
        group.join(&mut trees);
    }
    let alone = missing.iter().filter(|&&k| trees[k].any().is_none());
    let alone = alone.filter_map(|&k| Some((k, objects[k].mesh()?)));
    let tree = |(k, mesh): (usize, &Arc<Mesh>)| {
        let Some(tree) = fitted(k) else {
            return Ok((k, Arc::new(builder.build(mesh)?)));
        };
        builder.advance(mesh.triangles().len() as u64);
        Ok((k, Arc::new(tree)))
    };
    // One after the other large meshes take the memory of one, and all threads build each.
    let (small, large): (Vec<_>, Vec<_>) =
        alone.partition(|(_, mesh)| mesh.triangles().len() < SMALL);
    let mut made = parallel::try_map(small, tree)?;
    for one in large {
        stop_if_asked(watch)?;
        made.push(tree(one)?);
    }
    let pointer = |k: usize| objects[k].mesh().map(Arc::as_ptr);
    built.extend(made.into_iter().filter_map(|(k, tree)| Some((pointer(k)?, tree))));
    hand_out(&built, objects, &mut trees);
    Ok(trees)
}

/// Gives objects that have no tree that of their mesh, if there is one.
fn hand_out(
    built: &HashMap<*const Mesh, Arc<MeshTree>>,
    objects: &[Object],
    trees: &mut [ObjectTree],
) {
    let mut last = (std::ptr::null(), None);
    for (tree, object) in trees.iter_mut().zip(objects) {
        if let (None, Some(mesh)) = (tree.any(), object.mesh()) {
            if last.0 != Arc::as_ptr(mesh) {
                last = (Arc::as_ptr(mesh), built.get(&Arc::as_ptr(mesh)));
            }
            if let Some(built) = last.1 {
                *tree = ObjectTree::Own(Arc::clone(built));
            }
        }
    }
}

impl Scene {
    /// Whether `moved` may differ from the object in its place in vertices only, so that the tree
    /// can be refitted from the next step on.
    fn may_fit(&self, object: usize, moved: &Object) -> bool {
        let known = self.objects.get(object).and_then(Object::mesh);
        let is_alike = |(known, moved): (&Arc<Mesh>, &Arc<Mesh>)| {
            !Arc::ptr_eq(known, moved) && known.triangles().len() == moved.triangles().len()
        };
        known.zip(moved.mesh()).is_some_and(is_alike)
    }

    /// The tree of an object's mesh for one that differs from it in its vertices only.
    fn fitted(
        &self,
        object: usize,
        moved: &Mesh,
        is_good_enough: impl Fn(&MeshTree) -> bool,
    ) -> Option<MeshTree> {
        let mesh = self.objects.get(object)?.mesh()?;
        let tree = self.trees[object].own();
        let tree = tree.filter(|tree| is_good_enough(tree))?;
        (mesh.triangles() == moved.triangles()).then(|| tree.refit(moved))?
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Positions;

    #[test]
    fn few_rays_are_worth_a_fast_build_and_many_a_good_one() {
        let auto = |rays| BuildSettings { build: Build::Auto, rays };
        assert!(auto(Some(1 << 20)).is_fast(4_000_000));
        assert!(!auto(Some(1 << 20)).is_fast(70_000));
        assert!(!auto(None).is_fast(4_000_000));
        let asked = |build| BuildSettings { build, ..auto(Some(1)) };
        assert!(asked(Build::Fast).is_fast(1) && !asked(Build::Best).is_fast(4_000_000));
    }

    #[test]
    fn trees_that_are_good_enough_are_used_again() {
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let mesh = Mesh::new(Positions::compact(corners.to_vec()), vec![[0, 1, 2]]).unwrap();
        let objects = vec![Object::new(Arc::new(mesh))];
        let settings = |build, rays| BuildSettings { build, rays };
        let fast = Scene::build(objects.clone(), settings(Build::Fast, None)).unwrap();
        for (build, rays, is_quick) in [
            (Build::Fast, None, true),
            (Build::Auto, Some(9), true),
            (Build::Auto, None, false),
            (Build::Best, Some(1), false),
        ] {
            let scene = fast.clone().with_build(settings(build, rays));
            let scene = scene.with_objects(objects.clone()).unwrap();
            let tree = scene.trees[0].own().unwrap();
            assert_eq!(tree.is_quick(), is_quick, "{build:?} {rays:?}");
        }
    }
}

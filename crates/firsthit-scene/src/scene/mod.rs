//! The scene: objects, lights, and the trees over them. Once built, only the objects' transforms
//! change.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into a kernel is not compiled for its instruction set"
)]

mod background;
mod blend_below;
mod build;
mod catalog;
mod changes;
mod coloring;
mod duplicates;
mod emitters;
mod environment;
mod extent;
mod fingerprint;
mod interaction;
mod joined;
mod light;
mod lighting;
mod likely_up;
mod material;
mod object;
mod stored;
mod terminator;
mod texture;
mod top_tree;

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

pub use background::Background;
pub use build::{Build, BuildSettings};
pub use catalog::{Catalog, Label};
pub use coloring::{ColorBy, Colored, Coloring};
pub use environment::{Daylight, Environment, EnvironmentKind, EnvironmentMap};
pub use interaction::SurfaceInteraction;
pub use light::{
    DirectionalLight, DiscLight, Light, LightHit, LightSample, PointLight, RectangleLight,
    SphereLight, SpotLight,
};
pub use material::{
    AlphaMode, Bsdf, BsdfSample, Glass, MapRole, Maps, Material, Matte, MetalRough, Model,
};
pub use object::Object;
pub use texture::{Filter, Sample, Texture, TextureMap, UvSet, Wrap};

#[doc(hidden)]
pub use {
    duplicates::Duplicates,
    emitters::Emitters,
    environment::Hemispheres,
    extent::support,
    interaction::compute_geometry,
    joined::{Group, ObjectTree},
    light::{PreparedLight, Sun, form_factor},
    material::Lambertian,
    stored::SceneParts,
    terminator::terminator_factor,
    top_tree::{CandidateList, NearbyObjects, ObjectCandidates, PacketCandidates},
};

use build::object_trees;
use top_tree::TopTree;

use crate::accel::{InstructionSet, MeshTree, WalkStack, WorldRays};
use crate::error::{Error, Result};
use crate::geometry::summary::{Few, summary};
use crate::geometry::{Beam, Bounds, DVec3, Hit};
use crate::memory;
use crate::parallel;
use crate::shape::Meshes;
use crate::simd::Lanes;
use crate::watch::Watch;

/// Objects in a world, ready to be shot at from any number of threads.
///
/// An object's identifier is its index in the order of insertion.
///
/// ```
/// use firsthit::{DVec3, Object, Plane, Scene, Sphere, shoot};
///
/// let scene = Scene::new(vec![
///     Object::new(Sphere::new(DVec3::new(0.0, 0.0, 1.0), 1.0)?).named("ball"),
///     Object::new(Plane::new(DVec3::ZERO, DVec3::Z)?).named("ground"),
/// ])?;
/// let hit = shoot(&scene, DVec3::new(5.0, 0.0, 3.0), DVec3::NEG_Z);
/// assert_eq!(scene.object(&hit).map(Object::name), Some("ground"));
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Clone)]
pub struct Scene {
    objects: Vec<Object>,
    trees: Vec<ObjectTree>,
    /// The settings that the trees were built with, and that further ones will be.
    build: BuildSettings,
    top: TopTree,
    derived: Derived,
    lights: Vec<Light>,
    has_own_lights: bool,
    environment: Option<Arc<Environment>>,
    has_own_environment: bool,
    /// The colouring by numbers, if there is one.
    colored: Option<Arc<Colored>>,
    /// See [`Scene::up`].
    up: Option<DVec3>,
}

/// Values derived from the rest of a scene; made when first asked for.
#[derive(Clone, Default)]
struct Derived {
    places: Places,
    fingerprint: OnceLock<String>,
    /// See [`Scene::first_open_object`].
    first_open: OnceLock<Option<usize>>,
    /// See [`Scene::has_translucent`].
    translucent: OnceLock<bool>,
    /// See [`Scene::catalog`]; shared by all scenes that are this one with objects moved.
    catalog: OnceLock<Arc<Catalog>>,
    /// Digests of meshes and textures, shared by all scenes that are this one with objects moved.
    digests: Arc<OnceLock<fingerprint::Known>>,
}

/// Values derived from the places of the visible objects.
#[derive(Clone, Default)]
struct Places {
    /// See [`Scene::bounds`].
    bounds: OnceLock<Bounds>,
    /// See [`Scene::likely_up`].
    seen: OnceLock<likely_up::LevelAreas>,
    /// Whether something visible has no end.
    endless: OnceLock<bool>,
    /// See [`Scene::emitters`].
    emitters: OnceLock<Arc<Emitters>>,
}

// The first objects, and how much there is.
summary!(
    Scene, "Scene", |scene| "objects": Few(&scene.objects), "triangles": scene.triangles(), "bounds": scene.bounds(),
    "lights": scene.lights.len()
);

impl Scene {
    /// The scene of `objects`; builds the trees with all threads of the current rayon pool.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`] for more objects than an identifier can name, and those of
    /// [`InstructionSet::current`].
    pub fn new(objects: Vec<Object>) -> Result<Self> {
        Self::build(objects, BuildSettings::default())
    }

    /// The scene with trees as `settings` ask for. Rays have equal answers with all settings.
    /// Scenes derived from this one ([`with_objects`](Self::with_objects)) keep the settings.
    ///
    /// # Errors
    ///
    /// The errors of [`Scene::new`].
    pub fn build(objects: Vec<Object>, settings: BuildSettings) -> Result<Self> {
        Self::build_watched(objects, settings, &())
    }

    /// As [`build`](Self::build); `watch` follows it, and may end it.
    ///
    /// # Errors
    ///
    /// The errors of [`Scene::new`], and [`Error::Interrupted`].
    pub fn build_watched(
        objects: Vec<Object>,
        settings: BuildSettings,
        watch: &dyn Watch,
    ) -> Result<Self> {
        Self::assemble(objects, settings, None, watch)
    }

    /// Changes the settings for the trees of scenes derived from this one. Its own trees stay as
    /// they are.
    pub fn with_build(self, settings: BuildSettings) -> Self {
        Self { build: settings, ..self }
    }

    /// A clone, or an error where there is no memory for the objects and the tree over them, where
    /// `clone` ends the process. Meshes and their trees are shared.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`].
    pub fn try_clone(&self) -> Result<Self> {
        /// Upper bound on the memory of the tree over the objects and the lists beside it, in bytes
        /// for each object.
        const OF_TREE: usize = 512;
        let each = size_of::<Object>() + OF_TREE;
        memory::check("a copy of the scene", self.objects.len() * each)?;
        Ok(self.clone())
    }

    /// A scene of other objects, with the same lights, coloured as this one. Unchanged parts are
    /// shared: the tree over a mesh that this scene has too is not built again. A mesh in the place
    /// of one with the same triangles and other vertices gets that one's tree: its boxes are fitted
    /// to the new vertices, unless that would make a poor tree.
    ///
    /// # Errors
    ///
    /// The errors of [`Scene::new`] and [`Scene::with_coloring`].
    pub fn with_objects(&self, objects: Vec<Object>) -> Result<Self> {
        self.with_objects_watched(objects, &())
    }

    /// As [`with_objects`](Self::with_objects); `watch` follows it, and may end it.
    ///
    /// # Errors
    ///
    /// The errors of [`Scene::with_objects`], and [`Error::Interrupted`].
    pub fn with_objects_watched(&self, objects: Vec<Object>, watch: &dyn Watch) -> Result<Self> {
        let scene = Self::assemble(objects, self.build, Some(self), watch)?;
        let has_own_lights = self.has_own_lights;
        let scene = Self {
            has_own_lights,
            up: self.up,
            environment: self.environment.clone(),
            has_own_environment: self.has_own_environment,
            ..scene.with_lights(self.lights.clone())
        };
        scene.with_coloring(self.colored().map(|colored| colored.coloring().clone()))
    }

    /// Whether some of its trees were built for few rays, or objects have left them.
    #[doc(hidden)]
    pub fn has_poor_trees(&self) -> bool {
        let mut trees = self.trees.iter().filter_map(ObjectTree::any);
        let lacks_tree = |(object, tree): (&Object, &ObjectTree)| {
            object.mesh().is_some() && tree.any().is_none()
        };
        trees.any(|tree| tree.is_quick())
            || !self.groups().all(|group| group.is_whole())
            || self.objects.iter().zip(&self.trees).any(lacks_tree)
    }

    /// The scene with each of its trees from the full build or a refit of it, and over what is
    /// there alone.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`] where there is no memory for them, and [`Error::Interrupted`] when `watch`
    /// stops it.
    #[doc(hidden)]
    pub fn with_best_trees(&self, watch: &dyn Watch) -> Result<Self> {
        let best = BuildSettings { build: Build::Best, ..self.build };
        let mut scene = self.try_clone()?;
        scene.trees = object_trees(&self.objects, best, Some(self), watch)?;
        if !scene.groups().all(|group| group.is_whole()) {
            // Objects that have left a group may join another one.
            scene.trees = object_trees(&self.objects, best, None, watch)?;
        }
        scene.top = TopTree::new(&scene.objects, &scene.trees);
        Ok(scene)
    }

    fn assemble(
        objects: Vec<Object>,
        build: BuildSettings,
        before: Option<&Self>,
        watch: &dyn Watch,
    ) -> Result<Self> {
        if i32::try_from(objects.len()).is_err() {
            let (got, limit) = (objects.len().to_string(), i32::MAX.to_string());
            let what = "objects in a scene";
            return Err(Error::Limit { what, got, limit });
        }
        // A wrong setting is told here: shooting has no way to.
        InstructionSet::current()?;
        let trees = object_trees(&objects, build, before, watch)?;
        let changed =
            before.and_then(|before| before.few_changed(&objects, &trees).zip(Some(before)));
        let Some((changed, before)) = changed else {
            let top = TopTree::new(&objects, &trees);
            return Ok(Self::over((objects, trees), build, top, OnceLock::new()));
        };
        let (mut top, mut bounds) = (before.top.clone(), OnceLock::new());
        if changed.is_empty() {
            bounds.clone_from(&before.derived.places.bounds);
        } else {
            top.changed(&objects, &trees, &changed);
        }
        Ok(Self::over((objects, trees), build, top, bounds))
    }

    /// The scene of objects and their trees, without light.
    fn over(
        (objects, trees): (Vec<Object>, Vec<ObjectTree>),
        build: BuildSettings,
        top: TopTree,
        bounds: OnceLock<Bounds>,
    ) -> Self {
        let mut derived = Derived::default();
        derived.places.bounds = bounds;
        Self {
            objects,
            trees,
            build,
            top,
            derived,
            lights: Vec::new(),
            has_own_lights: true,
            environment: None,
            has_own_environment: true,
            colored: None,
            up: None,
        }
    }

    /// The objects that are not in the places of this scene's, whatever they look like, or new
    /// behind them; `None` where they are many, or joined in another way.
    fn few_changed(&self, objects: &[Object], trees: &[ObjectTree]) -> Option<Vec<u32>> {
        let leader = |tree: &ObjectTree| tree.group().map(|group| group.leader());
        let (known, new) = trees.split_at_checked(self.trees.len())?;
        let are_joined_alike = (self.trees.iter().map(leader).eq(known.iter().map(leader)))
            && new.iter().all(|tree| leader(tree).is_none());
        let mut before = self.objects.iter();
        let is_other = |object| !before.next().is_some_and(|it: &Object| it.is_in_place_of(object));
        let numbered = (0..).zip(objects.iter().map(is_other));
        let changed: Vec<u32> =
            numbered.filter(|&(_, is_other)| is_other).map(|(k, _)| k).collect();
        (are_joined_alike && top_tree::are_few(changed.len(), objects.len())).then_some(changed)
    }

    /// Changes the direction [`up`](Self::up). Hits and the fingerprint do not depend on it.
    pub fn with_up(mut self, up: DVec3) -> Self {
        self.up = Some(up);
        self
    }

    /// The direction upwards in the world, for default cameras: from the file or
    /// [`with_up`](Self::with_up), else +z.
    pub fn up(&self) -> DVec3 {
        self.up.unwrap_or(DVec3::Z)
    }

    /// The objects, in the order of their identifiers.
    #[inline]
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// The number of triangles in the world: those of a shared mesh once for each object.
    pub fn triangles(&self) -> u64 {
        self.objects.iter().map(|object| object.triangles() as u64).sum()
    }

    /// The object that was hit; `None` for a miss.
    ///
    /// For more about it, see [`Scene::interaction`].
    #[inline]
    pub fn object(&self, hit: &Hit) -> Option<&Object> {
        self.objects.get(usize::try_from(hit.object).ok()?)
    }

    /// The objects that no ray meets first, because an earlier one is in their place: no tree has
    /// them.
    #[doc(hidden)]
    #[inline]
    pub fn duplicates(&self) -> &Duplicates {
        &self.top.duplicates
    }

    /// The mesh and tree as [`at_mesh`](Self::at_mesh) has them, where triangles are all that rays
    /// can meet.
    #[doc(hidden)]
    pub fn plain_mesh(&self, index: u32) -> Option<(Meshes<'_>, &MeshTree)> {
        let object = self.objects.get(index as usize)?;
        let (_, tree) = self.at_mesh(index)?;
        let is_plain = tree.has_nodes() && !object.has_cutouts() && !object.is_hidden();
        self.at_mesh(index).filter(|_| is_plain)
    }

    /// The object that stands for all that rays may meet, if it is one alone.
    #[doc(hidden)]
    pub fn only_object(&self) -> Option<u32> {
        self.top.only_object()
    }

    /// Asks memory for what a ray needs of an object that it comes to.
    #[inline(always)]
    #[doc(hidden)]
    pub fn prefetch<L: Lanes>(&self, l: L, object: u32) {
        l.prefetch(&self.objects[object as usize]);
        l.prefetch(&self.trees[object as usize]);
    }

    /// The objects that a ray may meet.
    #[inline(always)]
    #[doc(hidden)]
    pub fn candidates(&self) -> ObjectCandidates<'_> {
        self.top.candidates()
    }

    /// The objects that the rays of a packet may meet; `None` where it is better to ask
    /// [for each](Self::candidates).
    #[doc(hidden)]
    #[inline(always)]
    pub fn packet_candidates<L: Lanes>(
        &self,
        l: L,
        rays: (&WorldRays, usize),
        stack: &mut WalkStack,
    ) -> Option<PacketCandidates<'_>> {
        self.top.packet_candidates(l, rays, stack)
    }

    /// The objects that any of some rays may meet; `None` where it is better to ask
    /// [for each](Self::candidates).
    #[doc(hidden)]
    pub fn list_candidates(&self, beam: &Beam) -> Option<CandidateList<'_>> {
        self.top.list_candidates(beam)
    }

    /// Whether objects are so few that rays together [list](Self::list_candidates) them.
    #[inline(always)]
    #[doc(hidden)]
    pub fn lists_candidates(&self) -> bool {
        self.top.lists_candidates()
    }

    /// The first object that is not [closed](Shape::is_closed), or has parts that are cut out. An
    /// empty mesh has no part.
    #[doc(hidden)]
    pub fn first_open_object(&self) -> Option<usize> {
        let has_gaps = |object: &Object| object.has_cutouts() || !object.shape().is_closed();
        let is_nothing = |object: &Object| object.is_hidden() || object.is_empty_mesh();
        let is_open = |object: &Object| !is_nothing(object) && has_gaps(object);
        *parallel::once(&self.derived.first_open, || self.objects.iter().position(is_open))
    }

    /// The objects around a point.
    #[doc(hidden)]
    pub fn around(&self, point: DVec3, stack: &mut WalkStack) -> NearbyObjects<'_> {
        self.top.around(point, stack)
    }

    /// The size of the trees in bytes, each shared one once.
    pub fn tree_bytes(&self) -> usize {
        let distinct: HashMap<_, _> = self
            .trees
            .iter()
            .filter_map(ObjectTree::any)
            .map(|tree| (Arc::as_ptr(tree), tree.bytes()))
            .collect();
        distinct.values().sum::<usize>() + self.top.bytes()
    }
}

//! What there is to see: objects, lights, and the trees over them. Immutable once built.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into a kernel is not compiled for its instruction set"
)]

mod background;
mod duplicates;
#[cfg(feature = "frame")]
mod fingerprint;
mod light;
mod likely_up;
mod material;
mod object;
mod texture;

use std::collections::HashMap;
use std::fmt::{self, Debug, Formatter};
use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

pub use background::Background;
pub use light::Light;
pub use material::{AlphaMode, MapRole, Maps, Material};
pub use object::Object;
pub use texture::{Filter, Sample, Texture, TextureMap, Wrap};

use duplicates::Duplicates;

use crate::accel::{Bvh, InstructionSet, MeshTree, Walk, WalkStack};
use crate::error::{Error, Result};
use crate::geometry::summary::Few;
use crate::geometry::{Bounds, Color, DVec2, DVec3, Hit, Ray};
use crate::memory;
use crate::shape::{Mesh, Shape, Surface};

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
    /// A mesh's tree, shared by all objects that share the mesh; `None` for other shapes.
    trees: Vec<Option<Arc<MeshTree>>>,
    tree: Bvh,
    /// The objects that every ray is a candidate for: they have no finite box, or only a vague one, or there
    /// are so few that asking the tree would take longer.
    unconditional: Vec<u32>,
    /// Objects in the same place as an earlier one, which are in no tree.
    duplicates: Duplicates,
    bounds: Bounds,
    lights: Vec<Light>,
    has_own_lights: bool,
    /// See [`Scene::up`].
    up: Option<DVec3>,
    /// Made when first asked for.
    fingerprint: OnceLock<String>,
}

/// A summary: the first objects, and how much there is.
impl Debug for Scene {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Scene")
            .field("objects", &Few(&self.objects))
            .field("triangles", &self.triangles())
            .field("bounds", &self.bounds)
            .field("lights", &self.lights.len())
            .finish_non_exhaustive()
    }
}

impl Scene {
    /// The scene of `objects`; builds the trees with all threads of the current rayon pool.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`] for more objects than an identifier can name, and those of
    /// [`InstructionSet::current`].
    pub fn new(objects: Vec<Object>) -> Result<Self> {
        Self::build(objects, None)
    }

    /// A scene of other objects, with the same lights. What did not change is shared: the tree over a mesh
    /// that this scene has too is not built again. A mesh in the place of one with the
    /// same triangles and other vertices gets that one's tree: its boxes are fitted to the new vertices, unless that
    /// would make a poor tree.
    ///
    /// # Errors
    ///
    /// Those of [`Scene::new`].
    pub fn with_objects(&self, objects: Vec<Object>) -> Result<Self> {
        let scene = Self::build(objects, Some(self))?;
        let has_own_lights = self.has_own_lights;
        Ok(Self {
            has_own_lights,
            up: self.up,
            ..scene.with_lights(self.lights.clone())
        })
    }

    fn build(objects: Vec<Object>, before: Option<&Self>) -> Result<Self> {
        let count = i32::try_from(objects.len())
            .ok()
            .and_then(|count| u32::try_from(count).ok());
        let Some(count) = count else {
            let (got, limit) = (objects.len().to_string(), i32::MAX.to_string());
            return Err(Error::Limit {
                what: "objects in a scene",
                got,
                limit,
            });
        };
        // A wrong setting is told here: shooting has no way to.
        InstructionSet::current()?;
        let trees = mesh_trees(&objects, before)?;
        let bounds: Vec<Bounds> = objects.par_iter().map(Object::bounds).collect();
        let duplicates = Duplicates::new(&objects, &bounds);
        let is_loose = |k: u32| {
            count <= FEW
                || is_unbounded(&bounds[k as usize])
                || objects[k as usize].slack() > LARGEST_SLACK
        };
        let is_asked = |&k: &u32| !duplicates.contains(k);
        let unconditional: Vec<u32> = (0..count)
            .filter(|&k| is_loose(k))
            .filter(is_asked)
            .collect();
        let slack = (0..count)
            .filter(|&k| !is_loose(k))
            .map(|k| objects[k as usize].slack())
            .fold(Bvh::OBJECTS, f64::max);
        let padded = |k: u32| {
            if is_loose(k) || duplicates.contains(k) {
                Bounds::EMPTY
            } else {
                objects[k as usize].padded(bounds[k as usize], slack)
            }
        };
        let tree = Bvh::build(count, padded, slack);
        let finite = bounds.iter().filter(|bounds| !is_unbounded(bounds));
        let bounds = finite.copied().fold(Bounds::EMPTY, Bounds::union);
        Ok(Self {
            objects,
            trees,
            tree,
            unconditional,
            duplicates,
            bounds,
            lights: Vec::new(),
            has_own_lights: true,
            up: None,
            fingerprint: OnceLock::new(),
        })
    }

    /// The same scene with another [`up`](Self::up). Hits and the fingerprint do not depend on it.
    pub fn with_up(self, up: DVec3) -> Self {
        Self {
            up: Some(up),
            ..self
        }
    }

    /// Which way is up in the world, for default cameras: that of the file or of [`with_up`](Self::with_up), else +z.
    pub fn up(&self) -> DVec3 {
        self.up.unwrap_or(DVec3::Z)
    }

    /// The same scene with other lights.
    pub fn with_lights(self, lights: Vec<Light>) -> Self {
        Self {
            lights,
            has_own_lights: true,
            fingerprint: OnceLock::new(),
            ..self
        }
    }

    /// The same scene with lights that nobody asked for, such as one that goes with the camera: they are
    /// not part of its [fingerprint](Self::fingerprint).
    pub fn with_borrowed_lights(self, lights: Vec<Light>) -> Self {
        let has_none = self.lights.is_empty() || !self.has_own_lights;
        Self {
            // Made already, it is still true.
            fingerprint: if has_none {
                self.fingerprint
            } else {
                OnceLock::new()
            },
            lights,
            has_own_lights: false,
            ..self
        }
    }

    /// The objects, in the order of their identifiers.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// The lights; none until some are set.
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// The smallest box around all objects in the world, infinite ones left out; empty without any.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The support function: the largest dot product of `direction` with a point of the scene, for a direction of any length.
    /// Infinite objects are left out; minus infinity for a scene without others.
    ///
    /// It is exact for every shape, where [`bounds`](Self::bounds) is a box around it.
    ///
    /// ```
    /// use firsthit::{DVec3, Object, Scene, Sphere};
    ///
    /// let ball = Sphere::new(DVec3::new(1.0, 0.0, 0.0), 2.0)?;
    /// let scene = Scene::new(vec![Object::new(ball)])?;
    /// assert_eq!(scene.support(DVec3::X), 3.0);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub fn support(&self, direction: DVec3) -> f64 {
        support(&self.objects, direction)
    }

    /// How many triangles there are in the world: those of a shared mesh once for each object.
    pub fn triangles(&self) -> u64 {
        self.objects
            .iter()
            .map(|object| object.triangles() as u64)
            .sum()
    }

    /// The object that was hit; `None` for a miss.
    ///
    /// This and what follows take hits of this scene: with one of another scene they answer for whatever
    /// has its identifiers here, and panic where a mesh has no such triangle.
    pub fn object(&self, hit: &Hit) -> Option<&Object> {
        self.objects.get(usize::try_from(hit.object).ok()?)
    }

    /// Where in the world `ray` has its `hit`; NaN for a miss.
    ///
    /// `ray.at(hit.t)` is off by the rounding of everything on the ray's way; this point is on the surface. In object space a
    /// triangle's is the mean of its corners by the hit's weights, off its plane by 13 * 2^-53 of the largest coordinate at most. Other shapes'
    /// is `ray.at(hit.t)` moved onto the shape, off that by 8 * 2^-53 of the shape's largest coordinate and its size. A
    /// transform rounds once more.
    pub fn position(&self, ray: &Ray, hit: &Hit) -> DVec3 {
        let Some(object) = self.object(hit) else {
            return DVec3::NAN;
        };
        let transform = object.transform();
        let point = if let Some((_, mesh, triangle)) = self.mesh(hit) {
            let [a, b, c] = mesh.corners(triangle);
            a + (hit.barycentric.x * (b - a) + hit.barycentric.y * (c - a))
        } else {
            let point = transform.ray_in_object(ray).at(hit.t);
            object.shape().onto(point, hit.primitive)
        };
        if transform.is_identity() {
            point
        } else {
            transform.world_from_object().transform_point3(point)
        }
    }

    /// The geometric normal in the world where `ray` has its `hit`: the face's own, of length one,
    /// outwards for closed shapes. NaN for a miss, and for a triangle without an area.
    pub fn normal(&self, ray: &Ray, hit: &Hit) -> DVec3 {
        let Some(object) = self.object(hit) else {
            return DVec3::NAN;
        };
        let point = object.transform().ray_in_object(ray).at(hit.t);
        object
            .transform()
            .normal_in_world(object.shape().normal(point, hit.primitive))
    }

    /// The normal to shade with: interpolated where the mesh has normals at its vertices, on the same
    /// side as the geometric `normal`, which is returned everywhere else.
    pub fn shading_normal(&self, hit: &Hit, normal: DVec3) -> DVec3 {
        let smooth = || {
            let (object, mesh, triangle) = self.mesh(hit)?;
            let smooth = object
                .transform()
                .normal_in_world(mesh.shading_normal(triangle, hit.barycentric)?);
            (smooth.is_finite() && smooth.dot(normal) > 0.0).then_some(smooth)
        };
        smooth().unwrap_or(normal)
    }

    /// Whether the front was met: the side that the `normal` points to.
    pub fn is_front(&self, ray: &Ray, normal: DVec3) -> bool {
        ray.direction.dot(normal) < 0.0
    }

    /// The linear colour of the object where it was hit: its material's, times its texture's, times the mesh's
    /// own. `None` for a miss.
    pub fn color(&self, hit: &Hit) -> Option<Color> {
        let object = self.object(hit)?;
        let Some((_, mesh, triangle)) = self.mesh(hit) else {
            return Some(object.color());
        };
        let own = mesh.color(triangle, hit.barycentric).unwrap_or(Color::ONE);
        let uv = || mesh.uv(triangle, hit.barycentric);
        let material = object.material(hit.primitive);
        let look = material.map_or(Object::NEUTRAL, |material| {
            match material.maps.get(MapRole::Color) {
                Some(_) => material.color_at(uv()),
                None => material.color,
            }
        });
        Some(look * own)
    }

    /// Whether the colour where the object was hit is to be seen as it is, whatever the light.
    pub fn is_unlit(&self, hit: &Hit) -> bool {
        self.object(hit)
            .and_then(|object| object.material(hit.primitive))
            .is_some_and(|material| material.unlit)
    }

    /// The texture coordinates where a mesh that has them was hit; else NaN.
    pub fn uv(&self, hit: &Hit) -> DVec2 {
        let uv = self
            .mesh(hit)
            .and_then(|(_, mesh, triangle)| mesh.uv(triangle, hit.barycentric));
        uv.unwrap_or(DVec2::NAN)
    }

    /// The polygon of the file that the triangle hit was part of; of other shapes the primitive.
    pub fn face(&self, hit: &Hit) -> i32 {
        let face = self
            .mesh(hit)
            .and_then(|(_, mesh, triangle)| i32::try_from(mesh.face(triangle)).ok());
        face.unwrap_or(hit.primitive)
    }

    fn mesh(&self, hit: &Hit) -> Option<(&Object, &Mesh, usize)> {
        let object = self.object(hit)?;
        match object.shape() {
            Shape::Mesh(mesh) => {
                Some((object, mesh.as_ref(), usize::try_from(hit.primitive).ok()?))
            }
            _ => None,
        }
    }

    /// Whether no ray meets an object first, because an earlier one is in its place.
    pub(crate) fn is_duplicate(&self, object: u32) -> bool {
        self.duplicates.contains(object)
    }

    /// The objects in the place of one, which no tree has.
    pub(crate) fn duplicates_of(&self, object: u32) -> &[u32] {
        self.duplicates.of(object)
    }

    /// The mesh and the tree of an object whose triangles are all there is to it.
    pub(crate) fn plain_mesh(&self, index: u32) -> Option<(&Mesh, &MeshTree)> {
        let object = self.objects.get(index as usize)?;
        match (object.shape(), self.mesh_tree(index as usize)) {
            (Shape::Mesh(mesh), Some(tree)) if tree.has_nodes() && !object.has_cutouts() => {
                Some((mesh, tree))
            }
            _ => None,
        }
    }

    pub(crate) fn mesh_tree(&self, object: usize) -> Option<&MeshTree> {
        self.trees[object].as_deref()
    }

    /// The objects that a ray may meet.
    #[inline(always)]
    pub(crate) fn on_the_way(&self) -> OnTheWay<'_> {
        OnTheWay {
            unconditional: &self.unconditional,
            tree: (self.unconditional.len() < self.objects.len()).then_some(&self.tree),
            walk: None,
        }
    }

    /// What the trees take in memory, each shared one once.
    pub fn tree_bytes(&self) -> usize {
        let distinct: HashMap<_, _> = self
            .trees
            .iter()
            .flatten()
            .map(|tree| (Arc::as_ptr(tree), tree.bytes()))
            .collect();
        distinct.values().sum::<usize>() + self.tree.bytes()
    }
}

/// See [`Scene::on_the_way`].
pub(crate) struct OnTheWay<'a> {
    unconditional: &'a [u32],
    /// Of all other objects.
    tree: Option<&'a Bvh>,
    /// Begun when the tree's turn comes.
    walk: Option<Walk<'a>>,
}

impl OnTheWay<'_> {
    /// The next object that `ray` may meet at a parameter of at most `t_max`. That is not larger than the
    /// time before, and the others are the same.
    #[inline(always)]
    pub(crate) fn next(&mut self, ray: &Ray, t_max: f64, stack: &mut WalkStack) -> Option<u32> {
        if let Some((&index, rest)) = self.unconditional.split_first() {
            self.unconditional = rest;
            return Some(index);
        }
        self.tree
            .is_some()
            .then(|| self.next_in_tree(ray, t_max, stack))?
    }

    #[inline(never)]
    fn next_in_tree(&mut self, ray: &Ray, t_max: f64, stack: &mut WalkStack) -> Option<u32> {
        let tree = self.tree?;
        let walk = self.walk.get_or_insert_with(|| tree.walk(ray, stack));
        walk.next(t_max, stack)
    }
}

/// Up to so many objects are all asked.
const FEW: u32 = 4;

/// Where rounding reaches farther than this share of the coordinates (the transform all but flattens
/// space), the object is better off without a box than all others are with wider ones.
const LARGEST_SLACK: f64 = 1e-8;

/// What building a tree takes at most, in bytes for each triangle. Where no vertices are shared it is most: four triangles have
/// a leaf, its share of a wide node, two binary nodes with their plans, and each has three points and a place in the order.
const TREE_BYTES: usize = 160;

/// A tree for each mesh, however many objects share it; what the scene before knows is used again.
fn mesh_trees(objects: &[Object], before: Option<&Scene>) -> Result<Vec<Option<Arc<MeshTree>>>> {
    let known = before
        .into_iter()
        .flat_map(|scene| scene.objects.iter().zip(&scene.trees));
    let known = known.filter_map(|(object, tree)| Some((object.mesh()?, tree.as_ref()?)));
    let mut built: HashMap<*const Mesh, Arc<MeshTree>> = known
        .map(|(mesh, tree)| (Arc::as_ptr(mesh), Arc::clone(tree)))
        .collect();
    let mut tree = |k: usize, mesh: &Arc<Mesh>| {
        if let Some(built) = built.get(&Arc::as_ptr(mesh)) {
            return Ok(Arc::clone(built));
        }
        let triangles = mesh.triangles().len();
        memory::check("the tree over a mesh", triangles.saturating_mul(TREE_BYTES))?;
        let fitted = before.and_then(|scene| scene.fitted(k, mesh));
        let tree = Arc::new(fitted.unwrap_or_else(|| MeshTree::build(mesh)));
        built.insert(Arc::as_ptr(mesh), Arc::clone(&tree));
        Ok(tree)
    };
    let objects = objects.iter().enumerate();
    objects
        .map(|(k, object)| object.mesh().map(|mesh| tree(k, mesh)).transpose())
        .collect()
}

impl Scene {
    /// The tree of an object's mesh for one that differs from it in its vertices only.
    fn fitted(&self, object: usize, moved: &Mesh) -> Option<MeshTree> {
        let mesh = self.objects.get(object)?.mesh()?;
        let tree = self.trees[object].as_ref();
        let tree = tree.filter(|_| mesh.triangles() == moved.triangles())?;
        tree.refit(moved)
    }
}

/// See [`Scene::support`]. Objects are visited in the order of the bounds that their boxes give, until no bound that is left
/// exceeds the largest product found: of many instances of a mesh, the vertices of a few are visited.
pub(crate) fn support(objects: &[Object], direction: DVec3) -> f64 {
    let bound = |(index, object): (usize, &Object)| (object.support_bound(direction), index);
    let mut bounds: Vec<(f64, usize)> = objects.par_iter().enumerate().map(bound).collect();
    bounds.retain(|&(bound, _)| bound < f64::INFINITY);
    bounds.par_sort_unstable_by(|(a, _), (b, _)| b.total_cmp(a));
    let mut farthest = f64::NEG_INFINITY;
    for (bound, index) in bounds {
        if bound <= farthest {
            break;
        }
        farthest = farthest.max(objects[index].support(direction));
    }
    farthest
}

fn is_unbounded(bounds: &Bounds) -> bool {
    !bounds.is_empty() && !bounds.is_finite()
}

use std::fmt::{self, Debug, Formatter};
use std::sync::{Arc, OnceLock};

use super::{Label, Material};
use crate::geometry::summary::Short;
use crate::geometry::{Bounds, Color, DVec2, DVec3, Ray, Transform};
use crate::parallel;
use crate::shape::triangle::{Doubtful, EdgeRule, MeshFilter, Shear};
use crate::shape::{Crossing, Mesh, Meshes, Shape, Surface};

/// A shape somewhere in the world. Objects that share a mesh (an [`Arc`]) are instances of it:
/// nothing is copied.
///
/// ```
/// use firsthit::{Color, DVec3, Object, Sphere, Transform};
///
/// let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0)?)
///     .named("ball")
///     .colored(Color::new(0.8, 0.2, 0.2))
///     .placed(Transform::translation(DVec3::new(0.0, 0.0, 1.0))?);
/// assert_eq!(ball.bounds().high, DVec3::new(1.0, 1.0, 2.0));
/// # Ok::<(), firsthit::Error>(())
/// ```
#[expect(clippy::struct_excessive_bools, reason = "independent facts")]
#[derive(Clone, PartialEq)]
pub struct Object {
    shape: Shape,
    transform: Transform,
    about: Arc<About>,
    /// See [`Object::farthest`].
    farthest: f64,
    mask: u32,
    has_cutouts: bool,
    is_out_of_range: bool,
    is_hidden: bool,
    is_removed: bool,
}

/// The parts of an object that no ray needs on its way; clones share them, and all objects that
/// were given none.
#[derive(Clone, Default, PartialEq)]
struct About {
    name: Arc<str>,
    /// The materials that a mesh's slots name; empty where the object was given none.
    materials: Arc<[Material]>,
    node: Option<Label>,
    mesh_label: Option<Label>,
}

impl About {
    fn none() -> &'static Arc<Self> {
        static NONE: OnceLock<Arc<About>> = OnceLock::new();
        parallel::once(&NONE, Arc::default)
    }
}

/// A summary: of its materials their number.
impl Debug for Object {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let mut shown = f.debug_struct("Object");
        shown.field("name", &Short(self.name()));
        shown.field("shape", &self.shape);
        if !self.transform.is_identity() {
            let world_from_object = self.transform.world_from_object();
            shown.field("world_from_object", world_from_object);
        }
        shown.field("materials", &self.materials().len());
        shown.finish_non_exhaustive()
    }
}

impl Object {
    /// The default linear colour of objects: a light grey.
    pub const NEUTRAL: Color = Color::splat(0.6);

    /// The shape where it is, without a name, in a neutral colour.
    pub fn new(shape: impl Into<Shape>) -> Self {
        let shape = shape.into();
        Self {
            is_out_of_range: is_out_of_range(&shape),
            farthest: farthest(&shape, &Transform::IDENTITY),
            shape,
            transform: Transform::IDENTITY,
            about: Arc::clone(About::none()),
            mask: u32::MAX,
            has_cutouts: false,
            is_hidden: false,
            is_removed: false,
        }
    }

    /// The object with a name.
    pub fn named(self, name: impl Into<Arc<str>>) -> Self {
        self.with(|about| &mut about.name, name.into())
    }

    /// The object with the label of the node of a file that it comes from. This changes no picture.
    pub fn from_node(self, node: impl Into<Option<Label>>) -> Self {
        self.with(|about| &mut about.node, node.into())
    }

    /// The object with the label of the mesh of a file that it comes from, or of the part of one.
    /// This changes no picture.
    pub fn from_mesh(self, mesh: impl Into<Option<Label>>) -> Self {
        self.with(|about| &mut about.mesh_label, mesh.into())
    }

    /// The object with something else about it.
    fn with<T: Default + PartialEq>(mut self, part: fn(&mut About) -> &mut T, value: T) -> Self {
        let is_new = Arc::ptr_eq(&self.about, About::none());
        if !(is_new && value == T::default()) {
            *part(Arc::make_mut(&mut self.about)) = value;
        }
        self
    }

    /// The object with its shape taken to the world by `transform`.
    pub fn placed(self, transform: Transform) -> Self {
        let farthest = farthest(&self.shape, &transform);
        Self { transform, farthest, ..self }
    }

    /// Takes its shape to the world by another transform.
    pub(super) fn place(&mut self, transform: Transform) {
        self.farthest = farthest(&self.shape, &transform);
        self.transform = transform;
    }

    /// The object in one linear colour, which a mesh's own colours multiply.
    pub fn colored(self, color: Color) -> Self {
        self.with_materials([Material::colored(color)])
    }

    /// The object with other materials: one for each slot of a mesh; the last one for slots beyond.
    /// Without any the object is in a neutral colour.
    pub fn with_materials(self, materials: impl Into<Arc<[Material]>>) -> Self {
        let materials: Arc<[Material]> = materials.into();
        let is_mesh = self.mesh().is_some();
        let has_cutouts = is_mesh && materials.iter().any(Material::has_cutouts);
        Self { has_cutouts, ..self.with(|about| &mut about.materials, materials) }
    }

    /// The object with another mask: a ray meets it when their masks have a bit in common. The
    /// default mask of objects and rays has all bits. With the mask 0 the object is hidden.
    pub fn masked(self, mask: u32) -> Self {
        Self { mask, ..self }
    }

    /// The object, hidden from all rays, or shown.
    pub fn hidden(self, is_hidden: bool) -> Self {
        Self { is_hidden, ..self }
    }

    /// The object, marked as removed: it is hidden for good, and only there so that the others keep
    /// their identifiers.
    pub fn removed(self, is_removed: bool) -> Self {
        Self { is_removed, ..self }
    }

    /// The mask; see [`Object::masked`].
    #[inline]
    pub fn mask(&self) -> u32 {
        self.mask
    }

    /// Whether no ray meets it.
    #[inline]
    pub fn is_hidden(&self) -> bool {
        self.is_hidden || self.is_removed || self.mask == 0
    }

    /// Whether it is marked as [removed](Self::removed).
    #[inline]
    pub fn is_removed(&self) -> bool {
        self.is_removed
    }

    /// Hides it, or shows it.
    pub(super) fn hide(&mut self, is_hidden: bool) {
        self.is_hidden = is_hidden;
    }

    /// Whether `other` is in the same place, whatever the two look like, as far as this can be told
    /// in constant time.
    pub(super) fn is_in_place_of(&self, other: &Self) -> bool {
        let is_same = match (&self.shape, &other.shape) {
            (Shape::Mesh(mesh), Shape::Mesh(other)) => Arc::ptr_eq(mesh, other),
            (shape, other) => shape == other,
        };
        // An object with cut-outs hides no duplicate.
        let are_cut_alike = self.has_cutouts == other.has_cutouts;
        let are_seen_alike = are_cut_alike && self.is_hidden() == other.is_hidden();
        is_same && are_seen_alike && self.transform == other.transform
    }

    /// The name; may be empty, need not be unique.
    pub fn name(&self) -> &str {
        &self.about.name
    }

    /// The node of a file that it comes from, if any.
    pub fn node(&self) -> Option<&Label> {
        self.about.node.as_ref()
    }

    /// The mesh of a file that it comes from, if the file has meshes of its own, as glTF has.
    pub fn mesh_label(&self) -> Option<&Label> {
        self.about.mesh_label.as_ref()
    }

    /// The shape, in object space.
    #[inline]
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The way from object space to the world.
    #[inline]
    pub fn transform(&self) -> &Transform {
        &self.transform
    }

    /// The mesh, if that is the shape.
    pub fn mesh(&self) -> Option<&Arc<Mesh>> {
        match &self.shape {
            Shape::Mesh(mesh) => Some(mesh),
            _ => None,
        }
    }

    /// The materials, in the order of a mesh's slots; empty where the object was given none.
    #[inline]
    pub fn materials(&self) -> &Arc<[Material]> {
        &self.about.materials
    }

    /// The linear colour: that of the first material, without textures.
    #[inline]
    pub fn color(&self) -> Color {
        self.materials().first().map_or(Self::NEUTRAL, |material| material.color)
    }

    /// The material of a primitive; `None` where the object was given none.
    #[inline]
    pub fn material(&self, primitive: i32) -> Option<&Material> {
        self.materials().get(self.material_slot(primitive)?)
    }

    /// The index of a primitive's material; `None` where the object was given none.
    #[inline]
    pub(crate) fn material_slot(&self, primitive: i32) -> Option<usize> {
        let slot = match (self.mesh(), usize::try_from(primitive)) {
            (Some(mesh), Ok(triangle)) => mesh.slot(triangle),
            _ => 0,
        };
        self.filled_slot(slot)
    }

    /// The slot whose material a slot has: the last one serves for those beyond.
    #[inline]
    fn filled_slot(&self, slot: usize) -> Option<usize> {
        let last = self.materials().len().checked_sub(1)?;
        Some(slot.min(last))
    }

    /// Whether it is a mesh without triangles.
    #[doc(hidden)]
    pub fn is_empty_mesh(&self) -> bool {
        self.mesh().is_some_and(|mesh| mesh.triangles().is_empty())
    }

    /// Whether some of its surface may be cut out by the alpha of a material.
    #[inline]
    pub fn has_cutouts(&self) -> bool {
        self.has_cutouts
    }

    /// Intersects a triangle of the object's mesh, or of those that it is joined with; `None` where
    /// it is cut out.
    #[inline]
    #[doc(hidden)]
    pub fn intersect_triangle(
        &self,
        meshes: Meshes<'_>,
        triangle: u32,
        (edges, filter): (EdgeRule, &MeshFilter),
        (ray, shear): (&Ray, &Shear),
    ) -> Option<Crossing> {
        let numbered = (triangle, meshes.corners(triangle));
        let hit = filter.intersect((ray, shear), edges, numbered, Doubtful::settle)?;
        let is_cut_out = self.has_cutouts()
            && (meshes.one())
                .is_some_and(|mesh| self.is_cut_out(mesh, triangle as usize, hit.barycentric));
        (ray.holds(hit.t) && !is_cut_out).then(|| hit.crossing(triangle.cast_signed()))
    }

    /// Whether its material is cut out where a triangle was hit: then there is no hit.
    #[doc(hidden)]
    pub fn is_cut_out(&self, mesh: &Mesh, triangle: usize, barycentric: DVec2) -> bool {
        let Some(slot) = self.filled_slot(mesh.slot(triangle)) else {
            return false;
        };
        let material = &self.materials()[slot];
        material.has_cutouts()
            && material.is_cut_out(
                mesh.uv(triangle, barycentric),
                mesh.alpha(triangle, barycentric).unwrap_or(1.0),
            )
    }

    /// The number of triangles: 0, unless the shape is a mesh.
    #[inline]
    pub fn triangles(&self) -> usize {
        self.mesh().map_or(0, |mesh| mesh.triangles().len())
    }

    /// The bound on rounding on the way to the object and back, as a share of the coordinates: the
    /// slack that the tree over the objects needs.
    #[doc(hidden)]
    pub fn slack(&self) -> f64 {
        16.0 * self.transform.rounding()
    }

    /// The `bounds`, wider by a share of the coordinates that they are made from (which are larger
    /// than their own where a transform moves something far away back to the origin).
    pub(super) fn padded(&self, bounds: Bounds, slack: f64) -> Bounds {
        if bounds.is_empty() || !bounds.is_finite() {
            return bounds;
        }
        let place = self.transform.world_from_object().translation;
        let largest = [bounds.low, bounds.high, place]
            .map(|point| point.abs().max_element())
            .into_iter()
            .fold(0.0, f64::max);
        // The object's coordinates in the world are the box's without the translation: at most the
        // sum.
        let padding = DVec3::splat(2.0 * slack * largest);
        Bounds { low: bounds.low - padding, high: bounds.high + padding }
    }

    /// The support function in the world: the largest dot product of `direction` with a point of
    /// the object, for a direction of any length. Infinite for an infinite shape, minus infinity
    /// for one without points.
    pub fn support(&self, direction: DVec3) -> f64 {
        self.along(direction, |direction| self.shape.support(direction))
    }

    /// An upper bound of [`support`](Self::support) in constant time. For a mesh it is the support
    /// of its box: a vertex and the box's corner go through the same operations, and rounding is
    /// monotone, so that it holds to the last bit.
    pub(super) fn support_bound(&self, direction: DVec3) -> f64 {
        self.along(direction, |direction| match &self.shape {
            Shape::Mesh(mesh) => {
                let Bounds { low, high } = mesh.bounds();
                let corner = DVec3::select(direction.cmpge(DVec3::ZERO), high, low);
                corner.dot(direction)
            }
            shape => shape.support(direction),
        })
    }

    /// The support in the world, from the support in object space.
    fn along(&self, direction: DVec3, reach: impl FnOnce(DVec3) -> f64) -> f64 {
        if self.transform.is_identity() {
            return reach(direction);
        }
        let world_from_object = self.transform.world_from_object();
        let in_object = world_from_object.matrix3.transpose() * direction;
        reach(in_object) + world_from_object.translation.dot(direction)
    }

    /// The smallest box around it in the world.
    pub fn bounds(&self) -> Bounds {
        let world_from_object = self.transform.world_from_object();
        match &self.shape {
            shape if self.transform.is_identity() => shape.bounds(),
            Shape::Mesh(mesh) if !self.transform.keeps_axes() => {
                let corners = mesh.triangles().iter().flatten();
                Bounds::of(corners.map(|&vertex| {
                    world_from_object.transform_point3(mesh.positions().get(vertex))
                }))
            }
            shape if self.transform.keeps_axes() || !shape.bounds().is_finite() => {
                shape.bounds().transformed(world_from_object)
            }
            _ => {
                let axes = [DVec3::X, DVec3::Y, DVec3::Z];
                Bounds {
                    low: DVec3::from(axes.map(|axis| -self.support(-axis))),
                    high: DVec3::from(axes.map(|axis| self.support(axis))),
                }
            }
        }
    }

    /// A box around it in the world in constant time, of a turned mesh wider than the smallest one.
    pub(super) fn box_around(&self) -> Bounds {
        let is_turned = !self.transform.keeps_axes();
        match &self.shape {
            Shape::Mesh(mesh) if is_turned => {
                let world_from_object = self.transform.world_from_object();
                mesh.bounds().transformed(world_from_object)
            }
            _ => self.bounds(),
        }
    }

    /// The largest coordinate, by absolute value, that the object's place in the world is computed
    /// from, or more.
    #[doc(hidden)]
    #[inline]
    pub fn farthest(&self) -> f64 {
        self.farthest
    }

    /// Whether a coordinate of its shape is so large that its square leaves float64: then it is not
    /// met.
    #[inline]
    #[doc(hidden)]
    pub fn is_out_of_range(&self) -> bool {
        self.is_out_of_range
    }
}

/// The box around what a shape is made from.
fn numbers_of(shape: &Shape) -> Bounds {
    match shape {
        Shape::Plane(plane) => Bounds::of([plane.point()]),
        shape => shape.bounds(),
    }
}

fn farthest(shape: &Shape, transform: &Transform) -> f64 {
    let Bounds { low, high } = numbers_of(shape);
    if !low.cmple(high).all() {
        return 0.0;
    }
    let corner = low.abs().max(high.abs());
    let to_world = transform.world_from_object();
    let axes = to_world.matrix3;
    let [x, y, z] = [axes.x_axis, axes.y_axis, axes.z_axis].map(DVec3::abs);
    let reach = x * corner.x + y * corner.y + z * corner.z + to_world.translation.abs();
    reach.max_element()
}

fn is_out_of_range(shape: &Shape) -> bool {
    let Bounds { low, high } = numbers_of(shape);
    // Not of nothing, whose box is inside out.
    let largest = low.abs().max(high.abs()).max_element();
    low.cmple(high).all() && largest > Ray::FARTHEST
}

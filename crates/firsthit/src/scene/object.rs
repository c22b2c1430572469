use crate::geometry::{Bounds, Color, Transform};
use crate::shape::{Shape, Surface};

/// A shape somewhere in the world. Objects that share a mesh (an [`Arc`](std::sync::Arc)) are instances
/// of it: nothing is copied.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    name: String,
    shape: Shape,
    transform: Transform,
    color: Color,
}

impl Object {
    /// The linear colour of an object that nobody gave one: a light grey.
    pub const NEUTRAL: Color = Color::splat(0.6);

    /// The shape where it is, without a name, in a neutral colour.
    pub fn new(shape: impl Into<Shape>) -> Self {
        Self {
            name: String::new(),
            shape: shape.into(),
            transform: Transform::IDENTITY,
            color: Self::NEUTRAL,
        }
    }

    /// The same object with a name.
    pub fn named(self, name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            ..self
        }
    }

    /// The same object, its shape taken to the world by `transform`.
    pub fn placed(self, transform: Transform) -> Self {
        Self { transform, ..self }
    }

    /// The same object with a linear colour, which a mesh's own colours multiply.
    pub fn colored(self, color: Color) -> Self {
        Self { color, ..self }
    }

    /// Its name; may be empty, need not be unique.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its shape, in object space.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The way from object space to the world.
    pub fn transform(&self) -> &Transform {
        &self.transform
    }

    /// Its linear colour.
    pub fn color(&self) -> Color {
        self.color
    }

    /// How many triangles it has: none, unless it is a mesh.
    pub fn triangles(&self) -> usize {
        match &self.shape {
            Shape::Mesh(mesh) => mesh.triangles().len(),
            _ => 0,
        }
    }

    /// A box around it in the world: the smallest one for a mesh, and for any shape whose box stays a
    /// box under the transform.
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
            shape => shape.bounds().transformed(world_from_object),
        }
    }
}

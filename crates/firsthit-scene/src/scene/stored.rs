//! The parts of a built scene, and their assembly from untrusted data.

use std::sync::OnceLock;

use super::duplicates::Duplicates;
use super::joined::ObjectTree;
use super::top_tree::TopTree;
use super::{BuildSettings, Object, Scene};
use crate::accel::InstructionSet;
use crate::error::{Error, Result};
use crate::geometry::Bounds;

/// All that a scene is made from but its lights.
#[derive(Debug)]
#[doc(hidden)]
pub struct SceneParts {
    pub objects: Vec<Object>,
    pub trees: Vec<ObjectTree>,
    /// A box around each object, for the tree over them alone.
    pub boxes: Vec<Bounds>,
    /// Objects, each with a later one in its place.
    pub duplicates: Vec<[u32; 2]>,
    /// See [`Scene::bounds`].
    pub bounds: Bounds,
}

impl Scene {
    /// The tree of an object's mesh, as objects share it.
    #[doc(hidden)]
    #[inline]
    pub fn tree_of(&self, object: usize) -> &ObjectTree {
        &self.trees[object]
    }

    /// The scene of these parts, as [`Scene::new`] makes it of its objects. The parts that take
    /// long to find, the boxes and the duplicates, are taken as they are: errors there make wrong
    /// answers and no more.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for what does not fit together, and the errors of [`Scene::new`].
    #[doc(hidden)]
    pub fn from_parts(parts: SceneParts) -> Result<Self> {
        let SceneParts { objects, trees, boxes, duplicates, bounds } = parts;
        InstructionSet::current()?;
        let count = objects.len();
        let refuse = |expected, got: String| Err(Error::argument("objects", expected, got));
        if i32::try_from(count).is_err() || trees.len() != count || boxes.len() != count {
            let got = format!("{count} objects with {} boxes", boxes.len());
            return refuse("as many as their boxes", got);
        }
        let is_nothing = |object: &Object| object.mesh().is_some() && object.triangles() == 0;
        let mut boxed = objects.iter().zip(&boxes);
        if let Some((object, _)) =
            boxed.find(|(object, around)| around.is_empty() != is_nothing(object))
        {
            return refuse("in boxes, unless they are empty", format!("{object:?}"));
        }
        let Some(duplicates) = Duplicates::from_pairs(count, &duplicates) else {
            return refuse("each a duplicate of one earlier object at most", "others".into());
        };
        let joined = (0..).zip(&trees).filter(|(_, tree)| tree.group().is_some());
        for (object, _) in joined {
            if duplicates.contains(object) || !duplicates.of(object).is_empty() {
                return refuse("joined with others or duplicates, not both", format!("{object}"));
            }
        }
        let top = TopTree::with_duplicates(&objects, &trees, boxes, duplicates);
        let bounds = OnceLock::from(bounds);
        Ok(Self::over((objects, trees), BuildSettings::default(), top, bounds))
    }
}

//! Changes of a built scene: moving its objects, hiding and showing them.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use super::top_tree::{self, TopTree};
use super::{Places, Scene};
use crate::error::{Error, Result};
use crate::geometry::Transform;
use crate::watch::Watch;

impl Scene {
    /// Moves an object: its shape is taken to the world by another transform. Rays at the
    /// scene have the answers of one that is built anew. This takes microseconds: nothing is built
    /// but, now and then, the tree over the objects. A mesh that shares a tree with others in its
    /// space gets its own when it is first moved.
    ///
    /// ```
    /// use firsthit::{DVec3, Object, Scene, Sphere, Transform, shoot};
    ///
    /// let mut scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
    /// scene.move_object(0, Transform::translation(DVec3::new(0.0, 0.0, 2.0))?)?;
    /// assert_eq!(shoot(&scene, DVec3::new(0.0, 0.0, 9.0), DVec3::NEG_Z).t, 6.0);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for an object that is not there.
    pub fn move_object(&mut self, object: usize, transform: Transform) -> Result<()> {
        self.move_objects(&[(object, transform)])
    }

    /// Moves several objects, each to the transform beside it, as
    /// [`move_object`](Self::move_object) one after the other. The tree over the objects is built
    /// anew at most once.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for an object that is not there, and [`Error::Limit`] where there is no
    /// memory for trees of objects that shared one; then nothing has moved.
    pub fn move_objects(&mut self, places: &[(usize, Transform)]) -> Result<()> {
        self.move_objects_watched(places, &())
    }

    /// As [`move_objects`](Self::move_objects); `watch` follows the trees that are built, and may
    /// end it.
    ///
    /// # Errors
    ///
    /// The errors of [`move_objects`](Self::move_objects), and [`Error::Interrupted`]; then nothing
    /// has moved.
    pub fn move_objects_watched(
        &mut self,
        places: &[(usize, Transform)],
        watch: &dyn Watch,
    ) -> Result<()> {
        let moved = places.iter().map(|&(object, _)| self.check_object(object));
        let moved = moved.collect::<Result<Vec<u32>>>()?;
        let is_elsewhere = |&&(object, transform): &&(usize, Transform)| {
            *self.objects[object].transform() != transform
        };
        let leaving: Vec<u32> = (moved.iter().zip(places))
            .filter(|(_, place)| is_elsewhere(place))
            .map(|(&object, _)| object)
            .collect();
        let has_parted = self.part(&leaving, true, watch)?;
        // Objects that are where they were may share a tree still, and its box.
        let moved: Vec<u32> = (moved.into_iter())
            .filter(|&object| self.trees[object as usize].group().is_none())
            .collect();
        for &(object, transform) in places {
            self.objects[object].place(transform);
        }
        if has_parted {
            self.top = TopTree::new(&self.objects, &self.trees);
        } else {
            self.top.changed(&self.objects, &self.trees, &moved);
        }
        self.forget_places();
        Ok(())
    }

    /// Hides objects from all rays and other queries, or shows them: `true` beside an object hides
    /// it. They keep their identifiers. The tree over the objects is fitted where few change, and
    /// built anew where many do. A mesh that is shown again and had shared a tree gets its own,
    /// which is built. `lint` looks at hidden objects too.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for an object that is not there, and [`Error::Limit`] where there is no
    /// memory for a tree; then nothing is hidden or shown.
    pub fn hide_objects(&mut self, objects: &[(usize, bool)]) -> Result<()> {
        self.hide_objects_watched(objects, &())
    }

    /// As [`hide_objects`](Self::hide_objects); `watch` follows the trees that are built, and may
    /// end it.
    ///
    /// # Errors
    ///
    /// The errors of [`hide_objects`](Self::hide_objects), and [`Error::Interrupted`]; then nothing
    /// is hidden or shown.
    pub fn hide_objects_watched(
        &mut self,
        objects: &[(usize, bool)],
        watch: &dyn Watch,
    ) -> Result<()> {
        // Of an object that is there twice the last one counts.
        let last: BTreeMap<usize, bool> = objects.iter().copied().collect();
        let (mut changed, mut hidden, mut shown) = (Vec::new(), Vec::new(), Vec::new());
        for (&object, &is_hidden) in &last {
            let identifier = self.check_object(object)?;
            changed.push(identifier);
            let has_mesh = self.objects[object].mesh().is_some();
            if is_hidden {
                hidden.push(identifier);
            } else if has_mesh && self.trees[object].any().is_none() {
                shown.push(identifier);
            }
        }
        for (object, tree) in self.own_trees(&shown, watch)? {
            self.trees[object] = tree;
        }
        let has_parted = self.part(&hidden, false, watch)?;
        for (&object, &is_hidden) in &last {
            self.objects[object].hide(is_hidden);
        }
        if top_tree::are_few(changed.len(), self.objects.len()) && !has_parted {
            self.top.changed(&self.objects, &self.trees, &changed);
        } else {
            self.top = TopTree::new(&self.objects, &self.trees);
        }
        self.derived.first_open = OnceLock::new();
        self.forget_places();
        Ok(())
    }

    /// The number of an object as trees have it.
    fn check_object(&self, object: usize) -> Result<u32> {
        let count = self.objects.len();
        let identifier = u32::try_from(object).ok().filter(|_| object < count);
        identifier.ok_or_else(|| {
            let got = format!("{object}; there are {count}");
            Error::argument("object", "one of the scene's", got)
        })
    }

    /// Forgets all that was computed from where the visible objects are.
    fn forget_places(&mut self) {
        self.derived.places = Places::default();
        self.derived.fingerprint = OnceLock::new();
    }
}

//! What changes in a built scene: where its objects are, and which of them are hidden.

use std::sync::OnceLock;

use super::{Scene, extent};
use crate::error::{Error, Result};
use crate::geometry::Transform;

impl Scene {
    /// Moves an object: its shape is taken to the world by another transform. What is shot at the scene is answered as by
    /// one that is built anew. This takes microseconds: nothing is built but, now and then, the tree over the objects.
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

    /// Moves several objects, each to the transform beside it, as [`move_object`](Self::move_object) one after the other. The
    /// tree over the objects is built anew at most once.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for an object that is not there, and [`Error::Limit`] where there is no memory for a tree of its own for an object
    /// that shares one; then nothing has moved.
    pub fn move_objects(&mut self, places: &[(usize, Transform)]) -> Result<()> {
        let moved = places.iter().map(|&(object, _)| self.check_object(object));
        let moved = moved.collect::<Result<Vec<u32>>>()?;
        let is_elsewhere = |&&(object, transform): &&(usize, Transform)| {
            *self.objects[object].transform() != transform
        };
        let leaving: Vec<u32> = (moved.iter().zip(places))
            .filter(|(_, place)| is_elsewhere(place))
            .map(|(&object, _)| object)
            .collect();
        let has_parted = self.part(&leaving, true)?;
        for &(object, transform) in places {
            self.objects[object].place(transform);
        }
        let around = |k: usize| extent::box_around(&self.objects[k], self.trees[k].own());
        if has_parted {
            for &object in &moved {
                self.top.set_box(object, around(object as usize));
            }
            self.top.rebuild(&self.objects, &self.trees);
        } else {
            self.top.moved(&self.objects, &self.trees, &moved, around);
        }
        self.forget_places();
        Ok(())
    }

    /// Hides objects from all rays and other queries, or shows them: `true` beside an object hides it. They keep their identifiers. Only
    /// the tree over the objects is built anew. `Scene::lint` looks at hidden objects too.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for an object that is not there; then nothing has changed.
    pub fn hide_objects(&mut self, objects: &[(usize, bool)]) -> Result<()> {
        for &(object, _) in objects {
            self.check_object(object)?;
        }
        let lacks_tree =
            |&k: &usize| self.objects[k].mesh().is_some() && self.trees[k].any().is_none();
        let shown = objects.iter().filter(|(_, is_hidden)| !*is_hidden);
        let shown = shown.map(|&(object, _)| object).filter(lacks_tree);
        let shown: Vec<u32> = shown.map(|k| self.check_object(k)).collect::<Result<_>>()?;
        for (object, tree) in self.own_trees(&shown)? {
            self.trees[object] = tree;
        }
        let hidden = objects.iter().filter(|(_, is_hidden)| *is_hidden);
        let hidden = hidden.map(|&(object, _)| self.check_object(object));
        self.part(&hidden.collect::<Result<Vec<u32>>>()?, false)?;
        for &(object, is_hidden) in objects {
            self.objects[object].hide(is_hidden);
        }
        self.top.rebuild(&self.objects, &self.trees);
        self.first_open = OnceLock::new();
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
        self.bounds = OnceLock::new();
        self.seen = OnceLock::new();
        self.endless = OnceLock::new();
        self.emitters = OnceLock::new();
        self.fingerprint = OnceLock::new();
    }
}

//! Objects in one space whose meshes share a tree.
//!
//! A ray comes to all of them at once, as if they were one mesh. One of them, the leader, stands
//! for all in the tree over the objects, and its number with that of a triangle in the shared tree
//! says what was met ([`Scene::surface_at`]).
//!
//! 1. Join objects with the same transform and mask whose meshes no other object has, that are cut
//!    out nowhere and in no other's place, and near to each other. Leave out what is so fine beside
//!    the others that float32 could not tell its triangles apart.
//! 2. Build one tree over all triangles.
//! 3. An object that is moved, hidden or changed leaves: its triangles are taken out of the leaves,
//!    and it gets a tree of its own.

mod find;

use std::collections::HashSet;
use std::sync::Arc;

use find::{Key, key};
pub(super) use find::{found, kept};

use super::build::TreeBuilder;
use super::{Object, Scene};
use crate::accel::MeshTree;
use crate::error::{Error, Result};
use crate::geometry::{Bounds, SurfaceId};
use crate::parallel;
use crate::shape::{JoinedMeshes, Mesh, Meshes};
use crate::watch::Watch;

/// The tree of an object's mesh.
#[derive(Debug, Clone)]
#[doc(hidden)]
pub enum ObjectTree {
    /// The object is no mesh.
    None,
    /// A tree over its mesh alone. All objects that have the mesh have the tree.
    Own(Arc<MeshTree>),
    /// The tree of a group, and which of its members the object is.
    Shared(Arc<Group>, u32),
}

impl ObjectTree {
    /// The tree of the object's mesh alone.
    pub fn own(&self) -> Option<&Arc<MeshTree>> {
        match self {
            Self::Own(tree) => Some(tree),
            Self::None | Self::Shared(..) => None,
        }
    }

    /// The object's group, if it has one.
    pub(crate) fn group(&self) -> Option<&Arc<Group>> {
        match self {
            Self::Shared(group, _) => Some(group),
            Self::None | Self::Own(_) => None,
        }
    }

    /// The tree that rays go through.
    pub fn any(&self) -> Option<&Arc<MeshTree>> {
        match self {
            Self::None => None,
            Self::Own(tree) => Some(tree),
            Self::Shared(group, _) => Some(&group.tree),
        }
    }
}

/// Objects that share a tree.
#[derive(Debug, Clone)]
#[doc(hidden)]
pub struct Group {
    /// The object of each mesh, in increasing order; `None` for those that have left.
    objects: Vec<Option<u32>>,
    meshes: Arc<JoinedMeshes>,
    tree: Arc<MeshTree>,
    leader: u32,
}

impl Group {
    fn new(
        members: Vec<Option<u32>>,
        meshes: Arc<JoinedMeshes>,
        tree: Arc<MeshTree>,
    ) -> Option<Self> {
        Some(Self { leader: *members.iter().flatten().next()?, objects: members, meshes, tree })
    }

    /// Joins objects; `None` where they cannot be joined, or there is no memory for it.
    fn build(
        mut members: Vec<u32>,
        objects: &[Object],
        build: &impl Fn(&Mesh) -> Result<MeshTree>,
    ) -> Option<Result<Self>> {
        let joined = meshes(&members, objects)?;
        let tree = match build(&joined.as_one().ok()?) {
            Err(error) => return matches!(error, Error::Interrupted).then_some(Err(error)),
            Ok(tree) => Some(tree).filter(MeshTree::has_nodes)?,
        };
        let common = with_common_triangles(&joined, &tree);
        if !common.is_empty() {
            let mut number = 0..;
            members.retain(|_| !number.next().is_some_and(|number| common.contains(&number)));
            return (members.len() > 1).then(|| Self::build(members, objects, build))?;
        }
        let members = members.into_iter().map(Some).collect();
        Self::new(members, Arc::new(joined), Arc::new(tree)).map(Ok)
    }

    /// Joins objects by a tree from untrusted data, which `tree` makes.
    ///
    /// # Errors
    ///
    /// In words, what is wrong.
    pub fn from_parts(
        members: &[u32],
        objects: &[Object],
        tree: impl FnOnce(Meshes<'_>) -> std::result::Result<MeshTree, &'static str>,
    ) -> std::result::Result<Self, &'static str> {
        let keys = members.iter().map(|&member| objects.get(member as usize).and_then(key));
        let keys: Option<Vec<Key>> = keys.collect();
        let is_common = |keys: &Vec<Key>| keys.windows(2).all(|pair| pair[0] == pair[1]);
        let is_ordered = members.is_sorted_by(|a, b| a < b);
        let mesh = |&member: &u32| objects.get(member as usize)?.mesh().map(Arc::as_ptr);
        let meshes_of: HashSet<_> = members.iter().map(mesh).collect();
        let are_distinct = meshes_of.len() == members.len();
        let is_group = is_ordered && are_distinct && members.len() > 1;
        if !(is_group && keys.is_some_and(|keys| is_common(&keys))) {
            return Err("it joins objects that are not alike");
        }
        let meshes = meshes(members, objects).ok_or("it joins too many triangles")?;
        let tree = tree(Meshes::Joined(&meshes))?;
        if !tree.has_nodes() || !with_common_triangles(&meshes, &tree).is_empty() {
            return Err("its tree has no nodes, or objects have triangles in common");
        }
        let members = members.iter().copied().map(Some).collect();
        let made = Self::new(members, Arc::new(meshes), Arc::new(tree));
        made.ok_or("it joins nothing")
    }

    /// The object that stands for all in the tree over the objects.
    pub(crate) fn leader(&self) -> u32 {
        self.leader
    }

    #[inline]
    pub fn tree(&self) -> &Arc<MeshTree> {
        &self.tree
    }

    /// Whether none of its objects has left.
    pub(super) fn is_whole(&self) -> bool {
        self.objects.iter().all(Option::is_some)
    }

    /// The objects, each with the range of its triangles' numbers in the tree.
    pub fn members(&self) -> impl Iterator<Item = (u32, [u32; 2])> {
        let numbered = self.objects.iter().enumerate();
        numbered.filter_map(|(member, object)| Some(((*object)?, self.meshes.range(member))))
    }

    /// The object that has a triangle, and its number there; `None` for one that has left.
    #[inline]
    pub fn locate(&self, triangle: u32) -> Option<(u32, u32)> {
        let (member, triangle) = self.meshes.locate(triangle);
        Some((self.objects[member]?, triangle))
    }

    /// The object that has a triangle of the tree, and the triangle's number there. A ray meets no
    /// triangle whose object has left, unless a file's boxes are wrong; then the answer is the
    /// leader's first triangle.
    #[inline]
    pub fn surface(&self, primitive: i32) -> SurfaceId {
        let located = self.locate(primitive.cast_unsigned());
        let (object, triangle) = located.unwrap_or((self.leader, 0));
        SurfaceId { object: object.cast_signed(), primitive: triangle.cast_signed() }
    }

    /// The least and the largest [`Object::farthest`].
    pub fn farthest(&self) -> [f64; 2] {
        self.meshes.farthest()
    }

    /// Whether the tree is more full than empty.
    pub(super) fn is_dense(&self) -> bool {
        let there = self.members().map(|(_, [first, end])| (end - first) as usize);
        2 * there.sum::<usize>() >= Meshes::Joined(&self.meshes).count()
    }

    /// The group of the objects that stay, under their new numbers; `None` where there are none, or
    /// their order is another one.
    fn keeping(mut self, new: impl Fn(u32) -> Option<u32>) -> Option<Self> {
        let (mut staying, mut leaving) = (Vec::new(), Vec::new());
        for (member, object) in self.objects.iter_mut().enumerate() {
            if let Some(old) = *object {
                *object = new(old);
                let list = if object.is_some() { &mut staying } else { &mut leaving };
                list.push(member);
            }
        }
        let around = |list: &[usize]| -> Vec<Bounds> {
            let boxes = list.iter().map(|&member| self.meshes.bounds_of(member));
            boxes.collect()
        };
        let is_of = |list: &[usize], triangle| {
            let (member, _) = self.meshes.locate(triangle);
            list.binary_search(&member).is_ok()
        };
        if !leaving.is_empty() {
            let mut tree = MeshTree::clone(&self.tree);
            if leaving.len() < staying.len() {
                tree.take_out(&around(&leaving), |triangle| is_of(&leaving, triangle));
            } else {
                tree.keep_only(&around(&staying), |triangle| is_of(&staying, triangle));
            }
            self.tree = Arc::new(tree);
        }
        self.leader = *self.objects.iter().flatten().next()?;
        let there = self.objects.iter().flatten();
        there.is_sorted_by(|a, b| a < b).then_some(self)
    }
}

/// The meshes that have a triangle in the place of an earlier one's. If that left, the tree would
/// lack the triangle.
fn with_common_triangles(meshes: &JoinedMeshes, tree: &MeshTree) -> HashSet<usize> {
    let mesh = |triangle| meshes.locate(triangle).0;
    let pairs = tree.copies().iter();
    let common = pairs.filter(|&&[first, copy]| mesh(first) != mesh(copy));
    common.map(|&[_, copy]| mesh(copy)).collect()
}

/// The meshes of objects.
fn meshes(members: &[u32], objects: &[Object]) -> Option<JoinedMeshes> {
    let of = |&member: &u32| {
        let object = &objects[member as usize];
        Some((object.mesh().cloned()?, object.farthest()))
    };
    let (meshes, farthest) = members.iter().filter_map(of).unzip();
    JoinedMeshes::new(meshes, farthest)
}

impl Scene {
    /// The groups of objects that share a tree.
    #[doc(hidden)]
    pub fn groups(&self) -> impl Iterator<Item = &Arc<Group>> {
        let leads = |(object, tree): (u32, &'_ ObjectTree)| {
            tree.group().is_some_and(|group| group.leader == object)
        };
        let numbered = (0..).zip(&self.trees);
        numbered.filter(move |&pair| leads(pair)).filter_map(|(_, tree)| tree.group())
    }

    fn group(&self, object: u32) -> Option<&Arc<Group>> {
        self.trees.get(object as usize)?.group()
    }

    /// The group that an object stands for.
    #[inline]
    #[doc(hidden)]
    pub fn group_led_by(&self, object: u32) -> Option<&Group> {
        let group: &Group = self.group(object)?;
        (group.leader == object).then_some(group)
    }

    /// The object that stands for an object in the tree over the objects: itself, or the leader of
    /// its group.
    #[inline]
    #[doc(hidden)]
    pub fn leader_of(&self, object: u32) -> u32 {
        self.group(object).map_or(object, |group| group.leader)
    }

    /// The triangles and the tree that rays come to at an object: those of its group if it leads
    /// one, none if another does.
    #[inline]
    #[doc(hidden)]
    pub fn at_mesh(&self, object: u32) -> Option<(Meshes<'_>, &MeshTree)> {
        match self.trees.get(object as usize)? {
            ObjectTree::None => None,
            ObjectTree::Own(tree) => {
                let mesh: &Mesh = self.objects[object as usize].mesh()?;
                Some((Meshes::One(mesh), tree))
            }
            ObjectTree::Shared(group, _) => (group.leader == object)
                .then(|| (Meshes::Joined(&group.meshes), group.tree.as_ref())),
        }
    }

    /// The numbers of the triangles of an object that shares a tree: the first, and the first that
    /// is another's.
    #[inline]
    #[doc(hidden)]
    pub fn numbers_of(&self, object: u32) -> Option<[u32; 2]> {
        match self.trees.get(object as usize)? {
            ObjectTree::Shared(group, member) => Some(group.meshes.range(*member as usize)),
            ObjectTree::None | ObjectTree::Own(_) => None,
        }
    }

    /// The number that a part of an object has where rays come to it.
    #[inline]
    #[doc(hidden)]
    pub fn number_of(&self, object: u32, primitive: u32) -> u32 {
        match self.numbers_of(object) {
            // A number that the object has not is none of another.
            Some([first, end]) if primitive >= end - first => u32::MAX,
            Some([first, _]) => first + primitive,
            None => primitive,
        }
    }

    /// The object, and the part of it, that a number stands for where rays come to `object`.
    #[inline]
    #[doc(hidden)]
    pub fn surface_at(&self, object: u32, primitive: i32) -> SurfaceId {
        match &self.trees[object as usize] {
            ObjectTree::Shared(group, _) if group.leader == object => group.surface(primitive),
            _ => SurfaceId { object: object.cast_signed(), primitive },
        }
    }

    /// Takes objects out of their groups. Those that are still to be seen get trees of their own.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`] where there is no memory for these, and [`Error::Interrupted`]; nothing has
    /// changed then.
    pub(super) fn part(
        &mut self,
        objects: &[u32],
        are_seen: bool,
        watch: &dyn Watch,
    ) -> Result<bool> {
        let mut leaving = objects.to_vec();
        leaving.retain(|&object| self.group(object).is_some());
        leaving.sort_unstable();
        leaving.dedup();
        if leaving.is_empty() {
            return Ok(false);
        }
        let mut trees: Vec<(usize, ObjectTree)> = if are_seen {
            self.own_trees(&leaving, watch)?
        } else {
            let none = |&object: &u32| (object as usize, ObjectTree::None);
            leaving.iter().map(none).collect()
        };
        let stays = |object: u32| leaving.binary_search(&object).is_err();
        let groups: Vec<Arc<Group>> = self.groups().map(Arc::clone).collect();
        for group in groups {
            let mut members = group.members();
            if members.all(|(object, _)| stays(object)) {
                continue;
            }
            let kept = Group::clone(&group).keeping(|object| stays(object).then_some(object));
            trees.extend(kept.map(Arc::new).iter().flat_map(Group::shares));
        }
        for (object, tree) in trees {
            self.trees[object] = tree;
        }
        Ok(true)
    }

    /// A tree of its own for each of some objects whose meshes have none.
    pub(super) fn own_trees(
        &self,
        objects: &[u32],
        watch: &dyn Watch,
    ) -> Result<Vec<(usize, ObjectTree)>> {
        let numbered = objects.iter().map(|&k| (k as usize, &self.objects[k as usize]));
        let numbered: Vec<(usize, &Object)> = numbered.collect();
        let of_each = numbered.iter().map(|&(_, object)| object);
        let builder = TreeBuilder::new(self.build, of_each, watch);
        parallel::try_map(numbered, |(k, object)| {
            let tree = object.mesh().map(|mesh| builder.build(mesh)).transpose()?;
            let tree = tree.map_or(ObjectTree::None, |tree| ObjectTree::Own(Arc::new(tree)));
            Ok((k, tree))
        })
    }
}

impl Group {
    /// The objects of the group, each with its share of the tree.
    fn shares(self: &Arc<Self>) -> impl Iterator<Item = (usize, ObjectTree)> {
        let share = |(member, object): (u32, &Option<u32>)| {
            let tree = ObjectTree::Shared(Arc::clone(self), member);
            Some(((*object)? as usize, tree))
        };
        (0..).zip(&self.objects).filter_map(share)
    }

    /// Makes its tree that of its objects.
    pub fn join(self: &Arc<Self>, trees: &mut [ObjectTree]) {
        for (object, tree) in self.shares() {
            trees[object] = tree;
        }
    }
}

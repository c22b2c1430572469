//! Translucent surfaces as cut-out ones.

use std::collections::HashMap;
use std::sync::Arc;

use super::{AlphaMode, Material, Object, Scene};
use crate::error::Result;
use crate::geometry::require;

#[cfg(doc)]
use crate::error::Error;

impl Scene {
    /// The scene with translucent surfaces of meshes ([`AlphaMode::Blend`]) cut out as by an alpha
    /// mask: where their alpha is below `cutoff` there is nothing, and elsewhere they are opaque.
    /// Trees over meshes are shared.
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use firsthit::{AlphaMode, DVec3, Material, Mesh, Object, Positions, Scene, shoot};
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let mesh = Arc::new(Mesh::new(Positions::compact(corners), vec![[0, 1, 2]])?);
    /// let pane = Material { alpha: 0.3, alpha_mode: AlphaMode::Blend, ..Material::default() };
    /// let scene = Scene::new(vec![Object::new(mesh).with_materials([pane])])?;
    /// let from = DVec3::new(0.2, 0.2, 1.0);
    /// assert!(shoot(&scene, from, DVec3::NEG_Z).t == 1.0);
    /// assert!(shoot(&scene.with_blend_below(0.5)?, from, DVec3::NEG_Z).t == f64::INFINITY);
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a cutoff that is not from 0 to 1, and those of
    /// [`Scene::with_objects`].
    pub fn with_blend_below(&self, cutoff: f64) -> Result<Self> {
        let is_share = (0.0..=1.0).contains(&cutoff);
        require("blend_below", "from 0 to 1", is_share, cutoff)?;
        if !self.has_translucent() {
            return self.try_clone();
        }
        let alpha_mode = AlphaMode::Mask { cutoff };
        // Objects that share their materials still share them.
        let mut made: HashMap<*const Material, Arc<[Material]>> = HashMap::new();
        let mut cut_out = |object: &Object| {
            let materials = object.materials();
            if !materials.iter().any(Material::is_translucent) {
                return object.clone();
            }
            let masked = made.entry(materials.as_ptr()).or_insert_with(|| {
                let masked = |material: &Material| {
                    let mut masked = material.clone();
                    if masked.is_translucent() {
                        masked.alpha_mode = alpha_mode;
                    }
                    masked
                };
                materials.iter().map(masked).collect()
            });
            object.clone().with_materials(Arc::clone(masked))
        };
        self.with_objects(self.objects.iter().map(&mut cut_out).collect())
    }
}

//! The light of a scene: its lights, its environment, and the surfaces that shine.

use std::sync::{Arc, OnceLock};

use super::{Emitters, Environment, Light, Material, Object, Scene};
use crate::error::Result;
use crate::parallel;

impl Scene {
    /// The scene with other lights.
    pub fn with_lights(mut self, lights: Vec<Light>) -> Self {
        self.derived.fingerprint = OnceLock::new();
        Self { lights, has_own_lights: true, ..self }
    }

    /// The scene with another environment, or none.
    pub fn with_environment(mut self, environment: Option<Arc<Environment>>) -> Self {
        self.derived.fingerprint = OnceLock::new();
        Self { environment, has_own_environment: true, ..self }
    }

    /// The scene with lights that were chosen automatically, such as one that goes with the camera:
    /// they are not part of its [fingerprint](Self::fingerprint).
    pub fn with_automatic_lights(mut self, lights: Vec<Light>) -> Self {
        // With none of its own, the fingerprint is still true.
        if !self.lights.is_empty() && self.has_own_lights {
            self.derived.fingerprint = OnceLock::new();
        }
        Self { lights, has_own_lights: false, ..self }
    }

    /// The scene with an environment that was chosen automatically, or none.
    pub fn with_borrowed_environment(mut self, environment: Option<Arc<Environment>>) -> Self {
        if self.environment.is_some() && self.has_own_environment {
            self.derived.fingerprint = OnceLock::new();
        }
        Self { environment, has_own_environment: false, ..self }
    }

    /// The lights; none until some are set.
    #[inline]
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// The light from all around, if there is any.
    #[inline]
    pub fn environment(&self) -> Option<&Environment> {
        self.environment.as_deref()
    }

    /// The surfaces that shine.
    #[doc(hidden)]
    pub fn emitters(&self) -> &Emitters {
        parallel::once::<Arc<_>>(&self.derived.places.emitters, || Arc::new(Emitters::new(self)))
    }

    /// Whether some surfaces may let light through by their alpha.
    pub fn has_translucent(&self) -> bool {
        let has_some = |object: &Object| object.materials().iter().any(Material::is_translucent);
        *parallel::once(&self.derived.translucent, || self.objects.iter().any(has_some))
    }

    /// Fails for light that makes no sense, the scene's own or borrowed: lights, an environment and
    /// emissions that are negative or not finite.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument), with the number's name.
    #[doc(hidden)]
    pub fn check_light(&self) -> Result<()> {
        self.lights.iter().try_for_each(Light::check)?;
        if let Some(environment) = &self.environment {
            environment.check()?;
        }
        let mut materials = (self.objects.iter()).flat_map(|object| object.materials().iter());
        materials.try_for_each(Material::check_emission)
    }

    /// Whether nothing shines: neither lights nor an environment nor surfaces.
    pub fn is_unlit(&self) -> bool {
        let has_light = !self.lights.is_empty() || self.environment.is_some();
        !has_light && !self.emitters().has_any()
    }
}

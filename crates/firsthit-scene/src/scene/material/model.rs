//! The list of material models: a file and a row each.

use super::bsdf::{Bsdf, Frame};
use super::{Glass, Matte, MetalRough};
use crate::geometry::kinds;
use crate::scene::SurfaceInteraction;

/// Makes [`Model`] and everything that depends on the list of models. A model is a struct of
/// settings that has a scattering.
macro_rules! models {
    ($($(#[doc = $about:literal])* $name:literal => $kind:ident;)*) => {
        /// The scattering model of a surface.
        ///
        /// ```
        /// use firsthit::geometry::Value;
        /// use firsthit::scene::Model;
        ///
        /// let mut glass = Model::named("glass")?;
        /// glass.set("ior", Value::Number(1.33))?;
        /// assert!(Model::NAMES.contains(&"metal-rough"));
        /// # Ok::<(), firsthit::Error>(())
        /// ```
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum Model {
            $($(#[doc = $about])* $kind($kind),)*
        }

        kinds!("material", Model { $($(#[doc = $about])* $name => $kind($kind);)* });

        impl Model {
            /// The BSDF at a point. `side` is -1 where its back is seen.
            pub(super) fn bsdf(&self, surface: &SurfaceInteraction<'_>, frame: Frame, side: f64) -> Bsdf {
                match self { $(Self::$kind(settings) => settings.bsdf(surface, frame, side),)* }
            }

            /// The share of light that a clear coat reflects towards the viewer, and keeps back of
            /// light from below.
            pub(in crate::scene) fn coat_share(&self, surface: &SurfaceInteraction<'_>) -> f64 {
                match self {
                    Self::MetalRough(settings) => settings.coat_share(surface),
                    Self::Matte(_) | Self::Glass(_) => 0.0,
                }
            }
        }

        $(impl From<$kind> for Model {
            fn from(model: $kind) -> Self {
                Self::$kind(model)
            }
        })*
    };
}

models! {
    /// A matte surface: light is scattered evenly in all directions.
    "matte" => Matte;
    /// A metal, or what is none, as glTF has it: a rough boundary over a matte ground, with fibres,
    /// a coat, and light that goes through.
    "metal-rough" => MetalRough;
    /// Clear matter with a smooth boundary.
    "glass" => Glass;
}

impl Default for Model {
    fn default() -> Self {
        Self::Matte(Matte)
    }
}

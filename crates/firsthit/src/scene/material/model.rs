//! The list of material models: a file and a row each.

use super::scattering::{Frame, Scattering};
use super::{Glass, Matte, MetalRough};
use crate::error::{Error, Result};
use crate::geometry::{Setting, Settings, Value};
use crate::scene::SurfaceInteraction;

/// Makes [`Model`] and everything that depends on the list of models. A model is a struct of settings that has a scattering.
macro_rules! models {
    ($($(#[doc = $about:literal])* $name:literal => $kind:ident;)*) => {
        /// What a surface is made of.
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

        impl Model {
            /// Every model's name.
            pub const NAMES: &[&'static str] = &[$($name),*];

            /// Every model's name, what it is, and its settings.
            pub const KINDS: &[(&'static str, &'static str, &'static [Setting])] =
                &[$(($name, concat!($($about),*).trim_ascii(), <$kind>::LIST)),*];

            /// The model of that name, with its usual settings.
            ///
            /// # Errors
            ///
            /// [`Error::Argument`] for a name that is not in [`Model::NAMES`].
            pub fn named(name: &str) -> Result<Self> {
                match name {
                    $($name => Ok(Self::$kind($kind::default())),)*
                    _ => Err(Error::argument("material", concat!("one of" $(, " ", $name)*), name)),
                }
            }

            /// Its name.
            pub fn name(&self) -> &'static str {
                match self { $(Self::$kind(_) => $name,)* }
            }

            /// Its settings, by their names.
            pub fn settings(&self) -> Vec<(&'static str, Value)> {
                match self { $(Self::$kind(settings) => settings.named_values(),)* }
            }

            /// Sets one of its settings.
            ///
            /// # Errors
            ///
            /// [`Error::Argument`] for a name that it does not have, and for a value that makes no sense.
            pub fn set(&mut self, name: &str, value: Value) -> Result<()> {
                match self { $(Self::$kind(settings) => settings.set(name, value),)* }
            }

            /// Fails where a setting makes no sense.
            ///
            /// # Errors
            ///
            /// [`Error::Argument`], with the setting's name.
            pub fn check(&self) -> Result<()> {
                match self { $(Self::$kind(settings) => settings.check(),)* }
            }

            /// How it scatters light at a point. `side` is -1 where its back is seen.
            pub(super) fn scattering(&self, surface: &SurfaceInteraction<'_>, frame: Frame, side: f64) -> Scattering {
                match self { $(Self::$kind(settings) => settings.scattering(surface, frame, side),)* }
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
    /// A metal, or what is none, as glTF has it: a rough boundary over a matte ground, with fibres, a coat, and light that goes through.
    "metal-rough" => MetalRough;
    /// Clear matter with a smooth boundary.
    "glass" => Glass;
}

impl Default for Model {
    fn default() -> Self {
        Self::Matte(Matte)
    }
}

//! Hits to linear colours: a file per shader, or a row.

mod lambert;

pub use lambert::Lambert;

use crate::error::{Error, Result};
use crate::geometry::{Color, DVec3, Hit, Ray};
use crate::scene::{Background, Scene, SurfaceInteraction};
use crate::shoot::{Cpu, Engine};

/// The colour that a ray sees. Replaceable: any function of the right form is one.
///
/// ```
/// use firsthit::{Color, DVec3, Hit, Shade};
///
/// // Fog: what is farther away fades.
/// let fog = |t: f64, _p: DVec3, _u_r: DVec3, _o: &Hit| Color::splat(libm::exp(-0.1 * t));
/// assert_eq!(fog.shade(f64::INFINITY, DVec3::ZERO, DVec3::X, &Hit::MISS), Color::ZERO);
/// ```
pub trait Shade: Sync {
    /// The linear colour of the ray `p + t * u_r` that met `o`. It is asked for misses too: there `t` is
    /// infinity, `o.object` is -1, and the shader itself returns the background.
    fn shade(&self, t: f64, p: DVec3, u_r: DVec3, o: &Hit) -> Color;

    /// [`shade`](Self::shade) for many samples: a colour for each. A shader that shoots rays of its own is faster when it
    /// shoots them together; whoever makes pictures asks for a few hundred at a time. There are as many colours as samples.
    fn shade_all(&self, samples: &Samples<'_>, colors: &mut [Color]) {
        for (k, (ray, color)) in samples.rays.iter().zip(colors).enumerate() {
            let hit = &samples.hits[k];
            *color = self.shade(hit.t, ray.origin, ray.direction, hit);
        }
    }

    /// Whether misses are transparent, as with [`Background::Transparent`]. Colours then get a fourth number, the pixel's coverage,
    /// and the shader must return black for misses.
    fn is_transparent(&self) -> bool {
        false
    }
}

impl<F: Fn(f64, DVec3, DVec3, &Hit) -> Color + Sync> Shade for F {
    fn shade(&self, t: f64, p: DVec3, u_r: DVec3, o: &Hit) -> Color {
        self(t, p, u_r, o)
    }
}

/// Rays of a picture, and what they met.
#[derive(Debug, Clone, Copy)]
pub struct Samples<'a> {
    /// The rays.
    pub rays: &'a [Ray],
    /// What they met, as many.
    pub hits: &'a [Hit],
    /// The pixels that they are of, counted row by row from the top of the whole picture, as many. With the sample's number they are
    /// a seed for random numbers that depends on nothing else.
    pub pixels: &'a [u64],
    /// Which sample of its pixel each ray is, from 0 on.
    pub sample: u32,
}

/// Makes [`Shader`] and everything that depends on the list of shaders. A shader is a function of its settings, of what it works
/// in, and of many hits: it sets a colour for each.
macro_rules! shaders {
    ($($(#[$doc:meta])* $name:literal => $kind:ident($settings:ty), $shade:expr;)*) => {
        /// The shaders that come with the library, by name.
        ///
        /// ```
        /// use firsthit::Shader;
        ///
        /// assert_eq!(Shader::default(), Shader::named("lambert")?);
        /// assert_eq!(Shader::NAMES, ["lambert", "unlit", "normal"]);
        /// # Ok::<(), firsthit::Error>(())
        /// ```
        #[derive(Debug, Clone, PartialEq)]
        pub enum Shader {
            $($(#[$doc])* $kind($settings),)*
        }

        impl Shader {
            /// Every shader's name.
            pub const NAMES: &[&'static str] = &[$($name),*];

            /// The shader of that name, with its usual settings.
            ///
            /// # Errors
            ///
            /// [`Error::Argument`] for a name that is not in [`Shader::NAMES`].
            pub fn named(name: &str) -> Result<Self> {
                match name {
                    $($name => Ok(Self::$kind(<$settings>::default())),)*
                    _ => Err(Error::argument("shader", concat!("one of" $(, " ", $name)*), name)),
                }
            }

            /// Its name.
            pub fn name(&self) -> &'static str {
                match self { $(Self::$kind(_) => $name,)* }
            }

            fn color(&self, shading: &Shading<'_>, surfaces: &[SurfaceInteraction<'_>], colors: &mut [Color]) {
                match self { $(Self::$kind(settings) => ($shade)(settings, shading, surfaces, colors),)* }
            }
        }
    };
}

shaders! {
    /// Lit by the scene's lights, with shadows.
    "lambert" => Lambert(Lambert), lambert::shade;
    /// The object's colour as it is.
    "unlit" => Unlit(()), |&(), _, hits, colors| each(hits, colors, SurfaceInteraction::color);
    /// The geometric normal as a colour: from -1..1 to 0..1 along each axis.
    "normal" => Normal(()), |&(), _, hits, colors| each(hits, colors, |hit| 0.5 * hit.normal() + 0.5);
}

/// Colours that each hit gives by itself.
fn each<'a>(
    surfaces: &[SurfaceInteraction<'a>],
    colors: &mut [Color],
    color_of: impl Fn(&SurfaceInteraction<'a>) -> Color,
) {
    for (surface, color) in surfaces.iter().zip(colors) {
        *color = color_of(surface);
    }
}

impl Shader {
    /// The [`Shade`] that applies this shader to `scene`, before [`Background::NEUTRAL`]; see [`Shading::background`] for another.
    ///
    /// ```
    /// use firsthit::{Color, DVec3, Object, Scene, Shade, Shader, Sphere, shoot};
    ///
    /// let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0)?).colored(Color::new(1.0, 0.5, 0.0));
    /// let scene = Scene::new(vec![ball])?;
    /// let (p, u_r) = (DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z);
    /// let hit = shoot(&scene, p, u_r);
    /// let color = Shader::named("unlit")?.on(&scene).shade(hit.t, p, u_r, &hit);
    /// assert_eq!(color, Color::new(1.0, 0.5, 0.0));
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub fn on(self, scene: &Scene) -> Shading<'_> {
        Shading {
            scene,
            shader: self,
            background: Background::NEUTRAL,
            engine: Cpu::shared(),
        }
    }
}

impl Default for Shader {
    fn default() -> Self {
        Self::Lambert(Lambert::default())
    }
}

/// A [`Shader`] at work: with the scene that it looks at, and what misses see.
///
/// ```
/// use firsthit::{Background, Color, DVec3, Hit, Scene, Shade, Shader, Shading};
///
/// let scene = Scene::new(vec![])?;
/// let white = Background::Uniform(Color::ONE);
/// let shading = Shading { background: white, ..Shader::default().on(&scene) };
/// let color = shading.shade(f64::INFINITY, DVec3::ZERO, DVec3::X, &Hit::MISS);
/// assert_eq!(color, Color::ONE);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Shading<'a> {
    /// Where to look up what was hit.
    pub scene: &'a Scene,
    /// How hits get their colour.
    pub shader: Shader,
    /// What misses see.
    pub background: Background,
    /// What finds the hits of its own rays, such as those towards lights.
    pub engine: &'a dyn Engine,
}

impl Shade for Shading<'_> {
    fn is_transparent(&self) -> bool {
        self.background == Background::Transparent
    }

    fn shade(&self, t: f64, p: DVec3, u_r: DVec3, o: &Hit) -> Color {
        if t == f64::INFINITY {
            return self.background.color(u_r);
        }
        let ray = Ray::new(p, u_r);
        let mut color = [Color::ZERO];
        if let Some(surface) = self.scene.interaction(&ray, o) {
            self.shader.color(self, &[surface], &mut color);
        }
        color[0]
    }

    fn shade_all(&self, samples: &Samples<'_>, colors: &mut [Color]) {
        let count = samples.rays.len();
        let mut met = Vec::with_capacity(count);
        let mut surfaces = Vec::with_capacity(count);
        for (k, (ray, hit)) in samples.rays.iter().zip(samples.hits).enumerate() {
            if let Some(surface) = self.scene.interaction(ray, hit) {
                met.push(k);
                surfaces.push(surface);
            } else {
                colors[k] = self.background.color(ray.direction);
            }
        }
        let mut found = vec![Color::ZERO; surfaces.len()];
        self.shader.color(self, &surfaces, &mut found);
        for (k, color) in met.into_iter().zip(found) {
            colors[k] = color;
        }
    }
}

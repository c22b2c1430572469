//! Hits to linear colours: a file per shader, or a row.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into a kernel is not compiled for its instruction set"
)]

mod appearance;
mod blend;
mod crossings;
mod depth_cue;
mod direct;
mod found;
mod ghost;
mod ground;
mod hemisphere;
mod lambert;
mod light_rig;
mod lit;
mod matcap;
mod matte;
mod occlusion;
mod path;
mod phong;
mod rows;
mod shading;
mod shadow;
mod vertex;
mod whitted;
mod xray;

pub use appearance::{
    Appearance, BACKGROUND, Guess, RANDOM_SAMPLES, Resolved, SAMPLES, default_samples,
    default_shader, world_up,
};
pub use direct::Direct;
pub use ghost::Ghost;
pub use ground::Ground;
pub use hemisphere::Hemisphere;
pub use lambert::Lambert;
pub use light_rig::{LightRig, Lighting};
pub use matcap::Matcap;
pub use occlusion::AmbientOcclusion;
pub use path::Path;
pub use phong::Phong;
pub use shading::Shading;
pub use whitted::Whitted;
pub use xray::Xray;

use crate::geometry::{Color, DVec3, Hit, Ray, Side, Value, kinds};
use crate::sampling::Draws;
use crate::scene::{Background, Scene, SurfaceInteraction};
use crate::shoot::Cpu;

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
    /// The linear colour of the ray `p + t * u_r` that met `o`. It is asked for misses too: there
    /// `t` is infinity, `o.object` is -1, and the shader itself returns the background.
    fn shade(&self, t: f64, p: DVec3, u_r: DVec3, o: &Hit) -> Color;

    /// Shades many samples as [`shade`](Self::shade) does: a colour for each. A shader that shoots
    /// rays of its own is faster when it shoots them together; renderers ask for a few hundred at a
    /// time. There are as many colours as samples, and as many numbers of coverage, which are 1 for
    /// hits and 0 for misses and may be changed. Colours are premultiplied by the coverage
    /// (associated alpha).
    fn shade_all(&self, samples: &Samples<'_>, colors: &mut [Color], _coverage: &mut [f64]) {
        for (k, (ray, color)) in samples.rays.iter().zip(colors).enumerate() {
            let hit = &samples.hits[k];
            *color = self.shade(hit.t, ray.origin, ray.direction, hit);
        }
    }

    /// Whether misses are transparent, as with [`Background::Transparent`]. Colours then get a
    /// fourth number, the pixel's coverage, and the shader must return black for misses.
    fn is_transparent(&self) -> bool {
        false
    }

    /// Whether it draws numbers, so that a pixel's samples differ even where they see the same.
    fn is_random(&self) -> bool {
        false
    }

    /// Whether samples may be negative although no expected colour is, so that a negative mean can
    /// only be noise. Pictures then have 0 in its place.
    fn has_negative_noise(&self) -> bool {
        false
    }

    /// The record of the shading for outputs; `None` for a shader of one's own.
    fn recipe(&self) -> Option<Recipe> {
        None
    }
}

/// The record of a shading: the shader with its settings.
#[derive(Debug, Clone, PartialEq)]
pub struct Recipe {
    /// The shader's name.
    pub shader: &'static str,
    /// The shader's settings.
    pub settings: Vec<(&'static str, Value)>,
    /// A digest of this and of the lights, the environment, the background and the ground.
    pub digest: String,
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
    /// The hits, one for each ray.
    pub hits: &'a [Hit],
    /// The pixels that they are of, counted row by row from the top of the whole picture, as many.
    /// With the sample's number they are a seed for random numbers that depends on nothing else.
    pub pixels: &'a [u64],
    /// The number of the rays' sample in their pixels, from 0 on.
    pub sample: u32,
    /// The side of surfaces that the rays pass through. Their continuations behind translucent
    /// surfaces pass through it too.
    pub cull: Option<Side>,
}

impl Samples<'_> {
    /// The numbers that a shader may draw for one of the samples.
    pub fn draws(&self, index: usize) -> Draws {
        Draws::new(self.pixels[index], self.sample)
    }
}

/// Streams of random numbers: each technique draws from its own (see [`Draws::split`]). The stream
/// of a light comes from its settings.
mod stream {
    pub(super) const EMITTERS: u64 = 1;
    pub(super) const ENVIRONMENT: u64 = 2;
    /// The first number of the streams for translucent surfaces on the way of a ray.
    pub(super) const LAYERS: u64 = 3;
}

/// The surfaces that a shader colours, and the random numbers for each.
struct Points<'a> {
    surfaces: Vec<SurfaceInteraction<'a>>,
    draws: Vec<Draws>,
}

/// Makes [`Shader`] and everything that depends on the list of shaders. A shader is a function of
/// its settings, of what it works in, and of many hits: it sets a colour for each. `true` stands
/// for one that draws numbers; a `translucent` one sets the coverage too.
macro_rules! shaders {
    ($($(#[doc = $about:literal])* $name:literal => $kind:ident($settings:ty), $is_random:expr, $shade:expr $(, $translucent:ident)?;)*) => {
        /// The shaders that come with the library, by name.
        ///
        /// ```
        /// use firsthit::geometry::Value;
        /// use firsthit::Shader;
        ///
        /// let mut shader = Shader::named("lambert")?;
        /// shader.set("ambient", Value::Number(0.1))?;
        /// assert!(Shader::NAMES.contains(&"direct"));
        /// # Ok::<(), firsthit::Error>(())
        /// ```
        #[derive(Debug, Clone, PartialEq)]
        pub enum Shader {
            $($(#[doc = $about])* $kind($settings),)*
        }

        kinds!("shader", Shader { $($(#[doc = $about])* $name => $kind($settings);)* });

        impl Shader {
            /// Whether it draws numbers: a pixel's samples then differ even where they see the
            /// same.
            pub fn is_random(&self) -> bool {
                match self { $(Self::$kind(_) => $is_random,)* }
            }

            fn color(&self, shading: &Shading<'_>, points: &Points<'_>, colors: &mut [Color], coverage: &mut [f64]) {
                match self {
                    $(Self::$kind(settings) => {
                        shaded!($shade, (settings, shading, points, colors), coverage $(, $translucent)?);
                    })*
                }
            }
        }
    };
}

/// Calls a shader's function.
macro_rules! shaded {
    ($shade:expr, ($($given:expr),*), $coverage:expr) => { ($shade)($($given),*) };
    ($shade:expr, ($($given:expr),*), $coverage:expr, translucent) => { ($shade)($($given),*, $coverage) };
}

shaders! {
    /// Direct light from lights, emissive surfaces and the environment, with soft shadows; mirrors
    /// show only these.
    "direct" => Direct(Direct), true, direct::shade;
    /// Light by any number of surfaces: reflections, refractions, and light that surfaces throw at
    /// each other.
    "path" => Path(Path), true, path::shade;
    /// Mirrors and clear matter without noise, to a depth; other surfaces by hard light and ambient
    /// light.
    "whitted" => Whitted(Whitted), false, whitted::shade;
    /// Matte, with ambient light from everywhere, which nothing blocks, and shadows that are hard.
    "lambert" => Lambert(Lambert), false, lambert::shade;
    /// Matte, with highlights by the angle to the mirrored light.
    "phong" => Phong(Phong), false, phong::shade;
    /// Matte, with highlights by the angle between the normal and the direction half way between
    /// light and viewer.
    "blinn-phong" => BlinnPhong(Phong), false, phong::shade_blinn;
    /// Lit by a sky over a ground, without shadows.
    "hemisphere" => Hemisphere(Hemisphere), false, hemisphere::shade;
    /// A colour by the normal as the viewer sees it, like clay, without lights.
    "matcap" => Matcap(Matcap), false, matcap::shade;
    /// Ambient occlusion: how much of the sky each point sees, as if all were white and matte.
    "ao" => AmbientOcclusion(AmbientOcclusion), true, occlusion::shade;
    /// A radiograph: what is behind, as much as is left of it on the way through everything.
    "xray" => Xray(Xray), false, xray::shade, translucent;
    /// Matte surfaces that are translucent, all of them on the way of a ray.
    "ghost" => Ghost(Ghost), false, ghost::shade, translucent;
    /// The object's colour as it is.
    "unlit" => Unlit(()), false, |&(), _, points, colors| each(points, colors, SurfaceInteraction::color);
    /// The geometric normal as a colour: from -1..1 to 0..1 along each axis.
    "normal" => Normal(()), false, |&(), _, points, colors| each(points, colors, normal_color);
}

impl Shader {
    /// Whether it looks at the colours of surfaces.
    pub fn takes_color(&self) -> bool {
        !matches!(self, Self::AmbientOcclusion(_) | Self::Xray(_) | Self::Normal(()))
    }

    /// Whether it looks at where the surfaces that were hit are and how they lie. `unlit` does not;
    /// `xray` and `ghost` look at crossings of their own.
    fn takes_geometry(&self) -> bool {
        !matches!(self, Self::Unlit(()) | Self::Xray(_) | Self::Ghost(_))
    }

    /// The number of rays that a hit takes, in a scene with `lights` lights; `None` where that
    /// depends on what they meet.
    pub fn rays_per_hit(&self, lights: usize) -> Option<usize> {
        match self {
            Self::Hemisphere(_) | Self::Matcap(_) | Self::Unlit(()) | Self::Normal(()) => Some(0),
            Self::AmbientOcclusion(_) => Some(1),
            Self::Lambert(_) | Self::Phong(_) | Self::BlinnPhong(_) => Some(lights),
            // And one to the sky.
            Self::Direct(_) => Some(lights.saturating_add(1)),
            Self::Path(_) | Self::Whitted(_) | Self::Xray(_) | Self::Ghost(_) => None,
        }
    }

    /// Whether surfaces show light of the environment.
    pub fn takes_environment(&self) -> bool {
        matches!(self, Self::Direct(_) | Self::Path(_) | Self::Whitted(_))
    }

    /// The light from everywhere, which nothing blocks, that it adds to that of lights.
    fn ambient(&self) -> Color {
        match self {
            Self::Lambert(settings) => settings.ambient,
            Self::Phong(settings) | Self::BlinnPhong(settings) => settings.ambient,
            Self::Ghost(settings) => settings.ambient,
            Self::Whitted(settings) => settings.ambient,
            _ => Color::ZERO,
        }
    }

    /// Whether it looks at lights or the environment.
    pub fn is_lit(&self) -> bool {
        self.default_rig().is_some()
    }
}

/// Colours that each hit gives by itself.
fn each<'a>(
    points: &Points<'a>,
    colors: &mut [Color],
    color_of: impl Fn(&SurfaceInteraction<'a>) -> Color,
) {
    for (surface, color) in points.surfaces.iter().zip(colors) {
        *color = color_of(surface);
    }
}

/// The geometric normal as a colour; black for a triangle without an area, which has none.
fn normal_color(surface: &SurfaceInteraction<'_>) -> Color {
    let normal = surface.normal();
    if normal.is_nan() { Color::ZERO } else { 0.5 * normal + 0.5 }
}

/// The normal on the side that is seen: smooth, or the face's own. NaN for a triangle without an
/// area.
#[inline]
fn seen_normal(surface: &SurfaceInteraction<'_>, flat: bool) -> DVec3 {
    surface.side() * if flat { surface.normal() } else { surface.shading_normal() }
}

impl Shader {
    /// Whether it shows what is behind surfaces itself.
    fn sees_through(&self) -> bool {
        matches!(self, Self::Xray(_) | Self::Ghost(_))
    }

    /// The lights of pictures that have none of their own: those that go best with this shader.
    /// `None` for one that looks at no light.
    pub fn default_rig(&self) -> Option<LightRig> {
        match self {
            Self::Lambert(_) | Self::Phong(_) | Self::BlinnPhong(_) | Self::Ghost(_) => {
                Some(LightRig::Shoulder)
            }
            Self::Direct(_) | Self::Path(_) | Self::Whitted(_) => Some(LightRig::Auto),
            Self::AmbientOcclusion(_)
            | Self::Hemisphere(_)
            | Self::Matcap(_)
            | Self::Xray(_)
            | Self::Unlit(())
            | Self::Normal(()) => None,
        }
    }

    /// The [`Shade`] that applies this shader to `scene`, before [`Background::NEUTRAL`]; see
    /// [`Shading::background`] for another.
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
            upwards: scene.up(),
            background: Background::NEUTRAL,
            sees_environment: true,
            ground: None,
            engine: Cpu::shared(),
        }
    }
}

impl Default for Shader {
    fn default() -> Self {
        Self::Lambert(Lambert::default())
    }
}

//! A builder for [`render()`], with defaults.

use std::fmt::{self, Debug, Formatter};

use super::{Picture, Region, framing_camera};
use crate::camera::{Camera, StandardView};
use crate::channel::{self, ChannelKind};
use crate::edge::Edges;
use crate::error::Result;
use crate::geometry::{DVec3, Side, require};
use crate::image::Frame;
use crate::scene::{Background, Coloring, Scene};
use crate::shade::{Appearance, LightRig, Shade, Shader, default_samples};
use crate::shoot::{Cpu, Engine};
use crate::watch::Watch;

/// A picture to be made of a scene. The defaults are those of the command line: a three-quarter
/// view from above that fills 768 rows of 1024 pixels, and, if the scene has no light, automatic
/// light and a ground for its shadows ([`Appearance`]).
///
/// ```
/// use firsthit::{Color, DVec3, Object, Render, Scene, Shader, Sphere, camera::StandardView};
///
/// let ball = Object::new(Sphere::new(DVec3::ZERO, 1.0)?).colored(Color::new(0.8, 0.2, 0.2));
/// let scene = Scene::new(vec![ball])?;
/// let frame = Render::new(&scene)
///     .view(StandardView::Front)
///     .size(30, 40)
///     .channels(&["color", "z"])
///     .shade(Shader::default())
///     .frame()?;
/// assert_eq!(frame.shape(), [30, 40]);
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// [`render()`](super::render()) is the same without defaults.
#[derive(Debug, Clone)]
#[must_use = "nothing is rendered before `frame` is called"]
pub struct Render<'a> {
    scene: &'a Scene,
    camera: Option<Camera>,
    view: StandardView,
    up: Option<DVec3>,
    size: [usize; 2],
    look: Option<Look<'a>>,
    appearance: Appearance,
    cull: Option<Side>,
    region: Option<Region>,
    engine: &'a dyn Engine,
    channels: &'a [&'a str],
    edges: Option<Edges>,
    watch: Follower<'a>,
}

/// The source of the rays' colours.
#[derive(Clone)]
pub enum Look<'a> {
    /// A shader of the library, with the scene and the background of the picture.
    Shader(Shader),
    /// Any other [`Shade`], which decides the colours of misses too.
    Own(&'a dyn Shade),
}

impl Debug for Look<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Shader(shader) => f.debug_tuple("Shader").field(shader).finish(),
            Self::Own(_) => f.debug_tuple("Own").finish_non_exhaustive(),
        }
    }
}

impl From<Shader> for Look<'_> {
    fn from(shader: Shader) -> Self {
        Self::Shader(shader)
    }
}

impl<'a, S: Shade> From<&'a S> for Look<'a> {
    fn from(shade: &'a S) -> Self {
        Self::Own(shade)
    }
}

impl<'a> From<&'a dyn Shade> for Look<'a> {
    fn from(shade: &'a dyn Shade) -> Self {
        Self::Own(shade)
    }
}

/// A [`Watch`] with [`Debug`].
#[derive(Clone, Copy)]
struct Follower<'a>(&'a dyn Watch);

impl Debug for Follower<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str("..")
    }
}

impl<'a> Render<'a> {
    /// A picture of `scene`.
    pub fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            camera: None,
            view: StandardView::default(),
            up: None,
            size: [768, 1024],
            look: None,
            appearance: Appearance::default(),
            cull: None,
            region: None,
            engine: Cpu::shared(),
            channels: &["color"],
            edges: None,
            watch: Follower(&()),
        }
    }

    /// Through a camera, in place of `view`, `up` and `size`.
    pub fn camera(mut self, camera: Camera) -> Self {
        self.camera = Some(camera);
        self
    }

    /// Sets the standard view; [`StandardView::Iso`] by default.
    pub fn view(self, view: StandardView) -> Self {
        Self { view, ..self }
    }

    /// Sets the direction upwards; [`Scene::up`] by default.
    pub fn up(mut self, up: DVec3) -> Self {
        self.up = Some(up);
        self
    }

    /// Sets the numbers of rows and columns of pixels.
    pub fn size(mut self, rows: usize, columns: usize) -> Self {
        self.size = [rows, columns];
        self
    }

    /// Sets the colours: a [`Shader`], or a reference to any other [`Shade`], such as a closure.
    ///
    /// ```
    /// use firsthit::{Color, DVec3, Hit, Object, Render, Scene, Shader, Sphere};
    ///
    /// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
    /// let fog = |t: f64, _p: DVec3, _u_r: DVec3, _o: &Hit| Color::splat(libm::exp(-t));
    /// let small = Render::new(&scene).size(3, 4);
    /// let frames = [small.clone().shade(&fog).frame()?, small.shade(Shader::named("normal")?).frame()?];
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub fn shade(mut self, look: impl Into<Look<'a>>) -> Self {
        self.look = Some(look.into());
        self
    }

    /// Sets the background, which is the colour of misses for the library's shaders;
    /// [`BACKGROUND`](crate::shade::BACKGROUND) by default.
    pub fn background(mut self, background: Background) -> Self {
        self.appearance.background = Some(background);
        self
    }

    /// Coloured by numbers, in place of the surfaces' own colours.
    ///
    /// ```
    /// use firsthit::scene::{ColorBy, Coloring};
    /// use firsthit::{DVec3, Object, Render, Scene, Sphere};
    ///
    /// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
    /// let frame = Render::new(&scene).size(3, 4).color_by(Coloring::new(ColorBy::Height)).frame()?;
    /// let legend = frame.metadata().colors.expect("colours have a legend");
    /// assert_eq!((&*legend.by, legend.range), ("height", [-1.0, 1.0]));
    /// # Ok::<(), firsthit::Error>(())
    /// ```
    pub fn color_by(mut self, coloring: Coloring) -> Self {
        self.appearance.coloring = Some(coloring);
        self
    }

    /// Replaces the scene's lights by some that go with the camera.
    pub fn light(mut self, rig: LightRig) -> Self {
        self.appearance.rig = Some(rig);
        self
    }

    /// Adds or leaves out a ground that shadows fall on, under everything; see [`Appearance`].
    pub fn ground(mut self, ground: bool) -> Self {
        self.appearance.ground = Some(ground);
        self
    }

    /// Sets the number of samples whose mean is a pixel's colour; see [`Appearance`].
    pub fn samples(mut self, samples: u32) -> Self {
        self.appearance.samples = Some(samples);
        self
    }

    /// Through one side of all surfaces, as into a room through its walls. Rays of shaders, such as
    /// those to lights, meet both.
    pub fn cull(mut self, side: Side) -> Self {
        self.cull = Some(side);
        self
    }

    /// Renders only a part of the picture, with the bytes that it has in the whole.
    pub fn region(mut self, region: Region) -> Self {
        self.region = Some(region);
        self
    }

    /// Sets another engine than [`Cpu`], for the camera's rays and for the shader's own.
    pub fn engine(self, engine: &'a dyn Engine) -> Self {
        Self { engine, ..self }
    }

    /// Sets the channels, by their names in [`channel::KINDS`], or `attribute:` and the name of an
    /// attribute of the meshes; `color` alone by default.
    pub fn channels(self, channels: &'a [&'a str]) -> Self {
        Self { channels, ..self }
    }

    /// Draws lines along edges over the colours, and as the channel `edge`.
    pub fn edges(mut self, edges: Edges) -> Self {
        self.edges = Some(edges);
        self
    }

    /// Reporting progress to `watch`, which may stop it.
    pub fn watch(mut self, watch: &'a dyn Watch) -> Self {
        self.watch = Follower(watch);
        self
    }

    /// Makes the picture, with all threads of the current rayon pool.
    ///
    /// # Errors
    ///
    /// The errors of [`render()`](super::render()), [`framing_camera`] and
    /// [`Scene::with_coloring`], and [`Error::Argument`](crate::error::Error::Argument) for an
    /// unknown channel, and for `color_by`, `light`, `background` or `ground` with a shade of one's
    /// own, which makes its colours without them.
    pub fn frame(self) -> Result<Frame> {
        let asked = self.channels.iter().map(|name| channel::asked(name));
        let asked = asked.collect::<Result<Vec<_>>>()?;
        let kinds: Vec<&ChannelKind> = asked.iter().map(|kind| &**kind).collect();
        let camera = self.camera.map_or_else(
            || {
                let up = self.up.unwrap_or_else(|| self.scene.up());
                framing_camera(self.scene, up, self.view, self.size)
            },
            Ok,
        )?;
        let picture = |scene: &Scene, shade: &dyn Shade, samples: Option<u32>| {
            let picture = Picture {
                samples: samples.unwrap_or(default_samples(shade.is_random())),
                cull: self.cull,
                region: self.region.clone(),
                engine: self.engine,
                edges: self.edges,
                ..Picture::new(scene, &camera, shade, &kinds)
            };
            picture.render(self.watch.0)
        };
        let shader = match self.look {
            Some(Look::Own(shade)) => {
                let Appearance { rig, background, ground, coloring, .. } = &self.appearance;
                for (what, is_left_out) in [
                    ("color_by", coloring.is_none()),
                    ("light", rig.is_none()),
                    ("background", background.is_none()),
                    ("ground", ground.is_none()),
                ] {
                    let domain = "left out with a shade of one's own";
                    require(what, domain, is_left_out, "some")?;
                }
                return picture(self.scene, shade, self.appearance.samples);
            }
            Some(Look::Shader(shader)) => Some(shader),
            None => None,
        };
        let appearance = Appearance { shader, ..self.appearance.clone() };
        let resolved = appearance.resolve(self.scene, Some(&camera))?;
        let shading = resolved.shading(self.engine);
        picture(&resolved.scene, &shading, Some(resolved.samples))
    }
}

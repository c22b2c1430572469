//! The loop: sensor, shoot, shade, image.

mod accumulation;
mod appearance;
mod batch;
mod idle;
mod legend;
mod mattes;
mod region;
mod sample;
mod settings;
mod slab;
mod state;

pub use appearance::{Appearance, Resolved, default_shader, world_up};
pub use idle::{idle, idle_in_files};
pub use region::Region;
pub use sample::{Sample, check_samples};
pub use settings::{Look, Render};
pub use state::check_state_file;

use std::borrow::Cow;

use crate::camera::{Aim, Camera, Description, StandardView};
use crate::channel::{ChannelKind, still_camera};
use crate::edge::{Edges, Lines, Subject};
use crate::error::{Error, Result};
use crate::geometry::summary::summary;
use crate::geometry::{DVec3, Digest, Side, Value, require};
use crate::image::{Channel, Frame, Names, Origin, ShadingRecord};
use crate::memory;
use crate::scene::{Background, Scene};
use crate::sensor::{Record, Sensor};
use crate::shade::{Recipe, Shade};
use crate::shoot::{Cpu, Engine};
use crate::watch::Watch;
use slab::Slab;

/// A picture to be made: what [`render()`] takes, and what it leaves open.
///
/// ```
/// use firsthit::render::{Picture, Region};
/// use firsthit::{Camera, DVec3, Object, Scene, Shader, Sphere, channel};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let camera = Camera::look_at(DVec3::new(0.0, -5.0, 2.0), DVec3::ZERO, DVec3::Z, 45.0, 30, 40)?;
/// let channels = [channel::kind("color")?, channel::kind("z")?];
/// let shade = Shader::named("normal")?.on(&scene);
/// let picture = Picture {
///     samples: 4,
///     region: Some(Region { rows: 10..20, columns: 0..40 }),
///     ..Picture::new(&scene, &camera, &shade, &channels)
/// };
/// assert_eq!(picture.render(&())?.shape(), [10, 40]);
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Clone)]
pub struct Picture<'a> {
    /// The scene that is seen.
    pub scene: &'a Scene,
    /// The sensor that makes the rays.
    pub sensor: &'a dyn Sensor,
    /// The shader that gives rays their colours.
    pub shade: &'a dyn Shade,
    /// The channels of the frame.
    pub channels: &'a [&'a ChannelKind],
    /// The number of samples of a pixel; 1 is the pixel's centre.
    pub samples: u32,
    /// A threshold: where the standard error of a pixel's brightness is below this, no more samples
    /// are taken. It is checked after 32, 64, 128, ... samples, for tiles of 16 x 16 pixels with
    /// their neighbours. Brightness is as sRGB shows it, 1 being white, and over white where the
    /// background is transparent. `None`: all pixels get as many samples.
    pub noise: Option<f64>,
    /// The side of surfaces that the sensor's rays pass through, as into a room through its walls.
    /// Those that a shader shoots do not.
    pub cull: Option<Side>,
    /// The part to make; the bytes are those of that part of the whole picture.
    pub region: Option<Region>,
    /// The engine that finds the hits.
    pub engine: &'a dyn Engine,
    /// Lines along edges, over the colours. The channel `edge` has them as they are said here, or
    /// else those of [`Edges::default`].
    pub edges: Option<Edges>,
}

summary!(
    Picture<'_>, "Picture", |picture| "sensor": picture.sensor, "samples": picture.samples, "region": picture.region
);

/// A picture of `scene`: a frame with the `channels`, row 0 at the top.
///
/// With more than one of `samples`, a pixel's colour is the mean over that many points of it; all
/// other channels are those of the pixel's centre. With a camera that has an aperture, each sample
/// comes from another point of the lens too. The result does not depend on the number of threads.
///
/// ```
/// use firsthit::{Camera, DVec3, Object, Scene, Shader, Sphere, channel, render};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let camera = Camera::look_at(DVec3::new(0.0, -5.0, 2.0), DVec3::ZERO, DVec3::Z, 45.0, 30, 40)?;
/// let channels = [channel::kind("color")?, channel::kind("z")?];
/// let shade = Shader::named("normal")?.on(&scene);
/// let frame = render(&scene, &camera, &shade, &channels, 1, &())?;
/// assert!(frame.channel("z").is_some());
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Argument`] for no samples, and for a single one of a camera with an aperture, whose
/// colours would be a pinhole's; [`Error::Limit`] when the picture does not fit into memory,
/// [`Error::Interrupted`] when `watch` stops it.
pub fn render(
    scene: &Scene,
    sensor: &dyn Sensor,
    shade: &dyn Shade,
    channels: &[&ChannelKind],
    samples: u32,
    watch: &dyn Watch,
) -> Result<Frame> {
    let picture = Picture { samples, ..Picture::new(scene, sensor, shade, channels) };
    picture.render(watch)
}

/// The approximate largest number of pixels that are rendered at once: the hits and sums of each
/// take 64 bytes, and so stay near the cores.
const SLAB: usize = 1 << 18;

/// Rows of a slab come in multiples of this, that of the squares of tiles.
const SLAB_ROWS: usize = 64;

impl<'a> Picture<'a> {
    /// All of a sensor's pixels, by their centres, on this machine.
    pub fn new(
        scene: &'a Scene,
        sensor: &'a dyn Sensor,
        shade: &'a dyn Shade,
        channels: &'a [&'a ChannelKind],
    ) -> Self {
        Self {
            scene,
            sensor,
            shade,
            channels,
            samples: 1,
            noise: None,
            cull: None,
            region: None,
            engine: Cpu::shared(),
            edges: None,
        }
    }

    /// Makes the picture.
    ///
    /// # Errors
    ///
    /// The errors of [`render()`], and [`Error::Argument`] for a region that is no part of the
    /// picture.
    pub fn render(&self, watch: &dyn Watch) -> Result<Frame> {
        let mut origin = None;
        let mut whole: Vec<Channel> = Vec::new();
        let region = self.checked()?;
        let [rows, columns] = region.shape();
        let pixels = rows.saturating_mul(columns);
        self.render_to(watch, &mut |part: Frame| {
            if origin.is_none() {
                // The first part begins where the whole does, and where a noise ends the samples
                // there are no other parts.
                origin = Some(part.origin().clone());
                whole = part.into_channels();
                return whole
                    .iter_mut()
                    .try_for_each(|channel| channel.data.reserve(pixels, channel.components));
            }
            for (channel, part) in whole.iter_mut().zip(part.into_channels()) {
                channel.data.append(part.data);
            }
            Ok(())
        })?;
        let mut frame = Frame::new(region.shape()).from_origin(origin.unwrap_or_default());
        for channel in whole {
            frame.push(channel)?;
        }
        Ok(frame)
    }

    /// Makes the picture and hands it on in parts, from the top to the bottom: each has some of the
    /// rows and all the columns of the region.
    ///
    /// # Errors
    ///
    /// The errors of [`Picture::render`], and those of `sink`.
    pub fn render_to(
        &self,
        watch: &dyn Watch,
        sink: &mut dyn FnMut(Frame) -> Result<()>,
    ) -> Result<()> {
        let region = self.checked()?;
        if self.needs_samples() {
            check_samples(self.sensor, self.samples)?;
        }
        let lines = self.lines(&region, watch)?;
        let columns = region.columns.len();
        let height = if self.noise.is_some() {
            // Whether a tile is active depends on its neighbours.
            region.rows.len()
        } else {
            (SLAB / columns / SLAB_ROWS).max(1) * SLAB_ROWS
        };
        let mut last: Option<Slab<'_>> = None;
        for first in region.rows.clone().step_by(height) {
            let rows = first..region.rows.end.min(first.saturating_add(height));
            let columns = region.columns.clone();
            let part = (Region { rows, columns }, lines.as_ref());
            let mut slab = match last {
                Some(last) => last.next(part, watch)?,
                None => Slab::new(self, part, watch)?,
            };
            let samples = if self.needs_samples() { self.samples } else { 1 };
            for _ in 0..samples {
                if !slab.add_sample(watch)? {
                    break;
                }
            }
            let frame = slab.take_frame()?;
            let has_more = first.saturating_add(height) < region.rows.end;
            last = has_more.then_some(slab);
            sink(frame)?;
        }
        Ok(())
    }

    /// Begins the picture, to be made one sample after the other.
    ///
    /// # Errors
    ///
    /// The errors of [`Picture::render`].
    pub fn start(&'a self) -> Result<Progressive<'a>> {
        self.start_watched(&())
    }

    fn start_watched(&'a self, watch: &dyn Watch) -> Result<Progressive<'a>> {
        let region = self.checked()?;
        if self.needs_samples() {
            check_samples(self.sensor, self.samples)?;
        }
        let lines = self.lines(&region, watch)?;
        let slab = Slab::new(self, (region, lines.as_ref()), watch)?;
        Ok(Progressive { slab })
    }

    /// Resumes a saved progressive render, from what [`Progressive::state`] gave. All must be as it
    /// was. Channels other than those of all samples are made with the first sample, so a resumed
    /// picture has none of them.
    ///
    /// # Errors
    ///
    /// The errors of [`Picture::render`], and [`Error::Argument`] for the state of another picture,
    /// and for a channel that would be missing.
    pub fn resume(&'a self, state: &Frame) -> Result<Progressive<'a>> {
        self.resume_checked(&(), |_| Ok(Cow::Borrowed(state)))
    }

    /// Goes on from a state that is made or checked by what the new picture says of itself.
    fn resume_checked<'s>(
        &'a self,
        watch: &dyn Watch,
        state: impl FnOnce(&Frame) -> Result<Cow<'s, Frame>>,
    ) -> Result<Progressive<'a>> {
        let is_lost = |kind: &&&ChannelKind| !kind.needs_shade();
        if let Some(kind) = self.channels.iter().find(is_lost) {
            let expected = "color, alpha or samples of a picture that is gone on with";
            return Err(Error::argument("channel", expected, &*kind.name));
        }
        let mut progressive = self.start_watched(watch)?;
        let state = state(&progressive.state()?)?;
        progressive.slab.resume(&state)?;
        Ok(progressive)
    }

    /// The lines of edges that a region needs, if any.
    fn lines(&self, region: &Region, watch: &dyn Watch) -> Result<Option<Lines>> {
        let over_colors = self.edges.is_some() && self.has_color();
        if !over_colors && !self.channels.iter().any(|kind| kind.is_edge()) {
            return Ok(None);
        }
        let Some(camera) = still_camera(self.sensor) else {
            return Ok(None);
        };
        let edges = self.edges.unwrap_or_default();
        let subject = Subject { scene: self.scene, camera, engine: self.engine, cull: self.cull };
        let part = [region.rows.clone(), region.columns.clone()];
        Lines::new(&subject, &edges, part, watch).map(Some)
    }

    fn checked(&self) -> Result<Region> {
        require("samples", "at least 1", self.samples > 0, self.samples)?;
        let noise = self.noise.unwrap_or(1.0);
        require("noise", "a positive number", noise > 0.0, noise)?;
        let is_whole = self.noise.is_none() || self.region.is_none();
        require("region", "none where there is a noise", is_whole, "one")?;
        let has_colors = self.noise.is_none() || self.has_color();
        let expected = "left out without color, alpha or samples among the channels";
        require("noise", expected, has_colors, noise)?;
        let shape = self.sensor.shape();
        let region = self.region.clone().unwrap_or_else(|| Region::all(shape));
        region.check(shape)?;
        for kind in self.channels {
            kind.check(self.scene)?;
            kind.check_sensor(self.sensor)?;
        }
        self.scene.check_light()?;
        if let Some(edges) = &self.edges {
            edges.check()?;
            let is_camera = still_camera(self.sensor).is_some();
            let expected = "left out for a sensor that is no camera";
            require("edges", expected, is_camera, edges.width)?;
        }
        let [rows, columns] = region.shape();
        let bytes = |kind: &&ChannelKind| kind.components * size_of::<f32>();
        let each: usize = self.channels.iter().map(bytes).sum();
        let pixels = rows.saturating_mul(columns);
        memory::check("the picture", pixels.saturating_mul(each))?;
        Ok(region)
    }

    fn has_color(&self) -> bool {
        self.channels.iter().any(|kind| kind.needs_shade())
    }

    fn needs_samples(&self) -> bool {
        self.channels.iter().any(|kind| kind.needs_samples())
    }

    /// A recipe whose digest knows which side of surfaces the sensor's rays pass through, and which
    /// noise ends the samples.
    fn complete(&self, recipe: Recipe) -> Recipe {
        let mut digest = Digest::default();
        digest.word(&recipe.digest);
        if let Some(side) = self.cull {
            digest.word(&format!("{} culled", side.name()));
        }
        if let Some(noise) = self.noise {
            digest.word("noise");
            digest.numbers(&[noise]);
        }
        Recipe { digest: digest.name(), ..recipe }
    }

    /// An empty frame of a region that says where it comes from; `samples` is the most that a pixel
    /// has.
    fn frame(&self, region: &Region, samples: u32) -> Frame {
        let first_pixel = [region.rows.start as u64, region.columns.start as u64];
        let origin = origin(self.scene, Some(self.sensor), Some(samples), self.channels);
        Frame::new(region.shape()).from_origin(Origin {
            shading: (self.shade.recipe()).map(|recipe| record(self.complete(recipe))),
            first_pixel,
            ..origin
        })
    }
}

/// A picture on the way: the mean of the samples so far.
#[expect(missing_debug_implementations, reason = "it is work on the way")]
pub struct Progressive<'a> {
    slab: Slab<'a>,
}

impl Progressive<'_> {
    /// Adds the next sample. N of them, one after the other, give the bytes of N at once, whatever
    /// [`Picture::samples`] says. Returns whether it did: with a [`Picture::noise`], a picture that
    /// is quiet has had its last.
    ///
    /// # Errors
    ///
    /// The errors of [`Picture::render`].
    pub fn add_sample(&mut self, watch: &dyn Watch) -> Result<bool> {
        self.slab.add_sample(watch)
    }

    /// The number of samples.
    pub fn samples(&self) -> u32 {
        self.slab.samples()
    }

    fn pixels(&self) -> usize {
        self.slab.pixels()
    }

    /// The state of the pixels, for [`Picture::resume`]: sums of colours and of squares of
    /// luminance in float64, and the number of samples. `.npz` holds it.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`] when it does not fit into memory.
    pub fn state(&self) -> Result<Frame> {
        self.slab.state()
    }

    /// The picture as it is.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] before the first sample, and [`Error::Limit`] when it does not fit into
    /// memory.
    pub fn frame(&self) -> Result<Frame> {
        let is_begun = self.samples() > 0;
        require("frame", "that of a picture with a sample", is_begun, "none")?;
        self.slab.frame()
    }
}

/// The number of rays that a picture of `pixels` pixels reports to its watch in all.
pub fn work(pixels: usize, channels: &[&ChannelKind], samples: u32) -> u64 {
    let has_color = channels.iter().any(|kind| kind.needs_shade());
    let has_samples = channels.iter().any(|kind| kind.needs_samples());
    let is_other = |kind: &&ChannelKind| !kind.needs_samples() && !kind.is_edge();
    let has_others = channels.iter().any(is_other);
    // Of each sample the rays and the colours; and the other channels, all at once.
    let traced = if has_samples { u64::from(samples) } else { 1 };
    let has_occlusion = channels.iter().any(|kind| kind.occlusion().is_some());
    let shaded = (u64::from(has_color) + u64::from(has_occlusion)) * traced;
    (pixels as u64).saturating_mul(traced + shaded + u64::from(has_others))
}

/// The origin of outputs: the scene's fingerprint, the camera, if one made the rays, and the names
/// behind the identifiers of the `channels`. `samples` are the points of a pixel that its colour is
/// the mean of, if there are colours or mattes.
pub fn origin(
    scene: &Scene,
    sensor: Option<&dyn Sensor>,
    samples: Option<u32>,
    channels: &[&ChannelKind],
) -> Origin {
    let has_names = channels.iter().any(|kind| kind.has_names());
    let (camera, sensor) = match sensor.map(Sensor::record) {
        Some(Record::Camera(camera)) => (Some(*camera), None),
        Some(Record::Other(sensor)) => (None, Some(*sensor)),
        None => (None, None),
    };
    Origin {
        scene: Some(scene.fingerprint().to_owned()),
        camera,
        sensor,
        samples,
        shading: None,
        colors: (scene.colored())
            .filter(|_| channels.iter().any(|kind| kind.needs_shade()))
            .map(legend::record),
        first_pixel: [0, 0],
        names: has_names.then(|| names(scene)),
        cryptomatte: (channels.iter()).filter_map(|kind| mattes::record(scene, kind)).collect(),
        scan: None,
        scans: None,
    }
}

/// A recipe as outputs have it.
fn record(recipe: Recipe) -> ShadingRecord {
    let number = |x: f64| {
        if x.is_finite() { x.into() } else { x.to_string().into() }
    };
    let value = |value| match value {
        Value::Flag(flag) => flag.into(),
        Value::Number(x) => number(x),
        Value::Vector(v) => v.to_array().map(number).to_vec().into(),
    };
    let settings = recipe.settings.into_iter();
    ShadingRecord {
        shader: recipe.shader.to_owned(),
        settings: settings.map(|(name, of)| (name.to_owned(), value(of))).collect(),
        digest: recipe.digest,
    }
}

/// The names of a scene's objects, and of what they come from.
pub fn names(scene: &Scene) -> Names {
    let catalog = scene.catalog();
    let objects = scene.objects().iter().enumerate();
    let objects = objects.map(|(number, object)| {
        let (node, mesh) = (catalog.node_of(number), catalog.mesh_of(number));
        (object.name(), node, mesh, catalog.materials_of(number))
    });
    let lists = [catalog.nodes(), catalog.meshes(), catalog.materials()];
    Names::new(objects, lists)
}

/// The default number of samples per pixel, of shaders that draw no numbers.
pub const SAMPLES: u32 = 4;

/// The default number of samples per pixel, of shaders that draw numbers.
pub const RANDOM_SAMPLES: u32 = 16;

/// The default number of samples per pixel, of shaders that draw numbers or do not.
pub const fn default_samples(is_random: bool) -> u32 {
    if is_random { RANDOM_SAMPLES } else { SAMPLES }
}

/// The default background of pictures.
pub const BACKGROUND: Background = Background::NEUTRAL;

/// The default camera: a perspective one, with a vertical field of view of 45 degrees, in which a
/// standard view of `scene` fills a picture of `rows` and `columns`, with `up` upwards. An empty or
/// infinite scene counts as the box from -1 to 1.
///
/// ```
/// use firsthit::{DVec3, Object, Scene, Sphere, camera::StandardView, render::framing_camera};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let camera = framing_camera(&scene, DVec3::Z, StandardView::Front, [480, 640])?;
/// assert_eq!(camera.aim(), DVec3::Y);
/// # Ok::<(), firsthit::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::Argument`] for an `up` that is zero or not finite, for no rows or columns, and for a
/// scene too far away to be framed.
pub fn framing_camera(
    scene: &Scene,
    up: DVec3,
    view: StandardView,
    [rows, columns]: [usize; 2],
) -> Result<Camera> {
    let description = Description {
        aim: Some(Aim::View(view)),
        rows: Some(rows),
        columns: Some(columns),
        ..Description::default()
    };
    description.camera(scene.bounds(), |direction| scene.support(direction), up)
}

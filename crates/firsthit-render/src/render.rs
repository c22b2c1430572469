//! The loop: sensor, shoot, shade, image.

mod accumulation;
mod batch;
mod idle;
mod legend;
mod mattes;
mod origin;
mod progressive;
mod region;
mod sample;
mod settings;
mod slab;
mod state;

pub use idle::{idle, idle_in_files};
pub use origin::{names, origin};
pub use progressive::Progressive;
pub use region::Region;
pub use sample::{Sample, check_samples};
pub use settings::{Look, Render};
pub use state::check_state_file;

use crate::camera::{Aim, Camera, Description, StandardView};
use crate::channel::{ChannelKind, still_camera};
use crate::edge::{Edges, Lines, Subject};
use crate::error::Result;
use crate::geometry::summary::summary;
use crate::geometry::{DVec3, Digest, Side, require};
use crate::image::{Channel, Frame, Origin};
use crate::memory;
use crate::scene::Scene;
use crate::sensor::Sensor;
use crate::shade::{Recipe, Shade};
use crate::shoot::{Cpu, Engine};
use crate::watch::Watch;
use origin::record;
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
///
/// [`Error::Argument`]: crate::error::Error::Argument
/// [`Error::Limit`]: crate::error::Error::Limit
/// [`Error::Interrupted`]: crate::error::Error::Interrupted
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
    /// The errors of [`render()`], and [`Error::Argument`](crate::error::Error::Argument) for a
    /// region that is no part of the picture.
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
/// [`Error::Argument`](crate::error::Error::Argument) for an `up` that is zero or not finite, for
/// no rows or columns, and for a scene too far away to be framed.
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

//! The table of output channels: quantities of hits.

mod asked;
mod attribute;
mod kinds;

use std::borrow::Cow;
use std::sync::Arc;

pub use asked::{ATTRIBUTE, MATTE_RANKS, PLACEHOLDER, asked};
pub use attribute::{AttributeName, AttributeValues, attribute, attributes};
pub use kinds::{DISTANCE, INSIDE, KINDS, POINT, RAY, SIGNED_DISTANCE, THICKNESS, VISIBLE};

use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::geometry::summary::summary;
use crate::geometry::{Hit, Rays};
use crate::image::{Channel, Data, Description, Display, Unit};
use crate::memory::filled;
use crate::parallel;
use crate::scene::{Catalog, Object, Scene, SurfaceInteraction};
use crate::sensor::{Record, Sensor};
use crate::shoot::{Hits, Prefetcher};
use crate::watch::{OnlyStops, Watch, stop_if_asked};

/// Rays, what they met, and all that channels are made from.
#[derive(Clone, Copy)]
pub struct ChannelInput<'a> {
    /// The scene that was shot at.
    pub scene: &'a Scene,
    /// The rays.
    pub rays: &'a dyn Rays,
    /// The hits of the rays.
    pub hits: &'a Hits,
    /// The sensor that made the rays, if one did.
    pub sensor: Option<&'a dyn Sensor>,
}

summary!(ChannelInput<'_>, "ChannelInput", |it| "rays": it.rays.len(), "sensor": it.sensor);

/// A kind of output: its name, what it says, and how it is made from hits.
#[derive(Debug, Clone)]
pub struct ChannelKind {
    /// The channel's name, in files too.
    pub name: Cow<'static, str>,
    /// One line for help texts: what it is, its unit, and its value for a miss.
    pub about: &'static str,
    /// Numbers for each ray; 0 where these are not known yet: of an attribute the scene decides, of
    /// numbers of one's own these do.
    pub components: usize,
    /// The colour scale in a picture.
    pub display: Display,
    /// The unit of the values.
    pub unit: Unit,
    /// The frame of reference of the values: `world`, `camera`, `ray`, `triangle` or `texture`.
    pub frame: Option<&'static str>,
    pub(crate) make: Make,
}

#[derive(Debug, Clone)]
pub(crate) enum Make {
    /// Made from a hit; for a miss the parameter of that, which is infinite.
    T,
    /// Made from the surface that a ray meets; NaN for a miss.
    Doubles(fn(&SurfaceInteraction<'_>, &mut [f64])),
    /// Made from a hit; -1 for a miss.
    Identifier(fn(&Hit) -> i32),
    /// Made from the origin of the object that is met; -1 for a miss.
    Origin(fn(&Catalog, &Object, &Hit) -> i32),
    /// Made from the surface that a ray meets; -1 for a miss.
    Integer(fn(&SurfaceInteraction<'_>) -> i32),
    /// Made from the surface that a ray meets; false for a miss.
    Flag(fn(&SurfaceInteraction<'_>) -> bool),
    /// The entry of [`Sensor::range_and_z`] with this index.
    Distance(usize),
    /// Made from the ray alone.
    Valid,
    /// An attribute of the meshes, by its name.
    Attribute(Arc<str>),
    /// Made by a shader, in `render`.
    Color,
    /// The coverage, from a shader, by `render`.
    Alpha,
    /// The number of samples of a pixel's colour, from `render`.
    Samples,
    /// Ambient occlusion up to a distance, over all samples of a pixel, by `render`.
    Occlusion(f64),
    /// Made from all samples of a pixel, in `render`.
    Matte(Matte),
    /// Made from the surfaces of the scene, in `render`.
    Edge,
    /// Made elsewhere, not from first hits.
    Elsewhere,
}

/// The kind of that name.
///
/// # Errors
///
/// [`Error::Argument`] for a name that no kind has.
pub fn kind(name: &str) -> Result<&'static ChannelKind> {
    let names: Vec<&str> = KINDS.iter().map(|kind| &*kind.name).collect();
    KINDS.iter().find(|kind| kind.name == name).ok_or_else(|| {
        let names = names.join(", ");
        let got = format!("{name:?}; there are {names}, and {ATTRIBUTE}NAME for an attribute");
        Error::argument("channel", "a channel's name", got)
    })
}

impl ChannelKind {
    /// Whether it takes a sensor: rays from elsewhere do not have it.
    pub fn needs_sensor(&self) -> bool {
        matches!(self.make, Make::Distance(_) | Make::Valid)
    }

    /// Fails for a distance along the aim of a sensor that has none, and for edges of one that is
    /// no camera.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`].
    pub fn check_sensor(&self, sensor: &dyn Sensor) -> Result<()> {
        if matches!(self.make, Make::Distance(1)) && !sensor.has_aim() {
            let expected = "one that a sensor without an aim has, such as range";
            return Err(Error::argument("channel", expected, &*self.name));
        }
        if self.is_edge() && still_camera(sensor).is_none() {
            let expected = "one that a sensor which is no camera has";
            return Err(Error::argument("channel", expected, &*self.name));
        }
        Ok(())
    }

    /// Whether it is made of lines along edges, by `render`, and not from hits.
    pub fn is_edge(&self) -> bool {
        matches!(self.make, Make::Edge)
    }

    /// Whether metadata have a table of what its identifiers stand for.
    pub fn has_names(&self) -> bool {
        matches!(self.make, Make::Origin(_)) || self.name == "object"
    }

    /// Whether it is the colour.
    pub fn is_color(&self) -> bool {
        matches!(self.make, Make::Color)
    }

    /// Whether it is the coverage.
    pub fn is_alpha(&self) -> bool {
        matches!(self.make, Make::Alpha)
    }

    /// Whether it is the number of samples.
    pub fn is_sample_count(&self) -> bool {
        matches!(self.make, Make::Samples)
    }

    /// The distance up to which things hide the sky, if the kind is ambient occlusion.
    pub fn occlusion(&self) -> Option<f64> {
        match self.make {
            Make::Occlusion(reach) => Some(reach),
            _ => None,
        }
    }

    /// Whether it takes a shader.
    pub fn needs_shade(&self) -> bool {
        matches!(self.make, Make::Color | Make::Alpha | Make::Samples)
    }

    /// Whether it is made from all samples of a pixel, by `render`; other channels are those of the
    /// pixel's centre.
    pub fn needs_samples(&self) -> bool {
        let of_samples = matches!(self.make, Make::Matte(_) | Make::Occlusion(_));
        self.needs_shade() || of_samples
    }

    /// The things that it has mattes of, if it is a Cryptomatte.
    pub fn matte(&self) -> Option<Matte> {
        match self.make {
            Make::Matte(matte) => Some(matte),
            _ => None,
        }
    }

    /// The channel of colours before a transparent background: four components, of which the last
    /// is the coverage (alpha).
    pub fn transparent_channel(&self, data: Data) -> Channel {
        let mut channel = self.channel(data);
        channel.components = 4;
        channel.description.about = "linear red, green, blue (Rec. 709), premultiplied by coverage; coverage (alpha); 0 for a miss";
        channel
    }

    /// The channel of this kind with `data`, which [`Frame::push`](crate::image::Frame::push)
    /// checks.
    pub fn channel(&self, data: Data) -> Channel {
        Channel {
            name: self.name.clone(),
            components: self.components,
            data,
            display: self.display,
            description: Description { about: self.about, unit: self.unit, frame: self.frame },
        }
    }
}

/// The things that a Cryptomatte has mattes of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Matte {
    /// The objects, by their names.
    Object,
    /// The materials, by their names.
    Material,
}

impl Matte {
    /// The name of one of the things.
    pub fn name(self) -> &'static str {
        match self {
            Self::Object => "object",
            Self::Material => "material",
        }
    }
}

/// The camera that a sensor is, if it is one; not that of one that moves. The rays of others make
/// no picture in which a point has one place.
pub(crate) fn still_camera(sensor: &dyn Sensor) -> Option<&Camera> {
    match sensor.record() {
        Record::Camera(_) => sensor.camera(),
        Record::Other(_) => None,
    }
}

/// The number of rays that a thread takes at a time.
const CHUNK: usize = 1 << 12;

/// Channels of hits, by all threads of the current rayon pool; of few rays by the calling thread
/// alone. Each hit is looked up once for all of them. `watch` is told of every ray once.
///
/// # Errors
///
/// [`Error::Limit`] when they do not fit into memory, [`Error::Argument`] for colours, for a
/// channel that needs a sensor where there is none, and for an attribute that no mesh has,
/// [`Error::Interrupted`] when `watch` stops it.
pub fn make(
    kinds: &[&ChannelKind],
    shots: &ChannelInput<'_>,
    watch: &dyn Watch,
) -> Result<Vec<Channel>> {
    let others = kinds.iter().copied();
    let others: Vec<&ChannelKind> = others.filter(|kind| kind.attribute_name().is_none()).collect();
    let mut made = make_at_hits(&others, shots, watch)?.into_iter();
    let mut channels = Vec::with_capacity(kinds.len());
    for kind in kinds {
        let Some(name) = kind.attribute_name() else {
            channels.extend(made.next());
            continue;
        };
        let found = attribute(name, None, shots.scene, shots.hits, &OnlyStops(watch))?;
        let mut channel = kind.channel(Data::Float64(found.values));
        channel.components = found.components;
        channels.push(channel);
    }
    if others.is_empty() && !kinds.is_empty() {
        watch.advance(shots.rays.len() as u64);
    }
    Ok(channels)
}

/// The channels that are no attributes.
fn make_at_hits(
    kinds: &[&ChannelKind],
    shots: &ChannelInput<'_>,
    watch: &dyn Watch,
) -> Result<Vec<Channel>> {
    for kind in kinds {
        let is_made_elsewhere =
            kind.needs_samples() || matches!(kind.make, Make::Elsewhere | Make::Edge);
        if is_made_elsewhere || (kind.needs_sensor() && shots.sensor.is_none()) {
            let expected = "one that rays without a camera have";
            return Err(Error::argument("channel", expected, &*kind.name));
        }
        if let Some(sensor) = shots.sensor {
            kind.check_sensor(sensor)?;
        }
    }
    let count = shots.rays.len();
    let made = kinds.iter().map(|kind| kind.missed(count));
    let mut made = made.collect::<Result<Vec<Data>>>()?;
    if kinds.is_empty() {
        return Ok(Vec::new());
    }
    let mut chunks: Vec<Vec<ChannelChunk<'_>>> = Vec::new();
    for (kind, data) in kinds.iter().zip(&mut made) {
        for (index, part) in ChannelChunk::chunks(kind, data).into_iter().enumerate() {
            if index == chunks.len() {
                chunks.push(Vec::with_capacity(kinds.len()));
            }
            chunks[index].push(part);
        }
    }
    let fill = |(index, parts): (usize, &mut Vec<ChannelChunk<'_>>)| {
        stop_if_asked(watch)?;
        let first = index * CHUNK;
        let count = (count - first).min(CHUNK);
        fill(shots, first, count, parts);
        watch.advance(count as u64);
        Ok(())
    };
    parallel::try_each(chunks.iter_mut().enumerate(), fill)?;
    drop(chunks);
    let channels = kinds.iter().zip(made);
    Ok(channels.map(|(kind, data)| kind.channel(data)).collect())
}

impl ChannelKind {
    /// The channel of `count` misses.
    fn missed(&self, count: usize) -> Result<Data> {
        Ok(match self.make {
            Make::T | Make::Distance(_) => Data::Float64(filled(count, f64::INFINITY)?),
            Make::Doubles(_) => {
                Data::Float64(filled(count.saturating_mul(self.components), f64::NAN)?)
            }
            Make::Identifier(_) | Make::Origin(_) | Make::Integer(_) => {
                Data::Int32(filled(count, -1)?)
            }
            Make::Flag(_) | Make::Valid => Data::Bool(filled(count, false)?),
            Make::Attribute(_)
            | Make::Color
            | Make::Alpha
            | Make::Samples
            | Make::Occlusion(_)
            | Make::Matte(_)
            | Make::Edge
            | Make::Elsewhere => {
                let expected = "one without a shader";
                return Err(Error::argument("channel", expected, &*self.name));
            }
        })
    }
}

/// The part of a channel that belongs to [`CHUNK`] rays, being made.
struct ChannelChunk<'a> {
    kind: &'a ChannelKind,
    values: Values<'a>,
}

/// The values of a chunk.
enum Values<'a> {
    Doubles(&'a mut [f64]),
    Integers(&'a mut [i32]),
    Flags(&'a mut [bool]),
}

impl<'a> ChannelChunk<'a> {
    /// The chunks of a channel.
    fn chunks(kind: &'a ChannelKind, data: &'a mut Data) -> Vec<Self> {
        let length = CHUNK * kind.components;
        let part = |values| Self { kind, values };
        match data {
            Data::Float64(all) => (all.chunks_mut(length).map(Values::Doubles).map(part)).collect(),
            Data::Int32(all) => (all.chunks_mut(length).map(Values::Integers).map(part)).collect(),
            Data::Bool(all) => (all.chunks_mut(length).map(Values::Flags).map(part)).collect(),
            Data::Float32(_) => unreachable!("`missed` makes none"),
        }
    }

    /// Whether it needs to know more than the hit.
    fn needs_surface(&self) -> bool {
        matches!(self.kind.make, Make::Doubles(_) | Make::Integer(_) | Make::Flag(_))
    }
}

/// Fills the parts of channels that belong to `count` rays from `first` on, where they hit
/// something.
fn fill(shots: &ChannelInput<'_>, first: usize, count: usize, parts: &mut [ChannelChunk<'_>]) {
    let met = |k: usize| Some(shots.hits.get(first + k)).filter(|hit| !hit.is_miss());
    for part in &mut *parts {
        match (&part.kind.make, &mut part.values) {
            (Make::T, Values::Doubles(out)) => {
                out.copy_from_slice(&shots.hits.t[first..first + count]);
            }
            (Make::Valid, Values::Flags(out)) => {
                for (k, out) in out.iter_mut().enumerate() {
                    *out = shots.rays.ray(first + k).is_valid();
                }
            }
            (Make::Identifier(value), Values::Integers(out)) => {
                for (out, hit) in out.iter_mut().zip((0..).map(met)) {
                    *out = hit.map_or(*out, |hit| value(&hit));
                }
            }
            (Make::Origin(value), Values::Integers(out)) => {
                let catalog = shots.scene.catalog();
                for (out, hit) in out.iter_mut().zip((0..).map(met)) {
                    if let Some(hit) = hit
                        && let Some(object) = shots.scene.object(&hit)
                    {
                        *out = value(catalog, object, &hit);
                    }
                }
            }
            (&Make::Distance(which), Values::Doubles(out)) => {
                for (k, out) in out.iter_mut().enumerate() {
                    if let (Some(hit), Some(sensor)) = (met(k), shots.sensor) {
                        *out = sensor.range_and_z(first + k, hit.t)[which];
                    }
                }
            }
            // From surfaces, below.
            (Make::Doubles(_), Values::Doubles(_))
            | (Make::Integer(_), Values::Integers(_))
            | (Make::Flag(_), Values::Flags(_)) => {}
            _ => unreachable!("`missed` makes the values of each kind, or refuses it"),
        }
    }
    // Nothing is fetched for hits that are not looked up.
    if parts.iter().any(ChannelChunk::needs_surface) {
        fill_from_surfaces(shots, first, count, parts);
    }
}

/// Fills what surfaces tell, hit by hit.
fn fill_from_surfaces(
    shots: &ChannelInput<'_>,
    first: usize,
    count: usize,
    parts: &mut [ChannelChunk<'_>],
) {
    let mut prefetcher = Prefetcher::new(shots.scene, shots.hits, first, count);
    for k in 0..count {
        prefetcher.advance(k);
        let hit = shots.hits.get(first + k);
        if hit.is_miss() {
            continue;
        }
        let ray = shots.rays.ray(first + k);
        let Some(surface) = shots.scene.interaction(&ray, &hit) else {
            continue;
        };
        for part in &mut *parts {
            match (&part.kind.make, &mut part.values) {
                (Make::Doubles(value), Values::Doubles(out)) => {
                    let components = part.kind.components;
                    value(&surface, &mut out[k * components..][..components]);
                }
                (Make::Integer(value), Values::Integers(out)) => out[k] = value(&surface),
                (Make::Flag(value), Values::Flags(out)) => out[k] = value(&surface),
                _ => {}
            }
        }
    }
}

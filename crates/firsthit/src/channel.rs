//! What can be asked about hits: the table of output channels.

mod attribute;

use std::borrow::Cow;
use std::sync::Arc;

use rayon::prelude::*;

pub use attribute::{AttributeName, AttributeValues, attribute, attributes};

use crate::error::{Error, Result};
use crate::geometry::{Hit, Rays};
use crate::image::{Channel, Data, Description, Display, Unit};
use crate::memory::filled;
use crate::scene::{Catalog, Object, Scene, SurfaceInteraction};
use crate::sensor::Sensor;
use crate::shoot::Hits;
use crate::watch::Watch;

/// Rays, what they met, and all that channels are made from.
#[derive(Clone, Copy)]
pub struct Shots<'a> {
    /// The scene that was shot at.
    pub scene: &'a Scene,
    /// The rays.
    pub rays: &'a dyn Rays,
    /// What they met.
    pub hits: &'a Hits,
    /// The sensor that made the rays, if one did.
    pub sensor: Option<&'a dyn Sensor>,
}

impl std::fmt::Debug for Shots<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shots")
            .field("rays", &self.rays.len())
            .field("sensor", &self.sensor)
            .finish_non_exhaustive()
    }
}

/// A kind of output: its name, what it says, and how it is made from hits.
#[derive(Debug, Clone)]
pub struct Kind {
    /// The channel's name, in files too.
    pub name: Cow<'static, str>,
    /// One line for help texts: what it is, its unit, and its value for a miss.
    pub about: &'static str,
    /// Numbers for each ray; 0 for an attribute, of which the scene decides.
    pub components: usize,
    /// How it becomes a picture.
    pub display: Display,
    /// What its numbers count.
    pub unit: Unit,
    /// What its numbers are relative to: `world`, `camera`, `ray`, `triangle` or `texture`.
    pub frame: Option<&'static str>,
    make: Make,
}

#[derive(Debug, Clone)]
enum Make {
    /// From a hit; for a miss the parameter of that, which is infinite.
    T,
    /// From what a ray meets; NaN for a miss.
    Doubles(fn(&SurfaceInteraction<'_>, &mut [f64])),
    /// From a hit; -1 for a miss.
    Identifier(fn(&Hit) -> i32),
    /// From what the object that is met comes from; -1 for a miss.
    Origin(fn(&Catalog, &Object, &Hit) -> i32),
    /// From what a ray meets; -1 for a miss.
    Integer(fn(&SurfaceInteraction<'_>) -> i32),
    /// From what a ray meets; false for a miss.
    Flag(fn(&SurfaceInteraction<'_>) -> bool),
    /// Which of [`Sensor::range_and_z`].
    Distance(usize),
    /// An attribute of the meshes, by its name.
    Attribute(Arc<str>),
    /// From a shader, by `render`.
    Color,
    /// Not from first hits.
    Elsewhere,
}

/// The number of the ray that each hit belongs to, where a ray may have several. It is no channel of a picture, so not among
/// [`KINDS`]; [`AllHits::ray_numbers`](crate::shoot::AllHits::ray_numbers) has its data.
pub const RAY: &Kind = &Kind {
    name: Cow::Borrowed("ray"),
    about: "number of the ray, from 0",
    components: 1,
    display: Display::Identifier,
    unit: Unit::None,
    frame: None,
    make: Make::Elsewhere,
};

/// Whether a point is inside an object. It is no channel of hits, so not among [`KINDS`];
/// [`inside`](crate::measure::inside()) has its data.
pub const INSIDE: &Kind = &Kind {
    name: Cow::Borrowed("inside"),
    about: "whether the point is inside an object",
    components: 1,
    display: Display::Mask,
    unit: Unit::None,
    frame: None,
    make: Make::Elsewhere,
};

/// Whether two points see each other. It is no channel of hits, so not among [`KINDS`]; [`visible`](crate::shoot::visible())
/// has its data.
pub const VISIBLE: &Kind = &Kind {
    name: Cow::Borrowed("visible"),
    about: "whether the two points see each other",
    components: 1,
    display: Display::Mask,
    unit: Unit::None,
    frame: None,
    make: Make::Elsewhere,
};

/// How thick an object is. It is no channel of hits, so not among [`KINDS`]; [`thickness`](crate::measure::thickness()) has its data.
pub const THICKNESS: &Kind = &Kind {
    name: Cow::Borrowed("thickness"),
    about: "distance inwards to the other side; inf where there is none",
    components: 1,
    display: Display::Distance,
    unit: Unit::SceneLength,
    frame: None,
    make: Make::Elsewhere,
};

/// Every channel. A new one is a new row.
pub const KINDS: &[Kind] = &[
    Kind {
        name: Cow::Borrowed("color"),
        about: "linear red, green, blue (Rec. 709); the background for a miss",
        components: 3,
        display: Display::Color,
        unit: Unit::LinearColor,
        frame: None,
        make: Make::Color,
    },
    Kind {
        name: Cow::Borrowed("t"),
        about: "distance from the ray's start along the ray (in lengths of the direction); inf for a miss",
        components: 1,
        display: Display::Distance,
        unit: Unit::DirectionLength,
        frame: Some("ray"),
        make: Make::T,
    },
    Kind {
        name: Cow::Borrowed("range"),
        about: "distance from the camera's position along the ray; inf for a miss",
        components: 1,
        display: Display::Distance,
        unit: Unit::SceneLength,
        frame: Some("camera"),
        make: Make::Distance(0),
    },
    Kind {
        name: Cow::Borrowed("z"),
        about: "distance from the camera's position along its aim; inf for a miss",
        components: 1,
        display: Display::Distance,
        unit: Unit::SceneLength,
        frame: Some("camera"),
        make: Make::Distance(1),
    },
    Kind {
        name: Cow::Borrowed("object"),
        about: "identifier of the object; -1 for a miss",
        components: 1,
        display: Display::Identifier,
        unit: Unit::None,
        frame: None,
        make: Make::Identifier(|hit| hit.object),
    },
    Kind {
        name: Cow::Borrowed("primitive"),
        about: "identifier of the object's part, such as the triangle; -1 for a miss",
        components: 1,
        display: Display::Identifier,
        unit: Unit::None,
        frame: None,
        make: Make::Identifier(|hit| hit.primitive),
    },
    Kind {
        name: Cow::Borrowed("face"),
        about: "identifier of the polygon that the triangle was part of; -1 for a miss",
        components: 1,
        display: Display::Identifier,
        unit: Unit::None,
        frame: None,
        make: Make::Integer(face),
    },
    Kind {
        name: Cow::Borrowed("node"),
        about: "identifier of the node that the object comes from; -1 for a miss and where there is none",
        components: 1,
        display: Display::Identifier,
        unit: Unit::None,
        frame: None,
        make: Make::Origin(|catalog, _, hit| of_object(hit, |object| catalog.node_of(object))),
    },
    Kind {
        name: Cow::Borrowed("mesh"),
        about: "identifier of the mesh that the object is, or is a part of; -1 for a miss and other shapes",
        components: 1,
        display: Display::Identifier,
        unit: Unit::None,
        frame: None,
        make: Make::Origin(|catalog, _, hit| of_object(hit, |object| catalog.mesh_of(object))),
    },
    Kind {
        name: Cow::Borrowed("material"),
        about: "identifier of the material; -1 for a miss and where there is none",
        components: 1,
        display: Display::Identifier,
        unit: Unit::None,
        frame: None,
        make: Make::Origin(material),
    },
    Kind {
        name: Cow::Borrowed("normal"),
        about: "geometric normal in the world, of length one, outwards; NaN for a miss",
        components: 3,
        display: Display::Direction,
        unit: Unit::None,
        frame: Some("world"),
        make: Make::Doubles(|surface, out| {
            out.copy_from_slice(&surface.normal().to_array());
        }),
    },
    Kind {
        name: Cow::Borrowed("position"),
        about: "where the hit is in the world; NaN for a miss",
        components: 3,
        display: Display::Position,
        unit: Unit::SceneLength,
        frame: Some("world"),
        make: Make::Doubles(|surface, out| {
            out.copy_from_slice(&surface.position().to_array());
        }),
    },
    Kind {
        name: Cow::Borrowed("barycentric"),
        about: "weights of the triangle's corners 0, 1, 2; NaN for a miss and for other shapes",
        components: 3,
        display: Display::Fraction,
        unit: Unit::None,
        frame: Some("triangle"),
        make: Make::Doubles(|surface, out| {
            let [b, c] = surface.hit().barycentric.to_array();
            out.copy_from_slice(&[1.0 - b - c, b, c]);
        }),
    },
    Kind {
        name: Cow::Borrowed("uv"),
        about: "texture coordinates; NaN for a miss and where there are none",
        components: 2,
        display: Display::Fraction,
        unit: Unit::None,
        frame: Some("texture"),
        make: Make::Doubles(|surface, out| {
            if let Some(uv) = surface.uv() {
                out.copy_from_slice(&uv.to_array());
            }
        }),
    },
    Kind {
        name: Cow::Borrowed("base_color"),
        about: "linear colour of the surface there, with its texture, without light; NaN for a miss",
        components: 3,
        display: Display::Fraction,
        unit: Unit::LinearColor,
        frame: None,
        make: Make::Doubles(|surface, out| {
            out.copy_from_slice(&surface.color().to_array());
        }),
    },
    Kind {
        name: Cow::Borrowed("front"),
        about: "whether the front of the surface was met; false for a miss",
        components: 1,
        display: Display::Mask,
        unit: Unit::None,
        frame: None,
        make: Make::Flag(is_front),
    },
];

// Of any lifetime, as the methods are not.
fn face(surface: &SurfaceInteraction<'_>) -> i32 {
    surface.face()
}

fn is_front(surface: &SurfaceInteraction<'_>) -> bool {
    surface.is_front()
}

fn of_object(hit: &Hit, number: impl FnOnce(usize) -> i32) -> i32 {
    usize::try_from(hit.object).map_or(-1, number)
}

fn material(catalog: &Catalog, object: &Object, hit: &Hit) -> i32 {
    let slot = object.material_slot(hit.primitive);
    let number = |slot| of_object(hit, |object| catalog.materials_of(object)[slot]);
    slot.map_or(-1, number)
}

/// The kind of that name.
///
/// # Errors
///
/// [`Error::Argument`] for a name that no kind has.
pub fn kind(name: &str) -> Result<&'static Kind> {
    let names: Vec<&str> = KINDS.iter().map(|kind| &*kind.name).collect();
    KINDS.iter().find(|kind| kind.name == name).ok_or_else(|| {
        Error::argument(
            "channel",
            "a channel's name",
            format!(
                "{name:?}; there are {}, and {ATTRIBUTE}NAME for an attribute",
                names.join(", ")
            ),
        )
    })
}

/// What the names of channels of attributes begin with.
pub const ATTRIBUTE: &str = "attribute:";

/// What a name asks for: the kind of that name, or with [`ATTRIBUTE`] before it the attribute of the meshes, see
/// [`Kind::attribute`].
///
/// # Errors
///
/// [`Error::Argument`] for a name that no kind has, and for an attribute without a name.
pub fn asked(name: &str) -> Result<Cow<'static, Kind>> {
    match name.strip_prefix(ATTRIBUTE) {
        Some("") => Err(Error::argument("channel", "an attribute's name", name)),
        Some(attribute) => Ok(Cow::Owned(Kind::attribute(attribute))),
        None => kind(name).map(Cow::Borrowed),
    }
}

impl Kind {
    /// The kind of an attribute of the meshes, as [`attribute()`] gives it. The channel's name is `attribute:` and the attribute's
    /// name, in which `_` stands for what is no letter, digit, `.`, `-` or `_` of ASCII: formats and paths do not take them all.
    /// A scene that does not have it refuses it.
    pub fn attribute(name: &str) -> Self {
        let plain = |char: char| match char {
            '.' | '-' | '_' => char,
            _ if char.is_ascii_alphanumeric() => char,
            _ => '_',
        };
        let shown: String = name.chars().take(LONGEST_NAME).map(plain).collect();
        Self {
            name: format!("{ATTRIBUTE}{shown}").into(),
            about: "attribute of the meshes that were hit; NaN for a miss and where there is none",
            components: 0,
            display: Display::Quantity,
            unit: Unit::None,
            frame: None,
            make: Make::Attribute(name.into()),
        }
    }

    /// The channel's name where a file's name has it: no system takes a colon for anything else then.
    pub fn name_in_path(&self) -> String {
        self.name.replace(':', "-")
    }

    /// The attribute's name in meshes, if it is one.
    pub fn attribute_name(&self) -> Option<&str> {
        match &self.make {
            Make::Attribute(name) => Some(name),
            _ => None,
        }
    }

    /// Fails for an attribute that no mesh of the scene has.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`], which lists those there are.
    pub fn check(&self, scene: &Scene) -> Result<()> {
        let name = self.attribute_name();
        name.map_or(Ok(()), |name| {
            attribute::components(name, None, scene).map(drop)
        })
    }

    /// Whether it takes a sensor: rays from elsewhere do not have it.
    pub fn needs_sensor(&self) -> bool {
        matches!(self.make, Make::Distance(_))
    }

    /// Whether metadata have a table of what its identifiers stand for.
    pub fn has_names(&self) -> bool {
        matches!(self.make, Make::Origin(_)) || self.name == "object"
    }

    /// Whether it takes a shader.
    pub fn needs_shade(&self) -> bool {
        matches!(self.make, Make::Color)
    }

    /// The channel of colours before a transparent background: four components, of which the last is the coverage (alpha).
    pub fn transparent_channel(&self, data: Data) -> Channel {
        let mut channel = self.channel(data);
        channel.components = 4;
        channel.description.about = "linear red, green, blue (Rec. 709), premultiplied by coverage; coverage (alpha); 0 for a miss";
        channel
    }

    /// The channel of this kind with `data`, which [`Frame::push`](crate::image::Frame::push) checks.
    pub fn channel(&self, data: Data) -> Channel {
        Channel {
            name: self.name.clone(),
            components: self.components,
            data,
            display: self.display,
            description: Description {
                about: self.about,
                unit: self.unit,
                frame: self.frame,
            },
        }
    }
}

/// So many characters of an attribute's name a channel's name has at most.
const LONGEST_NAME: usize = 100;

/// How many rays a thread takes at a time.
const CHUNK: usize = 1 << 12;

/// Channels of hits, by all threads of the current rayon pool; of few rays by the calling thread alone. Each hit is looked up
/// once for all of them. `watch` is told of every ray once.
///
/// # Errors
///
/// [`Error::Limit`] when they do not fit into memory, [`Error::Argument`] for colours, for a channel that needs a sensor where
/// there is none, and for an attribute that no mesh has, [`Error::Interrupted`] when `watch` stops it.
pub fn make(kinds: &[&Kind], shots: &Shots<'_>, watch: &dyn Watch) -> Result<Vec<Channel>> {
    let others = kinds.iter().copied();
    let others: Vec<&Kind> = others
        .filter(|kind| kind.attribute_name().is_none())
        .collect();
    let mut made = make_at_hits(&others, shots, watch)?.into_iter();
    let mut channels = Vec::with_capacity(kinds.len());
    for kind in kinds {
        let Some(name) = kind.attribute_name() else {
            channels.extend(made.next());
            continue;
        };
        let found = attribute(name, None, shots.scene, shots.hits, &Silent(watch))?;
        let mut channel = kind.channel(Data::Float64(found.values));
        channel.components = found.components;
        channels.push(channel);
    }
    if others.is_empty() && !kinds.is_empty() {
        watch.advance(shots.rays.len() as u64);
    }
    Ok(channels)
}

/// Stops as the other, and tells it nothing.
struct Silent<'a>(&'a dyn Watch);

impl Watch for Silent<'_> {
    fn is_stopped(&self) -> bool {
        self.0.is_stopped()
    }
}

/// The channels that are no attributes.
fn make_at_hits(kinds: &[&Kind], shots: &Shots<'_>, watch: &dyn Watch) -> Result<Vec<Channel>> {
    for kind in kinds {
        let is_made_elsewhere = matches!(kind.make, Make::Color | Make::Elsewhere);
        if is_made_elsewhere || (kind.needs_sensor() && shots.sensor.is_none()) {
            let expected = "one that rays without a camera have";
            return Err(Error::argument("channel", expected, &*kind.name));
        }
    }
    let count = shots.rays.len();
    let made = kinds.iter().map(|kind| kind.missed(count));
    let mut made = made.collect::<Result<Vec<Data>>>()?;
    if kinds.is_empty() {
        return Ok(Vec::new());
    }
    let mut chunks: Vec<Vec<Part<'_>>> = Vec::new();
    for (kind, data) in kinds.iter().zip(&mut made) {
        for (index, part) in Part::chunks(kind, data).into_iter().enumerate() {
            if index == chunks.len() {
                chunks.push(Vec::with_capacity(kinds.len()));
            }
            chunks[index].push(part);
        }
    }
    let fill = |(index, parts): (usize, &mut Vec<Part<'_>>)| {
        if watch.is_stopped() {
            return Err(Error::Interrupted);
        }
        let first = index * CHUNK;
        let count = (count - first).min(CHUNK);
        fill(shots, first, count, parts);
        watch.advance(count as u64);
        Ok(())
    };
    if chunks.len() == 1 {
        chunks.iter_mut().enumerate().try_for_each(fill)?;
    } else {
        chunks.par_iter_mut().enumerate().try_for_each(fill)?;
    }
    drop(chunks);
    let channels = kinds.iter().zip(made);
    Ok(channels.map(|(kind, data)| kind.channel(data)).collect())
}

impl Kind {
    /// The channel of so many misses.
    fn missed(&self, count: usize) -> Result<Data> {
        Ok(match self.make {
            Make::T | Make::Distance(_) => Data::Float64(filled(count, f64::INFINITY)?),
            Make::Doubles(_) => {
                Data::Float64(filled(count.saturating_mul(self.components), f64::NAN)?)
            }
            Make::Identifier(_) | Make::Origin(_) | Make::Integer(_) => {
                Data::Int32(filled(count, -1)?)
            }
            Make::Flag(_) => Data::Bool(filled(count, false)?),
            Make::Color | Make::Attribute(_) | Make::Elsewhere => {
                return Err(Error::argument(
                    "channel",
                    "one without a shader",
                    &*self.name,
                ));
            }
        })
    }
}

/// A chunk of a channel, being made.
enum Part<'a> {
    T(&'a mut [f64]),
    Doubles(
        fn(&SurfaceInteraction<'_>, &mut [f64]),
        usize,
        &'a mut [f64],
    ),
    Identifier(fn(&Hit) -> i32, &'a mut [i32]),
    Origin(fn(&Catalog, &Object, &Hit) -> i32, &'a mut [i32]),
    Integer(fn(&SurfaceInteraction<'_>) -> i32, &'a mut [i32]),
    Flag(fn(&SurfaceInteraction<'_>) -> bool, &'a mut [bool]),
    Distance(usize, &'a mut [f64]),
}

impl<'a> Part<'a> {
    /// The chunks of a channel.
    fn chunks(kind: &Kind, data: &'a mut Data) -> Vec<Self> {
        let components = kind.components;
        match (data, &kind.make) {
            (Data::Float64(values), Make::T) => values.chunks_mut(CHUNK).map(Self::T).collect(),
            (Data::Float64(values), &Make::Distance(which)) => {
                let parts = values.chunks_mut(CHUNK);
                parts.map(|part| Self::Distance(which, part)).collect()
            }
            (Data::Float64(values), &Make::Doubles(value)) => {
                let parts = values.chunks_mut(CHUNK * components);
                let part = |part| Self::Doubles(value, components, part);
                parts.map(part).collect()
            }
            (Data::Int32(values), &Make::Identifier(value)) => {
                let parts = values.chunks_mut(CHUNK);
                parts.map(|part| Self::Identifier(value, part)).collect()
            }
            (Data::Int32(values), &Make::Origin(value)) => {
                let parts = values.chunks_mut(CHUNK);
                parts.map(|part| Self::Origin(value, part)).collect()
            }
            (Data::Int32(values), &Make::Integer(value)) => {
                let parts = values.chunks_mut(CHUNK);
                parts.map(|part| Self::Integer(value, part)).collect()
            }
            (Data::Bool(values), &Make::Flag(value)) => {
                let parts = values.chunks_mut(CHUNK);
                parts.map(|part| Self::Flag(value, part)).collect()
            }
            _ => unreachable!("`missed` makes the data that the kind asks for"),
        }
    }

    /// Whether it needs to know more than the hit.
    fn needs_surface(&self) -> bool {
        matches!(self, Self::Doubles(..) | Self::Integer(..) | Self::Flag(..))
    }
}

/// Fills the parts of channels that belong to `count` rays from `first` on, where they hit something.
fn fill(shots: &Shots<'_>, first: usize, count: usize, parts: &mut [Part<'_>]) {
    let needs_surface = parts.iter().any(Part::needs_surface);
    let has_origin = parts.iter().any(|part| matches!(part, Part::Origin(..)));
    let catalog = has_origin.then(|| shots.scene.catalog());
    for k in 0..count {
        let hit = shots.hits.get(first + k);
        if hit.is_miss() {
            continue;
        }
        let ray = needs_surface.then(|| shots.rays.ray(first + k));
        let surface = ray
            .as_ref()
            .and_then(|ray| shots.scene.interaction(ray, &hit));
        for part in &mut *parts {
            match part {
                Part::T(out) => out[k] = hit.t,
                Part::Identifier(value, out) => out[k] = value(&hit),
                Part::Origin(value, out) => {
                    if let (Some(object), Some(catalog)) = (shots.scene.object(&hit), catalog) {
                        out[k] = value(catalog, object, &hit);
                    }
                }
                Part::Distance(which, out) => {
                    if let Some(sensor) = shots.sensor {
                        out[k] = sensor.range_and_z(first + k, hit.t)[*which];
                    }
                }
                Part::Doubles(value, components, out) => {
                    if let Some(surface) = &surface {
                        value(surface, &mut out[k * *components..][..*components]);
                    }
                }
                Part::Integer(value, out) => {
                    if let Some(surface) = &surface {
                        out[k] = value(surface);
                    }
                }
                Part::Flag(value, out) => {
                    if let Some(surface) = &surface {
                        out[k] = value(surface);
                    }
                }
            }
        }
    }
}

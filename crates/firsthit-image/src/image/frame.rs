use std::borrow::Cow;
use std::fmt::{self, Debug, Formatter};
use std::ops::Range;

use super::origin::Origin;
use crate::error::{Error, Result};
use crate::geometry::single;
use crate::geometry::summary::{Count, summary};

/// The result of a picture or a batch of rays: named channels over the same elements.
///
/// Elements are in row-major order; row 0 of a picture is its top.
///
/// ```
/// use firsthit::{DVec3, Object, Render, Scene, Sphere, image::Data};
///
/// let scene = Scene::new(vec![Object::new(Sphere::new(DVec3::ZERO, 1.0)?)])?;
/// let frame = Render::new(&scene).size(30, 40).channels(&["color", "object"]).frame()?;
/// let Some(Data::Int32(object)) = frame.channel("object").map(|channel| &channel.data) else {
///     unreachable!("identifiers are whole numbers")
/// };
/// assert_eq!((object[0], object[15 * 40 + 20]), (-1, 0));
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Clone)]
pub struct Frame {
    pub(super) shape: Vec<usize>,
    pub(super) channels: Vec<Channel>,
    pub(super) origin: Origin,
}

/// One named output: the same number of values for every element of its [`Frame`].
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// The name in files and in interfaces, unique in its frame.
    pub name: Cow<'static, str>,
    /// The number of values of each element, at least 1.
    pub components: usize,
    /// The values: all components of element 0, then those of element 1.
    pub data: Data,
    /// The colour scale in a PNG.
    pub display: Display,
    /// The description, for readers of the file.
    pub description: Description,
}

/// The meaning of a [`Channel`]'s values, for its metadata.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Description {
    /// One line: the meaning, and the value of a miss.
    pub about: &'static str,
    /// The unit of its numbers.
    pub unit: Unit,
    /// The frame of its numbers: `world`, `camera`, `ray`, `triangle` or `texture`.
    pub frame: Option<&'static str>,
}

/// The unit of a channel's numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Unit {
    /// No unit: identifiers, fractions, vectors of length one.
    #[default]
    None,
    /// Linear light with Rec. 709 primaries, 1 being a white surface in full light.
    LinearColor,
    /// The scene's own unit of length.
    SceneLength,
    /// Lengths of the ray's direction: for a camera's rays, which have length one, the scene's
    /// unit.
    DirectionLength,
    /// Angles in radians.
    Radian,
    /// Times in seconds.
    Second,
}

/// The values of a [`Channel`], as they are stored in files.
#[derive(Clone, PartialEq)]
pub enum Data {
    /// Double precision.
    Float64(Vec<f64>),
    /// Single precision.
    Float32(Vec<f32>),
    /// Identifiers; -1 is a miss.
    Int32(Vec<i32>),
    /// Yes or no.
    Bool(Vec<bool>),
}

/// The colours of a [`Channel`] in a PNG, by the kind of its values. `docs/outputs.md` has the
/// formulas.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Display {
    /// Linear colours, three floats, shown as sRGB; or four, premultiplied by the last, the
    /// coverage (alpha) from 0 to 1.
    Color,
    /// Distances, one float: from near, yellow, to far, violet.
    Distance,
    /// Identifiers, one int32: each in its own colour.
    Identifier,
    /// Unit vectors, three floats: `(n + 1) / 2` as red, green, blue.
    Direction,
    /// Points, three floats: each axis from its smallest to its largest value as red, green, blue.
    Position,
    /// One to three floats between 0 and 1, such as barycentrics: the bytes directly.
    Fraction,
    /// Booleans, one each: white where true.
    Mask,
    /// Any numbers of floats. One to three make a picture, each from its smallest to its largest
    /// value: one in the colours of a distance, two as red and green, three as red, green and blue.
    Quantity,
    /// Cryptomatte, an even number of float32: pairs of an identifier and its share of the pixel.
    /// It is no picture.
    Matte,
}

summary!(Frame, "Frame", |it| "shape": it.shape, "channels": ByName(&it.channels));

struct ByName<'a>(&'a [Channel]);

impl Debug for ByName<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let channels = self.0.iter();
        let channels = channels.map(|channel| (&channel.name, &channel.data));
        f.debug_map().entries(channels).finish()
    }
}

/// A summary: values are many.
impl Debug for Data {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        Count(self.len(), self.kind()).fmt(f)
    }
}

impl Frame {
    /// A frame without channels: `[rows, columns]` of a picture, `[n]` of a batch, or any other
    /// shape.
    pub fn new(shape: impl Into<Vec<usize>>) -> Self {
        Self { shape: shape.into(), channels: Vec::new(), origin: Origin::default() }
    }

    /// The frame with another origin.
    pub fn from_origin(self, origin: Origin) -> Self {
        Self { origin, ..self }
    }

    /// The scene and the camera that the frame comes from.
    pub fn origin(&self) -> &Origin {
        &self.origin
    }

    /// Adds `channel` after the others.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if its name is taken, if its length is not the frame's number of
    /// elements times its components, or if its values cannot be what its picture says.
    pub fn push(&mut self, channel: Channel) -> Result<()> {
        let (name, of) = (&*channel.name, channel.argument());
        if self.channel(name).is_some() {
            let expected = "a channel whose name the frame does not have yet";
            return Err(Error::argument("channel", expected, name));
        }
        if !channel.display.fits(&channel) {
            let expected = "of the type and the number of components that its display asks for";
            let (kind, display) = (channel.data.kind(), channel.display);
            let got = format!("{} {kind} as {display:?}", channel.components);
            return Err(Error::argument(of, expected, got));
        }
        // A shape whose product overflows has no data that could match it.
        let values =
            (self.shape.iter()).try_fold(channel.components, |n, &side| n.checked_mul(side));
        if values != Some(channel.data.len()) {
            let expected = "as long as the frame's elements times the channel's components";
            let got = format!(
                "{} values for {} of each element of {:?}",
                channel.data.len(),
                channel.components,
                self.shape
            );
            return Err(Error::argument(of, expected, got));
        }
        self.channels.push(channel);
        Ok(())
    }

    /// `[rows, columns]` of a picture, `[n]` of a batch.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// All channels, in the order in which they were added.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The channels, taken out of the frame.
    pub fn into_channels(self) -> Vec<Channel> {
        self.channels
    }

    /// A frame of the named channels, in that order. A channel for which `is_last` holds is taken
    /// out of this frame; the others are copied. After an error some may have been taken already.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a name that no channel has.
    pub fn select(&mut self, names: &[&str], is_last: impl Fn(&str) -> bool) -> Result<Self> {
        let mut frame = Self::new(self.shape.clone()).from_origin(self.origin.clone());
        for &name in names {
            let place = self.channels.iter().position(|channel| channel.name == name);
            let missing = || Error::argument("channel", "one of the frame", name);
            let place = place.ok_or_else(missing)?;
            frame.push(if is_last(name) {
                self.channels.remove(place)
            } else {
                self.channels[place].clone()
            })?;
        }
        Ok(frame)
    }

    /// The frame with float32 numbers in place of float64 ones: the nearest, but finite for finite
    /// ones, and zero for zero alone. So a hit does not become a miss.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`] when there is no memory for them.
    pub fn rounded(mut self) -> Result<Self> {
        for channel in &mut self.channels {
            if let Data::Float64(values) = &channel.data {
                let mut rounded = Data::Float32(Vec::new());
                rounded.reserve(values.len(), 1)?;
                if let Data::Float32(singles) = &mut rounded {
                    singles.extend(values.iter().map(|&value| distance(value)));
                }
                channel.data = rounded;
            }
        }
        Ok(self)
    }

    /// The channel called `name`.
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.name == name)
    }
}

/// See [`Frame::rounded`].
fn distance(value: f64) -> f32 {
    let rounded = single(value);
    if rounded.is_infinite() && value.is_finite() {
        f32::MAX.copysign(rounded)
    } else if rounded == 0.0 && value != 0.0 {
        f32::from_bits(1).copysign(rounded)
    } else {
        rounded
    }
}

impl Channel {
    /// A channel without a description. [`Frame::push`] checks that all four fit together.
    pub fn new(
        name: impl Into<Cow<'static, str>>,
        components: usize,
        data: Data,
        display: Display,
    ) -> Self {
        Self { name: name.into(), components, data, display, description: Description::default() }
    }

    /// The name of the channel in errors.
    pub(super) fn argument(&self) -> &'static str {
        match self.name {
            Cow::Borrowed(name) => name,
            Cow::Owned(_) => "channel",
        }
    }

    /// The value of a miss, in the words of the metadata.
    pub fn miss(&self) -> &'static str {
        if self.is_transparent() {
            "transparent"
        } else {
            match &*self.name {
                // They are about pixels, whatever their rays meet.
                "valid" | "alpha" | "ao" | "edge" | "samples" => "any",
                _ => self.display.miss(),
            }
        }
    }

    /// Whether these are colours with coverage (alpha).
    pub fn is_transparent(&self) -> bool {
        self.display == Display::Color && self.components == 4
    }
}

impl Data {
    /// Makes room for the values of `count` rays, each of `components` numbers.
    ///
    /// # Errors
    ///
    /// [`Error::Limit`] when there is no memory for them.
    #[doc(hidden)]
    pub fn reserve(&mut self, count: usize, components: usize) -> Result<()> {
        let more = count.saturating_mul(components).saturating_sub(self.len());
        let reserved = match self {
            Self::Float64(values) => values.try_reserve_exact(more),
            Self::Float32(values) => values.try_reserve_exact(more),
            Self::Int32(values) => values.try_reserve_exact(more),
            Self::Bool(values) => values.try_reserve_exact(more),
        };
        reserved.map_err(|_| Error::Limit {
            what: "elements of a result",
            got: more.to_string(),
            limit: "the memory there is".into(),
        })
    }

    /// Appends values of the same type.
    #[doc(hidden)]
    pub fn append(&mut self, other: Self) {
        match (self, other) {
            (Self::Float64(values), Self::Float64(more)) => values.extend(more),
            (Self::Float32(values), Self::Float32(more)) => values.extend(more),
            (Self::Int32(values), Self::Int32(more)) => values.extend(more),
            (Self::Bool(values), Self::Bool(more)) => values.extend(more),
            (values, more) => panic!("{} after {}", more.kind(), values.kind()),
        }
    }

    /// The number of values: elements times components.
    pub fn len(&self) -> usize {
        match self {
            Self::Float64(values) => values.len(),
            Self::Float32(values) => values.len(),
            Self::Int32(values) => values.len(),
            Self::Bool(values) => values.len(),
        }
    }

    /// Whether there is no value.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The NumPy name of the values' type.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Float64(_) => "float64",
            Self::Float32(_) => "float32",
            Self::Int32(_) => "int32",
            Self::Bool(_) => "bool",
        }
    }

    /// One value as float64, which holds every type here exactly; true is 1.
    ///
    /// # Panics
    ///
    /// Where `index` is not below [`len`](Self::len).
    pub fn value(&self, index: usize) -> f64 {
        match self {
            Self::Float64(values) => values[index],
            Self::Float32(values) => f64::from(values[index]),
            Self::Int32(values) => f64::from(values[index]),
            Self::Bool(values) => f64::from(u8::from(values[index])),
        }
    }

    /// Puts some values into `to`, in place of what it has, each as [`value`](Self::value) gives
    /// it.
    pub(super) fn read(&self, range: Range<usize>, to: &mut Vec<f64>) {
        to.clear();
        match self {
            Self::Float64(values) => to.extend_from_slice(&values[range]),
            Self::Float32(values) => to.extend(values[range].iter().map(|&x| f64::from(x))),
            Self::Int32(values) => to.extend(values[range].iter().map(|&x| f64::from(x))),
            Self::Bool(values) => to.extend(values[range].iter().map(|&x| f64::from(u8::from(x)))),
        }
    }
}

impl Unit {
    /// The name in metadata, for rays of a camera or for others.
    pub fn name(self, has_camera: bool) -> Option<&'static str> {
        match self {
            Self::None => None,
            Self::LinearColor => Some("linear Rec. 709"),
            Self::DirectionLength if !has_camera => Some("length of the ray's direction"),
            Self::SceneLength | Self::DirectionLength => Some("scene length"),
            Self::Radian => Some("radian"),
            Self::Second => Some("second"),
        }
    }
}

impl Display {
    /// The value of a miss, in the words of the metadata.
    pub fn miss(self) -> &'static str {
        match self {
            Self::Color => "background",
            Self::Distance => "inf",
            Self::Identifier => "-1",
            Self::Direction | Self::Position | Self::Fraction | Self::Quantity => "nan",
            Self::Mask => "false",
            Self::Matte => "0",
        }
    }

    /// Whether `channel`'s type and number of components make this kind of picture.
    fn fits(self, channel: &Channel) -> bool {
        let floats = matches!(channel.data, Data::Float64(_) | Data::Float32(_));
        match self {
            Self::Color => floats && matches!(channel.components, 3 | 4),
            Self::Direction | Self::Position => floats && channel.components == 3,
            Self::Distance => floats && channel.components == 1,
            Self::Quantity => {
                let counts = matches!(channel.data, Data::Int32(_));
                (floats || counts) && channel.components > 0
            }
            Self::Fraction => floats && (1..=3).contains(&channel.components),
            Self::Identifier => matches!(channel.data, Data::Int32(_)) && channel.components == 1,
            Self::Mask => matches!(channel.data, Data::Bool(_)) && channel.components == 1,
            Self::Matte => {
                let is_even = channel.components > 0 && channel.components.is_multiple_of(2);
                matches!(channel.data, Data::Float32(_)) && is_even
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_come_back_by_name_and_in_order() {
        let mut frame = Frame::new([2, 3]);
        let t = Channel::new("t", 1, Data::Float64(vec![1.0; 6]), Display::Distance);
        let object = Channel::new("object", 1, Data::Int32(vec![-1; 6]), Display::Identifier);
        frame.push(t.clone()).unwrap();
        frame.push(object.clone()).unwrap();
        assert_eq!(frame.channels(), [t, object.clone()]);
        assert_eq!(frame.channel("object"), Some(&object));
        assert_eq!(frame.channel("color"), None);
        assert_eq!(frame.shape(), [2, 3]);
    }

    #[test]
    fn a_channel_that_does_not_fit_is_refused_with_its_numbers() {
        let mut frame = Frame::new([2, 3]);
        let short = Channel::new("color", 3, Data::Float32(vec![0.0; 17]), Display::Color);
        assert_eq!(
            frame.push(short).unwrap_err().to_string(),
            "color must be as long as the frame's elements times the channel's components, \
             got 17 values for 3 of each element of [2, 3]"
        );
        let whole = Channel::new("front", 1, Data::Int32(vec![0; 6]), Display::Mask);
        assert_eq!(
            frame.push(whole).unwrap_err().to_string(),
            "front must be of the type and the number of components that its display asks for, \
             got 1 int32 as Mask"
        );
        let front = Channel::new("front", 1, Data::Bool(vec![true; 6]), Display::Mask);
        frame.push(front.clone()).unwrap();
        assert!(frame.push(front).is_err(), "the name is taken");
    }

    #[test]
    fn a_shape_that_overflows_is_refused_not_wrapped() {
        let mut frame = Frame::new([usize::MAX, 2]);
        let empty = Channel::new("t", 1, Data::Float64(vec![]), Display::Distance);
        assert!(frame.push(empty).is_err());
    }
}

//! Parses names of channels: rows of the table, and attributes of the meshes.

use std::borrow::Cow;

use super::attribute::components;
use super::{ChannelKind, Make, kind};
use crate::error::{Error, Result};
use crate::image::{Data, Display, Unit};
use crate::scene::Scene;

/// Stands for the channel's name in the name of a file.
pub const PLACEHOLDER: &str = "{channel}";

/// The prefix of channels of attributes.
pub const ATTRIBUTE: &str = "attribute:";

/// The default number of pairs of an identifier and its coverage in a Cryptomatte.
pub const MATTE_RANKS: usize = 6;

/// The most that can be asked for.
const MOST_RANKS: usize = 64;

/// The kind of a channel's name; a Cryptomatte with another number of pairs, as in
/// `crypto_object:8`; ambient occlusion up to a distance, as in `ao:0.5`; or with [`ATTRIBUTE`]
/// before it the attribute of the meshes, see [`ChannelKind::attribute`].
///
/// # Errors
///
/// [`Error::Argument`] for a name that no kind has, for an attribute without a name, and for a
/// number of pairs that is odd or not from 2 to 64.
pub fn asked(name: &str) -> Result<Cow<'static, ChannelKind>> {
    if let Some((name, ranks)) = name.split_once(':')
        && let Some(kind) = kind(name).ok().filter(|kind| kind.matte().is_some())
    {
        return kind.with_ranks(ranks).map(Cow::Owned);
    }
    if let Some((name, reach)) = name.split_once(':')
        && let Some(kind) = kind(name).ok().filter(|kind| kind.occlusion().is_some())
    {
        return kind.with_reach(reach).map(Cow::Owned);
    }
    match name.strip_prefix(ATTRIBUTE) {
        Some("") => Err(Error::argument("channel", "an attribute's name", name)),
        Some(attribute) => Ok(Cow::Owned(ChannelKind::attribute(attribute))),
        None => kind(name).map(Cow::Borrowed),
    }
}

impl ChannelKind {
    /// The Cryptomatte with another number of pairs. Two make a layer of an EXR.
    fn with_ranks(&self, ranks: &str) -> Result<Self> {
        let count = ranks.parse().ok();
        let count = count.filter(|count| (2..=MOST_RANKS).contains(count) && count % 2 == 0);
        let expected = "a Cryptomatte of an even number of pairs from 2 to 64";
        let got = || format!("{}:{ranks}", self.name);
        let count = count.ok_or_else(|| Error::argument("channel", expected, got()))?;
        Ok(Self { components: 2 * count, ..self.clone() })
    }

    /// The ambient occlusion up to a distance.
    fn with_reach(&self, reach: &str) -> Result<Self> {
        let length = reach.parse().ok().filter(|&reach: &f64| reach > 0.0);
        let expected = "ambient occlusion up to a positive distance, such as ao:0.5";
        let got = || format!("{}:{reach}", self.name);
        let length = length.ok_or_else(|| Error::argument("channel", expected, got()))?;
        Ok(Self { make: Make::Occlusion(length), ..self.clone() })
    }

    /// The kind of an attribute of the meshes, as [`attribute()`](super::attribute()) gives it. The
    /// channel's name is `attribute:` and the attribute's name, in which `_` stands for what is no
    /// letter, digit, `.`, `-` or `_` of ASCII: formats and paths do not take them all. A scene
    /// that does not have it refuses it.
    pub fn attribute(name: &str) -> Self {
        Self {
            name: format!("{ATTRIBUTE}{}", shown(name)).into(),
            about: "attribute of the meshes that were hit; NaN for a miss and where there is none",
            components: 0,
            display: Display::Quantity,
            unit: Unit::None,
            frame: None,
            make: Make::Attribute(name.into()),
        }
    }

    /// The kind of numbers of one's own, which are no channel of hits, under a name of one's own,
    /// with `_` as in that of an [`attribute`](Self::attribute).
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for a name that asks for a channel, even for one that there is not, and
    /// for an empty one.
    pub fn own(name: &str, data: &Data) -> Result<Self> {
        let (first, _) = name.split_once(':').unwrap_or((name, ""));
        if name.is_empty() || name.starts_with(ATTRIBUTE) || kind(first).is_ok() {
            let expected = "a name that is not empty, and not that of a channel";
            return Err(Error::argument("channel", expected, name));
        }
        Ok(Self {
            name: shown(name).into(),
            about: "numbers of one's own",
            components: 0,
            display: match data {
                Data::Bool(_) => Display::Mask,
                _ => Display::Quantity,
            },
            unit: Unit::None,
            frame: None,
            make: Make::Elsewhere,
        })
    }

    /// The channel's name where a file's name has it: no system takes a colon for anything else
    /// then.
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
        name.map_or(Ok(()), |name| components(name, None, scene).map(drop))
    }
}

/// A name in the characters that all formats and paths take.
fn shown(name: &str) -> String {
    let plain = |char: char| match char {
        '.' | '-' | '_' => char,
        _ if char.is_ascii_alphanumeric() => char,
        _ => '_',
    };
    name.chars().take(LONGEST_NAME).map(plain).collect()
}

/// The most characters of an attribute's name in a channel's name.
const LONGEST_NAME: usize = 100;

//! Cryptomatte: identifiers of names, and what a file says of them.
//!
//! After Friedman and Jones, "Fully Automatic ID Mattes with Support for Motion Blur and
//! Transparency", SIGGRAPH 2015 posters, and the specification of Psyop, version 1.2. A channel has
//! pairs of an identifier and the share of the pixel's samples that it covers, the largest first.
//! An identifier is the hash of a name, as the bits of a float32.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::error::escape_json;

/// The entries of a file's metadata for a channel of mattes, as the specification has them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Cryptomatte {
    /// The name of the layers of an EXR, such as `CryptoObject`.
    pub name: String,
    /// The hash that turns names into whole numbers: `MurmurHash3_32`.
    pub hash: String,
    /// The conversion of whole numbers to floats: `uint32_to_float32`.
    pub conversion: String,
    /// The identifier of every name, as eight hexadecimal digits.
    pub manifest: BTreeMap<String, String>,
}

impl Cryptomatte {
    /// The entries for a channel, with these names in the manifest.
    pub fn new(channel: &str, names: impl IntoIterator<Item = impl Into<String>>) -> Self {
        let entry = |name: String| {
            let id = format!("{:08x}", matte_id(&name));
            (name, id)
        };
        Self {
            name: layers(channel),
            hash: "MurmurHash3_32".to_owned(),
            conversion: "uint32_to_float32".to_owned(),
            manifest: names.into_iter().map(|name| entry(name.into())).collect(),
        }
    }

    /// The attributes of an EXR: names and texts.
    #[cfg(feature = "exr")]
    pub(super) fn attributes(&self) -> [(String, String); 4] {
        let key = &format!("{:08x}", murmur3(self.name.as_bytes()))[..7];
        let manifest = serde_json::to_string(&self.manifest).expect("texts are JSON");
        [
            ("name", self.name.clone()),
            ("hash", self.hash.clone()),
            ("conversion", self.conversion.clone()),
            ("manifest", ascii(&manifest)),
        ]
        .map(|(what, text)| (format!("cryptomatte/{key}/{what}"), text))
    }
}

/// The name of a channel's component in an EXR: two pairs make a layer of red, green, blue and
/// alpha.
#[cfg(feature = "exr")]
pub(super) fn plane_name(layers: &str, component: usize) -> String {
    let letter = ["R", "G", "B", "A"][component % 4];
    format!("{layers}{:02}.{letter}", component / 4)
}

/// The name of a channel's layers in an EXR: `CryptoObject` of `crypto_object`.
pub(super) fn layers(channel: &str) -> String {
    let mut name = String::new();
    for word in channel.split('_') {
        let mut letters = word.chars();
        name.extend(letters.next().map(|first| first.to_ascii_uppercase()));
        name.extend(letters);
    }
    name
}

/// The identifier of a name: the bits of a float32 that is neither zero, subnormal, infinite nor
/// NaN, so that every program keeps it.
///
/// ```
/// assert_eq!(firsthit::image::matte_id("bunny"), 0x1385_1a76);
/// ```
pub fn matte_id(name: &str) -> u32 {
    let hash = murmur3(name.as_bytes());
    let exponent = hash >> 23 & 255;
    if exponent == 0 || exponent == 255 { hash ^ 1 << 23 } else { hash }
}

/// `MurmurHash3_x86_32` of Appleby, with the seed 0.
fn murmur3(bytes: &[u8]) -> u32 {
    let mixed = |word: u32| {
        let word = word.wrapping_mul(0xcc9e_2d51).rotate_left(15);
        word.wrapping_mul(0x1b87_3593)
    };
    let (words, rest) = bytes.as_chunks::<4>();
    let mut hash = 0_u32;
    for word in words {
        hash ^= mixed(u32::from_le_bytes(*word));
        hash = hash.rotate_left(13).wrapping_mul(5).wrapping_add(0xe654_6b64);
    }
    // Of no bytes it is zero, and changes nothing.
    let mut last = [0; 4];
    last[..rest.len()].copy_from_slice(rest);
    hash ^= mixed(u32::from_le_bytes(last));
    #[expect(clippy::cast_possible_truncation, reason = "the hash takes the length modulo 2^32")]
    let length = bytes.len() as u32;
    hash ^= length;
    hash = (hash ^ hash >> 16).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35);
    hash ^ hash >> 16
}

/// JSON whose characters beyond ASCII are escaped: texts of an EXR have one byte for each.
pub(super) fn ascii(json: &str) -> String {
    escape_json(json, |c| !c.is_ascii())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The hashes that implementations are checked with, and `bunny` and `default` of the
    /// specification's example.
    #[test]
    fn hashes_are_those_of_murmur3() {
        for (text, hash) in [
            ("", 0),
            ("test", 0xba6b_d213),
            ("Hello, world!", 0xc036_3e43),
            ("The quick brown fox jumps over the lazy dog", 0x2e4f_f723),
            ("hello", 0x248b_fa47),
            ("bunny", 0x1385_1a76),
            ("default", 0x42c9_679f),
        ] {
            assert_eq!(murmur3(text.as_bytes()), hash, "{text}");
        }
    }

    #[test]
    fn identifiers_are_ordinary_floats() {
        let mut flipped = 0;
        for k in 0..3000 {
            let name = format!("object_{k}");
            let id = matte_id(&name);
            assert!(f32::from_bits(id).is_normal(), "{name}");
            let hash = murmur3(name.as_bytes());
            assert!(id == hash || id == hash ^ 1 << 23);
            flipped += usize::from(id != hash);
        }
        // Two of 256 exponents.
        assert!((10..40).contains(&flipped), "{flipped}");
        assert_eq!(matte_id(""), 1 << 23);
    }

    #[cfg(feature = "exr")]
    #[test]
    fn attributes_and_layers_have_the_names_of_the_specification() {
        let said = Cryptomatte::new("crypto_object", ["bunny", "ça"]);
        let [name, hash, conversion, manifest] = said.attributes();
        assert_eq!(name, ("cryptomatte/3ae39a5/name".into(), "CryptoObject".into()));
        assert_eq!(hash.1, "MurmurHash3_32");
        assert_eq!(conversion.1, "uint32_to_float32");
        assert_eq!(manifest.0, "cryptomatte/3ae39a5/manifest");
        let read: BTreeMap<String, String> = serde_json::from_str(&manifest.1).unwrap();
        assert!(manifest.1.is_ascii());
        assert_eq!(read, said.manifest);
        assert_eq!(read["bunny"], "13851a76");
        let planes = [0, 3, 4, 11].map(|k| plane_name("CryptoObject", k));
        assert_eq!(
            planes,
            ["CryptoObject00.R", "CryptoObject00.A", "CryptoObject01.R", "CryptoObject02.A"]
        );
    }
}

//! Cryptomatte: which objects or materials the samples of a pixel meet, and how many of them each.

use crate::channel::{ChannelKind, Matte};
use crate::error::Result;
use crate::geometry::Hit;
use crate::image::{Cryptomatte, Data, matte_id};
use crate::memory::{filled, zeroed};
use crate::parallel;
use crate::scene::{Object, Scene};
use crate::shoot::Hits;

/// The number of pixels that a thread takes at a time.
const CHUNK: usize = 1 << 12;

/// The counts of one channel.
pub(super) struct Mattes {
    of: Matte,
    /// The matte identifiers, by the number of an object or a material.
    ids: Vec<u32>,
    pixels: Vec<PixelShares>,
}

/// The shares of objects or materials in the samples of a pixel so far. Most pixels meet one thing,
/// and need no more memory.
#[derive(Clone, Default)]
struct PixelShares {
    first: Share,
    others: Vec<Share>,
}

/// An identifier and the number of samples that met it; none before the first.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
struct Share {
    id: u32,
    count: u32,
}

impl PixelShares {
    fn add(&mut self, id: u32) {
        if self.first.count == 0 {
            self.first.id = id;
        }
        if self.first.id == id {
            self.first.count += 1;
            return;
        }
        match self.others.iter_mut().find(|share| share.id == id) {
            Some(share) => share.count += 1,
            None => self.others.push(Share { id, count: 1 }),
        }
    }

    /// Pairs of an identifier, as a float's bits, and its share of the samples: the largest first,
    /// of equal ones the lower identifier. Pairs without room are left out.
    fn write(&self, samples: u32, out: &mut [f32]) {
        let mut all = self.others.clone();
        all.extend((self.first.count > 0).then_some(self.first));
        all.sort_by_key(|share| (std::cmp::Reverse(share.count), share.id));
        let (pairs, _) = out.as_chunks_mut::<2>();
        for (pair, share) in pairs.iter_mut().zip(all) {
            *pair = [f32::from_bits(share.id), portion(share.count, samples)];
        }
    }
}

/// A share of the samples, rounded towards zero: so the sum of a pixel's is one at most.
#[expect(clippy::cast_possible_truncation, reason = "it is rounded")]
fn portion(count: u32, samples: u32) -> f32 {
    let exact = f64::from(count) / f64::from(samples);
    let nearest = exact as f32;
    if f64::from(nearest) > exact { nearest.next_down() } else { nearest }
}

impl Mattes {
    /// The mattes of a channel, if it is one of mattes, for `pixels` pixels.
    pub(super) fn new(kind: &ChannelKind, scene: &Scene, pixels: usize) -> Result<Option<Self>> {
        let Some(of) = kind.matte() else {
            return Ok(None);
        };
        let ids = names(scene, of).map(|name| matte_id(&name));
        Ok(Some(Self { of, ids: ids.collect(), pixels: filled(pixels, PixelShares::default())? }))
    }

    /// Counts what a sample of each pixel met.
    pub(super) fn add(&mut self, scene: &Scene, hits: &Hits) {
        let (of, ids) = (self.of, &self.ids);
        let chunks = self.pixels.chunks_mut(CHUNK).enumerate();
        parallel::each(chunks, |(chunk, pixels)| {
            for (index, pixel) in (chunk * CHUNK..).zip(pixels) {
                let number = number(scene, of, &hits.get(index));
                if let Some(&id) = number.and_then(|number| ids.get(number)) {
                    pixel.add(id);
                }
            }
        });
    }

    /// The values of the channel, `components` for each pixel.
    pub(super) fn data(&self, components: usize, samples: u32) -> Result<Data> {
        let mut data = zeroed::<f32>(self.pixels.len().saturating_mul(components))?;
        let pixels = self.pixels.chunks(CHUNK);
        let chunks = data.chunks_mut(CHUNK * components).zip(pixels);
        parallel::each(chunks, |(out, pixels)| {
            for (out, pixel) in out.chunks_mut(components).zip(pixels) {
                pixel.write(samples, out);
            }
        });
        Ok(Data::Float32(data))
    }
}

/// The number of the object or the material that is met.
fn number(scene: &Scene, of: Matte, hit: &Hit) -> Option<usize> {
    let object = usize::try_from(hit.object).ok()?;
    match of {
        Matte::Object => Some(object),
        Matte::Material => {
            let of_object = scene.object(hit)?;
            let material = scene.catalog().material_of(object, of_object, hit.primitive);
            usize::try_from(material).ok()
        }
    }
}

/// The name of every object or material, by its number. Those without one are called after the
/// number.
fn names(scene: &Scene, of: Matte) -> Box<dyn Iterator<Item = String> + '_> {
    let named = move |(number, name): (usize, &str)| {
        if name.is_empty() { format!("{}_{number}", of.name()) } else { name.to_owned() }
    };
    match of {
        Matte::Object => {
            let objects = scene.objects().iter();
            Box::new(objects.map(Object::name).enumerate().map(named))
        }
        Matte::Material => {
            let materials = scene.catalog().materials().iter();
            Box::new(materials.map(|name| &**name).enumerate().map(named))
        }
    }
}

/// The metadata of a channel, with its name, if it is one of mattes.
pub(super) fn record(scene: &Scene, kind: &ChannelKind) -> Option<(String, Cryptomatte)> {
    let said = Cryptomatte::new(&kind.name, names(scene, kind.matte()?));
    Some((kind.name.to_string(), said))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_sorted_by_share_and_then_by_identifier() {
        let mut seen = PixelShares::default();
        for id in [7, 3, 9, 3, 9, 5, 3, 1] {
            seen.add(id);
        }
        let mut out = [0.0; 8];
        seen.write(16, &mut out);
        let ids = [0, 2, 4, 6].map(|k| out[k].to_bits());
        assert_eq!(ids, [3, 9, 1, 5]);
        assert_eq!([1, 3, 5, 7].map(|k| out[k]), [3.0 / 16.0, 2.0 / 16.0, 1.0 / 16.0, 1.0 / 16.0]);
    }

    #[test]
    fn shares_never_add_up_to_more_than_one() {
        for samples in 1..200 {
            for part in 0..=samples {
                let shares = [portion(part, samples), portion(samples - part, samples)];
                assert!(shares.map(f64::from).iter().sum::<f64>() <= 1.0);
            }
            let each = f64::from(portion(1, samples));
            assert!(each * f64::from(samples) <= 1.0 && each * f64::from(samples) > 0.999_999_8);
            assert_eq!(portion(samples, samples), 1.0);
        }
    }
}

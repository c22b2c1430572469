//! Whole numbers of a document.

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, Visitor};

/// A count, an offset, or the index of something: a whole number that is not negative.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub(super) struct Index(pub(super) usize);

impl<'de> Deserialize<'de> for Index {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Whole;
        impl Visitor<'_> for Whole {
            type Value = Index;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number from 0 to 2^53")
            }

            fn visit_u64<E: serde::de::Error>(self, number: u64) -> Result<Index, E> {
                let index = usize::try_from(number).ok().filter(|_| number <= 1 << 53);
                let wrong = || E::invalid_value(serde::de::Unexpected::Unsigned(number), &self);
                index.map(Index).ok_or_else(wrong)
            }

            /// 3.0 is as whole as 3.
            fn visit_f64<E: serde::de::Error>(self, number: f64) -> Result<Index, E> {
                if number.fract() == 0.0 && (0.0..=9e15).contains(&number) {
                    #[expect(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "whole, and in range"
                    )]
                    let number = number as u64;
                    return self.visit_u64(number);
                }
                Err(E::invalid_value(serde::de::Unexpected::Float(number), &self))
            }
        }
        deserializer.deserialize_any(Whole)
    }
}

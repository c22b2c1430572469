//! Numbers in the record: JSON's own, or words for those that JSON has not.

use std::fmt;

use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::geometry::DVec3;

/// A float64 that is read back to the last bit, but for what is in a NaN.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Number(pub(super) f64);

const WORDS: [(&str, f64); 3] =
    [("inf", f64::INFINITY), ("-inf", f64::NEG_INFINITY), ("nan", f64::NAN)];

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let Self(number) = *self;
        let word = WORDS.iter().find(|(_, of)| *of == number || (of.is_nan() && number.is_nan()));
        match word {
            Some((word, _)) => to.serialize_str(word),
            None => to.serialize_f64(number),
        }
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Any;
        impl Visitor<'_> for Any {
            type Value = Number;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, \"inf\", \"-inf\" or \"nan\"")
            }

            fn visit_f64<E: Error>(self, number: f64) -> Result<Number, E> {
                Ok(Number(number))
            }

            fn visit_u64<E: Error>(self, number: u64) -> Result<Number, E> {
                Ok(Number(number as f64))
            }

            fn visit_i64<E: Error>(self, number: i64) -> Result<Number, E> {
                Ok(Number(number as f64))
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<Number, E> {
                let found = WORDS.iter().find(|(word, _)| *word == text);
                let wrong = || E::invalid_value(Unexpected::Str(text), &self);
                found.map(|&(_, number)| Number(number)).ok_or_else(wrong)
            }
        }
        from.deserialize_any(Any)
    }
}

/// Three numbers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Triple([Number; 3]);

impl From<DVec3> for Triple {
    fn from(vector: DVec3) -> Self {
        Self(vector.to_array().map(Number))
    }
}

#[doc(hidden)]
impl From<Triple> for DVec3 {
    fn from(Triple(numbers): Triple) -> Self {
        Self::from(numbers.map(|Number(number)| number))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_back_to_the_last_bit() {
        let numbers = [0.0, -0.0, 0.1, 1e300, 5e-324, -1.0 / 3.0, f64::MAX, 3.0];
        let all = numbers.into_iter().chain([f64::INFINITY, f64::NEG_INFINITY]);
        for number in all {
            let text = serde_json::to_string(&Number(number)).unwrap();
            let Number(again) = serde_json::from_str(&text).unwrap();
            assert_eq!(again.to_bits(), number.to_bits(), "{text}");
        }
        let text = serde_json::to_string(&Number(f64::NAN)).unwrap();
        assert!(serde_json::from_str::<Number>(&text).unwrap().0.is_nan());
        assert!(serde_json::from_str::<Number>("\"infinity\"").is_err());
    }
}

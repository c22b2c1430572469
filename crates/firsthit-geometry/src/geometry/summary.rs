//! Short debug texts of large things: in a few words, never in megabytes.

use std::fmt::{self, Debug, Formatter};

/// Makes a [`Debug`] that shows these of many things, each by its name.
#[doc(hidden)]
#[macro_export]
macro_rules! summary {
    ($kind:ty, $name:literal, |$it:ident| $($field:literal: $value:expr),+) => {
        impl std::fmt::Debug for $kind {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                let $it = self;
                f.debug_struct($name)$(.field($field, &$value))+.finish_non_exhaustive()
            }
        }
    };
}
#[doc(hidden)]
pub use summary;

/// The first few of many, and how many there are.
#[doc(hidden)]
pub struct Few<'a, T>(pub &'a [T]);

impl<T> Few<'_, T> {
    const SHOWN: usize = 3;
}

impl<T: Debug> Debug for Few<'_, T> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let mut list = f.debug_list();
        list.entries(self.0.iter().take(Self::SHOWN));
        if self.0.len() > Self::SHOWN {
            list.entry(&format_args!("... of {}", self.0.len()));
        }
        list.finish()
    }
}

/// A number of things, and their name.
#[doc(hidden)]
pub struct Count<'a>(pub usize, pub &'a str);

impl Debug for Count<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.0, self.1)
    }
}

/// A text, cut where it is long: names come from files.
#[doc(hidden)]
pub struct Short<'a>(pub &'a str);

impl Debug for Short<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self.0.char_indices().nth(60) {
            Some((end, _)) => write!(f, "{:?}...", &self.0[..end]),
            None => self.0.fmt(f),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_are_shown_and_the_rest_is_counted() {
        assert_eq!(format!("{:?}", Few(&[1, 2, 3])), "[1, 2, 3]");
        assert_eq!(format!("{:?}", Few(&[1, 2, 3, 4])), "[1, 2, 3, ... of 4]");
        let name = "é".repeat(70);
        assert_eq!(format!("{:?}", Short(&name)).chars().count(), 65);
        assert_eq!(format!("{:?}", Short("ball")), "\"ball\"");
    }
}

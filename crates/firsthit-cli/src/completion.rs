//! The words that shells complete.

use std::ffi::OsStr;

use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
use clap::{Arg, Command};

use crate::output::ChannelSource;

/// The names of channels, as shells complete them. Other words are refused where the channels
/// are looked up: there it is known what else could be meant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ChannelNames(pub(crate) ChannelSource);

impl TypedValueParser for ChannelNames {
    type Value = String;

    fn parse_ref(
        &self,
        command: &Command,
        argument: Option<&Arg>,
        value: &OsStr,
    ) -> Result<String, clap::Error> {
        StringValueParser::new().parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.0.channels().map(|kind| PossibleValue::new(&*kind.name))))
    }
}

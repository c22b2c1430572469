//! Colours by numbers, as the command line and the file ask for them.

use firsthit::scene::Coloring;

use crate::args::{ColorsArgs, Given};
use crate::failure::Failure;

/// Whether an option is about colours by numbers.
pub(super) fn is_coloring(option: &str) -> bool {
    option.starts_with("color-")
}

/// The colouring that is asked for; `None` for none.
pub(super) fn coloring(
    (given, args): (&Given, &ColorsArgs),
    of_file: Option<&Coloring>,
) -> Result<Option<Coloring>, Failure> {
    let of_file = of_file.cloned();
    let base = match &args.color_by {
        // The file's settings go with the file's numbers.
        Some(by) => of_file
            .filter(|coloring| coloring.by == *by)
            .or_else(|| Some(Coloring::new(by.clone()))),
        None => of_file,
    };
    let Some(base) = base else {
        return match given.options().find(|option| is_coloring(option)) {
            Some(option) => Err(Failure::usage(format!("--{option} needs --color-by"))),
            None => Ok(None),
        };
    };
    let coloring = Coloring {
        map: args.color_map.unwrap_or(base.map),
        range: args.color_range.or(base.range),
        below: args.color_below.or(base.below),
        above: args.color_above.or(base.above),
        missing: args.color_missing.or(base.missing),
        by: base.by,
    };
    for (option, color) in [("--color-below", coloring.below), ("--color-above", coloring.above)] {
        if color.is_some() && coloring.range.is_none() {
            let why = "of all numbers that there are none is outside";
            return Err(Failure::usage(format!("{option} needs --color-range: {why}")));
        }
    }
    Ok(Some(coloring))
}

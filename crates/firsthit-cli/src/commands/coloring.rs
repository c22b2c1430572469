//! Colours by numbers, as the command line and the file ask for them.

use firsthit::Shader;
use firsthit::scene::Coloring;

use crate::args::ColorsArgs;
use crate::failure::Failure;

/// What is asked for; `None` where nothing is.
pub(super) fn coloring(
    args: &ColorsArgs,
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
        return match given(args).next() {
            Some(option) => Err(Failure::usage(format!("{option} needs --color-by"))),
            None => Ok(None),
        };
    };
    let coloring = Coloring {
        map: args.color_map.unwrap_or(base.map),
        range: args.color_range.or(base.range),
        below: args.color_below.or(base.below),
        above: args.color_above.or(base.above),
        missing: args.color_missing.or(base.missing),
        bar: args.color_bar || base.bar,
        by: base.by,
    };
    for (option, color) in [
        ("--color-below", coloring.below),
        ("--color-above", coloring.above),
    ] {
        if color.is_some() && coloring.range.is_none() {
            let why = "of all numbers that there are none is outside";
            return Err(Failure::usage(format!(
                "{option} needs --color-range: {why}"
            )));
        }
    }
    Ok(Some(coloring))
}

/// The options that are given.
pub(super) fn given(args: &ColorsArgs) -> impl Iterator<Item = &'static str> {
    let given = [
        ("--color-by", args.color_by.is_some()),
        ("--color-map", args.color_map.is_some()),
        ("--color-range", args.color_range.is_some()),
        ("--color-below", args.color_below.is_some()),
        ("--color-above", args.color_above.is_some()),
        ("--color-missing", args.color_missing.is_some()),
        ("--color-bar", args.color_bar),
    ];
    let given = given.into_iter().filter(|(_, is_given)| *is_given);
    given.map(|(option, _)| option)
}

/// Says of options that they do nothing, with a shader that looks at no colours, or `why` else.
pub(super) fn idle(args: &ColorsArgs, shader: &Shader, why: Option<&str>) -> Vec<String> {
    let with_shader = format!("with --shader {}", shader.name());
    let why = why.or_else(|| (!shader.takes_color()).then_some(&*with_shader));
    let line = |why| move |option| format!("{option} does nothing {why}");
    why.map_or_else(Vec::new, |why| given(args).map(line(why)).collect())
}

//! How hits get their colour.

use super::section::Section;
use super::table::Form;
use super::table::{Key, Pick, Record, Variant, key};
use crate::error::Result;
use crate::io::fault::Checked;
use crate::shade::Shader;

const SAMPLES: Key = key(
    "samples",
    Form::Whole(1, 65_536),
    "The colour of a pixel is the mean of this many points of it; 1 is its centre. Default: 4.",
);

const SHADER: &str = "shader";

pub(super) static SHADING: Record = Record {
    name: "shading",
    about: "How hits get their colour.",
    variants: &[
        Variant {
            pick: Pick::Default(SHADER, "lambert"),
            keys: &[&[
                key(
                    "ambient",
                    Form::Color,
                    "Light from everywhere. Default: [0.25, 0.25, 0.25].",
                ),
                key(
                    "shadows",
                    Form::Boolean,
                    "Whether things cast shadows. Default: true.",
                ),
                SAMPLES,
            ]],
            rules: &[],
        },
        Variant {
            pick: Pick::Tag(SHADER, "unlit"),
            keys: &[&[SAMPLES]],
            rules: &[],
        },
        Variant {
            pick: Pick::Tag(SHADER, "normal"),
            keys: &[&[SAMPLES]],
            rules: &[],
        },
    ],
};

/// How a scene file wants its hits coloured; `None` where it does not say.
#[derive(Debug, Default)]
pub(super) struct Settings {
    pub(super) shader: Option<Shader>,
    pub(super) samples: Option<u32>,
}

pub(super) fn read(section: &Section<'_, '_>) -> Checked<Settings> {
    let named: Result<Shader> = Shader::named(section.tag().unwrap_or("lambert"));
    let mut shader = section.checked(named)?;
    if let Shader::Lambert(lambert) = &mut shader {
        lambert.ambient = section.color("ambient").unwrap_or(lambert.ambient);
        lambert.shadows = section.boolean("shadows").unwrap_or(lambert.shadows);
    }
    Ok(Settings {
        shader: Some(shader),
        samples: section.whole("samples"),
    })
}

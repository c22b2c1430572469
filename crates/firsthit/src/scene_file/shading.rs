//! How hits get their colour.

use super::section::Section;
use super::table::{Form, Key, Pick, Record, Variant, keys, optional};
use crate::error::Result;
use crate::io::fault::Checked;
use crate::shade::Shader;

const SAMPLES: &[Key] = keys! {
    /// The colour of a pixel is the mean of this many points of it; 1 is its centre. Default: 4.
    samples: optional(Form::Whole(1, 65_536)),
};

const SHADER: &str = "shader";

const fn plain(shader: &'static str) -> Variant {
    Variant {
        pick: Pick::Tag(SHADER, shader),
        keys: &[SAMPLES],
        rules: &[],
    }
}

pub(super) static SHADING: Record = Record {
    name: "shading",
    about: "How hits get their colour.",
    variants: &[
        Variant {
            pick: Pick::Default(SHADER, "lambert"),
            keys: &[
                keys! {
                    /// Light from everywhere. Default: [0.25, 0.25, 0.25].
                    ambient: optional(Form::Color),
                    /// Whether things cast shadows. Default: true.
                    shadows: optional(Form::Boolean),
                },
                SAMPLES,
            ],
            rules: &[],
        },
        plain("unlit"),
        plain("normal"),
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

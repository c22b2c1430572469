//! The shading of hits in a scene file.

#![allow(
    clippy::indexing_slicing,
    reason = "tables are made when this is compiled, not when a file is read"
)]

use super::section::Section;
use super::settings;
use super::table::{Form, Key, Pick, Record, Variant, keys, optional};
use crate::io::fault::Checked;
use crate::shade::{Appearance, LightRig, Shader};

const COMMON: &[Key] = keys! {
    /// The colour of a pixel is the mean of this many points of it; 1 is its centre. Default: 16
    /// where the shader draws numbers or there is a ground, else 4.
    samples: optional(Form::Whole(1, 65_536)),
    /// Lights that go with the camera, in place of the file's. Default: automatic light where
    /// nothing shines.
    light: optional(Form::OneOf(|| LightRig::NAMES.to_vec())),
    /// Whether there is a ground that only shadows are seen of, under everything. Default: with a
    /// set of lights but shoulder.
    ground: optional(Form::FLAG),
};

const SHADER: &str = "shader";

/// The shader whose settings may be given without its name.
const UNNAMED: &str = "lambert";

settings::variants!(Shader::KINDS, |name| pick(name), COMMON);

const fn pick(name: &'static str) -> Pick {
    if same(name, UNNAMED) { Pick::Default(SHADER, name) } else { Pick::Tag(SHADER, name) }
}

const fn same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut place = 0;
    while place < a.len() && place < b.len() && a[place] == b[place] {
        place += 1;
    }
    place == a.len() && place == b.len()
}

pub(super) static SHADING: Record =
    Record { name: "shading", about: "How hits get their colour.", variants: &VARIANTS };

/// The shading that a scene file asks for; `None` where it does not say.
pub(super) fn read(section: &Section<'_, '_>) -> Checked<Appearance> {
    let name = section.text(SHADER);
    let kind = name.unwrap_or(UNNAMED);
    let given = settings::given(section, Shader::KINDS, kind);
    let is_said = name.is_some() || !given.is_empty();
    let shader = section.checked(Shader::from_settings(kind, given))?;
    let rig = section.text("light").map(str::parse).transpose();
    Ok(Appearance {
        shader: is_said.then_some(shader),
        samples: section.whole("samples"),
        rig: section.checked(rig)?,
        ground: section.boolean("ground"),
        ..Appearance::default()
    })
}

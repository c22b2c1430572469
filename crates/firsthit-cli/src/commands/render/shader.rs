//! The shader that the command line and the file ask for.

use firsthit::Shader;
use firsthit::geometry::{Setting, Value};
use firsthit::shade::{LightRig, default_shader};

use crate::args::LightingArgs;
use crate::failure::Failure;

const LAMBERT: &str = "lambert";

// Settings that have options of their own.
pub(super) const AMBIENT: &str = "ambient";
pub(super) const SHADOWS: &str = "shadows";

/// The shader that is asked for; `None` where none is. `rig` is the set of lights that is asked
/// for.
pub(super) fn shader(
    args: &LightingArgs,
    of_file: Option<&Shader>,
    rig: Option<LightRig>,
) -> Result<Option<Shader>, Failure> {
    let named = args.shader.as_deref();
    let is_silent = args.set.is_empty() && !args.no_shadows;
    let mut shader = match (named, of_file) {
        // The file's settings go with the file's shader.
        (Some(name), Some(shader)) if shader.name() == name => shader.clone(),
        (Some(name), _) => Shader::named(name)?,
        (None, Some(shader)) if args.ambient.is_some() && setting(shader, AMBIENT).is_none() => {
            return Err(without_ambient(shader));
        }
        (None, Some(shader)) => shader.clone(),
        // The shader that goes with ambient light.
        (None, None) if args.ambient.is_some() => Shader::named(LAMBERT)?,
        (None, None) if is_silent => return Ok(None),
        (None, None) => default_shader(rig),
    };
    for (name, text) in &args.set {
        set(&mut shader, name, text)?;
    }
    if let Some(ambient) = args.ambient.filter(|_| setting(&shader, AMBIENT).is_some()) {
        shader.set(AMBIENT, Value::Vector(ambient))?;
    }
    if args.no_shadows && setting(&shader, SHADOWS).is_some() {
        shader.set(SHADOWS, Value::Flag(false))?;
    }
    Ok(Some(shader))
}

fn without_ambient(shader: &Shader) -> Failure {
    let has_it = |kind: &&firsthit::geometry::SettingsSchema| {
        let mut names = kind.settings.iter().map(|setting| setting.name);
        names.any(|name| name == AMBIENT)
    };
    let known = Shader::KINDS.iter().filter(has_it).map(|kind| kind.name);
    let known: Vec<&str> = known.collect();
    Failure::usage(format!(
        "--ambient: the file's shader {} has no ambient light; with --shader one of {} has it",
        shader.name(),
        known.join(", ")
    ))
}

/// Sets what `--set` says.
fn set(shader: &mut Shader, name: &str, text: &str) -> Result<(), Failure> {
    let Some(setting) = setting(shader, name) else {
        let known: Vec<&str> = shader.list().iter().map(|known| known.name).collect();
        let known = if known.is_empty() {
            "no settings".to_owned()
        } else {
            format!("the settings {}", known.join(", "))
        };
        return Err(Failure::usage(format!(
            "--set {name}: the shader {} has {known}",
            shader.name()
        )));
    };
    let value = setting.domain.parsed(text).ok_or_else(|| {
        let expected = setting.domain.expected();
        Failure::usage(format!("--set {name} must be {expected}, got {text}"))
    })?;
    Ok(shader.set(name, value)?)
}

pub(super) fn setting(shader: &Shader, name: &str) -> Option<&'static Setting> {
    shader.list().iter().find(|known| known.name == name)
}

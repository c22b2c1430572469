//! Settings of a picture that do nothing without a channel or a file.

use std::borrow::Borrow;

use crate::channel::ChannelKind;
use crate::image::Display;

/// The channels without which a setting does nothing, in words; `None` where a picture of these
/// channels has one of them, and for a name that is no setting of colours, samples or lines. Names
/// are those of Python, of plans and, with hyphens, of options.
///
/// ```
/// use firsthit::channel::kind;
/// use firsthit::render::idle;
///
/// let depth = [kind("z")?];
/// assert_eq!(idle("light", &depth), Some("color"));
/// assert_eq!(idle("edges", &depth), Some("color or edge"));
/// assert_eq!(idle("light", &[kind("color")?]), None);
/// # Ok::<(), firsthit::Error>(())
/// ```
pub fn idle(setting: &str, channels: &[impl Borrow<ChannelKind>]) -> Option<&'static str> {
    let (is_needed, words): (fn(&ChannelKind) -> bool, _) = match setting {
        // Mattes take samples and a lens, but no light.
        "samples" | "aperture" | "focus" => (ChannelKind::needs_samples, "color"),
        "noise" | "shade" | "shader" | "set" | "color" | "background" | "sky" | "light"
        | "environment" | "ambient" | "shadows" | "ground" => (ChannelKind::needs_shade, "color"),
        "color_by" | "color_map" | "color_range" | "color_below" | "color_above"
        | "color_missing" | "edge_color" => (|kind| kind.name == "color", "color"),
        "edges" | "edge_kinds" | "edge_angle" | "hidden_edges" | "wireframe" => {
            (|kind| kind.needs_shade() || kind.is_edge(), "color or edge")
        }
        _ => return None,
    };
    let mut kinds = channels.iter().map(Borrow::borrow);
    (!kinds.any(is_needed)).then_some(words)
}

/// The files without which a setting of files does nothing, in words; `None` where one of these is
/// such a file, and for another name. Files are pairs of the name of a format and of what one of
/// its channels is.
///
/// ```
/// use firsthit::channel::kind;
/// use firsthit::render::idle_in_files;
///
/// let files = [("npz", kind("z")?), ("png", kind("object")?)];
/// assert_eq!(idle_in_files("png_scale", files), Some("t, range or z in a .png"));
/// assert_eq!(idle_in_files("png_labels", files), None);
/// # Ok::<(), firsthit::Error>(())
/// ```
pub fn idle_in_files<'a>(
    setting: &str,
    files: impl IntoIterator<Item = (&'a str, impl Borrow<ChannelKind>)>,
) -> Option<&'static str> {
    let (format, display, words) = match setting {
        "png_scale" | "far" => ("png", Some(Display::Distance), "t, range or z in a .png"),
        "png_labels" => {
            let words = "an identifier, such as object, in a .png";
            ("png", Some(Display::Identifier), words)
        }
        "exposure" | "tone_map" => ("png", Some(Display::Color), "color in a .png"),
        "compress" => ("npz", None, "a .npz"),
        _ => return None,
    };
    let is_such = |(name, kind): (&str, _)| {
        let kind: &ChannelKind = Borrow::borrow(&kind);
        name == format && display.is_none_or(|display| kind.display == display)
    };
    (!files.into_iter().any(is_such)).then_some(words)
}

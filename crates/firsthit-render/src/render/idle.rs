//! Settings of a picture that do nothing without a channel.

use std::borrow::Borrow;

use crate::channel::ChannelKind;

/// The channels without which a setting does nothing, in words; `None` where a picture of these channels has one of them, and for a
/// name that is no setting of colours, samples or lines. Names are those of Python, of plans and, with hyphens, of options.
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

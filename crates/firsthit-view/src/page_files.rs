//! The files of the page, by their names.

/// The type of scripts.
const SCRIPT: &str = "text/javascript; charset=utf-8";

/// Each with its type and its bytes.
const PAGES: &[(&str, &str, &[u8])] = &[
    (
        "/",
        "text/html; charset=utf-8",
        include_bytes!("../../web/index.html"),
    ),
    (
        "/app.css",
        "text/css; charset=utf-8",
        include_bytes!("../../web/app.css"),
    ),
    ("/camera.js", SCRIPT, include_bytes!("../../web/camera.js")),
    (
        "/chapter.js",
        SCRIPT,
        include_bytes!("../../web/chapter.js"),
    ),
    ("/color.js", SCRIPT, include_bytes!("../../web/color.js")),
    (
        "/compare.js",
        SCRIPT,
        include_bytes!("../../web/compare.js"),
    ),
    ("/cut.js", SCRIPT, include_bytes!("../../web/cut.js")),
    ("/dom.js", SCRIPT, include_bytes!("../../web/dom.js")),
    (
        "/engine-native.js",
        SCRIPT,
        include_bytes!("../../web/engine-native.js"),
    ),
    ("/hands.js", SCRIPT, include_bytes!("../../web/hands.js")),
    ("/hear.js", SCRIPT, include_bytes!("../../web/hear.js")),
    (
        "/light-ball.js",
        SCRIPT,
        include_bytes!("../../web/light-ball.js"),
    ),
    ("/main.js", SCRIPT, include_bytes!("../../web/main.js")),
    ("/marks.js", SCRIPT, include_bytes!("../../web/marks.js")),
    (
        "/objects.js",
        SCRIPT,
        include_bytes!("../../web/objects.js"),
    ),
    ("/story.js", SCRIPT, include_bytes!("../../web/story.js")),
    ("/view.js", SCRIPT, include_bytes!("../../web/view.js")),
];

/// The type and the bytes of a file of the page.
pub(super) fn page(path: &str) -> Option<(&'static str, &'static [u8])> {
    let mut pages = PAGES.iter();
    let (_, kind, bytes) = pages.find(|(known, _, _)| *known == path)?;
    Some((kind, bytes))
}

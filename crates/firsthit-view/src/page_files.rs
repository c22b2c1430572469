//! The files of the page, by their names. They are statics: of a constant each place that uses it
//! may have a copy.

/// The type of scripts.
const SCRIPT: &str = "text/javascript; charset=utf-8";
/// The type of the module, which is packed by gzip.
const PACKED: &str = "application/gzip";

/// The page itself.
pub(crate) static INDEX: &str = include_str!("../web/index.html");
/// The style sheet.
pub(crate) static STYLE: &str = include_str!("../web/app.css");

/// A script of the page.
#[derive(Debug)]
pub(crate) struct Script {
    pub(crate) name: &'static str,
    pub(crate) text: &'static str,
}

macro_rules! scripts {
    ($($name:literal)*) => {
        &[$(Script { name: $name, text: include_str!(concat!("../web/", $name)) },)*]
    };
}

/// The scripts, each after those that it imports.
pub(crate) static SCRIPTS: &[Script] = scripts! {
    "dom.js"
    "storage.js"
    "camera.js"
    "color.js"
    "label.js"
    "letters.js"
    "readout.js"
    "legend.js"
    "probe-text.js"
    "camera-text.js"
    "look-text.js"
    "saved-look.js"
    "status.js"
    "newest.js"
    "engine.js"
    "engine-native.js"
    "engine-port.js"
    "engine-wasm.js"
    "engines.js"
    "picture.js"
    "compare.js"
    "cut.js"
    "light-ball.js"
    "lighting.js"
    "marks.js"
    "objects.js"
    "pointer.js"
    "keys.js"
    "view.js"
    "chapter-fields.js"
    "chapter-drawing.js"
    "chapter.js"
    "camera-panel.js"
    "page-keys.js"
    "page.js"
    "main.js"
};

/// The scripts of the worker that runs the module.
pub(crate) static WORKER: &[Script] = scripts! {
    "firsthit.mjs"
    "worker.js"
};

/// The crate `firsthit-wasm` as a module, packed by gzip. `make wasm` makes it, and
/// `make test-wasm` compares its answers with those of the sources.
pub(crate) static MODULE: &[u8] = include_bytes!("../module/firsthit.wasm.gz");

/// The type and the bytes of a file of the page.
#[cfg(feature = "server")]
pub(crate) fn file(path: &str) -> Option<(&'static str, &'static [u8])> {
    match path.strip_prefix('/')? {
        "" => Some(("text/html; charset=utf-8", INDEX.as_bytes())),
        "app.css" => Some(("text/css; charset=utf-8", STYLE.as_bytes())),
        "firsthit.wasm.gz" => Some((PACKED, MODULE)),
        name => {
            let mut scripts = SCRIPTS.iter().chain(WORKER);
            let script = scripts.find(|script| script.name == name)?;
            Some((SCRIPT, script.text.as_bytes()))
        }
    }
}

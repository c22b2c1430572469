//! The page in one file: with the scene and what computes it, or without, for a program that embeds
//! it and answers it.

use std::io::Write;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use firsthit::geometry::Digest;
use firsthit::watch::{Watch, stop_if_asked};
use firsthit::world::{NamedCamera, World};
use firsthit::{Error, Result, fhs};
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::{Value, json};

use crate::frame::Pixels;
use crate::look::FrameRequest;
use crate::page_files::{INDEX, MODULE, SCRIPTS, STYLE, Script, WORKER};
use crate::viewer::Viewer;

/// A third more as text, this is what browsers hold, and the module unpacks beside its own memory.
const MOST_BYTES: usize = 256 << 20;

/// The edge of the picture for those who run no scripts, in pixels at most.
const STILL_EDGE: usize = 640;
/// The number of samples of the still picture.
const STILL_SAMPLES: u32 = 4;

impl Viewer {
    /// The page in one HTML file, with the scene and an engine inside. It needs no server, and its
    /// policy would not let it ask one.
    ///
    /// Its bytes follow from the scene, on every machine.
    ///
    /// # Errors
    ///
    /// The errors of [`fhs::encode`], and [`Error::Limit`] for more than a browser reads.
    pub fn report(&self, watch: &dyn Watch) -> Result<Vec<u8>> {
        let scene = fhs::encode(self.scene(), &self.world()?, watch)?;
        let scene = packed(&scene)?;
        stop_if_asked(watch)?;
        if scene.len() > MOST_BYTES {
            let (got, limit) = (scene.len().to_string(), MOST_BYTES.to_string());
            let what = "packed bytes of a scene in a report";
            return Err(Error::Limit { what, got, limit });
        }
        let scene = BASE64_STANDARD.encode(scene);
        let module = BASE64_STANDARD.encode(MODULE);
        let engine = json!({"kind": "wasm", "title": self.title, "warnings": self.warnings});
        let still = BASE64_STANDARD.encode(self.still(watch)?);
        let head = [
            data("report-engine", "application/json", &json_block(&engine)),
            data("report-worker", "text/plain", &bundle(WORKER)),
            data("report-module", "text/plain", &module),
            data("report-scene", "text/plain", &scene),
        ];
        Ok(page(&head.concat(), &still).into_bytes())
    }

    /// The page in one HTML file, which asks the window around it: see `web/engine-port.js`.
    ///
    /// # Errors
    ///
    /// The errors of [`Viewer::still`].
    pub fn embedded_page(&self, watch: &dyn Watch) -> Result<String> {
        let engine = json_block(&json!({"kind": "port"}));
        let head = data("report-engine", "application/json", &engine);
        let still = BASE64_STANDARD.encode(self.still(watch)?);
        Ok(page(&head, &still))
    }

    /// A PNG of what the page begins with, for those who run no scripts.
    ///
    /// # Errors
    ///
    /// The errors of [`Viewer::frame`].
    pub fn still(&self, watch: &dyn Watch) -> Result<Vec<u8>> {
        let mut camera = self.first_camera;
        let longest = camera.rows.max(camera.columns);
        if longest > STILL_EDGE {
            let shrunk = |edge: usize| (edge * STILL_EDGE / longest).max(1);
            (camera.rows, camera.columns) = (shrunk(camera.rows), shrunk(camera.columns));
        }
        let request = FrameRequest {
            is_lit: true,
            samples: Some(STILL_SAMPLES),
            ..FrameRequest::new(camera)
        };
        match self.frame(&request, watch)?.pixels {
            Pixels::Png(bytes) | Pixels::Values { bytes, .. } => Ok(bytes),
        }
    }

    /// The world beside the scene: its camera and appearance.
    fn world(&self) -> Result<World> {
        let camera = NamedCamera {
            name: String::new(),
            own_name: String::new(),
            view: *self.first_camera.camera()?.view(),
            has_size: true,
            description: None,
        };
        Ok(World {
            cameras: vec![camera],
            has_view: true,
            lights: self.scene().lights().to_vec(),
            environment: self.scene().environment().cloned().map(Into::into),
            appearance: self.appearance.clone(),
            display: self.display,
            edges: self.edges,
            up: self.scene().up(),
            ..World::default()
        })
    }
}

fn packed(bytes: &[u8]) -> Result<Vec<u8>> {
    let mut packer = GzEncoder::new(Vec::new(), Compression::default());
    let written = packer.write_all(bytes).and_then(|()| packer.finish());
    written.map_err(|error| Error::argument("report", "one that can be packed", error))
}

/// JSON that ends no element of HTML.
fn json_block(value: &Value) -> String {
    value.to_string().replace('<', "\\u003c")
}

/// An element that only holds a text.
fn data(id: &str, kind: &str, text: &str) -> String {
    format!("<script id=\"{id}\" type=\"{kind}\">{text}</script>\n")
}

/// The page with its style and its scripts inside, and `head` before them.
fn page(head: &str, still: &str) -> String {
    let bundled = bundle(SCRIPTS);
    // The author of a name in a scene cannot know the nonce of a file that holds this name.
    let mut digest = Digest::default();
    for part in [head, still, &bundled] {
        digest.word(part);
    }
    let nonce = digest.name().replace(':', "-");
    let policy = format!(
        "default-src 'none'; script-src 'nonce-{nonce}' 'wasm-unsafe-eval'; style-src 'nonce-{nonce}'; worker-src blob:; \
         img-src blob: data:; base-uri 'none'; form-action 'none'"
    );
    let policy =
        format!("<meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n<title>");
    let style = format!("<style nonce=\"{nonce}\">\n{STYLE}</style>");
    let script = format!("{head}<script type=\"module\" nonce=\"{nonce}\">\n{bundled}</script>");
    let still = format!(
        "<body>\n<noscript><img alt=\"The scene\" src=\"data:image/png;base64,{still}\"></noscript>"
    );
    INDEX
        .replacen("<title>", &policy, 1)
        .replacen("<link rel=\"stylesheet\" href=\"app.css\">", &style, 1)
        .replacen("<script type=\"module\" src=\"main.js\"></script>", &script, 1)
        .replacen("<body>", &still, 1)
}

/// Modules as one script: each but the last is a function that returns what it exports. They are
/// written for that: an import is one line and names a script before, and what is exported is
/// declared at the start of a line.
fn bundle(scripts: &[Script]) -> String {
    let each = scripts.iter().enumerate().map(|(k, script)| {
        let mut exported = Vec::new();
        let lines = script.text.lines();
        let lines = lines.map(|line| unlinked(line, &mut exported));
        let body = lines.collect::<Vec<_>>().join("\n");
        if k + 1 == scripts.len() {
            return format!("{body}\n");
        }
        let (name, exported) = (variable(script.name), exported.join(", "));
        format!("const {name} = (() => {{\n{body}\nreturn {{ {exported} }};\n}})();\n")
    });
    each.collect()
}

/// A line without `import` and `export`; the name that it exported is told.
fn unlinked(line: &str, exported: &mut Vec<String>) -> String {
    if let Some((names, from)) = imported(line) {
        return format!("const {names} = {};", variable(from));
    }
    let Some(declared) = line.strip_prefix("export ") else {
        return line.to_owned();
    };
    let kinds = ["class ", "const ", "async function ", "function "];
    let rest = kinds.iter().find_map(|kind| declared.strip_prefix(kind));
    let is_of_name = |c: &char| c.is_alphanumeric() || *c == '_';
    let name = rest.unwrap_or_default().chars().take_while(is_of_name);
    exported.push(name.collect());
    declared.to_owned()
}

/// The names in the braces of an import, and the script.
fn imported(line: &str) -> Option<(&str, &str)> {
    let (names, from) = line.strip_prefix("import ")?.split_once(" from \"./")?;
    Some((names, from.strip_suffix("\";")?))
}

/// The variable that holds what a script exports.
fn variable(script: &str) -> String {
    let stem = script.split('.').next().unwrap_or_default();
    format!("of_{}", stem.replace('-', "_"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The scripts and the page fulfil the assumptions of [`bundle`] and [`page`].
    #[test]
    fn scripts_are_written_to_be_bundled() {
        for scripts in [SCRIPTS, WORKER] {
            for (k, Script { name, text }) in scripts.iter().enumerate() {
                for part in ["</script", "<!--", "<title>", "<body>", "<link", "<script"] {
                    assert!(!text.contains(part), "{name}: {part}");
                }
                for line in text.lines() {
                    let is_import = line.starts_with("import");
                    assert_eq!(is_import, imported(line).is_some(), "{name}: {line}");
                    if let Some((names, from)) = imported(line) {
                        let before = &scripts[..k];
                        assert!(before.iter().any(|script| script.name == from), "{name}: {line}");
                        assert!(
                            names.starts_with("{ ") && !names.contains(" as "),
                            "{name}: {line}"
                        );
                    }
                    let mut exported = Vec::new();
                    unlinked(line, &mut exported);
                    assert_eq!(line.starts_with("export"), exported.len() == 1, "{name}: {line}");
                    assert!(exported.iter().all(|name| !name.is_empty()), "{name}: {line}");
                }
            }
        }
    }

    #[test]
    fn a_bundle_holds_what_its_scripts_export() {
        let scripts = [
            Script {
                name: "a-b.js",
                text: "export const one = 1;\nexport function two() {}\nconst own = 3;",
            },
            Script { name: "main.js", text: "import { one, two } from \"./a-b.js\";\ntwo(one);" },
        ];
        let expected = "const of_a_b = (() => {\nconst one = 1;\nfunction two() {}\nconst own = 3;\nreturn { one, two };\n})();\n\
                        const { one, two } = of_a_b;\ntwo(one);\n";
        assert_eq!(bundle(&scripts), expected);
    }

    #[test]
    fn the_page_has_places_for_all_that_goes_in() {
        let page = page("<head-block>", "PICTURE");
        let is_once = |text: &str| page.matches(text).count() == 1;
        for text in [
            "<head-block>",
            "<noscript><img",
            "http-equiv",
            "<style nonce",
            "<script type=\"module\" nonce",
        ] {
            assert!(is_once(text), "{text}");
        }
        assert!(!page.contains("src=\"main.js\"") && !page.contains("href=\"app.css\""));
    }

    #[test]
    fn names_end_no_element() {
        let block = json_block(&json!({"title": "</script><script>alert(1)</script>"}));
        assert!(!block.contains('<'));
        let read: Value = serde_json::from_str(&block).unwrap();
        assert_eq!(read["title"], "</script><script>alert(1)</script>");
    }
}

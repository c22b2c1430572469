//! Every key of the files that a plan of a data set asks for, and of how their pictures look.

#![allow(
    clippy::indexing_slicing,
    reason = "tables are made when this is compiled, not when a file is read"
)]

use super::colors::SCALE;
use super::edges::LINES;
use super::environment::ENVIRONMENT;
use super::form::TRANSPARENT;
use super::plan::{NUMBERS, PAIR, SIZE};
use super::settings;
use super::table::{Form, Key, Pick, Record, Rule, Variant, keys, optional, record, required};
use crate::channel::{ATTRIBUTE, KINDS};
use crate::edge::{EdgeKind, Edges};
use crate::geometry::{ColorMap, Domain, ToneMap};
use crate::shade::{LightRig, Shader};

const MASK: Form = Form::OneOf(|| vec!["visible", "amodal"]);
const AXIS: Form = Form::OneOf(|| vec!["+x", "-x", "+y", "-y", "+z", "-z"]);
const CHANNEL: Form = Form::OneOfOr(|| KINDS.iter().map(|kind| &*kind.name).collect(), ATTRIBUTE);
const FRAME: Form = Form::OneOf(|| vec!["npz", "exr"]);
const CLOUD: Form = Form::OneOf(|| vec!["npz", "ply", "pcd", "csv", "las", "laz", "parquet"]);
const FLOW: Form = Form::OneOf(|| vec!["flo", "png"]);
const DISPARITY: Form = Form::OneOf(|| vec!["png", "pfm"]);
const EDGE: Form = Form::OneOf(|| EdgeKind::NAMES.to_vec());
const UNIT: Form = Form::Either(&Form::Text, &Form::POSITIVE);
const SOURCE: Form = Form::Either(&Form::Text, &NUMBERS);
const WIDTH: Form = Form::Of(Domain::UpTo(Edges::WIDEST));
const SHADER: Form = Form::OneOf(|| Shader::NAMES.to_vec());

/// One of some words, or an array of them.
macro_rules! some {
    ($word:ident) => {
        Form::Either(&$word, &Form::Array(&$word, 0, usize::MAX))
    };
}

const FILES: &[Key] = keys! {
    /// Channels to compute. Default: pictures, or ["color"].
    channels: optional(some!(CHANNEL)),
    /// The formats that hold all channels. Default: ["npz"].
    frames: optional(some!(FRAME)),
    /// The channels that have a PNG each. Default: none.
    pictures: optional(some!(CHANNEL)),
    /// The step of PNGs of distances, in scene units.
    png_scale: optional(Form::POSITIVE),
    /// The value in these PNGs in place of distances beyond 65535 steps.
    far: optional(Form::OneOf(|| vec!["saturate", "zero"])),
    /// Whether PNGs of identifiers hold their numbers, plus one. Default: false.
    png_labels: optional(Form::FLAG),
    /// The type of what is computed as float64. Default: float64.
    dtype: optional(Form::OneOf(|| vec!["float32", "float64"])),
    /// Whether NPZ files are packed. Default: false.
    compress: optional(Form::FLAG),
    /// The formats of the optical flow to the next frame. Default: none.
    flow: optional(some!(FLOW)),
    /// The disparity of a stereo pair.
    disparity: optional(Form::Table(&STEREO)),
    /// The formats of scans. Default: ["npz"].
    clouds: optional(some!(CLOUD)),
};

static SHADE_TABLE: Form = Form::Table(&SHADE);
static COLOR_TABLE: Form = Form::Table(&COLOR_BY);
static EDGE_TABLE: Form = Form::Table(&PLANNED_EDGES);

const LOOK: &[Key] = keys! {
    /// Points of a pixel. Default: the scene's.
    samples: optional(Form::Whole(1, 65_536)),
    /// The colour of misses. Default: the scene's.
    background: optional(Form::Either(&Form::COLOR, &Form::Word(TRANSPARENT))),
    /// Light from all around, in place of the scene's.
    environment: optional(Form::Table(&ENVIRONMENT)),
    /// Lights that go with the camera, in place of the scene's.
    light: optional(Form::OneOf(|| LightRig::NAMES.to_vec())),
    /// Whether there is a ground that only shadows are seen of.
    ground: optional(Form::FLAG),
    /// The ambient light of shaders that have some.
    ambient: optional(Form::COLOR),
    /// Whether there are shadows.
    shadows: optional(Form::FLAG),
    /// A shader by its name, or a table with its settings. Default: the scene's.
    shade: optional(Form::Either(&SHADER, &SHADE_TABLE)),
    /// The source of colours by numbers, or a table. Default: the scene's.
    color_by: optional(Form::Either(&SOURCE, &COLOR_TABLE)),
    /// The colour map of colours by numbers.
    color_map: optional(Form::OneOf(|| ColorMap::NAMES.to_vec())),
    /// The numbers of the first and the last colour.
    color_range: optional(Form::Range),
    /// The width of lines along edges in pixels, or a table. Default: the scene's.
    edges: optional(Form::Either(&WIDTH, &EDGE_TABLE)),
    /// The exposure of PNGs in stops. Default: the scene's.
    exposure: optional(Form::NUMBER),
    /// The tone map of PNGs. Default: the scene's.
    tone_map: optional(Form::OneOf(|| ToneMap::NAMES.to_vec())),
};

pub(super) static WRITTEN: Record = record! {
    "written", "What is written.";
    Pick::Always => [FILES, LOOK, keys! {
        /// The masks of instances that have a PNG each. Default: none.
        masks: optional(some!(MASK)),
        /// Annotations in COCO's form.
        coco: optional(Form::Table(&COCO)),
        /// Annotations in BOP's form.
        bop: optional(Form::Table(&BOP)),
        /// Annotations in KITTI's form.
        kitti: optional(Form::Table(&KITTI)),
        /// Annotations in YOLO's form.
        yolo: optional(Form::Table(&YOLO)),
        /// The records of frames, one a line.
        jsonl: optional(Form::Table(&JSONL)),
    }] [Rule::NotBoth("environment", "light")];
};

static STEREO: Record = record! {
    "stereo", "A stereo pair.";
    Pick::Always => [keys! {
        /// The name of the left camera.
        left: required(Form::Text),
        /// The name of the right camera.
        right: required(Form::Text),
        /// The formats. Default: ["png"].
        formats: optional(some!(DISPARITY)),
    }];
};

settings::variants!(Shader::KINDS, |name| Pick::Tag("name", name), &[]);

static SHADE: Record =
    Record { name: "shade", about: "A shader and its settings.", variants: &VARIANTS };

static COLOR_BY: Record = record! {
    "color_by", "Colours by numbers.";
    Pick::Always => [keys! {
        /// The source of the numbers, or a number for each object.
        by: required(SOURCE),
    }, SCALE] [Rule::Needs("below", "range"), Rule::Needs("above", "range")];
};

static PLANNED_EDGES: Record = record! {
    "planned_edges", "Lines along edges.";
    Pick::Always => [LINES, keys! {
        /// The kinds of edges that are drawn. Default: ["silhouette", "crease", "boundary",
        /// "material"].
        kinds: optional(some!(EDGE)),
        /// Whether occluded lines are drawn, dashed; or the lengths of dash and gap.
        hidden: optional(Form::Either(&Form::FLAG, &PAIR)),
    }];
};

static COCO: Record = record! {
    "coco", "COCO's file.";
    Pick::Always => [keys! {
        /// Which masks it holds. Default: visible.
        masks: optional(MASK),
        /// Their form. Default: polygon.
        form: optional(Form::OneOf(|| vec!["polygon", "rle"])),
    }];
};

const LENGTH: &[Key] = keys! {
    /// The scene's unit: a name, or metres.
    unit: required(UNIT),
};

static BOP: Record = record! {
    "bop", "BOP's folders.";
    Pick::Always => [LENGTH, keys! {
        /// Numbers of objects by the names of classes.
        object_ids: optional(Form::Named(&SIZE)),
    }];
};

static KITTI: Record = record! {
    "kitti", "KITTI's labels.";
    Pick::Always => [LENGTH, keys! {
        /// The axis of objects that points forwards. Default: +x.
        forward: optional(AXIS),
        /// The axis of objects that points upwards. Default: +z.
        up: optional(AXIS),
        /// Which mask the box holds. Default: amodal.
        box: optional(MASK),
        /// The visible shares below which occlusion counts as partly and largely. Default: [0.9,
        /// 0.5].
        occlusion: optional(PAIR),
        /// How far objects may lean, in degrees. Default: 0.001.
        tilt_degrees: optional(Form::NON_NEGATIVE),
    }];
};

static YOLO: Record = record! {
    "yolo", "YOLO's labels.";
    Pick::Always => [keys! {
        /// Things to find. Default: detect.
        task: optional(Form::OneOf(|| vec!["detect", "segment"])),
        /// Which masks it holds. Default: visible.
        masks: optional(MASK),
        /// The share of frames that are for validation. Default: 0.
        validation: optional(Form::Of(Domain::From(0.0, 1.0))),
    }];
};

static JSONL: Record =
    record! { "jsonl", "Lines of JSON, which have no options."; Pick::Always => []; };

//! Every key of a scene file: the reader, the JSON Schema and the documentation's test all go by
//! these tables.

use super::background::{BACKGROUND, SKY};
use super::camera::CAMERA;
use super::colors::COLORS;
use super::display::DISPLAY;
use super::edges::EDGES;
use super::environment::ENVIRONMENT;
use super::light::LIGHT;
use super::object::OBJECT;
use super::output::OUTPUT;
use super::shading::SHADING;
use super::table::{Form, Pick, Record, Rule, keys, optional, record};

pub(super) static SCENE: Record = record! {
    "scene", "A scene for firsthit: cameras, objects, lights, background and outputs.";
    Pick::Always => [keys! {
        /// The version of this form of scene file. There is one, 1, which is the default.
        version: optional(Form::Whole(1, 1)),
        /// The direction upwards, for cameras and the sky where they do not say. Default: [0,
        /// 0, 1].
        up: optional(Form::DIRECTION),
        /// The camera that a picture is taken with, unless another is asked for.
        camera: optional(Form::Table(&CAMERA)),
        /// Further cameras, each a table [cameras.NAME]. Without [camera] the first of them takes
        /// the picture.
        cameras: optional(Form::Named(&Form::Table(&CAMERA))),
        /// The objects, in the order of the identifiers.
        objects: optional(Form::List(&OBJECT)),
        /// The lights. Where nothing in the scene shines, automatic lights do.
        lights: optional(Form::List(&LIGHT)),
        /// Light from all around, which is seen where nothing is hit, too.
        environment: optional(Form::Table(&ENVIRONMENT)),
        /// The colour of misses.
        background: optional(Form::Table(&BACKGROUND)),
        /// The sky that misses see.
        sky: optional(Form::Table(&SKY)),
        /// The shading of hits.
        shading: optional(Form::Table(&SHADING)),
        /// The display of colours in PNGs: exposure and tone map.
        display: optional(Form::Table(&DISPLAY)),
        /// Colours by numbers, in place of those that surfaces have.
        colors: optional(Form::Table(&COLORS)),
        /// Lines along edges, over the colours. Without this table there are none.
        edges: optional(Form::Table(&EDGES)),
        /// The files that firsthit render writes unless told otherwise by -o.
        outputs: optional(Form::List(&OUTPUT)),
    }] [Rule::NotBoth("background", "sky")];
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Projection;
    use crate::scene_file::plan::PLAN;
    use crate::shade::Shader;
    use crate::shape::Shape;

    /// The tags of a record, for the lists that they must be the same as.
    fn tags(record: &Record) -> Vec<&'static str> {
        let tags = record.variants.iter().filter_map(|variant| variant.pick.tag());
        tags.map(|(_, value)| value).collect()
    }

    #[test]
    fn every_kind_there_is_can_be_in_a_scene_file() {
        let sorted = |names: &[&'static str]| {
            let mut names = names.to_vec();
            names.sort_unstable();
            names
        };
        assert_eq!(sorted(&tags(&OBJECT)), sorted(Shape::NAMES));
        assert_eq!(tags(&CAMERA), Projection::NAMES);
        assert_eq!(tags(&SHADING), Shader::NAMES);
    }

    #[test]
    fn no_table_has_a_key_twice_and_rules_name_keys_that_it_has() {
        for record in [&SCENE, &PLAN].into_iter().flat_map(Record::all) {
            for variant in record.variants {
                let mut names: Vec<_> = variant.keys().map(|key| key.name).collect();
                for rule in variant.rules {
                    let (Rule::NotBoth(a, b) | Rule::Needs(a, b) | Rule::OneOf(a, b)) = *rule
                    else {
                        continue;
                    };
                    assert!(names.contains(&a) && names.contains(&b), "{rule:?}");
                }
                let count = names.len();
                names.sort_unstable();
                names.dedup();
                assert_eq!(names.len(), count, "{}", record.name);
            }
        }
    }
}

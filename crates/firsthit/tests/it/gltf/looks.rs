//! Colours, textures, holes.

use std::fs;
use std::path::Path;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use firsthit::load::{LoadSettings, Loaded, load};
use firsthit::scene::{Filter, MapRole, Wrap};
use firsthit::{AlphaMode, Color, DVec2, DVec3, Ray, Scene, shoot};
use serde_json::{Value, json};

use super::builder::{Builder, FLOAT, reference};

fn loaded(path: &Path) -> Loaded {
    load(path, &LoadSettings::default()).unwrap()
}

/// The colour of the scene from above, if a ray meets it.
fn color(scene: &Scene, x: f64, y: f64) -> Option<Color> {
    let ray = Ray::new(DVec3::new(x, y, 1.0), DVec3::NEG_Z);
    let hit = shoot(scene, ray.origin, ray.direction);
    scene.interaction(&ray, &hit).map(|surface| surface.color())
}

/// The curve of IEC 61966-2-1, as the standard has it.
fn decode(level: u8) -> f64 {
    let value = f64::from(level) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Which of four texels a place shows, by the wrap modes as glTF numbers them.
fn wrapped(place: f64, mode: u64) -> usize {
    let texel = (4.0 * place).floor() as i64;
    let texel = match mode {
        10497 => texel.rem_euclid(4),
        33071 => texel.clamp(0, 3),
        _ => match texel.rem_euclid(8) {
            texel @ 0..4 => texel,
            texel => 7 - texel,
        },
    };
    usize::try_from(texel).unwrap()
}

/// The twelve squares of `textures.glb`: nine pairs of wrap modes, another set of coordinates, a
/// transform, a factor.
#[test]
#[ignore = "needs ../shared/refdata"]
fn texels_are_seen_where_the_reference_has_them() {
    let file = reference("generated/textures.glb");
    let bytes = fs::read(reference("generated/textures_texels.npy")).unwrap();
    let texels = &bytes[bytes.len() - 48..];
    let texel = |column: usize, row: usize| {
        let start = 3 * (4 * row + column);
        Color::from(std::array::from_fn(|k| decode(texels[start + k])))
    };
    let scene = Scene::new(loaded(&file).world.objects).unwrap();
    let modes = [10497, 33071, 33648];
    for square in 0..12_usize {
        let corner = [1.1 * (square % 3) as f64, 1.1 * (square / 3) as f64];
        for k in 0..400 {
            let [x, y] = [(f64::from(k % 20) + 0.47) / 20.0, (f64::from(k / 20) + 0.53) / 20.0];
            let (u, v) = if square < 9 { (2.5 * x - 0.75, 2.0 - 2.5 * y) } else { (x, 1.0 - y) };
            // The transform: scaled by (2, 1/2), turned by a quarter (as the extension says it in
            // words: the texture clockwise, v downwards), moved by (1/4, 1/2).
            let (u, v) = if square == 10 { (0.25 + 0.5 * v, 0.5 - 2.0 * u) } else { (u, v) };
            let [across, down] =
                if square < 9 { [modes[square / 3], modes[square % 3]] } else { [10497; 2] };
            let factor = if square == 11 { Color::new(0.5, 0.25, 1.0) } else { Color::ONE };
            let expected = factor * texel(wrapped(u, across), wrapped(v, down));
            let seen = color(&scene, corner[0] + x, corner[1] + y).unwrap();
            assert!(
                (seen - expected).length() < 1e-6,
                "square {square} at {x} {y}: {seen}, not {expected}"
            );
        }
    }
}

/// Sixteen texels on each of five squares: rays meet those whose alpha the cutoff lets be.
#[test]
#[ignore = "needs ../shared/refdata"]
fn masks_cut_holes_where_alpha_is_below_the_cutoff() {
    let model = loaded(&reference("generated/alpha_modes.gltf"));
    let map = model.world.objects[0].materials()[0].maps.get(MapRole::Color).cloned().unwrap();
    let alphas = map.texture.texels().iter().map(|texel| f64::from(texel[3]) / 255.0);
    let alphas: Vec<f64> = alphas.collect();
    let scene = Scene::new(model.world.objects).unwrap();
    let mut holes = 0;
    for (square, cutoff) in [0.0, 0.5, 0.25, 0.0, 0.75].into_iter().enumerate() {
        for (k, alpha) in alphas.iter().enumerate() {
            let (column, row) = ((k % 4) as f64, (k / 4) as f64);
            let (x, y) = (1.1 * square as f64 + (column + 0.5) / 4.0, 1.0 - (row + 0.5) / 4.0);
            let is_there = color(&scene, x, y).is_some();
            assert_eq!(is_there, *alpha >= cutoff, "square {square}, texel {k} of alpha {alpha}");
            holes += usize::from(!is_there);
        }
    }
    assert!(holes > 10, "{holes}");
    assert!(scene.objects()[4].materials()[0].double_sided);
    assert!(!scene.objects()[0].materials()[0].double_sided);
    assert!(scene.objects()[0].materials()[0].unlit);
}

/// The first vertices of each square, as the file's bytes have them.
#[test]
#[ignore = "needs ../shared/refdata"]
fn vertex_colours_are_linear_in_every_type() {
    let model = loaded(&reference("generated/vertex_colors.glb"));
    let exact = [0.586_518_35, 0.839_684_6, 0.726_473_63];
    let bytes = [150.0, 214.0, 185.0].map(|level: f64| level / 255.0);
    let shorts = [38437.0, 55029.0, 47609.0].map(|level: f64| level / 65535.0);
    for (k, expected) in [exact, exact, bytes, bytes, shorts, shorts].into_iter().enumerate() {
        let own = model.world.objects[k].mesh().unwrap().color(0, DVec2::ZERO).unwrap();
        assert!((own - Color::from(expected)).length() < 1e-7, "{k}: {own}");
        // Nothing else colours them.
        assert_eq!(model.world.objects[k].color(), Color::ONE);
    }
}

#[test]
fn a_primitive_without_a_material_is_neutral() {
    let model = Builder::triangle().load().unwrap();
    assert!(model.world.objects[0].materials().is_empty());
}

/// One red pixel.
fn png() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().unwrap().write_image_data(&[255, 0, 0]).unwrap();
    bytes
}

/// A picture of one colour and 8192 x 8192 texels, in 8 kB.
fn flat_png() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 8192, 8192);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::One);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&vec![0; 8192 * 8192 / 8]).unwrap();
    writer.finish().unwrap();
    bytes
}

/// A document of 20 images of one source.
fn with_images(builder: &mut Builder, image: Value) {
    let many = 0..20;
    builder.json["images"] = json!(vec![image; 20]);
    let textures: Vec<Value> = many.clone().map(|k| json!({"source": k})).collect();
    builder.json["textures"] = json!(textures);
    let material = |k: usize| json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": k}}});
    builder.json["materials"] = json!(many.clone().map(material).collect::<Vec<_>>());
    let primitive = builder.primitive().clone();
    let with_material = |k: usize| {
        let mut primitive = primitive.clone();
        primitive["material"] = json!(k);
        primitive
    };
    builder.json["meshes"][0]["primitives"] = json!(many.map(with_material).collect::<Vec<_>>());
}

/// In the document itself, and beside it.
#[test]
fn a_small_file_has_few_large_textures() {
    let mut within = textured();
    let picture = within.view(&flat_png());
    with_images(&mut within, json!({"bufferView": picture, "mimeType": "image/png"}));
    let mut beside = textured();
    with_images(&mut beside, json!({"uri": "flat.png"}));
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("flat.png"), flat_png()).unwrap();
    let path = folder.path().join("a.gltf");
    fs::write(&path, beside.text()).unwrap();
    for model in [within.load().unwrap(), loaded(&path)] {
        let has_texture =
            |object: &&firsthit::Object| object.materials()[0].maps.get(MapRole::Color).is_some();
        assert_eq!(model.world.objects.iter().filter(has_texture).count(), 2);
        let [warning] = model.warnings.as_slice() else { panic!("{:?}", model.warnings) };
        let words = "256 MiB of memory, of which 1/16 counts, ";
        assert!(warning.contains(words) && warning.ends_with("(and 17 more like it)"), "{warning}");
    }
}

fn textured() -> Builder {
    let mut builder = Builder::triangle();
    builder.attribute("TEXCOORD_0", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0], "VEC2");
    builder.json["materials"] = json!([{"pbrMetallicRoughness":
        {"baseColorTexture": {"index": 0}, "baseColorFactor": [0.5, 1, 1, 1]}}]);
    builder.json["textures"] = json!([{"source": 0}]);
    let uri = format!("data:image/png;base64,{}", STANDARD.encode(png()));
    builder.json["images"] = json!([{"uri": uri}]);
    builder.primitive()["material"] = json!(0);
    builder
}

#[test]
fn images_come_from_data_uris_views_and_files_beside_the_document() {
    let expected = Some(Color::new(0.5, 0.0, 0.0));
    let seen = |model: Loaded| color(&Scene::new(model.world.objects).unwrap(), 0.2, 0.2);
    assert_eq!(seen(textured().load().unwrap()), expected);

    let mut builder = textured();
    let view = builder.view(&png());
    builder.json["images"] = json!([{"bufferView": view, "mimeType": "image/png"}]);
    assert_eq!(seen(builder.load().unwrap()), expected);

    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("red one.png"), png()).unwrap();
    fs::write(folder.path().join("a.bin"), &builder.buffer).unwrap();
    builder.json["images"] = json!([{"uri": "red%20one.png"}]);
    builder.json["buffers"] = json!([{"uri": "a.bin", "byteLength": builder.buffer.len()}]);
    let path = folder.path().join("a.gltf");
    fs::write(&path, builder.text()).unwrap();
    let model = loaded(&path);
    assert_eq!(model.warnings, [""; 0]);
    assert_eq!(seen(model), expected);
}

#[test]
fn an_image_that_cannot_be_had_is_one_warning_and_a_flat_colour() {
    for (image, word) in [
        (json!({"uri": "missing.png"}), "missing.png"),
        (json!({"uri": "../up.png"}), "refused"),
        (json!({"uri": "http://host/x.png"}), "refused"),
        (json!({"uri": "data:image/png;base64,AAAA"}), "format"),
        (json!({}), "neither"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let mut builder = textured();
        builder.json["images"] = json!([image]);
        let path = folder.path().join("a.gltf");
        fs::write(&path, builder.text()).unwrap();
        let model = loaded(&path);
        let [warning] = &model.warnings[..] else { panic!("{:?}", model.warnings) };
        assert!(warning.contains("#/images/0: ") && warning.contains(word), "{warning}");
        let scene = Scene::new(model.world.objects).unwrap();
        assert_eq!(color(&scene, 0.2, 0.2), Some(Color::new(0.5, 1.0, 1.0)));
    }
}

#[test]
fn pictures_in_formats_that_are_not_read_have_their_fallback_or_a_flat_colour() {
    let mut builder = textured();
    builder.json["textures"] = json!([{"extensions": {"KHR_texture_basisu": {"source": 0}}}]);
    let model = builder.load().unwrap();
    assert!(model.warnings[0].contains("KHR_texture_basisu"), "{:?}", model.warnings);
    builder.json["textures"] =
        json!([{"source": 0, "extensions": {"KHR_texture_basisu": {"source": 0}}}]);
    assert_eq!(builder.load().unwrap().warnings, [""; 0]);
}

#[test]
fn a_texture_without_its_coordinates_is_a_warning() {
    let mut builder = textured();
    builder.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = json!(3);
    let model = builder.load().unwrap();
    assert!(model.warnings[0].contains("TEXCOORD_3"), "{:?}", model.warnings);
}

#[test]
fn the_alpha_of_vertices_counts_for_masks() {
    let mut builder = Builder::triangle();
    builder.json["materials"] = json!([{"alphaMode": "MASK", "alphaCutoff": 0.5}]);
    builder.primitive()["material"] = json!(0);
    // From 1 at the origin down to 0 at the other corners.
    let colors = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.0];
    builder.attribute("COLOR_0", &colors, "VEC4");
    let model = builder.load().unwrap();
    assert_eq!(model.world.objects[0].materials()[0].alpha_mode, AlphaMode::Mask { cutoff: 0.5 });
    let scene = Scene::new(model.world.objects).unwrap();
    assert!(color(&scene, 0.2, 0.2).is_some());
    assert!(color(&scene, 0.3, 0.3).is_none());
}

#[test]
fn samplers_say_how_a_texture_goes_on_and_what_lies_between_texels() {
    let mut builder = textured();
    builder.json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]);
    builder.json["textures"][0]["sampler"] = json!(0);
    let model = builder.load().unwrap();
    let map = model.world.objects[0].materials()[0].maps.get(MapRole::Color).cloned().unwrap();
    assert_eq!(map.wrap, [Wrap::Clamp, Wrap::Mirror]);
    assert_eq!(map.filter, Filter::Nearest);
}

#[test]
fn normals_are_interpolated_for_shading() {
    let mut builder = Builder::triangle();
    let tilted = [0.0, 0.0, 1.0, 0.6, 0.0, 0.8, 0.0, 0.0, 1.0];
    let bytes: Vec<u8> = tilted.iter().flat_map(|x: &f32| x.to_le_bytes()).collect();
    let normals = builder.accessor(&bytes, FLOAT, 3, "VEC3");
    builder.primitive()["attributes"]["NORMAL"] = json!(normals);
    let model = builder.load().unwrap();
    let mesh = model.world.objects[0].mesh().unwrap();
    let normal = mesh.shading_normal(0, DVec2::new(1.0, 0.0)).unwrap();
    assert!((normal - DVec3::new(0.6, 0.0, 0.8)).length() < 1e-7);
}

#[test]
fn words_of_samplers_that_mean_nothing_are_a_warning() {
    let mut builder = textured();
    builder.json["samplers"] = json!([{"wrapS": 1, "minFilter": 9728}]);
    builder.json["textures"][0]["sampler"] = json!(0);
    let model = builder.load().unwrap();
    let map = model.world.objects[0].materials()[0].maps.get(MapRole::Color).cloned().unwrap();
    assert_eq!(map.wrap, [Wrap::Repeat; 2]);
    assert_eq!(
        model.warnings,
        ["a.gltf#/samplers/0/wrapS: must be one of [10497, 33071, 33648], got 1: \
             the default is taken"]
    );
}

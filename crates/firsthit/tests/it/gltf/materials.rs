//! Materials, normal maps, and numbers that make no sense.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use firsthit::load::{LoadSettings, Loaded, load_bytes};
use firsthit::scene::{MapRole, MetalRough, Model, SurfaceInteraction, UvSet};
use firsthit::{Color, DVec3, Material, Ray, Scene, shoot};
use serde_json::{Value, json};

use super::builder::Builder;

/// A triangle of this material.
fn of(material: &Value) -> Builder {
    let mut builder = Builder::triangle();
    builder.json["materials"] = json!([material]);
    builder.primitive()["material"] = json!(0);
    builder
}

fn material(model: &Loaded) -> &Material {
    &model.world.objects[0].materials()[0]
}

fn metal_rough(model: &Loaded) -> MetalRough {
    match material(model).model {
        Model::MetalRough(settings) => settings,
        other => panic!("{other:?}"),
    }
}

/// A picture of two texels beside each other, as a data URI.
fn picture(texels: [[u8; 4]; 2]) -> String {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 2, 1);
    encoder.set_color(png::ColorType::Rgba);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(texels.as_flattened()).unwrap();
    writer.finish().unwrap();
    format!("data:image/png;base64,{}", STANDARD.encode(bytes))
}

/// Adds a texture of two texels, which do not repeat.
fn with_texture(builder: &mut Builder, texels: [[u8; 4]; 2]) {
    builder.json["images"] = json!([{"uri": picture(texels)}]);
    builder.json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33071}]);
    builder.json["textures"] = json!([{"source": 0, "sampler": 0}]);
}

/// A property of the surface where the triangle is met from above.
fn surface<T>(model: Loaded, of: impl Fn(&SurfaceInteraction<'_>) -> T) -> T {
    let scene = Scene::new(model.world.objects).unwrap();
    let ray = Ray::new(DVec3::new(0.25, 0.25, 1.0), DVec3::new(0.1, 0.2, -1.0));
    let hit = shoot(&scene, ray.origin, ray.direction);
    of(&scene.interaction(&ray, &hit).expect("it is met"))
}

#[test]
fn a_material_without_words_is_what_gltf_says() {
    let model = of(&json!({})).load().unwrap();
    assert!(model.warnings.is_empty(), "{:?}", model.warnings);
    let settings = metal_rough(&model);
    assert_eq!((settings.metallic, settings.roughness), (1.0, 1.0));
    let expected = MetalRough { metallic: 1.0, roughness: 1.0, ..MetalRough::default() };
    assert_eq!(settings, expected);
    let unlit = of(&json!({"extensions": {"KHR_materials_unlit": {}}}));
    assert_eq!(material(&unlit.load().unwrap()).model, Model::default());
}

#[test]
fn every_number_of_the_extensions_arrives() {
    let model = of(&json!({
        "pbrMetallicRoughness": {"metallicFactor": 0.25, "roughnessFactor": 0.75},
        "emissiveFactor": [0.5, 0.25, 1],
        "extensions": {
            "KHR_materials_emissive_strength": {"emissiveStrength": 8},
            "KHR_materials_ior": {"ior": 1.33},
            "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [1, 2, 0.5]},
            "KHR_materials_transmission": {"transmissionFactor": 0.9},
            "KHR_materials_volume": {"thicknessFactor": 0.1, "attenuationDistance": 2, "attenuationColor": [1, 0.5, 0.25]},
            "KHR_materials_clearcoat": {"clearcoatFactor": 0.8, "clearcoatRoughnessFactor": 0.1},
            "KHR_materials_sheen": {"sheenColorFactor": [0.1, 0.2, 0.3], "sheenRoughnessFactor": 0.4}
        }
    }));
    let model = model.load().unwrap();
    assert!(model.warnings.is_empty(), "{:?}", model.warnings);
    assert_eq!(material(&model).emission, Color::new(4.0, 2.0, 8.0));
    let expected = MetalRough {
        metallic: 0.25,
        roughness: 0.75,
        ior: 1.33,
        specular: 0.5,
        specular_color: Color::new(1.0, 2.0, 0.5),
        transmission: 0.9,
        solid: true,
        attenuation_color: Color::new(1.0, 0.5, 0.25),
        attenuation_distance: 2.0,
        clearcoat: 0.8,
        clearcoat_roughness: 0.1,
        clearcoat_normal_scale: 1.0,
        sheen_color: Color::new(0.1, 0.2, 0.3),
        sheen_roughness: 0.4,
    };
    assert_eq!(metal_rough(&model), expected);
    let halved = expected.absorption() * 2.0;
    assert!((halved - Color::new(0.0, 2_f64.ln(), 4_f64.ln())).length() < 1e-12);
}

#[test]
fn numbers_out_of_range_are_moved_into_it_with_one_warning() {
    let model = of(&json!({
        "pbrMetallicRoughness": {"metallicFactor": -3, "roughnessFactor": 1e300},
        "emissiveFactor": [-1, 2, 1e308],
        "extensions": {
            "KHR_materials_emissive_strength": {"emissiveStrength": 1e308},
            "KHR_materials_ior": {"ior": 0.3},
            "KHR_materials_volume": {"thicknessFactor": -1, "attenuationDistance": 0},
            "KHR_materials_clearcoat": {"clearcoatFactor": 1e9}
        }
    }));
    let model = model.load().unwrap();
    assert_eq!(
        model.warnings,
        [
            "a.gltf#/materials/0/metallicFactor: must be from 0 to 1, got -3: 0 is taken (and 8 more like it)"
        ]
    );
    let settings = metal_rough(&model);
    assert_eq!((settings.metallic, settings.roughness, settings.ior), (0.0, 1.0, 1.0));
    assert!(!settings.solid && settings.clearcoat == 1.0);
    assert!(material(&model).check_numbers().is_ok());
    let seen = surface(model, |surface| surface.bsdf().unwrap().value(DVec3::Z));
    assert!(seen.is_finite());
}

#[test]
fn a_surface_sends_back_no_more_light_than_it_gets() {
    let specular_glossiness = json!({
        "extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [3, 0.5, -1, 2]}}
    });
    let metal_rough =
        json!({"pbrMetallicRoughness": {"baseColorFactor": [3, 0.5, -1, 2], "metallicFactor": 0}});
    for (material_json, name) in
        [(metal_rough, "baseColorFactor"), (specular_glossiness, "diffuseFactor")]
    {
        let model = of(&material_json).load().unwrap();
        let material = material(&model);
        assert_eq!(material.color, Color::new(1.0, 0.5, 0.0));
        assert_eq!(material.alpha, 1.0);
        let warning = format!("/{name}: must be from 0 to 1, got 3: 1 is taken");
        assert!(model.warnings[0].contains(&warning), "{:?}", model.warnings);
    }
}

#[test]
fn maps_multiply_in_their_channels_and_data_is_no_colour() {
    let mut builder = of(&json!({
        "pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 0}, "baseColorTexture": {"index": 0, "texCoord": 3}},
        "occlusionTexture": {"index": 0, "strength": 0.5},
        "emissiveTexture": {"index": 0},
        "emissiveFactor": [1, 1, 1],
    }));
    with_texture(&mut builder, [[51, 102, 204, 255]; 2]);
    builder.attribute("TEXCOORD_0", &[0.0; 6], "VEC2");
    builder.attribute("TEXCOORD_3", &[0.0; 6], "VEC2");
    let model = builder.load().unwrap();
    assert!(model.warnings.is_empty(), "{:?}", model.warnings);
    let maps = &material(&model).maps;
    assert_eq!(maps.get(MapRole::Color).unwrap().uv_set, UvSet::First);
    assert_eq!(maps.get(MapRole::Occlusion).unwrap().uv_set, UvSet::Second);
    let (data, occlusion, emitted) = surface(model, |surface| {
        let data = surface.mapped(MapRole::MetallicRoughness).unwrap();
        (data, surface.occlusion(), surface.emitted())
    });
    assert_eq!(data, [0.2, 0.4, 0.8, 1.0]);
    assert!((occlusion - 0.6).abs() < 1e-12);
    // 0.2 in sRGB.
    assert!((emitted.x - 0.033_104_77).abs() < 1e-8, "{emitted}");
}

#[test]
fn a_third_set_of_coordinates_is_a_warning() {
    let mut builder = of(&json!({
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
        "occlusionTexture": {"index": 0, "texCoord": 1},
        "normalTexture": {"index": 0, "texCoord": 2},
    }));
    with_texture(&mut builder, [[255; 4]; 2]);
    for set in 0..3 {
        builder.attribute(&format!("TEXCOORD_{set}"), &[0.0; 6], "VEC2");
    }
    let model = builder.load().unwrap();
    assert_eq!(model.warnings.len(), 1, "{:?}", model.warnings);
    assert!(model.warnings[0].contains("#/materials/0/occlusionTexture: a third set"));
    assert_eq!(material(&model).maps.iter().count(), 2);
}

/// Between 127 and 128 the level is one half: no tilt.
const LEVEL: [[u8; 4]; 2] = [[127, 127, 255, 255], [128, 128, 255, 255]];

fn normal_mapped(texels: [[u8; 4]; 2], uvs: &[f32; 6]) -> Builder {
    let pbr = json!({"metallicFactor": 0.5, "roughnessFactor": 0.4});
    let mut builder = of(&json!({"normalTexture": {"index": 0}, "pbrMetallicRoughness": pbr}));
    with_texture(&mut builder, texels);
    builder.attribute("TEXCOORD_0", uvs, "VEC2");
    builder
}

fn value(model: Loaded) -> Color {
    let light = DVec3::new(0.3, -0.5, 0.8).normalize();
    surface(model, |surface| surface.bsdf().unwrap().value(light))
}

#[test]
fn a_normal_map_without_a_tilt_changes_nothing() {
    let middle = [0.5; 6];
    let mapped = normal_mapped(LEVEL, &[0.5, 0.0, 0.5, 0.0, 0.5, 1.0]);
    let mut plain = normal_mapped(LEVEL, &middle);
    plain.json["materials"][0]["normalTexture"] = Value::Null;
    let plain = value(plain.load().unwrap());
    let mut with_tangents = normal_mapped(LEVEL, &middle);
    with_tangents.attribute("NORMAL", &[0.0, 0.0, 2.0].repeat(3), "VEC3");
    with_tangents.attribute("TANGENT", &[0.6, 0.8, 0.0, -1.0].repeat(3), "VEC4");
    for mapped in [mapped, with_tangents] {
        let mapped = value(mapped.load().unwrap());
        assert!((mapped - plain).length() < 1e-12, "{mapped} {plain}");
    }
}

/// The texture's rows run downwards: green leans upwards, against v. The texels say x, y = 0.6 to
/// the right, or 0.6 upwards.
#[test]
fn normal_maps_lean_as_gltf_says_in_mirrors_too() {
    let right = [[204, 128, 230, 255]; 2];
    let up = [[128, 204, 230, 255]; 2];
    // On the triangle u runs along x, and v against y.
    let uvs = [0.0, 1.0, 1.0, 1.0, 0.0, 0.0];
    let lean = |builder: &Builder| {
        // A white matte surface: values of three lights tell the normal.
        let mut builder = Builder { json: builder.json.clone(), buffer: builder.buffer.clone() };
        builder.json["materials"][0]["extensions"] =
            json!({"KHR_materials_specular": {"specularFactor": 0}});
        builder.json["materials"][0]["pbrMetallicRoughness"] =
            json!({"metallicFactor": 0, "roughnessFactor": 1});
        let tilted = |towards: DVec3| {
            let towards = towards.normalize();
            surface(builder.load().unwrap(), |surface| surface.bsdf().unwrap().value(towards).x)
        };
        let [x, y] =
            [DVec3::X, DVec3::Y].map(|axis| tilted(axis + DVec3::Z) - tilted(DVec3::Z - axis));
        [x, y]
    };
    let mirrored = |mut builder: Builder| {
        builder.json["nodes"][0]["matrix"] =
            json!([-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.8, 0, 0, 1]);
        builder
    };
    // Off by the eight bits of the texels, and by what is taken from light near the edge.
    for (texels, [x, y]) in [(right, [1.0, 0.0]), (up, [0.0, 1.0])] {
        let [got_x, got_y] = lean(&normal_mapped(texels, &uvs));
        let scale = 2_f64.sqrt() * 0.6;
        assert!(
            (got_x - scale * x).abs() < 0.04 && (got_y - scale * y).abs() < 0.04,
            "{got_x} {got_y}"
        );
        let [got_x, got_y] = lean(&mirrored(normal_mapped(texels, &uvs)));
        assert!(
            (got_x + scale * x).abs() < 0.04 && (got_y - scale * y).abs() < 0.04,
            "{got_x} {got_y}"
        );
    }
}

#[test]
fn tangents_that_are_no_numbers_do_no_harm() {
    let mut builder = normal_mapped([[0, 0, 0, 255]; 2], &[f32::NAN, 0.0, 1e38, 1.0, -1e38, 0.0]);
    builder.attribute("NORMAL", &[0.0, 0.0, 1.0].repeat(3), "VEC3");
    assert!(value(builder.load().unwrap()).is_finite());
    builder.attribute("TANGENT", &[f32::NAN, f32::INFINITY, 0.0, 0.0].repeat(3), "VEC4");
    assert!(value(builder.load().unwrap()).is_finite());
}

/// A triangle with the variants beach and, of another material, midnight.
fn with_variants() -> Builder {
    let mut builder = of(&json!({"name": "plain"}));
    let names = json!([{"name": "beach"}, {"name": "mid\nnight"}, {"name": "none"}]);
    builder.json["extensionsUsed"] = json!(["KHR_materials_variants"]);
    builder.json["extensions"] = json!({"KHR_materials_variants": {"variants": names}});
    builder.json["materials"] = json!([{"name": "plain"}, {"name": "sand"}, {"name": "ink"}]);
    builder.primitive()["extensions"] = json!({"KHR_materials_variants": {"mappings": [
        {"material": 1, "variants": [0]}, {"material": 2, "variants": [1]},
    ]}});
    builder
}

#[test]
fn a_variant_by_name_brings_its_materials() {
    let builder = with_variants();
    let load = |variant: Option<&str>| {
        let settings =
            LoadSettings { variant: variant.map(str::to_owned), ..LoadSettings::default() };
        load_bytes("a.gltf".as_ref(), &builder.text(), &settings)
    };
    for (variant, name) in [
        (None, "plain"),
        (Some("beach"), "sand"),
        (Some("mid\nnight"), "ink"),
        (Some("none"), "plain"),
    ] {
        let model = load(variant).unwrap();
        assert_eq!(&*material(&model).name, name);
        assert_eq!(model.variants, ["beach", "mid\nnight", "none"]);
        assert!(model.warnings.is_empty(), "{:?}", model.warnings);
    }
    let message = load(Some("noon")).unwrap_err().to_string();
    assert_eq!(
        message,
        "variant must be one of the file's, got \"noon\"; there are \"beach\", \"mid\\nnight\", \"none\""
    );
}

#[test]
fn a_variant_of_a_file_that_has_none_is_refused_and_its_materials_must_be_there() {
    let settings = LoadSettings { variant: Some("beach".to_owned()), ..LoadSettings::default() };
    let text = of(&json!({})).text();
    let message = load_bytes("a.gltf".as_ref(), &text, &settings).unwrap_err();
    let expected = "variant must be one of the file's, got \"beach\"; it has none";
    assert_eq!(message.to_string(), expected);
    let mut builder = with_variants();
    builder.primitive()["extensions"]["KHR_materials_variants"]["mappings"][0]["material"] =
        json!(9);
    let message = load_bytes("a.gltf".as_ref(), &builder.text(), &settings).unwrap_err();
    let message = message.to_string();
    assert!(message.contains("there is no material 9"), "{message}");
}

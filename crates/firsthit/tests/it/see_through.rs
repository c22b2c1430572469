//! X-rays and ghosts against closed forms.

use firsthit::render::Picture;
use firsthit::scene::AlphaMode;
use firsthit::shade::{Ghost, Lambert, Xray};
use firsthit::shape::Shape;
use firsthit::shoot::{Count, trace};
use firsthit::{
    Background, Camera, Color, Cuboid, DVec3, Disc, Material, Mesh, Object, Plane, Positions,
    Scene, Shade, Shader, Shading, Sphere, shoot,
};

const BEHIND: Color = Color::new(0.5, 0.25, 1.0);

fn seen(scene: &Scene, shader: Shader, p: DVec3, u_r: DVec3) -> Color {
    let shade = Shading { background: Background::Uniform(BEHIND), ..shader.on(scene) };
    let hit = shoot(scene, p, u_r);
    shade.shade(hit.t, p, u_r, &hit)
}

fn scene(shapes: impl IntoIterator<Item = Shape>) -> Scene {
    Scene::new(shapes.into_iter().map(Object::new).collect()).unwrap()
}

fn cuboid(low: [f64; 3], high: [f64; 3]) -> Shape {
    Cuboid::new(low.into(), high.into()).unwrap().into()
}

fn xray(density: f64, skin: f64) -> Shader {
    let color = Color::ZERO;
    Shader::Xray(Xray { density, skin, color })
}

#[test]
fn a_box_lets_through_what_its_thickness_leaves() {
    let scene = scene([cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 1.5])]);
    for density in [0.25, 1.0, 8.0] {
        let left = libm::exp(-density * 1.5);
        let color = seen(&scene, xray(density, 0.0), 4.0 * DVec3::Z, DVec3::NEG_Z);
        assert_eq!(color, BEHIND * left);
        // The direction's length is of no account, and neither is where the ray starts: from inside
        // half of it is left.
        let color = seen(&scene, xray(density, 0.0), 4.0 * DVec3::Z, -8.0 * DVec3::Z);
        assert_eq!(color, BEHIND * left);
        let color = seen(&scene, xray(density, 0.0), 0.75 * DVec3::Z, DVec3::NEG_Z);
        assert_eq!(color, BEHIND * libm::exp(-density * 0.75));
    }
}

#[test]
fn objects_that_overlap_each_count_and_open_ones_have_no_inside() {
    let disc = Disc::new(DVec3::new(0.0, 0.0, 5.0), DVec3::Z, 1.0).unwrap();
    let scene = scene([
        cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 2.0]),
        disc.into(),
        cuboid([-1.0, -1.0, 1.0], [1.0, 1.0, 4.0]),
    ]);
    let color = seen(&scene, xray(0.125, 0.0), 9.0 * DVec3::Z, DVec3::NEG_Z);
    assert_eq!(color, BEHIND * libm::exp(-0.125 * 5.0));
}

/// Aslant by 60 degrees, each of the two surfaces of a slab counts twice.
#[test]
fn a_skin_absorbs_more_where_it_is_met_aslant() {
    let scene = scene([cuboid([-99.0, -99.0, 0.0], [99.0, 99.0, 1.0])]);
    let aslant = DVec3::new(3.0_f64.sqrt(), 0.0, -1.0);
    for (direction, count) in [(DVec3::NEG_Z, 2.0), (aslant, 4.0)] {
        let color = seen(&scene, xray(0.0, 0.25), 4.0 * DVec3::Z, direction);
        let expected = BEHIND * libm::exp(-0.25 * count);
        assert!((color - expected).length() < 1e-14, "{color} {expected}");
    }
}

#[test]
fn an_xray_is_covered_as_far_as_it_absorbs() {
    let scene = scene([cuboid([-1.0; 3], [1.0; 3])]);
    let shade = Shading {
        background: Background::Transparent,
        ..Shader::Xray(Xray { density: 0.5, skin: 0.0, color: Color::ONE }).on(&scene)
    };
    let ray = firsthit::Ray::new(4.0 * DVec3::Z, DVec3::NEG_Z);
    let samples = firsthit::shade::Samples {
        rays: &[ray],
        hits: &[shoot(&scene, ray.origin, ray.direction)],
        pixels: &[0],
        sample: 0,
        cull: None,
    };
    let (mut colors, mut coverage) = ([Color::ZERO], [1.0]);
    shade.shade_all(&samples, &mut colors, &mut coverage);
    assert_eq!(coverage, [1.0 - libm::exp(-1.0)]);
    assert_eq!(colors, [Color::splat(1.0 - libm::exp(-1.0))]);
}

fn ghost(opacity: f64) -> Shader {
    Shader::Ghost(Ghost { opacity, ..Ghost::default() })
}

/// Of n surfaces of the colour c, 1 - (1 - a)^n is seen of c and the rest is background.
#[test]
fn parallel_planes_are_a_geometric_series() {
    for count in [1, 2, 5, 40] {
        let plane = |k: i32| Plane::new(DVec3::new(0.0, 0.0, f64::from(-k)), DVec3::Z).unwrap();
        let red = Material { unlit: true, ..Material::colored(Color::new(0.75, 0.125, 0.0)) };
        let planes = (0..count).map(|k| Object::new(plane(k)).with_materials([red.clone()]));
        let scene = Scene::new(planes.collect()).unwrap();
        for opacity in [0.25, 0.5, 1.0] {
            let color = seen(&scene, ghost(opacity), 4.0 * DVec3::Z, DVec3::NEG_Z);
            let behind = libm::pow(1.0 - opacity, f64::from(count));
            let expected = red.color.lerp(BEHIND, behind);
            assert!((color - expected).length() < 1e-14, "{count} {opacity}: {color}");
        }
    }
}

/// From either side the nearer one is seen more, whatever their numbers are.
#[test]
fn ghosts_are_put_together_in_the_order_along_the_ray() {
    let disc = |z, color| {
        let disc = Disc::new(DVec3::new(0.0, 0.0, z), DVec3::Z, 1.0).unwrap();
        let material = Material { unlit: true, ..Material::colored(color) };
        Object::new(disc).with_materials([material])
    };
    let (red, green) = (DVec3::X, DVec3::Y);
    let scene = Scene::new(vec![disc(0.0, red), disc(1.0, green)]).unwrap();
    for (from, [first, second]) in [(DVec3::Z, [green, red]), (DVec3::NEG_Z, [red, green])] {
        let color = seen(&scene, ghost(0.25), 4.0 * from, -from);
        assert_eq!(color, 0.25 * first + 0.1875 * second + 0.5625 * BEHIND);
    }
}

#[test]
fn opaque_ghosts_are_lambert() {
    let ball = Sphere::new(DVec3::ZERO, 1.0).unwrap();
    let scene = scene([ball.into(), cuboid([-2.0, -2.0, -3.0], [2.0, 2.0, -2.0])]);
    let lambert = Shader::Lambert(Lambert { shadows: false, ..Lambert::default() });
    for x in [0.0, 0.5, 1.5] {
        let p = DVec3::new(x, 0.25, 5.0);
        let [ghost, lambert] =
            [ghost(1.0), lambert.clone()].map(|shader| seen(&scene, shader, p, DVec3::NEG_Z));
        assert_eq!(ghost, lambert, "{x}");
    }
}

/// A wall whose side is culled is not there, behind a translucent pane neither.
#[test]
fn what_is_culled_is_culled_behind_translucent_surfaces() {
    let colored = |alpha, color| Material {
        alpha,
        alpha_mode: AlphaMode::Blend,
        unlit: true,
        ..Material::colored(color)
    };
    let pane = Object::new(Disc::new(DVec3::Z, DVec3::Z, 0.5).unwrap())
        .with_materials([colored(0.1, Color::X)]);
    // Its back is seen.
    let wall = Object::new(Disc::new(DVec3::ZERO, DVec3::NEG_Z, 9.0).unwrap())
        .with_materials([colored(1.0, Color::Y)]);
    let camera = Camera::look_at(4.0 * DVec3::Z, DVec3::ZERO, DVec3::Y, 40.0, 9, 9).unwrap();
    let channels = [firsthit::channel::kind("color").unwrap()];
    let seen = |objects, cull| {
        let scene = Scene::new(objects).unwrap();
        let shade = Shader::named("unlit").unwrap().on(&scene);
        let picture = Picture { cull, ..Picture::new(&scene, &camera, &shade, &channels) };
        picture.render(&()).unwrap().channels().to_vec()
    };
    let both = vec![pane.clone(), wall];
    let back = Some(firsthit::Side::Back);
    assert_eq!(seen(both.clone(), back), seen(vec![pane.clone()], back));
    assert_ne!(seen(both, None), seen(vec![pane], None));
}

/// Squares above each other, of these alphas, each of two triangles.
fn panes(alphas: &[f64]) -> Scene {
    let pane = |(height, alpha): (u32, &f64)| {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let corners = corners.map(|[x, y]| [x, y, f64::from(height)]);
        let triangles = vec![[0, 1, 2], [0, 2, 3]];
        let mesh = Mesh::new(Positions::compact(corners.to_vec()), triangles).unwrap();
        let material =
            Material { alpha: *alpha, alpha_mode: AlphaMode::Blend, ..Material::default() };
        Object::new(std::sync::Arc::new(mesh)).with_materials([material])
    };
    Scene::new((0..).zip(alphas).map(pane).collect()).unwrap()
}

#[test]
fn rays_pass_what_is_translucent_below_an_alpha_if_they_are_asked_to() {
    let scene = panes(&[1.0, 0.5, 0.49, 0.0]);
    let from = DVec3::new(0.3, 0.2, 9.0);
    let first = |scene: &Scene| shoot(scene, from, DVec3::NEG_Z).object;
    assert_eq!(first(&scene), 3);
    for (cutoff, object) in [(0.0, 3), (0.2, 2), (0.5, 1), (0.51, 0), (1.0, 0)] {
        let cut = scene.with_blend_below(cutoff).unwrap();
        assert_eq!(first(&cut), object, "{cutoff}");
        assert!(!cut.has_translucent() && scene.has_translucent());
        let rays = [firsthit::Ray::new(from, DVec3::NEG_Z)];
        let count = trace(&cut, &rays, Count, &()).unwrap();
        assert_eq!(count[0], u32::try_from(object).unwrap() + 1);
    }
    for cutoff in [-0.1, 1.1, f64::NAN] {
        let message = scene.with_blend_below(cutoff).unwrap_err().to_string();
        assert!(message.starts_with("blend_below must be from 0 to 1, got "), "{message}");
    }
}

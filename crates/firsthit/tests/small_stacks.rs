//! Callers' threads may be small: nothing that is asked of a scene overflows a stack of 256 KiB.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::sync::Arc;

use firsthit::scene::DirectionalLight;
use firsthit::shade::Ground;
use firsthit::shoot::{Any, Cpu, Engine, First, trace_with};
use firsthit::{
    Camera, DVec3, InstructionSet, Light, Mesh, Object, Positions, Ray, Scene, Shader, Shading,
    Sphere, render,
};

const STACK_BYTES: usize = 256 << 10;

/// A wavy sheet of `2 * 40 * 40` triangles from -1 to 1, in the plane z = 0.
fn sheet() -> Mesh {
    let place = |k: u32| f64::from(k) / 20.0 - 1.0;
    let height = |k: u32| 0.1 * place(k % 41) * place(k / 41);
    let points = (0..41 * 41).map(|k| [place(k % 41), place(k / 41), height(k)]);
    let cell = |k: u32| {
        let a = k / 40 * 41 + k % 40;
        [[a, a + 1, a + 41], [a + 1, a + 42, a + 41]]
    };
    let triangles = (0..40 * 40).flat_map(cell).collect();
    Mesh::new(Positions::Double(points.collect()), triangles).unwrap()
}

/// Every way into the kernels, through one mesh and through several objects.
fn ask_everything(set: InstructionSet) {
    let mesh = Arc::new(sheet());
    let ball = Object::new(Sphere::new(DVec3::new(0.2, -0.3, 0.5), 0.3).unwrap());
    let sun = Light::from(DirectionalLight {
        direction: DVec3::new(0.2, 0.1, -1.0),
        color: DVec3::ONE,
        angle_degrees: 10.0,
    });
    let alone = Scene::new(vec![Object::new(Arc::clone(&mesh))]).unwrap();
    let beside = Scene::new(vec![Object::new(mesh), ball]).unwrap();
    let eye = DVec3::new(0.3, -2.0, 3.0);
    let camera = Camera::look_at(eye, DVec3::ZERO, DVec3::Z, 30.0, 40, 60).unwrap();
    let pixel = |k: usize| camera.ray(k / camera.columns(), k % camera.columns());
    let row_by_row: Vec<Ray> = (0..camera.pixels()).map(pixel).collect();
    let shuffled: Vec<Ray> =
        (0..camera.pixels()).map(|k| pixel(k * 7919 % camera.pixels())).collect();
    for scene in [alone, beside] {
        let scene = scene.with_lights(vec![sun]);
        let engine = Cpu::with(set);
        let middle = pixel(20 * 60 + 30);
        assert!(engine.first_hit(&scene, &middle).t < 5.0);
        assert!(engine.any_hit(&scene, &middle));
        for rays in [&row_by_row, &shuffled] {
            assert_eq!(trace_with(&engine, &scene, rays, First, &()).unwrap().len(), rays.len());
            assert!(trace_with(&engine, &scene, rays, Any, &()).unwrap().contains(&true));
        }
        let color = firsthit::channel::kind("color").unwrap();
        for name in ["lambert", "phong", "direct", "path", "ao"] {
            let shade = Shading {
                engine: &engine,
                ground: Ground::under(&scene, DVec3::Z),
                ..Shader::named(name).unwrap().on(&scene)
            };
            let frame = render(&scene, &camera, &shade, &[color], 2, &()).unwrap();
            assert_eq!(frame.shape(), &[40, 60]);
        }
    }
}

#[test]
fn kernels_fit_on_the_small_stack_of_a_caller_and_of_its_pool() {
    for set in InstructionSet::available() {
        let builder = rayon::ThreadPoolBuilder::new().num_threads(2);
        let pool = builder.stack_size(STACK_BYTES).build().unwrap();
        pool.install(|| ask_everything(set));
        let thread = std::thread::Builder::new().stack_size(STACK_BYTES);
        let caller = thread.spawn(move || ask_everything(set)).unwrap();
        caller.join().unwrap();
    }
}

//! A newcomer's program: rays and pictures of meshes, on the threads that there are and on a very
//! small one.

use std::sync::Arc;

use firsthit::channel::kind;
use firsthit::image::Channel;
use firsthit::render::Picture;
use firsthit::measure::{Grouping, inside};
use firsthit::nearest::closest_point;
use firsthit::shoot::{All, Any, Count, Cpu, Engine, First, trace_with};
use firsthit::{
    Camera, Color, DVec3, Hit, InstructionSet, Mesh, Object, Positions, Ray, Result, Scene, Sphere,
};

/// Two triangles for each square of a hilly grid.
fn hills(side: u32) -> Result<Arc<Mesh>> {
    let at = |k: u32| f64::from(k) / f64::from(side) - 0.5;
    let mut points = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..=side {
        for j in 0..=side {
            let (x, y) = (at(i), at(j));
            points.push([x, y, 0.1 * (9.0 * x).sin() * (7.0 * y).cos()]);
            if i < side && j < side {
                let corner = i * (side + 1) + j;
                let across = corner + side + 2;
                triangles.push([corner, across - 1, across]);
                triangles.push([corner, across, corner + 1]);
            }
        }
    }
    Ok(Arc::new(Mesh::new(Positions::compact(points), triangles)?))
}

/// Rays from above, each in a direction of its own.
fn scattered(count: u32) -> Vec<Ray> {
    let fraction = |k: u32, factor: f64| (f64::from(k) * factor).fract() - 0.5;
    let ray = |k| {
        let origin = DVec3::new(fraction(k, 0.618), fraction(k, 0.755), 1.0);
        let direction = DVec3::new(fraction(k, 0.57), fraction(k, 0.41), -1.0);
        Ray::new(origin, direction)
    };
    (0..count).map(ray).collect()
}

/// How many rays hit of one, a few and many, in all the ways in which rays go, and a picture.
fn everything(engine: &dyn Engine, scene: &Scene) -> Result<(Vec<usize>, Vec<Channel>)> {
    let eye = DVec3::new(0.3, -1.5, 1.0);
    let camera = Camera::look_at(eye, DVec3::ZERO, DVec3::Z, 40.0, 40, 60)?;
    let mut counts = Vec::new();
    let one = camera.ray(20, 30);
    counts.push(usize::from(!engine.first_hit(scene, &one).is_miss()));
    for count in [1, 20, 5000] {
        let rays = scattered(count);
        let hits = trace_with(engine, scene, &rays, First, &())?;
        counts.push(hits.object.iter().filter(|&&object| object >= 0).count());
        let occluded = trace_with(engine, scene, &rays, Any, &())?;
        counts.push(occluded.into_iter().filter(|&is| is).count());
    }
    let rays = scattered(3000);
    let all = trace_with(engine, scene, &rays, All::default(), &())?;
    let crossings = trace_with(engine, scene, &rays, Count, &())?;
    let total: usize = crossings.into_iter().map(|count| count as usize).sum();
    assert!(all.hits.len() == total && total > 1500, "{total}");
    let middle = DVec3::new(0.2, 0.2, 0.2);
    let near = closest_point(scene, middle)?.expect("there is something");
    assert!(near.distance < 0.31, "{near:?}");
    // The middle of the ball, where that is there; the hills are open.
    let found = inside(scene, &[middle], Grouping::Object, &())?;
    let has_ball = found.is_inside.len() == 2;
    assert_eq!(found.is_inside.last(), Some(&has_ball));
    counts.push(total);
    let depth_cue = |t: f64, _: DVec3, _: DVec3, _: &Hit| Color::splat(1.0 / (1.0 + t));
    let channels = [kind("color")?, kind("t")?];
    let picture = Picture {
        samples: 4,
        engine,
        ..Picture::new(scene, &camera, &depth_cue, &channels)
    };
    Ok((counts, picture.render(&())?.into_channels()))
}

fn main() -> Result<()> {
    let ball = Object::new(Sphere::new(DVec3::new(0.2, 0.2, 0.2), 0.1)?);
    let alone = Scene::new(vec![Object::new(hills(60)?)])?;
    let together = Scene::new(vec![Object::new(hills(60)?), ball])?;
    for set in InstructionSet::available() {
        for scene in [&alone, &together] {
            let (scene, engine) = (scene.clone(), Cpu::with(set));
            println!("{}, on rayon's threads", set.name());
            let expected = everything(&engine, &scene)?;
            assert!(expected.0[5] > 2500, "{:?}", expected.0);
            println!("{}, from a thread of 256 KiB", set.name());
            let small = std::thread::Builder::new().stack_size(256 << 10);
            let found = small.spawn(move || {
                // Made here, too: from vertices to trees.
                hills(60)?;
                everything(&engine, &scene)
            });
            let found = found.expect("a thread is granted").join().expect("no panic")?;
            assert!(found == expected, "{set:?}");
        }
    }
    Ok(())
}

//! Lines along edges: where they are, what hides them, and that they are the same however they are
//! made.

mod kinds;
mod lenses;
mod pictures;
mod shapes;
mod visibility;

use firsthit::camera::Viewplane;
use firsthit::edge::{EdgeKind, EdgeKinds, Edges, Lines, Subject};
use firsthit::shoot::Cpu;
use firsthit::{Camera, DVec3, Lens, Mesh, Object, Positions, Scene, View};

const SIDE: usize = 200;

/// A cube from -1 to 1, each face of two triangles.
fn cube() -> Mesh {
    let corner = |k: u32| [0, 1, 2].map(|axis| if k >> axis & 1 == 1 { 1.0 } else { -1.0 });
    let quads =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let halves = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let faces = (0..12).map(|triangle| triangle / 2).collect();
    let mesh = Mesh::new(Positions::compact((0..8).map(corner).collect()), halves.collect());
    mesh.unwrap().with_faces(faces).unwrap()
}

fn mesh(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Mesh {
    Mesh::new(Positions::compact(points.to_vec()), triangles.to_vec()).unwrap()
}

fn scene(objects: Vec<Object>) -> Scene {
    Scene::new(objects).unwrap()
}

fn of(shape: impl Into<firsthit::Shape>) -> Scene {
    scene(vec![Object::new(shape)])
}

/// A camera that sees a square of 4 units, fifty pixels each, in parallel.
fn parallel(aim: DVec3) -> Camera {
    let viewplane = Viewplane {
        width: 4.0,
        height: 4.0,
        parallel: true,
        ray_start: firsthit::RayStart::Eye,
        ..Viewplane::default()
    };
    let view = View {
        position: -10.0 * aim.normalize(),
        aim,
        up: if aim.x == 0.0 && aim.y == 0.0 { DVec3::Y } else { DVec3::Z },
        rows: SIDE,
        columns: SIDE,
        lens: Lens::Flat(viewplane),
    };
    Camera::new(view).unwrap()
}

fn perspective(position: DVec3) -> Camera {
    Camera::look_at(position, DVec3::ZERO, DVec3::Z, 35.0, SIDE, SIDE).unwrap()
}

fn lines_of(scene: &Scene, camera: &Camera, edges: &Edges) -> Lines {
    let subject = Subject { scene, camera, engine: Cpu::shared(), cull: None };
    let all = [0..camera.rows(), 0..camera.columns()];
    Lines::new(&subject, edges, all, &()).unwrap()
}

fn covered(scene: &Scene, camera: &Camera, edges: &Edges) -> Vec<f32> {
    let lines = lines_of(scene, camera, edges);
    lines.coverage(0..camera.rows(), 0..camera.columns(), &()).unwrap()
}

/// The length of all pieces.
fn length(lines: &Lines) -> f64 {
    lines.pieces().iter().map(|[a, b]| a.distance(*b)).sum()
}

fn only(kinds: &[EdgeKind]) -> Edges {
    Edges { kinds: EdgeKinds::of(kinds), ..Edges::default() }
}

/// The lengths in the picture of the edges of the cube of which a face is seen.
fn seen_of_cube(camera: &Camera) -> f64 {
    let mut total = 0.0;
    for axis in 0..3 {
        for (i, j) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let ends = [-1.0, 1.0].map(|k| {
                let mut end = DVec3::splat(k);
                (end[(axis + 1) % 3], end[(axis + 2) % 3]) = (i, j);
                end
            });
            let toward = match camera.lens().viewplane() {
                Some(viewplane) if viewplane.parallel => -camera.aim(),
                _ => camera.position(),
            };
            let is_in_front = |axis: usize, side: f64| {
                let from = if camera.lens().viewplane().unwrap().parallel { 0.0 } else { 1.0 };
                side * toward[axis] > from
            };
            if is_in_front((axis + 1) % 3, i) || is_in_front((axis + 2) % 3, j) {
                let [a, b] = ends.map(|end| camera.project(end).unwrap());
                total += a.distance(b);
            }
        }
    }
    total
}

/// A ball of triangles, pole to pole.
fn ball(rings: u32, parts: u32) -> Mesh {
    let mut points = Vec::new();
    for ring in 0..=rings {
        let (sine, cosine) =
            libm::sincos(std::f64::consts::PI * f64::from(ring) / f64::from(rings));
        for part in 0..parts {
            let (y, x) = libm::sincos(std::f64::consts::TAU * f64::from(part) / f64::from(parts));
            points.push([sine * x, sine * y, cosine]);
        }
    }
    let mut triangles = Vec::new();
    for ring in 0..rings {
        for part in 0..parts {
            let at = |ring: u32, part: u32| ring * parts + part % parts;
            let [a, b] = [at(ring, part), at(ring, part + 1)];
            let [c, d] = [at(ring + 1, part), at(ring + 1, part + 1)];
            triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    Mesh::new(Positions::Double(points.into()), triangles).unwrap()
}

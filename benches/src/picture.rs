//! Whole pictures: firsthit renders them, colours and all; Embree traces the rays that they take,
//! and shades nothing.

use firsthit::render::Sample;
use firsthit::scene::PointLight;
use firsthit::shade::Shade as _;
use firsthit::{Background, Camera, Color, DVec3, Light, Ray, Scene, Shader, Shading};

use crate::check::Judge;
use crate::embree::{self, Answers, Columns, Door, Pixels, Source as _};
use crate::firsthit_side;

/// The number of samples of a pixel where there are several.
const SAMPLES: u32 = 4;

/// A picture, and its rays for Embree.
pub(crate) struct Picture {
    scene: Scene,
    camera: Camera,
    shader: Shader,
    samples: u32,
    /// The rays through the points of all pixels, pixel by pixel; the camera's own where a pixel
    /// has one.
    points: Option<Columns>,
    shadows: Option<Columns>,
}

impl Picture {
    /// A picture whose colours are means over four points, without light.
    pub(crate) fn antialiased(scene: &Scene, camera: &Camera) -> Self {
        let points = (0..camera.pixels()).flat_map(|pixel| (0..SAMPLES).map(move |k| (pixel, k)));
        let rays: Vec<Ray> = points.map(|(pixel, k)| Sample::new(camera, k).ray(pixel)).collect();
        Self {
            scene: scene.clone(),
            camera: *camera,
            shader: named("unlit"),
            samples: SAMPLES,
            points: Some(Columns::new(&rays)),
            shadows: None,
        }
    }

    /// One point to a pixel, lit from one place, with shadows.
    pub(crate) fn shaded(scene: &Scene, camera: &Camera, light: DVec3, shadows: &[Ray]) -> Self {
        let light = Light::from(PointLight {
            position: light,
            intensity: Color::splat((camera.position() - light).length_squared()),
        });
        Self {
            scene: scene.clone().with_lights(vec![light]),
            camera: *camera,
            shader: named("lambert"),
            samples: 1,
            points: None,
            shadows: Some(Columns::new(shadows)),
        }
    }

    /// The number of points in all.
    pub(crate) fn count(&self) -> usize {
        self.camera.pixels() * self.samples as usize
    }

    /// The number of pixels.
    pub(crate) fn pixels(&self) -> usize {
        self.camera.pixels()
    }

    fn shading(&self) -> Shading<'_> {
        Shading { background: Background::default(), ..self.shader.clone().on(&self.scene) }
    }

    /// The colours of all pixels, three numbers each.
    pub(crate) fn render(&self) -> Vec<f32> {
        firsthit_side::colors(&self.scene, &self.camera, &self.shading(), self.samples)
    }

    /// The colour of a pixel, its hits found by the judge.
    pub(crate) fn judged(&self, pixel: usize, judge: &Judge<'_>) -> [f32; 3] {
        let shading = self.shading();
        let point = |k| {
            let ray = Sample::new(&self.camera, k).ray(pixel);
            let hit = judge.first_hit(&ray);
            shading.shade(hit.t, ray.origin, ray.direction, &hit)
        };
        let sum = (0..self.samples).map(point).fold(Color::ZERO, |a, b| a + b);
        (sum / f64::from(self.samples)).to_array().map(|x| x as f32)
    }

    /// The work of Embree for it, but for the shading: its rays, and those to the light.
    pub(crate) fn trace(&self, scene: &embree::Scene<'_>, door: Door, answers: &mut Answers) {
        match &self.points {
            Some(points) => scene.first_hits(points, door, answers),
            None => scene.first_hits(&Pixels::new(&self.camera), door, answers),
        }
        if let Some(shadows) = self.shadows.as_ref().filter(|shadows| shadows.len() > 0) {
            scene.any_hits(shadows, door, answers);
        }
    }
}

fn named(shader: &str) -> Shader {
    Shader::named(shader).expect("the library has it")
}

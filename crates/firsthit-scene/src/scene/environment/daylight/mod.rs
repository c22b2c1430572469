//! The sky of a clear day, by its sun and its haze.

mod perez;
mod sun;

use std::sync::Arc;

use super::directions::DirectionTable;
use super::irradiance::IrradianceCache;
use crate::error::Result;
use crate::geometry::{
    Color, DMat3, DVec3, luminance, require, require_direction, rotation, unit, upright,
};
use crate::scene::DirectionalLight;
use perez::Sky;

/// The sky of a day by Preetham, Shirley and Smits ("A Practical Analytic Model for Daylight",
/// SIGGRAPH 1999), over ground of one colour.
///
/// It is exposed so that a white, level surface under all of it takes a luminance of 1: the sky's
/// light and the [sun's](Self::sun_light), which is a light of its own. The ground sends back what
/// it takes of both.
///
/// ```
/// use firsthit::scene::{Daylight, Environment, EnvironmentKind};
/// use firsthit::{Color, DVec3, Scene};
///
/// let day = Daylight::new(DVec3::Z, 35.0, 120.0, 3.0, Color::splat(0.2))?;
/// let sun = day.sun_light();
/// let sky = Environment::new(EnvironmentKind::Daylight(day));
/// let scene = Scene::new(vec![])?.with_lights(vec![sun.into()]).with_environment(Some(sky.into()));
/// # Ok::<(), firsthit::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Daylight {
    up: DVec3,
    elevation_degrees: f64,
    azimuth_degrees: f64,
    turbidity: f64,
    ground: Color,
    made: Arc<Made>,
}

/// The values computed from the settings.
#[derive(Debug, PartialEq)]
struct Made {
    world_from_own: DMat3,
    sky: Sky,
    /// The factor on the sky's luminance, in thousands of candelas for a square metre.
    exposure: f64,
    ground: Color,
    sun: DirectionalLight,
    table: Option<DirectionTable>,
    irradiance: IrradianceCache,
}

/// The sky as a grid, for sums over it and for the table to draw from.
const COLUMNS: usize = 256;
const ROWS: usize = 128;

impl Daylight {
    /// The range of the sun's elevation, in degrees.
    pub const ELEVATIONS: (f64, f64) = (0.0, 90.0);

    /// The range of the turbidity. The model is made for 2 to 6 and holds out to 10.
    pub const TURBIDITIES: (f64, f64) = (2.0, 10.0);

    /// The haze of a clear day.
    pub const CLEAR: f64 = 3.0;

    /// The default albedo of the ground.
    pub const GROUND: Color = Color::splat(0.2);

    /// The sky in a world with that direction upwards, of any length but zero. `elevation_degrees`
    /// is the sun's angle above the horizon; `azimuth_degrees` is counter-clockwise, seen from
    /// above, from the middle of an upright [map](super::EnvironmentMap): from +x, where +y or +z
    /// is up. `turbidity` is the haze of the air: 2 is very clear, 3 clear, 6 hazy.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for numbers out of range.
    pub fn new(
        up: DVec3,
        elevation_degrees: f64,
        azimuth_degrees: f64,
        turbidity: f64,
        ground: Color,
    ) -> Result<Self> {
        require_direction("up", up)?;
        let range = |(low, high): (f64, f64), value: f64| value >= low && value <= high;
        let fine = range(Self::ELEVATIONS, elevation_degrees);
        require("elevation", "from 0 to 90", fine, elevation_degrees)?;
        require("azimuth", "finite", azimuth_degrees.is_finite(), azimuth_degrees)?;
        let fine = range(Self::TURBIDITIES, turbidity);
        require("turbidity", "from 2 to 10", fine, turbidity)?;
        let fine = ground.min_element() >= 0.0 && ground.max_element() <= 1.0;
        require("ground", "from 0 to 1", fine, ground)?;
        // Azimuths first, so that the sky turns with the sun.
        let world_from_own = upright(up) * rotation(DVec3::Y, azimuth_degrees);
        Ok(Self {
            up,
            elevation_degrees,
            azimuth_degrees,
            turbidity,
            ground,
            made: Arc::new(Made::new(world_from_own, elevation_degrees, turbidity, ground)),
        })
    }

    /// [`Daylight::new`] with the sun in a direction of the world, of any length but zero.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::error::Error::Argument) for a sun below the horizon, and for
    /// other numbers out of range.
    pub fn with_sun_towards(
        up: DVec3,
        towards: DVec3,
        turbidity: f64,
        ground: Color,
    ) -> Result<Self> {
        require_direction("up", up)?;
        require_direction("sun", towards)?;
        let own = upright(up).transpose() * unit(towards);
        let elevation = libm::atan2(own.y, libm::hypot(own.x, own.z)).to_degrees();
        let azimuth = libm::atan2(-own.z, own.x).to_degrees();
        Self::new(up, elevation, azimuth, turbidity, ground)
    }

    /// The direction upwards.
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// The sun's elevation above the horizon, in degrees.
    pub fn elevation_degrees(&self) -> f64 {
        self.elevation_degrees
    }

    /// The sun's azimuth, in degrees.
    pub fn azimuth_degrees(&self) -> f64 {
        self.azimuth_degrees
    }

    /// The turbidity: the haze of the air.
    pub fn turbidity(&self) -> f64 {
        self.turbidity
    }

    /// The ground's albedo.
    pub fn ground(&self) -> Color {
        self.ground
    }

    /// Towards the sun, of length one.
    pub fn towards_sun(&self) -> DVec3 {
        -unit(self.made.sun.direction)
    }

    /// The sun, 0.53 degrees wide, as bright as the sky says. It is not part of the sky's own
    /// radiance.
    pub fn sun_light(&self) -> DirectionalLight {
        self.made.sun
    }

    /// The radiance from a direction of any length; black where there is none.
    pub fn radiance(&self, direction: DVec3) -> Color {
        let made = &self.made;
        made.radiance(unit(made.world_from_own.transpose() * direction))
    }

    pub(super) fn irradiance_cache(&self) -> &IrradianceCache {
        &self.made.irradiance
    }

    pub(super) fn table(&self) -> Option<(&DirectionTable, &DMat3)> {
        Some((self.made.table.as_ref()?, &self.made.world_from_own))
    }
}

impl Made {
    fn new(world_from_own: DMat3, elevation_degrees: f64, turbidity: f64, albedo: Color) -> Self {
        let towards_sun = rotation(DVec3::Z, elevation_degrees) * DVec3::X;
        let sky = Sky::new(towards_sun, turbidity);
        // In thousands of lumens for a square metre, so that what a level surface takes adds up.
        let sun = sun::illuminance(elevation_degrees, turbidity);
        let taken = (sky.illuminance() + towards_sun.y * sun) / std::f64::consts::PI;
        let exposure = 1.0 / luminance(taken);
        let mut made = Self {
            world_from_own,
            sky,
            exposure,
            ground: exposure * albedo * taken,
            sun: DirectionalLight {
                direction: -(world_from_own * towards_sun),
                color: exposure / std::f64::consts::PI * sun,
                angle_degrees: 0.53,
            },
            table: None,
            irradiance: IrradianceCache::default(),
        };
        let cells = cells().map(|(direction, _)| luminance(made.radiance(direction)));
        made.table = DirectionTable::new(COLUMNS, cells.collect());
        made
    }

    /// The radiance from a direction of length one in the sky's own frame.
    fn radiance(&self, direction: DVec3) -> Color {
        if direction.y > 0.0 {
            self.exposure * self.sky.luminance(direction)
        } else if direction.y <= 0.0 {
            self.ground
        } else {
            Color::ZERO
        }
    }
}

/// The middles of a grid's cells, from straight up to straight down, and their solid angles. The
/// horizon is between two rows.
fn cells() -> impl Iterator<Item = (DVec3, f64)> {
    use std::f64::consts::{PI, TAU};
    let (columns, rows) = (COLUMNS as f64, ROWS as f64);
    let cell = move |k: usize| {
        let angle = |row: f64| PI * row / rows;
        let (row, column) = ((k / COLUMNS) as f64, (k % COLUMNS) as f64);
        let (sin, cos) = libm::sincos(angle(row + 0.5));
        let (z, x) = libm::sincos(TAU * ((column + 0.5) / columns - 0.5));
        let height = libm::cos(angle(row)) - libm::cos(angle(row + 1.0));
        (DVec3::new(sin * x, cos, sin * z), TAU / columns * height)
    };
    (0..COLUMNS * ROWS).map(cell)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::geometry::DVec2;
    use crate::scene::{Environment, EnvironmentKind};

    fn day(up: DVec3, elevation: f64, azimuth: f64) -> Daylight {
        Daylight::new(up, elevation, azimuth, 3.0, Daylight::GROUND).unwrap()
    }

    /// The reference is another sum than the one that the exposure is made from.
    #[test]
    fn a_white_level_surface_takes_a_luminance_of_one() {
        for elevation in [0.0, 5.0, 45.0, 90.0] {
            let day = day(DVec3::Z, elevation, 200.0);
            let (count, mut taken) = (300, Color::ZERO);
            for k in 0..count * count {
                let u = (DVec2::new(f64::from(k % count), f64::from(k / count)) + 0.5)
                    / f64::from(count);
                let direction = crate::sampling::warp::cosine_hemisphere(u);
                taken += day.radiance(direction) / f64::from(count * count);
            }
            let sun = day.sun_light();
            taken += sun.color * day.towards_sun().z;
            assert!((luminance(taken) - 1.0).abs() < 0.003, "{elevation} {taken}");
            let ground = day.radiance(DVec3::new(0.3, 0.2, -0.1));
            assert!((ground - taken * Daylight::GROUND).abs().max_element() < 0.002);
        }
    }

    #[test]
    fn the_sun_is_where_the_angles_say_and_the_sky_is_brightest_there() {
        for (up, elevation, azimuth, towards) in [
            (DVec3::Z, 0.0, 0.0, DVec3::X),
            (DVec3::Z, 0.0, 90.0, DVec3::Y),
            (DVec3::Y, 0.0, 90.0, DVec3::NEG_Z),
            (DVec3::Z, 45.0, 180.0, DVec3::new(-1.0, 0.0, 1.0)),
            (DVec3::Y, 90.0, 33.0, DVec3::Y),
        ] {
            let day = day(up, elevation, azimuth);
            assert!((day.towards_sun() - unit(towards)).length() < 1e-12);
            let bright = luminance(day.radiance(day.towards_sun() + 0.02 * up));
            let away = luminance(
                day.radiance(up + 0.7 * up.any_orthonormal_vector() - 0.5 * day.towards_sun()),
            );
            assert!(bright > 2.0 * away, "{elevation} {bright} {away}");
        }
    }

    #[test]
    fn directions_are_drawn_with_the_density_that_is_said() {
        let sky =
            Environment::new(EnvironmentKind::Daylight(day(DVec3::new(0.1, 0.2, 1.0), 20.0, 70.0)));
        assert!(sky.is_drawn());
        for k in 0..256 {
            let u = crate::sampling::Draws::new(k, 0).two();
            let arriving = sky.sample(u).unwrap();
            let pdf = arriving.pdf.unwrap();
            assert!((sky.pdf(arriving.towards) / pdf - 1.0).abs() < 1e-6);
            let light = sky.radiance(arriving.towards) / (PI * pdf);
            assert!((arriving.light - light).length() <= 1e-12 * light.length());
        }
    }

    #[test]
    fn numbers_out_of_range_are_refused_by_name() {
        let with = |elevation, azimuth, turbidity, ground| {
            let made = Daylight::new(DVec3::Z, elevation, azimuth, turbidity, Color::splat(ground));
            made.map_err(|error| error.to_string())
        };
        assert!(with(90.0, -720.0, 10.0, 1.0).is_ok());
        assert!(with(-1.0, 0.0, 3.0, 0.2).unwrap_err().contains("elevation"));
        assert!(with(f64::NAN, 0.0, 3.0, 0.2).unwrap_err().contains("elevation"));
        assert!(with(1.0, f64::INFINITY, 3.0, 0.2).unwrap_err().contains("azimuth"));
        assert!(with(1.0, 0.0, 1.9, 0.2).unwrap_err().contains("turbidity"));
        assert!(with(1.0, 0.0, 3.0, 1.1).unwrap_err().contains("ground"));
        assert!(Daylight::new(DVec3::ZERO, 1.0, 0.0, 3.0, Color::ZERO).is_err());
    }
}

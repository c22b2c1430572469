//! Light from all around.

use std::path::PathBuf;
use std::sync::Arc;

use firsthit::geometry::rotation;
use firsthit::load::{LoadSettings, load_environment};
use firsthit::scene::{Daylight, EnvironmentKind};
use firsthit::{Color, DMat3, DVec3};
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::copied;
use crate::errors::{Outcome, Raised};
use crate::run::run;
use crate::shading::{LightOut, light_out};

/// A picture of all directions, which environments can share.
#[pyclass(frozen, module = "firsthit._firsthit")]
pub(crate) struct EnvironmentMap(pub(crate) Arc<firsthit::scene::EnvironmentMap>);

#[pymethods]
impl EnvironmentMap {
    /// A map from float32 (rows, columns, 3).
    #[new]
    fn new(py: Python<'_>, texels: PyReadonlyArray3<'_, f32>) -> Outcome<Self> {
        let &[rows, columns, 3] = texels.shape() else {
            return Err(Raised::value("texels must be (rows, columns, 3)"));
        };
        let numbers = texels.as_slice()?;
        let texels = copied(numbers.as_chunks().0)?;
        let made = run(py, 0, |_| firsthit::scene::EnvironmentMap::new(columns, rows, texels));
        Ok(Self(Arc::new(made?)))
    }

    /// A map from a file; with warnings.
    #[staticmethod]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        max_memory: u64,
        max_texture: u32,
    ) -> Outcome<(Self, Vec<String>)> {
        let settings = LoadSettings { max_memory, max_texture, ..LoadSettings::default() };
        let (map, warnings) = run(py, 0, |_| load_environment(&path, &settings))?;
        Ok((Self(Arc::new(map)), warnings))
    }

    /// The texels, float32 (rows, columns, 3): a copy.
    fn array<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyArray3<f32>>> {
        let numbers = PyArray1::from_vec(py, copied(self.0.texels().as_flattened())?);
        Ok(numbers.reshape([self.0.rows(), self.0.columns(), 3])?)
    }
}

/// An environment: its kind, vectors, numbers, its map if it is one, its strength, whether it is
/// seen, and which way is up unless the scene says so.
///
/// | kind | vectors | numbers |
/// |---|---|---|
/// | uniform | colour | |
/// | hemispheres | above, below | |
/// | gradient | horizon, zenith | |
/// | map | axis, if not up | degrees |
/// | placed | columns of the rotation to the world | |
/// | daylight | ground | elevation, azimuth, turbidity |
#[derive(FromPyObject)]
pub(crate) struct EnvironmentIn<'py>(
    String,
    Vec<[f64; 3]>,
    Vec<f64>,
    Option<PyRef<'py, EnvironmentMap>>,
    f64,
    bool,
    Option<[f64; 3]>,
);

/// The environment on its way out.
pub(crate) type EnvironmentOut = (
    &'static str,
    Vec<(f64, f64, f64)>,
    Vec<f64>,
    Option<EnvironmentMap>,
    f64,
    bool,
    Option<(f64, f64, f64)>,
);

/// The environment in a scene with that direction upwards.
pub(crate) fn environment_in(
    environment: &EnvironmentIn<'_>,
    up: DVec3,
) -> firsthit::Result<firsthit::scene::Environment> {
    let &EnvironmentIn(.., strength, is_seen, own_up) = environment;
    let environment = firsthit::scene::Environment {
        kind: kind(environment, own_up.map_or(up, DVec3::from))?,
        strength,
        is_seen,
    };
    environment.check().map(|()| environment)
}

fn kind(
    EnvironmentIn(kind, vectors, numbers, map, ..): &EnvironmentIn<'_>,
    up: DVec3,
) -> firsthit::Result<EnvironmentKind> {
    let vectors: Vec<DVec3> = vectors.iter().copied().map(DVec3::from).collect();
    let map = map.as_ref().map(|map| Arc::clone(&map.0));
    Ok(match (&**kind, &*vectors, &**numbers, map) {
        ("uniform", &[color], [], None) => EnvironmentKind::Uniform(color),
        ("hemispheres", &[above, below], [], None) => {
            EnvironmentKind::Hemispheres { above, below, up }
        }
        ("gradient", &[horizon, zenith], [], None) => {
            EnvironmentKind::Gradient { horizon, zenith, up }
        }
        ("map", axis, &[degrees], Some(map)) => {
            let axis = axis.first().copied().unwrap_or(up);
            EnvironmentKind::of_map(map, up, &rotation(axis, degrees))
        }
        ("placed", &[x, y, z], [], Some(map)) => {
            EnvironmentKind::Map { map, world_from_map: DMat3::from_cols(x, y, z) }
        }
        ("daylight", &[ground], &[elevation, azimuth, turbidity], None) => {
            let day = Daylight::new(up, elevation, azimuth, turbidity, ground)?;
            EnvironmentKind::Daylight(day)
        }
        _ => {
            let expected = "one that the package makes";
            return Err(firsthit::Error::argument("environment", expected, kind));
        }
    })
}

pub(crate) fn environment_out(environment: &firsthit::scene::Environment) -> EnvironmentOut {
    let triples = |vectors: &[DVec3]| vectors.iter().map(|&vector| vector.into()).collect();
    let (mut numbers, mut held) = (Vec::new(), None);
    let (kind, vectors, up) = match &environment.kind {
        EnvironmentKind::Uniform(color) => ("uniform", triples(&[*color]), None),
        EnvironmentKind::Hemispheres { above, below, up } => {
            ("hemispheres", triples(&[*above, *below]), Some(*up))
        }
        EnvironmentKind::Gradient { horizon, zenith, up } => {
            ("gradient", triples(&[*horizon, *zenith]), Some(*up))
        }
        EnvironmentKind::Map { map, world_from_map } => {
            held = Some(EnvironmentMap(Arc::clone(map)));
            let columns = [0, 1, 2].map(|axis| world_from_map.col(axis));
            ("placed", triples(&columns), None)
        }
        EnvironmentKind::Daylight(day) => {
            let [elevation, azimuth] = [day.elevation_degrees(), day.azimuth_degrees()];
            numbers = vec![elevation, azimuth, day.turbidity()];
            ("daylight", triples(&[day.ground()]), Some(day.up()))
        }
    };
    let (strength, is_seen) = (environment.strength, environment.is_seen);
    let up = up.map(Into::into);
    (kind, vectors, numbers, held, strength, is_seen, up)
}

/// Refuses an environment whose numbers make no sense.
#[pyfunction]
pub(crate) fn check_environment(candidate: EnvironmentIn<'_>) -> Outcome<()> {
    environment_in(&candidate, DVec3::Z)?;
    Ok(())
}

/// The sun of a sky in a scene with that direction upwards; `None` for what is no sky.
#[pyfunction]
pub(crate) fn sun_of(environment: EnvironmentIn<'_>, up: [f64; 3]) -> Outcome<Option<LightOut>> {
    let environment = environment_in(&environment, up.into())?;
    Ok(environment.sun().as_ref().map(light_out))
}

/// The radiance from directions, one after the other.
#[pyfunction]
pub(crate) fn environment_radiance<'py>(
    py: Python<'py>,
    environment: EnvironmentIn<'_>,
    up: [f64; 3],
    directions: Vec<[f64; 3]>,
) -> Outcome<Bound<'py, PyArray1<f64>>> {
    let environment = environment_in(&environment, up.into())?;
    let radiance = |&direction: &[f64; 3]| environment.radiance(direction.into());
    let colors: Vec<Color> = directions.iter().map(radiance).collect();
    let numbers = colors.iter().flat_map(DVec3::to_array).collect();
    Ok(PyArray1::from_vec(py, numbers))
}

//! A scene that is looked at.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use firsthit::camera::StandardView;
use firsthit::edge::Edges;
use firsthit::image::Frame;
use firsthit::render::framing_camera;
use firsthit::shade::Appearance;
use firsthit::{Camera, Color, DisplayTransform, Error, Object, Result, Scene};

use crate::look::{FlatCamera, FrameRequest, Visibility};

/// The subject of a page: a scene, its appearance, and the first camera.
#[derive(Debug)]
pub struct Viewer {
    pub(crate) title: String,
    scene: Arc<Scene>,
    pub(crate) appearance: Appearance,
    pub(crate) first_camera: FlatCamera,
    pub(crate) warnings: Vec<String>,
    pub(crate) display: DisplayTransform,
    pub(crate) edges: Option<Edges>,
    /// The scene as the last question wanted it.
    changed: Mutex<Option<(Changes, Arc<Scene>)>>,
    /// The last picture of several samples that was made, to be continued.
    begun: Mutex<Option<ProgressiveState>>,
}

/// The changes of a scene against the viewer's.
#[derive(Debug, Clone, PartialEq, Default)]
struct Changes {
    /// Whether each object is hidden, where that is not as the scene has it.
    hidden: Option<Vec<bool>>,
    /// Objects with other colours.
    colors: Vec<(usize, [f64; 3])>,
}

/// A picture that is not at its end.
#[derive(Debug)]
pub(crate) struct ProgressiveState {
    /// The request, but for the number of samples.
    pub(crate) request: FrameRequest,
    pub(crate) samples: u32,
    pub(crate) state: Frame,
}

impl Viewer {
    /// A scene of that title, to be looked at by a camera first. Of a camera without a flat
    /// viewplane around its aim the page takes the one that frames the scene.
    ///
    /// # Errors
    ///
    /// The errors of [`framing_camera`].
    pub fn new(
        title: impl Into<String>,
        scene: Scene,
        appearance: Appearance,
        camera: &Camera,
    ) -> Result<Self> {
        let mut warnings = Vec::new();
        let first_camera = if let Some(first_camera) = FlatCamera::of(camera) {
            first_camera
        } else {
            let other = "the page begins with a camera of its own: that of the scene has an aperture or no flat viewplane around its aim";
            warnings.push(other.to_owned());
            let shape = [camera.rows(), camera.columns()];
            let framing = framing_camera(&scene, scene.up(), StandardView::Iso, shape)?;
            FlatCamera::of(&framing).unwrap_or_default()
        };
        Ok(Self {
            title: title.into(),
            scene: Arc::new(scene),
            appearance,
            first_camera,
            warnings,
            display: DisplayTransform::default(),
            edges: None,
            changed: Mutex::new(None),
            begun: Mutex::new(None),
        })
    }

    /// Adds warnings from reading the scene, one line each.
    #[must_use]
    pub fn warned(mut self, warnings: Vec<String>) -> Self {
        self.warnings.extend(warnings);
        self
    }

    /// Sets the display of colours in PNGs and the lines along edges, as the scene's file says.
    #[must_use]
    pub fn shown(self, display: DisplayTransform, edges: Option<Edges>) -> Self {
        Self { display, edges, ..self }
    }

    /// The whole scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The scene with the objects that are to be seen, in their colours. Meshes and their trees are
    /// shared; the tree over the objects is built anew where others are hidden.
    pub(crate) fn scene_of(
        &self,
        visibility: &Visibility,
        colors: &[(usize, [f64; 3])],
    ) -> Result<Arc<Scene>> {
        let changes = Changes { hidden: self.hidden_of(visibility)?, colors: colors.to_vec() };
        if changes == Changes::default() {
            return Ok(Arc::clone(&self.scene));
        }
        let mut changed = lock(&self.changed);
        if let Some((known, scene)) = &*changed
            && *known == changes
        {
            return Ok(Arc::clone(scene));
        }
        let mut scene = if colors.is_empty() {
            self.scene.try_clone()?
        } else {
            self.scene.with_objects(self.colored(colors)?)?
        };
        if let Some(hidden) = &changes.hidden {
            let flags: Vec<(usize, bool)> = hidden.iter().copied().enumerate().collect();
            scene.hide_objects(&flags)?;
        }
        let scene = Arc::new(scene);
        *changed = Some((changes, Arc::clone(&scene)));
        Ok(scene)
    }

    /// The objects, some of them in one colour each.
    fn colored(&self, colors: &[(usize, [f64; 3])]) -> Result<Vec<Object>> {
        let mut objects = self.scene.objects().to_vec();
        for &(number, color) in colors {
            let Some(object) = objects.get_mut(number) else {
                let expected = "identifiers of objects";
                return Err(Error::argument("colors", expected, number));
            };
            *object = object.clone().colored(color_of("colors", color)?);
        }
        Ok(objects)
    }

    /// Whether each object is hidden; `None` where that is as the scene has it.
    fn hidden_of(&self, visibility: &Visibility) -> Result<Option<Vec<bool>>> {
        let objects = self.scene.objects();
        let (named, is_named_hidden) = match (&visibility.hidden, &visibility.only) {
            (None, None) => return Ok(None),
            (Some(hidden), None) => (hidden, true),
            (None, Some(only)) => (only, false),
            (Some(_), Some(_)) => {
                let expected = "none where there are hidden ones";
                return Err(Error::argument("only", expected, "both"));
            }
        };
        let mut hidden = vec![!is_named_hidden; objects.len()];
        for &object in named {
            let Some(flag) = hidden.get_mut(object) else {
                let expected = "an identifier of an object";
                return Err(Error::argument("hidden", expected, object));
            };
            *flag = is_named_hidden;
        }
        let is_usual =
            (objects.iter().zip(&hidden)).all(|(object, &flag)| object.is_hidden() == flag);
        Ok((!is_usual).then_some(hidden))
    }

    /// The picture to continue, if it is that of this look and has no more samples.
    pub(crate) fn take_begun(
        &self,
        request: &FrameRequest,
        samples: u32,
    ) -> Option<ProgressiveState> {
        lock(&self.begun).take_if(|begun| begun.request == *request && begun.samples <= samples)
    }

    pub(crate) fn keep_begun(&self, begun: ProgressiveState) {
        *lock(&self.begun) = Some(begun);
    }
}

/// A linear colour that a page gave.
pub(crate) fn color_of(name: &'static str, color: [f64; 3]) -> Result<Color> {
    if !color.iter().all(|part| (0.0..=1.0).contains(part)) {
        let expected = "parts from 0 to 1";
        return Err(Error::argument(name, expected, format!("{color:?}")));
    }
    Ok(Color::from(color))
}

/// A poisoned lock holds what it did.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

//! What a script left behind.

use pyo3::prelude::*;
use rtscript::{Report, diag::Diagnostic, render};

use crate::{
    diagnostic::list,
    host::{Files, Guest},
    image::Image,
    script::render_options,
};

/// What a script left behind: the scene, the pictures that it rendered, warnings.
#[pyclass(frozen, module = "rtscript")]
pub(crate) struct Run {
    run: rtscript::script::Run,
    warnings: Vec<Diagnostic>,
}

impl Run {
    pub(crate) fn new(report: Report<rtscript::script::Run>) -> Self {
        Self {
            run: report.value,
            warnings: report.warnings,
        }
    }
}

#[pymethods]
impl Run {
    /// Warnings of the script: a list of Diagnostic.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        list(py, &self.warnings)
    }

    /// The pictures that the script rendered by itself: a list of (name or None, Image).
    #[getter]
    fn pictures(&self) -> Vec<(Option<String>, Image)> {
        let pictures = self.run.pictures.iter();
        pictures
            .map(|picture| {
                (
                    picture.name.clone(),
                    Image::new(picture.image.clone(), Vec::new()),
                )
            })
            .collect()
    }

    /// The parameters that the script declared: a list of (name, value of this run as text).
    #[getter]
    fn parameters(&self) -> Vec<(String, String)> {
        let declared = self.run.parameters.iter();
        declared.map(|d| (d.name.clone(), d.value.clone())).collect()
    }

    /// The hash of the scene, as `rtscript hash` prints it: equal scenes have equal ones.
    #[getter]
    fn scene_hash(&self) -> String {
        self.run.scene.hash()
    }

    /// The picture, as the command would write it: the last one that the script rendered by `render()`; where it never
    /// did, the scene is rendered now. Its warnings are those of the run and of the render.
    ///
    /// `progress` is called now and then with the number of pixels done and that of all, from other threads than this
    /// one; where it returns False or raises, the render ends. `threads` is how many render; 0 takes one for each
    /// processor. Other threads of Python run meanwhile, and Ctrl-C ends it.
    #[pyo3(signature = (*, progress = None, threads = 0))]
    fn render(&self, py: Python<'_>, progress: Option<Py<PyAny>>, threads: usize) -> PyResult<Image> {
        let options = render_options(threads)?;
        let mut warnings = self.warnings.clone();
        if let Some(last) = self.run.pictures.last() {
            return Ok(Image::new(last.image.clone(), warnings));
        }
        let guest = Guest::new(Files::default(), None, progress);
        let report = guest.detached(py, |guest| render(&self.run.scene, &options, guest))?;
        warnings.extend(report.warnings);
        Ok(Image::new(report.value.image, warnings))
    }
}

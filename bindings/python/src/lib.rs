//! The Python module of rtscript; `python/rtscript/` is what a user imports.

mod diagnostic;
mod host;
mod image;
mod run;
mod script;

use pyo3::prelude::*;

/// What `rtscript` is made of; import that.
#[pymodule]
#[pyo3(name = "_rtscript")]
mod native {
    use super::*;

    #[pymodule_export]
    use super::{image::Image, run::Run, script::Script};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}

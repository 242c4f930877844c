//! Pictures.

use std::path::PathBuf;

use pyo3::{
    exceptions::PyRuntimeError,
    prelude::*,
    types::{PyByteArray, PyBytes},
};
use rtscript::{
    diag::Diagnostic,
    output::{Format, encode, save},
};

use crate::diagnostic::{exception, list};

/// A picture.
#[pyclass(frozen, module = "rtscript")]
pub(crate) struct Image {
    image: rtscript::Image,
    warnings: Vec<Diagnostic>,
}

impl Image {
    pub(crate) fn new(image: rtscript::Image, warnings: Vec<Diagnostic>) -> Self {
        Self { image, warnings }
    }

    /// An array of shape (height, width, 3) on the bytes of `values`.
    fn array<'py>(&self, py: Python<'py>, values: &[u8], dtype: &str) -> PyResult<Bound<'py, PyAny>> {
        let shape = (self.image.height(), self.image.width(), 3);
        // numpy takes over a bytearray without a copy, and may write to it.
        let flat = py
            .import("numpy")?
            .call_method1("frombuffer", (PyByteArray::new(py, values), dtype))?;
        flat.call_method1("reshape", (shape,))
    }

    fn linear_native(&self) -> Vec<u8> {
        let channels = self.image.pixels().as_flattened().iter();
        channels.flat_map(|v| v.to_ne_bytes()).collect()
    }
}

#[pymethods]
impl Image {
    /// Pixels across.
    #[getter]
    fn width(&self) -> u32 {
        self.image.width()
    }

    /// Pixels down.
    #[getter]
    fn height(&self) -> u32 {
        self.image.height()
    }

    /// The hash of the 8-bit pixels, 32 hexadecimal digits, as `rtscript hash` prints it: the same for a scene on every
    /// machine.
    #[getter]
    fn hash(&self) -> String {
        self.image.hash()
    }

    /// What looked wrong on the way: a list of Diagnostic.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        list(py, &self.warnings)
    }

    /// The picture in 8 bits per channel, as a new numpy array of shape (height, width, 3).
    fn rgb8<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.array(py, &py.detach(|| self.image.rgb8()), "uint8")
    }

    /// The picture in scene-linear light, as a new numpy array of float64 of shape (height, width, 3).
    fn linear<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.array(py, &py.detach(|| self.linear_native()), "float64")
    }

    /// The picture in 8 bits per channel: red, green, blue, rows from the top. Needs no numpy.
    fn rgb8_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &py.detach(|| self.image.rgb8()))
    }

    /// The picture in scene-linear light as doubles in the machine's order of bytes, for `array.array("d", ...)`.
    fn linear_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &py.detach(|| self.linear_native()))
    }

    /// The picture as a PNG file.
    fn png<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| encode(&self.image, Format::Png));
        let bytes = bytes.map_err(|e| PyRuntimeError::new_err(e.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Writes the picture to a file, whole or not at all, in the format that its ending asks for: .png, .jpg, .jpeg,
    /// .ppm. Raises Error of kind "output" where it cannot.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let saved = py.detach(|| save(&path, &self.image));
        saved.map_err(|e| exception(py, &Diagnostic::error(e.kind, e.message).into()))
    }

    fn __repr__(&self) -> String {
        let (width, height) = (self.image.width(), self.image.height());
        format!("<rtscript.Image {width}x{height} {}>", self.image.hash())
    }
}

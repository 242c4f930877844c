//! Pictures.

use std::{
    ffi::{CString, c_char},
    path::Path,
    ptr,
    sync::OnceLock,
};

use rtscript::{
    Image,
    output::{Format, encode, save},
};

use crate::{
    RtsDiagnostic, RtsError, RtsStatus,
    border::{ask, attempt_only, c_string, free, of, put, text},
    diagnostic::nth,
};

/// A picture. What is asked of it is made once and kept with it.
#[derive(Debug)]
pub struct RtsImage {
    image: Image,
    warnings: Vec<RtsDiagnostic>,
    rgb8: OnceLock<Vec<u8>>,
    linear_f32: OnceLock<Vec<f32>>,
    png: OnceLock<Vec<u8>>,
    hash: OnceLock<CString>,
}

impl RtsImage {
    pub(crate) fn new(image: Image, warnings: Vec<RtsDiagnostic>) -> Self {
        Self {
            image,
            warnings,
            rgb8: OnceLock::new(),
            linear_f32: OnceLock::new(),
            png: OnceLock::new(),
            hash: OnceLock::new(),
        }
    }
}

/// Answers with several values: their place, and how many in `length`.
///
/// # Safety
/// `image` is NULL or live, `length` is NULL or may be written to.
unsafe fn several<'a, T: 'a>(
    image: *const RtsImage,
    length: *mut usize,
    values: impl FnOnce(&'a RtsImage) -> &'a [T],
) -> *const T {
    // SAFETY: as this function's own.
    unsafe {
        let values: &[T] = ask(image, &[], values);
        put(length, values.len());
        if values.is_empty() {
            ptr::null()
        } else {
            values.as_ptr()
        }
    }
}

/// Ends an image, and with it its pixels and texts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_image_free(image: *mut RtsImage) {
    // SAFETY: a handle is NULL or came from here, and its user is done with it.
    unsafe { free(image) }
}

/// Pixels across.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_image_width(image: *const RtsImage) -> u32 {
    // SAFETY: a handle is NULL or live.
    unsafe { ask(image, 0, |image| image.image.width()) }
}

/// Pixels down.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_image_height(image: *const RtsImage) -> u32 {
    // SAFETY: a handle is NULL or live.
    unsafe { ask(image, 0, |image| image.image.height()) }
}

/// The picture in 8 bits per channel: width * height * 3 bytes, red, green, blue, rows from the top without gaps.
/// `*length` becomes the number of bytes; `length` may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_image_rgb8(image: *const RtsImage, length: *mut usize) -> *const u8 {
    // SAFETY: a handle is NULL or live; the caller's promise of a place for the length.
    unsafe {
        several(image, length, |image| {
            image.rgb8.get_or_init(|| image.image.rgb8())
        })
    }
}

/// The picture in scene-linear light: width * height * 3 numbers, red, green, blue, rows from the top without gaps.
/// `*length` becomes the number of numbers; `length` may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_image_linear(image: *const RtsImage, length: *mut usize) -> *const f64 {
    // SAFETY: a handle is NULL or live; the caller's promise of a place for the length.
    unsafe { several(image, length, |image| image.image.pixels().as_flattened()) }
}

/// As rts_image_linear, each number rounded to a float.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_image_linear_f32(image: *const RtsImage, length: *mut usize) -> *const f32 {
    let narrow = |image: &RtsImage| {
        let channels = image.image.pixels().as_flattened().iter();
        channels.map(|&v| v as f32).collect()
    };
    // SAFETY: a handle is NULL or live; the caller's promise of a place for the length.
    unsafe {
        several(image, length, |image| {
            image.linear_f32.get_or_init(|| narrow(image))
        })
    }
}

/// The picture as a PNG file. `*length` becomes the number of bytes; `length` may be NULL. NULL where the picture is
/// too large for the format.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_image_png(image: *const RtsImage, length: *mut usize) -> *const u8 {
    let encoded = |image: &RtsImage| encode(&image.image, Format::Png).unwrap_or_default();
    // SAFETY: a handle is NULL or live; the caller's promise of a place for the length.
    unsafe { several(image, length, |image| image.png.get_or_init(|| encoded(image))) }
}

/// The hash of the 8-bit pixels, 32 hexadecimal digits, as `rtscript hash` prints it: the same for a scene on every
/// machine.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_image_hash(image: *const RtsImage) -> *const c_char {
    let hash = |image: &RtsImage| c_string(&image.image.hash());
    // SAFETY: a handle is NULL or live.
    unsafe {
        ask(image, ptr::null(), |image| {
            image.hash.get_or_init(|| hash(image)).as_ptr()
        })
    }
}

/// Writes the picture to a file, whole or not at all, in the format that its ending asks for: .png, .jpg, .jpeg, .ppm.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_image_save(
    image: *const RtsImage,
    path: *const c_char,
    error: *mut *mut RtsError,
) -> RtsStatus {
    let write = || {
        // SAFETY: the caller's promise of a handle.
        let image = unsafe { of(image, "the image") }?;
        // SAFETY: the caller's promise of a text.
        let path = unsafe { text(path, "the path") }?;
        Ok(save(Path::new(path), &image.image)?)
    };
    // SAFETY: the caller's promise of a place for the error.
    unsafe { attempt_only(error, write) }
}

/// How many warnings came up while the picture was rendered; those of the script are the run's.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_image_warning_count(image: *const RtsImage) -> usize {
    // SAFETY: a handle is NULL or live.
    unsafe { ask(image, 0, |image| image.warnings.len()) }
}

/// One of the warnings of the picture, counted from 0; NULL past their end.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rts_image_warning(image: *const RtsImage, index: usize) -> *const RtsDiagnostic {
    // SAFETY: a handle is NULL or live.
    unsafe { ask(image, ptr::null(), |image| nth(&image.warnings, index)) }
}

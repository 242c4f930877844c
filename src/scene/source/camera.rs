//! The camera, the samples, and the part of the picture that is rendered.

use std::fmt::{self, Write as _};

use crate::scene::{
    Adaptive, Camera, Crop, Filter, Focus, Lens, Motion, Projection, Shutter, Stereo,
    literal::{Number, Text, Vector},
};

/// The calls that make a camera.
pub(in crate::scene) fn camera(c: &Camera) -> Vec<String> {
    let place = format!("{}, {}, {}", Vector(c.eye), Vector(c.at), Vector(c.up));
    let view = match c.projection {
        Projection::Perspective { fovy } => format!("camera({place}, {});", Number(fovy)),
        Projection::Orthographic { height } => format!("orthographic({place}, {});", Number(height)),
        Projection::Fisheye { angle, full_frame } => {
            let full = if full_frame { ", \"full\"" } else { "" };
            format!("fisheye({place}, {}{full});", Number(angle))
        }
        Projection::Panorama { angle, fovy } => {
            format!("panorama({place}, {}, {});", Number(angle), Number(fovy))
        }
        Projection::Cylindrical { angle, fovy: None } => {
            format!("cylindrical({place}, {});", Number(angle))
        }
        Projection::Cylindrical {
            angle,
            fovy: Some(fovy),
        } => {
            format!("cylindrical({place}, {}, {});", Number(angle), Number(fovy))
        }
    };
    let mut calls = vec![view];
    calls.extend(c.lens.as_ref().map(lens));
    calls.extend(c.stereo.as_ref().map(stereo));
    calls.extend(c.motion.as_ref().map(motion));
    calls.extend((c.shutter != Shutter::default()).then(|| shutter(&c.shutter)));
    calls
}

/// The call that moves the camera.
pub(in crate::scene) fn motion(motion: &Motion) -> String {
    let Motion { eye, at, up } = *motion;
    format!("cameraTo({}, {}, {});", Vector(eye), Vector(at), Vector(up))
}

/// The call that sets the shutter.
pub(in crate::scene) fn shutter(shutter: &Shutter) -> String {
    let Shutter { open, close } = *shutter;
    format!("shutter({}, {});", Number(open), Number(close))
}

/// The call that puts a lens into a camera.
pub(in crate::scene) fn lens(lens: &Lens) -> String {
    LensCall(lens).to_string()
}

struct LensCall<'l>(&'l Lens);

impl fmt::Display for LensCall<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Lens {
            radius,
            focus,
            blades,
            rotation,
        } = *self.0;
        write!(f, "lens({}", Number(radius))?;
        match focus {
            Focus::Target => {}
            Focus::Distance(distance) => write!(f, ", {}", Number(distance))?,
            Focus::Point(point) => write!(f, ", {}", Vector(point))?,
        }
        if blades != 0 || rotation.to_bits() != 0 {
            write!(f, ", #{{ blades: {blades}, rotation: {} }}", Number(rotation))?;
        }
        f.write_str(");")
    }
}

/// The call that makes two eyes of one.
pub(in crate::scene) fn stereo(stereo: &Stereo) -> String {
    let Stereo {
        separation,
        layout,
        convergence,
    } = *stereo;
    let mut call = format!(
        "stereo({}, #{{ layout: {}",
        Number(separation),
        Text(layout.name())
    );
    // Writing into a String does not fail.
    let _ = match convergence {
        None => Ok(()),
        Some(f64::INFINITY) => write!(call, ", convergence: \"parallel\""),
        Some(distance) => write!(call, ", convergence: {}", Number(distance)),
    };
    call + " });"
}

/// The call that sets a filter.
pub(in crate::scene) fn filter(filter: &Filter) -> String {
    format!("filter({}, {});", Text(filter.kind.name()), Number(filter.radius))
}

/// The call that bounds the error.
pub(in crate::scene) fn adaptive(adaptive: &Adaptive) -> String {
    let Adaptive { error, min } = *adaptive;
    format!("adaptive(#{{ error: {}, min: {min} }});", Number(error))
}

/// The call that makes a crop.
pub(in crate::scene) fn crop(crop: &Crop) -> String {
    match *crop {
        Crop::Pixels(r) => format!("crop({}, {}, {}, {});", r.x, r.y, r.width, r.height),
        Crop::Fractions {
            left,
            top,
            right,
            bottom,
        } => format!(
            "crop(#{{ left: {}, top: {}, right: {}, bottom: {} }});",
            Number(left),
            Number(top),
            Number(right),
            Number(bottom)
        ),
    }
}

//! The course's own scenes against the course's own pictures, where they lie beside this repository.
//!
//! The JPEGs are lossy, so their bounds are what their compression leaves; `imgdiff.py --rejpeg` beside them takes
//! that loss out. The PNG is exact.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::{fs, path::PathBuf};

use rtscript::{
    Builder, Image, Limits, NoHost, RenderOptions, RunOptions, Script,
    import::{load_course, script_from_course},
    output, render,
};

/// The folder of the course's scenes; `None` where it is not there.
fn folder() -> Option<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/cse167");
    folder.is_dir().then_some(folder)
}

/// Renders a scene with its `camera`-th camera line, counted from 1, commented out or not; 0 takes it as it is.
fn rendered(name: &str, camera: usize) -> Option<Image> {
    let source = fs::read_to_string(folder()?.join(name)).unwrap();
    let mut seen = 0;
    let source: Vec<String> = source
        .lines()
        .map(|line| {
            let Some(arguments) = line
                .trim_start_matches('#')
                .strip_prefix("camera ")
                .filter(|_| camera > 0)
            else {
                return line.to_owned();
            };
            seen += 1;
            if seen == camera {
                format!("camera {arguments}")
            } else {
                String::new()
            }
        })
        .collect();
    let mut builder = Builder::new();
    load_course(name, &source.join("\n"), &mut builder).unwrap();
    let scene = builder.finish().value;
    let image = render(&scene, &RenderOptions::default(), &NoHost)
        .unwrap()
        .value
        .image;
    let out = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-camera{camera}.png"));
    output::save(&out, &image).unwrap();
    Some(image)
}

fn reference(name: &str) -> Vec<u8> {
    image::open(folder().unwrap().join(name))
        .unwrap()
        .to_rgb8()
        .into_raw()
}

fn psnr(a: &[u8], b: &[u8]) -> f64 {
    assert_eq!(a.len(), b.len());
    let square: f64 = a
        .iter()
        .zip(b)
        .map(|(a, b)| rtscript::math::powi(f64::from(a.abs_diff(*b)), 2))
        .sum();
    10.0 * rtscript::math::log10(255.0 * 255.0 * a.len() as f64 / square)
}

#[test]
fn the_table_is_the_courses_to_the_last_pixel() {
    let Some(image) = rendered("scene4-ambient.test", 0) else {
        return;
    };
    let differing = image
        .rgb8()
        .iter()
        .zip(reference("scene4-ambient.png"))
        .filter(|(a, b)| **a != *b)
        .count();
    assert_eq!(differing, 0);
}

/// The script that `convert` writes gives the same pixels.
#[test]
fn converted_scenes_are_the_same_pictures() {
    let Some(folder) = folder() else { return };
    for name in ["scene1.test", "scene2.test", "scene3.test", "scene4-ambient.test"] {
        let source = fs::read_to_string(folder.join(name)).unwrap();
        let script = script_from_course(name, &source).unwrap();
        let script = Script::compile("converted.rhai", &script, &Limits::default()).unwrap();
        let run = script.run(&NoHost, &RunOptions::default()).unwrap();
        assert!(run.warnings.is_empty(), "{:?}", run.warnings);
        let image = render(&run.value.scene, &RenderOptions::default(), &NoHost)
            .unwrap()
            .value
            .image;
        assert_eq!(image.hash(), rendered(name, 0).unwrap().hash(), "{name}");
    }
}

#[test]
fn every_view_of_the_public_scenes_is_the_courses() {
    for (scene, camera, picture, least) in [
        ("scene1.test", 1, "scene1-camera1.jpg", 39.0),
        ("scene1.test", 2, "scene1-camera2.jpg", 36.0),
        ("scene1.test", 3, "scene1-camera3.jpg", 38.0),
        ("scene1.test", 4, "scene1-camera4.jpg", 39.0),
        ("scene2.test", 1, "scene2-camera1.jpg", 34.0),
        ("scene2.test", 2, "scene2-camera2.jpg", 34.0),
        ("scene2.test", 3, "scene2-camera3.jpg", 33.0),
        ("scene3.test", 0, "scene3.jpg", 31.0),
    ] {
        let Some(image) = rendered(scene, camera) else {
            return;
        };
        let ratio = psnr(&image.rgb8(), &reference(picture));
        println!("{picture}: {ratio:.2} dB");
        assert!(ratio >= least, "{picture}: {ratio:.2} dB, at least {least}");
    }
}

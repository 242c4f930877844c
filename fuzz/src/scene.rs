//! Whole scenes, rendered at 16 x 16 in several ways that must give the same picture.

use rtscript::{
    Image, NoHost, RenderOptions, Scene, render,
    render::{World, inspect},
};

use crate::{builder::build, bytes::Bytes, oracle::check};

const SIDE: u32 = 16;

pub fn run(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let (x, y) = (bytes.below(16) as u32, bytes.below(16) as u32);
    let mut scene = build(&mut bytes);
    (scene.settings.width, scene.settings.height) = (SIDE, SIDE);
    scene.settings.samples = scene.settings.samples.min(2);
    let mut options = RenderOptions::default();
    options.threads = 1;
    let picture = picture(&scene, &options);
    let finite = |pixel: &[f64; 3]| pixel.iter().all(|v| v.is_finite());
    assert!(picture.pixels().iter().all(finite), "a pixel that is no number");
    let same = |what: &str, change: fn(&mut RenderOptions)| {
        let mut options = options.clone();
        change(&mut options);
        let other = self::picture(&scene, &options);
        assert_eq!(bits(&picture), bits(&other), "another picture {what}");
    };
    same("with single rays", |options| options.single_rays = true);
    same("with two threads", |options| options.threads = 2);
    same("with other tiles", |options| {
        (options.tile, options.shuffle) = (5, Some(7))
    });
    explained(&scene, &picture, x, y);
    for warning in inspect(&scene, &NoHost).into_iter().flatten() {
        check(&warning, &[]);
    }
}

fn picture(scene: &Scene, options: &RenderOptions) -> Image {
    let rendered = render(scene, options, &NoHost);
    let report = rendered.unwrap_or_else(|e| panic!("a scene that was built is not rendered: {e}"));
    report.warnings.iter().for_each(|warning| check(warning, &[]));
    report.value.image
}

fn bits(image: &Image) -> Vec<[u64; 3]> {
    image
        .pixels()
        .iter()
        .map(|pixel| pixel.map(f64::to_bits))
        .collect()
}

/// What is said of why a pixel has its value adds up to it.
fn explained(scene: &Scene, picture: &Image, x: u32, y: u32) {
    let world = World::compile(scene).expect("it was rendered");
    let explanation = world.explain(x, y, &NoHost).expect("the pixel is in the picture");
    let value = picture.pixel(x, y).expect("the pixel is in the picture");
    assert!(
        explanation.value == value || !explanation.value.is_finite(),
        "pixel {x},{y} is {value}, explained as {}",
        explanation.value
    );
}

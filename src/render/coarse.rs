//! Pictures of a picture that is still to be traced, for whoever waits for it.

use super::{RenderOptions, interrupt::Interrupt, tiles, world::World};
use crate::{
    diag::Error,
    host::{Host, HostError},
    scene::Settings,
};

/// Pixels that one pixel of a coarse picture stands for, along an edge: first few, then more.
const STEPS: [u32; 2] = [8, 2];
/// A picture with an edge of fewer pixels than this says little.
const LEAST: u32 = 16;
/// A picture with fewer samples is not much dearer than every second pixel of it.
const SAMPLES: u32 = 4;

/// Traces coarse pictures with one sample a pixel and hands them to the host.
///
/// # Errors
/// Where the host asked to stop or the render takes too long.
pub(super) fn show(
    world: &World<'_>,
    options: &RenderOptions,
    host: &dyn Host,
    interrupt: &Interrupt<'_>,
) -> Result<(), Error> {
    // Their rays are not counted: with them and without, the picture is the same, and so is whether there is one.
    let options = &RenderOptions {
        rays: None,
        ..options.clone()
    };
    for settings in settings(&world.scene.settings) {
        let (image, _) = tiles::trace(world, &settings, options, &Unannounced(host), interrupt)?;
        host.coarse(&image);
    }
    Ok(())
}

/// Those of the coarse pictures that are worth it.
fn settings(whole: &Settings) -> impl Iterator<Item = Settings> {
    let region = whole.region();
    let worth = move |step: &u32| {
        region.width.min(region.height) / step >= LEAST && (*step == STEPS[0] || whole.samples >= SAMPLES)
    };
    STEPS.into_iter().filter(worth).map(|step| Settings {
        width: whole.width.div_ceil(step),
        height: whole.height.div_ceil(step),
        samples: 1,
        adaptive: None,
        crop: whole.crop.map(|crop| crop.coarser(step)),
        ..whole.clone()
    })
}

/// A host that hears nothing of the progress: what counts is that of the picture.
struct Unannounced<'h>(&'h dyn Host);

impl Host for Unannounced<'_> {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        self.0.read(path, max_bytes)
    }

    fn should_stop(&self) -> bool {
        self.0.should_stop()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;
    use crate::{
        Builder, DVec3,
        render::{Image, Progress, render},
    };

    #[derive(Default)]
    struct Watcher {
        coarse: Mutex<Vec<Image>>,
        stops_after: Option<usize>,
        done: Mutex<u64>,
    }

    impl Host for Watcher {
        fn read(&self, path: &str, _max_bytes: u64) -> Result<Vec<u8>, HostError> {
            Err(HostError::new(crate::diag::ErrorKind::Denied, path))
        }

        fn should_stop(&self) -> bool {
            self.stops_after == Some(self.coarse.lock().unwrap().len())
        }

        fn progress(&self, progress: &Progress) {
            *self.done.lock().unwrap() = progress.done;
        }

        fn coarse(&self, image: &Image) {
            assert_eq!(*self.done.lock().unwrap(), 0);
            self.coarse.lock().unwrap().push(image.clone());
        }
    }

    fn scene(width: u32, height: u32, samples: u32) -> crate::Scene {
        let mut b = Builder::new();
        b.size(width, height).unwrap();
        b.samples(samples).unwrap();
        b.directional(DVec3::Z, DVec3::ONE).unwrap();
        b.sphere(DVec3::ZERO, 1.0).unwrap();
        b.finish().value
    }

    #[test]
    fn coarse_pictures_come_first_and_change_nothing() {
        let scene = scene(170, 130, 4);
        let host = Watcher::default();
        let options = RenderOptions {
            coarse: true,
            ..RenderOptions::default()
        };
        let image = render(&scene, &options, &host).unwrap().value.image;
        let plain = render(&scene, &RenderOptions::default(), &Watcher::default()).unwrap();
        assert_eq!(image, plain.value.image);
        assert_eq!(*host.done.lock().unwrap(), 170 * 130);
        let coarse = host.coarse.into_inner().unwrap();
        let sizes: Vec<_> = coarse.iter().map(|i| (i.width(), i.height())).collect();
        assert_eq!(sizes, [(22, 17), (85, 65)]);
        let middle = |image: &Image| image.pixel(image.width() / 2, image.height() / 2).unwrap();
        for coarse in &coarse {
            assert!((middle(coarse) - middle(&image)).length() < 0.05);
        }
    }

    #[test]
    fn small_pictures_and_few_samples_have_no_coarse_ones() {
        let sizes = |width, height, samples| {
            let scene = scene(width, height, samples);
            settings(&scene.settings).map(|s| s.width).collect::<Vec<_>>()
        };
        assert_eq!(sizes(60, 400, 9), [30]);
        assert_eq!(sizes(640, 480, 1), [80]);
        assert!(sizes(31, 31, 9).is_empty());
    }

    #[test]
    fn the_host_can_stop_between_them() {
        let host = Watcher {
            stops_after: Some(1),
            ..Watcher::default()
        };
        let options = RenderOptions {
            coarse: true,
            ..RenderOptions::default()
        };
        assert!(render(&scene(170, 130, 4), &options, &host).is_err());
        assert_eq!(host.coarse.into_inner().unwrap().len(), 1);
    }
}

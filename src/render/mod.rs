//! From a [`Scene`] to an [`Image`].

mod adaptive;
mod around;
mod bounces;
mod coarse;
mod compiled;
pub(crate) mod daylight;
mod environment;
pub mod explain;
mod film;
mod filter;
mod inspect;
mod integrator;
mod interrupt;
mod layers;
mod lighting;
mod microfacet;
mod observe;
mod path;
pub(crate) mod polish;
mod sampler;
mod shots;
pub mod show;
mod solids;
mod spectrum;
mod square;
mod tiles;
mod world;

pub use compiled::Compiled;
pub use film::{FileOptions, Image, quantize};
pub use inspect::{inspect, unanswered};
pub use layers::{Layer, LayerKind};
pub use observe::RayKind;
pub use world::{KeptTrees, RayHit, World};

use std::time::Duration;

use rayon::prelude::*;

use interrupt::Interrupt;

use crate::{
    diag::{Code, Diagnostic, Error, ErrorKind, Report},
    host::Host,
    limits::Limits,
    scene::Scene,
};

/// How to render, never what: no option changes a pixel. A limit that is passed ends the render with an error.
///
/// ```
/// use rtscript::{Limits, RenderOptions};
/// let mut options = RenderOptions::default().within(&Limits::untrusted());
/// options.threads = 2;
/// assert!(options.rays.is_some() && options.render_time.is_some());
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RenderOptions {
    /// Threads; 0 takes the rayon pool the call is made in. Without threads (wasm32-unknown-unknown) there is one.
    pub threads: usize,
    /// Traces every ray alone, which is slower, never in a packet with its neighbors; for tests that compare.
    pub single_rays: bool,
    /// Edge of a tile in pixels, which is what a thread takes at a time; 0 takes 16. At most 1024 counts; for tests
    /// that compare.
    pub tile: u32,
    /// Takes the tiles in an order drawn from this number, with threads that give way to others at random; for tests
    /// that compare.
    pub shuffle: Option<u64>,
    /// Before the picture is traced, hands coarse ones to [`Host::coarse`]: of every eighth pixel, then of every second,
    /// with one sample each. The picture itself is the same.
    pub coarse: bool,
    /// Acceleration structures kept from one render to the next, for renders of nearly the same scene; the picture is
    /// the same with and without.
    pub trees: Option<KeptTrees>,
    /// Time that the render may take, with its trees; `None` is any. Looked at every few milliseconds. Without a clock
    /// (wasm32-unknown-unknown) time stands still.
    pub render_time: Option<Duration>,
    /// Rays of every kind that the picture may take, [`RenderStats::rays`]; `None` is any number. Whether a picture
    /// stays within it depends on the scene alone.
    pub rays: Option<u64>,
    /// What else the picture is to hold of each pixel, [`Image::layers`].
    pub layers: Vec<LayerKind>,
    /// What earlier pictures of the same run took of both.
    pub(crate) spent: Spent,
}

impl RenderOptions {
    /// The same options with the limits on renders: `render_time` and `rays`.
    ///
    /// ```
    /// use rtscript::{Limits, RenderOptions};
    /// let options = RenderOptions::default().within(&Limits::untrusted());
    /// assert_eq!(options.rays, Some(200_000_000));
    /// ```
    #[must_use]
    pub fn within(mut self, limits: &Limits) -> Self {
        self.render_time = limits.render_time;
        self.rays = limits.rays;
        self
    }
}

/// What the pictures of a run took so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Spent {
    /// Time to build their trees and to trace them.
    pub(crate) time: Duration,
    /// Rays.
    pub(crate) rays: u64,
}

impl Spent {
    /// Adds what a picture took.
    pub(crate) fn add(&mut self, stats: &RenderStats) {
        self.time = self
            .time
            .saturating_add(stats.compile)
            .saturating_add(stats.trace);
        self.rays = self.rays.saturating_add(stats.rays());
    }
}

/// How far a render is.
///
/// ```
/// use rtscript::{Host, host::HostError, render::{Progress, Tile}};
/// struct Window;
/// impl Host for Window {
///     fn read(&self, path: &str, _: u64) -> Result<Vec<u8>, HostError> {
///         rtscript::NoHost.read(path, 0)
///     }
///     fn tile(&self, tile: &Tile<'_>) {
///         println!("{} x {} pixels at {}, {}", tile.width, tile.height, tile.x, tile.y);
///     }
///     fn progress(&self, progress: &Progress) {
///         println!("{} of {}", progress.done, progress.total);
///     }
/// }
/// # rtscript::render(&rtscript::Builder::new().finish().value, &Default::default(), &Window)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Pixels finished.
    pub done: u64,
    /// Pixels in all.
    pub total: u64,
    /// Rays traced so far, of every kind.
    pub rays: u64,
}

/// A finished part of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tile<'p> {
    /// Its first column, in pixels from the left.
    pub x: u32,
    /// Its first row, in pixels from the top.
    pub y: u32,
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// `width * height` scene-linear colors, row by row from the top; [`quantize`] gives the 8 bits of the picture.
    pub pixels: &'p [[f64; 3]],
}

/// What a render took.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct RenderStats {
    /// Rays from the camera.
    pub camera_rays: u64,
    /// Rays towards lights, without those for highlights too faint to change a sum.
    pub shadow_rays: u64,
    /// Mirrored rays, total internal reflection included.
    pub reflected_rays: u64,
    /// Rays through transparent surfaces.
    pub refracted_rays: u64,
    /// Samples whose value was not a finite number and was counted as black.
    pub invalid_samples: u64,
    /// Shapes and triangles that can be hit, each defined group counted once.
    pub primitives: u64,
    /// Bytes of the compiled scene: acceleration structures and what they refer to.
    pub world_bytes: u64,
    /// Time to build acceleration structures.
    pub compile: Duration,
    /// Time to trace all rays.
    pub trace: Duration,
}

impl RenderStats {
    /// Rays of every kind.
    #[must_use]
    pub fn rays(&self) -> u64 {
        self.camera_rays + self.shadow_rays + self.reflected_rays + self.refracted_rays
    }
}

/// A picture and what it took.
///
/// ```
/// use rtscript::{Builder, NoHost, RenderOptions, render, render::{RenderStats, Rendered}};
/// let mut b = Builder::new();
/// b.size(8, 6)?;
/// let Rendered { image, stats, .. } = render(&b.finish().value, &RenderOptions::default(), &NoHost)?.value;
/// let stats: RenderStats = stats;
/// assert_eq!((image.width(), stats.rays()), (8, 48));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The picture.
    pub image: Image,
    /// What it took.
    pub stats: RenderStats,
}

/// Renders a scene. The picture depends on the scene alone: not on threads, machine or build.
///
/// # Errors
/// `Cancelled` where the host asks to stop, `Limit` where a limit of `options` is passed or instancing multiplies past
/// 2^62 primitives.
pub fn render(scene: &Scene, options: &RenderOptions, host: &dyn Host) -> Result<Report<Rendered>, Error> {
    on_threads(options.threads, || {
        let interrupt = Interrupt::within(options, host);
        interrupt.watched(|| render_here(scene, options, host, &interrupt))
    })
}

/// Does something on as many threads; 0 is those of the current pool.
fn on_threads<T: Send>(threads: usize, f: impl FnOnce() -> Result<T, Error> + Send) -> Result<T, Error> {
    if threads == 0 || cfg!(target_family = "wasm") {
        return f();
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| {
            Diagnostic::error(
                ErrorKind::Internal,
                format!("cannot start {threads} threads: {e}"),
            )
        })?;
    pool.install(f)
}

/// `pixel` of every column and row, rows from the top, on all threads.
fn by_rows<T: Send>(
    (width, height): (u32, u32),
    host: &dyn Host,
    pixel: impl Fn(u32, u32, &Interrupt<'_>) -> T + Sync,
) -> Result<Vec<T>, Error> {
    let interrupt = Interrupt::new(host);
    let rows: Vec<Vec<T>> = (0..height)
        .into_par_iter()
        .map(|y| {
            if interrupt.poll() {
                return Vec::new();
            }
            (0..width).map(|x| pixel(x, y, &interrupt)).collect()
        })
        .collect();
    if interrupt.is_stopped() {
        return Err(interrupt.reason().into());
    }
    Ok(rows.into_iter().flatten().collect())
}

/// Renders on the threads of the current pool.
fn render_here(
    scene: &Scene,
    options: &RenderOptions,
    host: &dyn Host,
    interrupt: &Interrupt<'_>,
) -> Result<Report<Rendered>, Error> {
    let compiling = Stopwatch::start();
    let mut world = World::compile_keeping(scene, options.trees.as_ref(), interrupt)?;
    world.packets = !options.single_rays;
    world.interrupt = Some(interrupt);
    let compile = compiling.elapsed();
    let mut warnings = inspect::before(&world);
    warnings.iter().for_each(|warning| host.warn(warning));
    let tracing = Stopwatch::start();
    let coarse = match options.coarse {
        true => coarse::show(&world, options, host, interrupt),
        false => Ok(()),
    };
    let traced = coarse.and_then(|()| tiles::trace(&world, &scene.settings, options, host, interrupt));
    let traced = match options.layers.as_slice() {
        [] => traced,
        kinds => traced.and_then(|(image, counts)| {
            world.uv_everywhere = true;
            Ok((image.with_layers(layers::layers(&world, kinds, host)?), counts))
        }),
    };
    let (primitives, world_bytes) = (world.primitives(), world.bytes());
    if let Ok((image, _)) = &traced {
        warnings.extend(inspect::after(&world, image, &warnings));
    }
    if let Some(trees) = &options.trees {
        trees.take_back(world);
    }
    let (image, counts) = traced?;
    let stats = RenderStats {
        camera_rays: counts.camera,
        shadow_rays: counts.shadow,
        reflected_rays: counts.reflected,
        refracted_rays: counts.refracted,
        invalid_samples: counts.invalid,
        primitives,
        world_bytes,
        compile,
        trace: tracing.elapsed(),
    };
    warnings.extend(invalid_samples(counts.invalid));
    Ok(Report {
        value: Rendered { image, stats },
        warnings,
    })
}

/// A warning where samples were no finite numbers.
fn invalid_samples(count: u64) -> Option<Diagnostic> {
    let what = match count {
        0 => return None,
        1 => "1 sample was no finite number and counts".to_owned(),
        n => format!("{n} samples were not finite numbers and count"),
    };
    Some(
        Diagnostic::warning(Code::InvalidSamples, format!("{what} as black"))
            .hint("are colors or lights beyond 1e150?"),
    )
}

/// Measures a stage where the platform has a clock; 0 where it has none (wasm32-unknown-unknown).
struct Stopwatch {
    #[cfg(not(target_family = "wasm"))]
    start: std::time::Instant,
}

impl Stopwatch {
    fn start() -> Self {
        Self {
            #[cfg(not(target_family = "wasm"))]
            start: std::time::Instant::now(),
        }
    }

    fn elapsed(&self) -> Duration {
        #[cfg(not(target_family = "wasm"))]
        return self.start.elapsed();
        #[cfg(target_family = "wasm")]
        Duration::ZERO
    }
}

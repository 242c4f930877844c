//! What ends a render early, looked at often enough that no scene makes anybody wait: a single pixel can take minutes,
//! with thousands of samples, with a tree of 2^64 rays between mirrors of glass, or with lights of 65,536 points.

use std::{
    fmt,
    sync::{
        Condvar, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread,
    time::Duration,
};

use super::{RenderOptions, Stopwatch};
use crate::{
    diag::{Diagnostic, ErrorKind},
    host::Host,
};

/// How often the thread that watches a render asks.
const EVERY: Duration = Duration::from_millis(5);

/// Calls its function when it goes, also by a panic.
struct OnDrop<F: Fn()>(F);

impl<F: Fn()> Drop for OnDrop<F> {
    fn drop(&mut self) {
        (self.0)();
    }
}

/// Who is asked.
enum Asked<'h> {
    Borrowed(&'h dyn Host),
    Own(Box<dyn Host>),
}

/// Whether to stop, for all threads of a render.
pub(super) struct Interrupt<'h> {
    host: Asked<'h>,
    stopped: AtomicBool,
    /// Nobody else asks, so who looks at it asks.
    asks: bool,
    clock: Stopwatch,
    /// Time in all, and what of it is left.
    time: Option<(Duration, Duration)>,
    too_long: AtomicBool,
    /// Rays in all, and how many of them are left.
    most_rays: Option<(u64, u64)>,
    rays: AtomicU64,
}

impl<'h> Interrupt<'h> {
    /// The host's wish to stop alone.
    pub(super) fn new(host: &'h dyn Host) -> Self {
        Self::within(&RenderOptions::default(), host)
    }

    /// The host's wish, and the limits of a render that begins now.
    pub(super) fn within(options: &RenderOptions, host: &'h dyn Host) -> Self {
        Self::of(options, Asked::Borrowed(host))
    }

    /// The wish to stop of a host that is asked whenever anybody looks: for single questions, which no thread watches.
    pub(super) fn asking(host: Box<dyn Host>) -> Self {
        let asked = Self::of(&RenderOptions::default(), Asked::Own(host));
        Self { asks: true, ..asked }
    }

    fn of(options: &RenderOptions, host: Asked<'h>) -> Self {
        let spent = options.spent;
        Self {
            host,
            stopped: AtomicBool::new(false),
            asks: false,
            clock: Stopwatch::start(),
            time: options
                .render_time
                .map(|most| (most, most.saturating_sub(spent.time))),
            too_long: AtomicBool::new(false),
            most_rays: options.rays.map(|most| (most, most.saturating_sub(spent.rays))),
            rays: AtomicU64::new(0),
        }
    }

    /// Does something that may go for long without a question, while another thread asks.
    pub(super) fn watched<T>(&self, f: impl FnOnce() -> T) -> T {
        if cfg!(target_family = "wasm") {
            return f();
        }
        let (ended, bell) = (Mutex::new(false), Condvar::new());
        thread::scope(|scope| {
            let watcher = thread::Builder::new().name("rtscript watch".to_owned());
            let watch = || {
                let mut ended = ended.lock().unwrap_or_else(PoisonError::into_inner);
                while !*ended && !self.poll() {
                    let waited = bell.wait_timeout(ended, EVERY);
                    ended = waited.unwrap_or_else(PoisonError::into_inner).0;
                }
            };
            // Where there can be no thread more, the questions on the way have to do.
            let _ = watcher.spawn_scoped(scope, watch);
            let _end = OnDrop(|| {
                *ended.lock().unwrap_or_else(PoisonError::into_inner) = true;
                bell.notify_all();
            });
            f()
        })
    }

    /// True once the render is to stop; what is being computed is then dropped, so any value does.
    pub(super) fn poll(&self) -> bool {
        let is_stopped = || self.stopped.load(Ordering::Relaxed);
        if is_stopped() {
            return true;
        }
        let host = match &self.host {
            Asked::Borrowed(host) => *host,
            Asked::Own(host) => &**host,
        };
        if host.should_stop() {
            self.stopped.store(true, Ordering::Relaxed);
        } else if self.time.is_some_and(|(_, left)| self.clock.elapsed() > left) {
            self.too_long.store(true, Ordering::Relaxed);
            self.stopped.store(true, Ordering::Relaxed);
        }
        is_stopped()
    }

    /// Counts rays of the picture. Past the limit the render stops, which it would at the latest with the last tile:
    /// whether it does depends on the picture alone, not on the order of tiles.
    pub(super) fn count(&self, rays: u64) {
        if let Some((_, left)) = self.most_rays
            && self.rays.fetch_add(rays, Ordering::Relaxed).saturating_add(rays) > left
        {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }

    /// True where a [`Interrupt::poll`] was: the picture is not whole.
    #[inline]
    pub(super) fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed) || self.asks && self.poll()
    }

    /// Why the picture is not whole.
    pub(super) fn reason(&self) -> Diagnostic {
        // Where there are too many rays, there always are, so this comes first.
        if let Some((most, left)) = self.most_rays
            && self.rays.load(Ordering::Relaxed) > left
        {
            let message = format!("the picture takes too many rays: the limit 'rays' is {most}");
            return Diagnostic::error(ErrorKind::Limit, message)
                .hint("fewer samples, fewer bounces or a smaller picture take fewer");
        }
        if let Some((most, _)) = self.time
            && self.too_long.load(Ordering::Relaxed)
        {
            let message = format!("the render takes too long: the limit 'render_time' is {most:?}");
            return Diagnostic::error(ErrorKind::Limit, message)
                .hint("fewer samples, fewer bounces or a smaller picture take less");
        }
        Diagnostic::error(ErrorKind::Cancelled, "the render was stopped")
    }
}

impl fmt::Debug for Interrupt<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Interrupt")
            .field("stopped", &self.stopped)
            .finish_non_exhaustive()
    }
}

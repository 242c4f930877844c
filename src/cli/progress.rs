//! The line that tells how far a long render is.

use std::{
    fmt::Write as _,
    io::{IsTerminal, Write as _},
    sync::Mutex,
    time::{Duration, Instant},
};

use super::stats::{rate, time};
use crate::render::Progress;

/// Renders shorter than this show no line at all.
const PATIENCE: Duration = Duration::from_millis(500);
/// Time between two drawings.
const INTERVAL: Duration = Duration::from_millis(100);
/// Width of the bar in characters.
const BAR: u64 = 24;

/// One line on standard error, drawn over itself, erased at the end.
#[derive(Debug)]
pub(super) struct ProgressLine {
    state: Option<Mutex<State>>,
}

#[derive(Debug)]
struct State {
    start: Instant,
    last: Progress,
    drawn: Option<Instant>,
}

impl ProgressLine {
    /// A line on standard error, if that is a terminal that can erase and `wanted`.
    pub(super) fn new(wanted: bool) -> Self {
        let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        let state = (wanted && !dumb && std::io::stderr().is_terminal()).then(|| {
            Mutex::new(State {
                start: Instant::now(),
                last: Progress {
                    done: 0,
                    total: 0,
                    rays: 0,
                },
                drawn: None,
            })
        });
        Self { state }
    }

    /// Draws the line where it is time to. Threads never wait for one another here.
    pub(super) fn update(&self, progress: &Progress) {
        let Some(mut state) = self.state.as_ref().and_then(|state| state.try_lock().ok()) else {
            return;
        };
        let now = Instant::now();
        let is_another_render = progress.total != state.last.total || progress.rays < state.last.rays;
        if is_another_render {
            state.start = now;
        }
        state.last = *progress;
        let elapsed = now - state.start;
        let is_early = elapsed < PATIENCE || state.drawn.is_some_and(|drawn| now - drawn < INTERVAL);
        if is_early || progress.done >= progress.total {
            return;
        }
        state.drawn = Some(now);
        // A terminal that does not take it gets no progress line, and nothing is lost.
        let mut err = std::io::stderr().lock();
        let _ = write!(err, "\r{}\x1b[K", line(progress, elapsed)).and_then(|()| err.flush());
    }

    /// Erases the line, if there is one.
    pub(super) fn clear(&self) {
        let Some(state) = &self.state else { return };
        let drawn = state.lock().ok().and_then(|mut state| state.drawn.take());
        if drawn.is_some() {
            let mut err = std::io::stderr().lock();
            let _ = write!(err, "\r\x1b[K").and_then(|()| err.flush());
        }
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        self.clear();
    }
}

/// ` 42% [##########              ]  3.1 Mrays/s  12 s left`
fn line(progress: &Progress, elapsed: Duration) -> String {
    let Progress { done, total, rays } = *progress;
    let share = done as f64 / total.max(1) as f64;
    let full = (share * BAR as f64) as u64;
    let mut text = format!("{:3}% [", (share * 100.0) as u64);
    text.extend((0..BAR).map(|i| if i < full { '#' } else { ' ' }));
    let _ = write!(text, "]  {}", rate(rays, elapsed));
    if done > 0 {
        let left = elapsed.mul_f64((1.0 / share - 1.0).min(1e6));
        let _ = write!(text, "  {} left", time(left));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_tells_percent_rate_and_time_left() {
        let at = |done, total, rays| line(&Progress { done, total, rays }, Duration::from_secs(10));
        assert_eq!(
            at(250, 1000, 31_000_000),
            " 25% [######                  ]  3.10 Mrays/s  30 s left"
        );
        assert_eq!(at(0, 1000, 0), "  0% [                        ]  0 rays/s");
        assert!(at(1, u64::MAX, 5).contains(" h "));
        assert!(at(0, 0, 0).starts_with("  0%"));
    }

    #[test]
    fn nothing_is_drawn_where_it_is_not_wanted() {
        let line = ProgressLine::new(false);
        assert!(line.state.is_none());
        line.clear();
    }
}

//! A thumbnail service: `POST /thumbnail?width=160&height=120` with a script as its body answers with a PNG.
//!
//! The scripts come from strangers and run in this process. What keeps it alive, from the outside in:
//!
//! - [`http`]: a body of bounded size that arrives in bounded time; who hangs up is not worked for.
//! - [`queue`]: bounded, in two lanes, so that what is quick does not wait behind what is not.
//! - [`work`]: rtscript with [`Limits::untrusted`](rtscript::Limits::untrusted), assets in memory, and a deadline.

pub mod http;
pub mod queue;
pub mod work;

use std::{num::NonZero, thread::available_parallelism, time::Duration};

use rtscript::{Limits, MemoryHost};

/// What the service allows.
#[derive(Clone, Debug)]
pub struct Config {
    /// What a script may use.
    pub limits: Limits,
    /// The files that scripts can read.
    pub assets: MemoryHost,
    /// Longest edge of a thumbnail in pixels.
    pub longest_edge: u32,
    /// Threads that render. One of them works on the short lane only, so at least 2.
    pub workers: usize,
    /// Requests that may wait in the short lane, where every request begins. More are turned away.
    pub short_lane: usize,
    /// Requests that may wait in the long lane. More are turned away.
    pub long_lane: usize,
    /// How long a request is worked on before it has to go to the long lane.
    pub slice: Duration,
    /// How long a request is worked on in the long lane before it is given up.
    pub budget: Duration,
    /// From a request's arrival to its answer, waiting included.
    pub timeout: Duration,
    /// Time in which a body has to arrive.
    pub body_timeout: Duration,
    /// Bytes of pictures that are remembered.
    pub cache_bytes: usize,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            limits: Limits::untrusted(),
            assets: MemoryHost::new(),
            longest_edge: 512,
            workers: available_parallelism().map_or(2, NonZero::get).max(2),
            short_lane: 256,
            long_lane: 16,
            slice: Duration::from_millis(250),
            budget: Duration::from_secs(10),
            timeout: Duration::from_secs(30),
            body_timeout: Duration::from_secs(5),
            cache_bytes: 64 << 20,
        }
    }
}

//! The script's thread and the caller's thread.
//!
//! A script runs on a thread of its own, for its deep stack. The host belongs to the caller, so whatever a
//! script asks of the outside world is sent back and done there; rendering too, which thereby happens in the
//! rayon pool the caller is in.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
    mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
};
use std::time::Duration;

use crate::{
    diag::{Error, ErrorKind, Report},
    host::{Host, HostError},
    render::{Image, RenderOptions, Rendered, render},
    scene::Scene,
};

/// How often the host is asked whether to stop while the script keeps to itself.
const POLL: Duration = Duration::from_millis(10);

/// What rendering gives.
pub(crate) type RenderResult = Result<Report<Rendered>, Error>;

/// One thing asked of the caller's thread.
pub(super) enum Request {
    Read {
        path: String,
        max_bytes: u64,
        reply: SyncSender<Result<Vec<u8>, HostError>>,
    },
    Print(String),
    Render {
        scene: Box<Scene>,
        reply: SyncSender<(Box<Scene>, RenderResult)>,
    },
    Write {
        name: String,
        image: Arc<Image>,
        reply: SyncSender<Result<(), HostError>>,
    },
}

/// The host, as the script's thread sees it.
#[derive(Clone)]
pub(crate) struct Remote {
    requests: SyncSender<Request>,
    stop: Arc<AtomicBool>,
}

impl Remote {
    /// The two ends. Few requests may wait, so that a flood of prints cannot fill the memory.
    pub(super) fn pair() -> (Self, Receiver<Request>) {
        let (requests, incoming) = sync_channel(64);
        let stop = Arc::default();
        (Self { requests, stop }, incoming)
    }

    pub(super) fn stop_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }

    fn ask<T>(&self, make: impl FnOnce(SyncSender<T>) -> Request) -> Option<T> {
        let (reply, answer) = sync_channel(1);
        self.requests.send(make(reply)).ok()?;
        answer.recv().ok()
    }

    /// Renders on the caller's thread, and gives the scene back.
    pub(crate) fn render(&self, scene: Scene) -> Option<(Scene, RenderResult)> {
        let scene = Box::new(scene);
        let (scene, result) = self.ask(|reply| Request::Render { scene, reply })?;
        Some((*scene, result))
    }

    /// Hands a picture over without copying it.
    pub(crate) fn write_shared(&self, name: &str, image: &Arc<Image>) -> Result<(), HostError> {
        self.ask(|reply| Request::Write {
            name: name.to_owned(),
            image: Arc::clone(image),
            reply,
        })
        .unwrap_or_else(gone)
    }
}

fn gone<T>() -> Result<T, HostError> {
    Err(HostError::new(ErrorKind::Cancelled, "the run was stopped"))
}

impl Host for Remote {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        self.ask(|reply| Request::Read {
            path: path.to_owned(),
            max_bytes,
            reply,
        })
        .unwrap_or_else(gone)
    }

    fn print(&self, text: &str) {
        // Nobody listens only when the run is over.
        let _ = self.requests.send(Request::Print(text.to_owned()));
    }

    fn should_stop(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn write_image(&self, name: &str, image: &Image) -> Result<(), HostError> {
        self.write_shared(name, &Arc::new(image.clone()))
    }
}

/// Answers the script's requests until its thread ends.
pub(super) fn serve(
    incoming: &Receiver<Request>,
    host: &dyn Host,
    options: &RenderOptions,
    stop: &AtomicBool,
) {
    loop {
        if host.should_stop() {
            stop.store(true, Ordering::Relaxed);
        }
        // An answer that nobody waits for any more is dropped.
        match incoming.recv_timeout(POLL) {
            Ok(Request::Read {
                path,
                max_bytes,
                reply,
            }) => drop(reply.send(host.read(&path, max_bytes))),
            Ok(Request::Print(text)) => host.print(&text),
            Ok(Request::Render { scene, reply }) => {
                let result = render(&scene, options, host);
                drop(reply.send((scene, result)));
            }
            Ok(Request::Write { name, image, reply }) => {
                let written = host.write_image(&name, &image);
                // The script goes on with the only handle, so that it need not copy the picture.
                drop(image);
                drop(reply.send(written));
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

/// Stops the script when the caller's thread leaves, also by a panic of the host.
pub(super) struct StopOnDrop(pub(super) Arc<AtomicBool>);

impl Drop for StopOnDrop {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

//! The script and its caller.
//!
//! A script runs on a thread of its own, for its deep stack. The host belongs to the caller, so whatever a
//! script asks of the outside world is sent back and done there; rendering too, which thereby happens in the
//! rayon pool the caller is in. Where there is one thread only, the caller waits below the script on the same
//! stack, and answers the same requests when it is called.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
    mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
};
use std::time::Duration;

use scoped_tls_hkt::scoped_thread_local;

use super::clock::Clock;
use crate::{
    diag::{Error, ErrorKind, Report},
    host::{Host, HostError},
    render::{Image, LayerKind, RenderOptions, Rendered, Spent, render},
    scene::Scene,
};

/// How often the host is asked whether to stop while the script keeps to itself.
const POLL: Duration = Duration::from_millis(2);

/// How long a script is waited for that is to stop. It looks within microseconds, unless a step of it takes longer: Rhai
/// copies and frees millions of values in one. What it has made is freed in that time as well, or else by its thread after
/// the call has returned; the rest of the 20 ms in which that is to happen is for a machine that has other things to do.
const GRACE: Duration = Duration::from_millis(8);

/// What rendering gives.
pub(crate) type RenderResult = Result<Report<Rendered>, Error>;

/// What a script's render may take, and what those before took of it.
#[derive(Clone, Debug)]
pub(crate) struct RenderLimits {
    /// What else the picture is to hold.
    pub(crate) layers: Vec<LayerKind>,
    pub(crate) time: Option<Duration>,
    pub(crate) rays: Option<u64>,
    pub(crate) spent: Spent,
}

/// One thing asked of the caller.
pub(super) enum Request {
    Read {
        path: String,
        max_bytes: u64,
        reply: SyncSender<Result<Vec<u8>, HostError>>,
    },
    Print(String),
    Render {
        scene: Box<Scene>,
        limits: RenderLimits,
        reply: SyncSender<(Box<Scene>, RenderResult)>,
    },
    Write {
        name: String,
        image: Arc<Image>,
        reply: SyncSender<Result<(), HostError>>,
    },
}

/// What the caller's thread tells the script's without being asked.
#[derive(Debug, Default)]
pub(super) struct Flags {
    /// The run is to end.
    pub(super) stop: AtomicBool,
    /// Some milliseconds have passed: a step of the script may have taken long, so that its time is looked at now.
    pub(super) look: AtomicBool,
}

/// The host, as the script sees it.
#[derive(Clone)]
pub(crate) enum Remote {
    /// The caller waits on another thread.
    Thread {
        requests: SyncSender<Request>,
        flags: Arc<Flags>,
    },
    /// The caller is [`CALLER`] of this thread.
    Here,
}

impl Remote {
    /// The end of a script that runs on another thread, which does what the flags say, and the caller's end.
    /// Few requests may wait, so that a flood of prints cannot fill the memory.
    pub(super) fn pair(flags: Arc<Flags>) -> (Self, Receiver<Request>) {
        let (requests, incoming) = sync_channel(64);
        (Self::Thread { requests, flags }, incoming)
    }

    /// What the caller tells meanwhile: nothing where it waits below the script.
    pub(super) fn flags(&self) -> Arc<Flags> {
        match self {
            Self::Thread { flags, .. } => Arc::clone(flags),
            Self::Here => Arc::default(),
        }
    }

    /// Hands a request to the caller; `None` where nobody listens any more.
    fn send(&self, request: Request) -> Option<()> {
        match self {
            Self::Thread { requests, .. } => requests.send(request).ok(),
            Self::Here => CALLER
                .is_set()
                .then(|| CALLER.with(|caller| caller.answer(request))),
        }
    }

    fn ask<T>(&self, make: impl FnOnce(SyncSender<T>) -> Request) -> Option<T> {
        let (reply, answer) = sync_channel(1);
        self.send(make(reply))?;
        answer.recv().ok()
    }

    /// Lets the caller render, and gives the scene back.
    pub(crate) fn render(&self, scene: Scene, limits: RenderLimits) -> Option<(Scene, RenderResult)> {
        let scene = Box::new(scene);
        let (scene, result) = self.ask(|reply| Request::Render { scene, limits, reply })?;
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
        let _ = self.send(Request::Print(text.to_owned()));
    }

    fn should_stop(&self) -> bool {
        match self {
            Self::Thread { flags, .. } => flags.stop.load(Ordering::Relaxed),
            Self::Here => CALLER.is_set() && CALLER.with(|caller| caller.host.should_stop()),
        }
    }

    fn write_image(&self, name: &str, image: &Image) -> Result<(), HostError> {
        self.write_shared(name, &Arc::new(image.clone()))
    }
}

scoped_thread_local! {
    /// Who called the script that runs on this thread.
    static CALLER: for<'c> &'c Caller<'c>
}

/// Who runs a script, and answers it.
pub(super) struct Caller<'c> {
    pub(super) host: &'c dyn Host,
    pub(super) render: &'c RenderOptions,
}

impl Caller<'_> {
    /// Answers the requests of a script on another thread until that ends. False where the host wants it to end, and it
    /// takes longer than it is waited for.
    pub(super) fn serve(&self, incoming: &Receiver<Request>, flags: &Flags) -> bool {
        let clock = Clock::start();
        let mut looked = Duration::ZERO;
        let mut until = None;
        loop {
            let now = clock.elapsed();
            let stops = until.is_none() && self.host.should_stop();
            if stops {
                flags.stop.store(true, Ordering::Relaxed);
                until = Some(now + GRACE);
            }
            if until.is_some_and(|until| now >= until) {
                return false;
            }
            // Requests may come all the time.
            if stops || now >= looked + POLL {
                looked = now;
                flags.look.store(true, Ordering::Relaxed);
            }
            let left = until.map_or(POLL, |until| until.saturating_sub(now).min(POLL));
            match incoming.recv_timeout(left) {
                // Files take their time. The script hears that nobody answers.
                Ok(Request::Read { .. } | Request::Write { .. }) if until.is_some() => {}
                Ok(request) => self.answer(request),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return true,
            }
        }
    }

    /// Answers the requests of a script that `run` runs on this thread.
    pub(super) fn call<T>(&self, run: impl FnOnce(Remote) -> T) -> T {
        CALLER.set(self, || run(Remote::Here))
    }

    fn answer(&self, request: Request) {
        // An answer that nobody waits for any more is dropped.
        match request {
            Request::Read {
                path,
                max_bytes,
                reply,
            } => drop(reply.send(self.host.read(&path, max_bytes))),
            Request::Print(text) => self.host.print(&text),
            Request::Render { scene, limits, reply } => {
                // The caller's own limits count too, and the stricter one of each.
                let mut options = self.render.clone();
                options.render_time = options.render_time.into_iter().chain(limits.time).min();
                options.rays = options.rays.into_iter().chain(limits.rays).min();
                options.spent = limits.spent;
                options.layers = limits.layers;
                let result = render(&scene, &options, self.host);
                drop(reply.send((scene, result)));
            }
            Request::Write { name, image, reply } => {
                let written = self.host.write_image(&name, &image);
                // The script goes on with the only handle, so that it need not copy the picture.
                drop(image);
                drop(reply.send(written));
            }
        }
    }
}

/// Stops the script when the caller's thread leaves, also by a panic of the host.
pub(super) struct StopOnDrop(pub(super) Arc<Flags>);

impl Drop for StopOnDrop {
    fn drop(&mut self) {
        self.0.stop.store(true, Ordering::Relaxed);
        self.0.look.store(true, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;
    use crate::{
        MemoryHost,
        limits::Limits,
        script::{Run, RunOptions, Script},
    };

    const SCRIPT: &str = "import \"parts\" as parts;
        size(8, 6);
        print(`one ${parts::part()}`);
        sphere(0, 0, 0, 1);
        let picture = render(\"a.png\");
        print(picture.pixel(4, 3));
        diffuse(picture);
        box();";

    /// Keeps what it hears.
    #[derive(Default)]
    struct Ear {
        heard: Mutex<Vec<String>>,
        stops: bool,
        runs: bool,
    }

    impl Ear {
        fn hear(&self, what: String) {
            self.heard.lock().unwrap().push(what);
        }
    }

    impl Host for Ear {
        fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
            self.hear(format!("read {path}"));
            let parts = "fn part() { sphere(1, 0, 0, 1); \"part\" }";
            MemoryHost::new().with("parts.rhai", parts).read(path, max_bytes)
        }

        fn print(&self, text: &str) {
            self.hear(format!("print {text}"));
            if self.runs {
                let inner = here("box();", &Self::default());
                self.hear(inner.map_or_else(|e| e.diagnostic.message.clone(), |_| "ran".to_owned()));
            }
        }

        fn should_stop(&self) -> bool {
            self.stops
        }

        fn write_image(&self, name: &str, image: &Image) -> Result<(), HostError> {
            self.hear(format!("write {name} {}", image.hash()));
            Ok(())
        }
    }

    fn here(script: &str, host: &dyn Host) -> Result<Report<Run>, Error> {
        let script = Script::compile("a.rhai", script, &Limits::default())?;
        let options = RunOptions::default();
        let caller = Caller {
            host,
            render: &options.render,
        };
        script.run_here(&caller, &options, None)
    }

    #[test]
    fn a_script_on_the_callers_thread_does_what_it_does_on_its_own() {
        let (one, two) = (Ear::default(), Ear::default());
        let alone = here(SCRIPT, &one).unwrap().value.scene.dump();
        let script = Script::compile("a.rhai", SCRIPT, &Limits::default()).unwrap();
        let threaded = script.run(&two, &RunOptions::default()).unwrap();
        assert_eq!(alone, threaded.value.scene.dump());
        let heard = one.heard.into_inner().unwrap();
        assert_eq!(heard.len(), 4, "{heard:?}");
        assert_eq!(heard, two.heard.into_inner().unwrap());
    }

    #[test]
    fn a_script_on_the_callers_thread_is_stopped_too() {
        let ear = Ear {
            stops: true,
            ..Ear::default()
        };
        let error = here("loop { }", &ear).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Cancelled);
    }

    #[test]
    fn a_host_cannot_run_a_script_within_the_one_it_answers() {
        let ear = Ear {
            runs: true,
            ..Ear::default()
        };
        let outer = here("print(1); box(); box();", &ear).unwrap().value;
        assert_eq!(outer.scene.root().objects.len(), 2);
        let heard = ear.heard.into_inner().unwrap();
        assert!(
            heard[1].starts_with("a script runs on this thread already"),
            "{heard:?}"
        );
        // The next run has the thread to itself again.
        here("box();", &Ear::default()).unwrap();
    }
}

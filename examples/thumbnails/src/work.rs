//! From a script to a PNG, within limits and a deadline.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::{Builder, JoinHandle},
    time::Instant,
};

use rtscript::{
    Error, Host, Image, MemoryHost, RenderOptions, RunOptions, Script,
    diag::ErrorKind,
    host::HostError,
    output::{Format, encode},
    render,
};
use tokio::sync::oneshot;

use crate::{
    Config,
    queue::{Lane, Queue},
};

/// What is asked for; equal requests have equal pictures.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Request {
    /// The script's text.
    pub script: String,
    /// Width and height in pixels, whatever the script says.
    pub size: (u32, u32),
}

/// Why there is no picture.
#[derive(Debug)]
pub enum Failure {
    /// The script is wrong, or reached a limit.
    Script(Box<Error>),
    /// It took longer than the budget of the long lane.
    TooSlow,
    /// Others came first, and there is no room or no time left.
    Busy,
    /// A fault of the service's own.
    Internal(String),
}

/// A PNG, or why there is none.
pub type Answer = Result<Vec<u8>, Failure>;

/// A request on its way through the queue.
#[derive(Debug)]
pub struct Job {
    pub request: Request,
    /// When the answer has to be there.
    pub deadline: Instant,
    /// Set where the client has gone.
    pub is_cancelled: Arc<AtomicBool>,
    pub answer: oneshot::Sender<Answer>,
}

/// The threads that render, and what they work on.
pub struct Service {
    pub config: Config,
    pub queue: Queue<Job>,
    /// Jobs that were answered.
    pub answered: AtomicU64,
}

impl Service {
    /// Starts the workers. They end once the queue is closed and empty.
    ///
    /// # Errors
    /// Where the system gives no more threads.
    pub fn start(config: Config) -> std::io::Result<(Arc<Self>, Vec<JoinHandle<()>>)> {
        let service = Arc::new(Self {
            queue: Queue::new(config.short_lane, config.long_lane),
            config,
            answered: AtomicU64::new(0),
        });
        let worker = |number: usize| {
            let lanes: &[Lane] = match number {
                0 => &[Lane::Short],
                _ => &[Lane::Long, Lane::Short],
            };
            let service = Arc::clone(&service);
            // One picture keeps one processor busy. Many small ones at once are faster than each on all processors, and
            // a costly one cannot take more than its worker. rtscript renders in the pool that it is called in.
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
            let pool = pool.map_err(std::io::Error::other)?;
            Builder::new().name(format!("worker {number}")).spawn(move || {
                while let Some((lane, job)) = service.queue.take(lanes) {
                    pool.install(|| service.work_on(lane, job));
                }
            })
        };
        let workers = (0..service.config.workers.max(2))
            .map(worker)
            .collect::<Result<_, _>>()?;
        Ok((service, workers))
    }

    fn work_on(&self, lane: Lane, job: Job) {
        let now = Instant::now();
        if job.is_cancelled.load(Ordering::Relaxed) {
            return;
        }
        if now >= job.deadline {
            return self.answer(job, Err(Failure::Busy));
        }
        let time = match lane {
            Lane::Short => self.config.slice,
            Lane::Long => self.config.budget,
        };
        let host = JobHost {
            assets: &self.config.assets,
            is_cancelled: &job.is_cancelled,
            until: job.deadline.min(now + time),
        };
        // rtscript does not panic. Should it, one request fails and not the service.
        let made = catch_unwind(AssertUnwindSafe(|| thumbnail(&job.request, &self.config, &host)));
        let answer = match made {
            Err(_) => Err(Failure::Internal("the renderer panicked".to_owned())),
            Ok(Err(error)) if error.kind() == ErrorKind::Cancelled => match lane {
                // It had its time. The client may have gone, or the time may have been cut short by the deadline; both
                // are found out at the next turn.
                Lane::Short => match self.queue.push(Lane::Long, job) {
                    Ok(()) => return,
                    Err(job) => return self.answer(job, Err(Failure::Busy)),
                },
                Lane::Long if Instant::now() >= job.deadline => Err(Failure::Busy),
                Lane::Long => Err(Failure::TooSlow),
            },
            Ok(Err(error)) => Err(Failure::Script(Box::new(error))),
            Ok(Ok(image)) => encode(&image, Format::Png).map_err(|e| Failure::Internal(e.to_string())),
        };
        self.answer(job, answer);
    }

    fn answer(&self, job: Job, answer: Answer) {
        self.answered.fetch_add(1, Ordering::Relaxed);
        // Nobody waits for it where the client has gone.
        let _ = job.answer.send(answer);
    }
}

/// The picture of a script: the last one that it rendered by itself, or the scene that it leaves behind.
///
/// # Errors
/// Whatever is wrong with the script; `Cancelled` where the host asked to stop.
pub fn thumbnail(request: &Request, config: &Config, host: &dyn Host) -> Result<Image, Error> {
    let mut options = RunOptions::default();
    options.size = Some(request.size);
    options.render = RenderOptions::default().within(&config.limits);
    let script = Script::compile("script", &request.script, &config.limits)?;
    let mut run = script.run(host, &options)?.value;
    if let Some(last) = run.pictures.pop() {
        return Ok(last.image);
    }
    Ok(render(&run.scene, &options.render, host)?.value.image)
}

/// What a script can reach: files in memory and no others. It prints to nobody, and its pictures stay here.
pub struct JobHost<'a> {
    pub assets: &'a MemoryHost,
    pub is_cancelled: &'a AtomicBool,
    pub until: Instant,
}

impl Host for JobHost<'_> {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        self.assets.read(path, max_bytes)
    }

    /// Asked while the script runs and while rays are traced. This, not the limits, is what frees a worker soon.
    fn should_stop(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed) || Instant::now() >= self.until
    }

    fn write_image(&self, _name: &str, _image: &Image) -> Result<(), HostError> {
        Ok(())
    }
}

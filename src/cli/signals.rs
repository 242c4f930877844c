//! SIGINT, SIGTERM and SIGHUP: the first asks the run to stop, and ends the process where it has not stopped soon; the
//! second ends it at once. However it ends, files are whole and no temporary one stays.

use std::sync::{
    Arc, Mutex, PoisonError,
    atomic::{AtomicBool, AtomicI32, Ordering},
};

/// Which signal came, if any.
#[derive(Default)]
pub(super) struct Signals {
    /// Number of the first signal; 0 before one came.
    caught: AtomicI32,
    /// Whether somebody looks at `caught`. While a file is read nobody does: reading a terminal may wait for
    /// ever, so that a signal must end the process at once.
    armed: AtomicBool,
    /// What is to be done before a signal ends the process, such as to give the terminal back.
    last: Mutex<Option<Box<dyn Fn() + Send>>>,
}

impl std::fmt::Debug for Signals {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Signals").field(&self.caught()).finish()
    }
}

impl Signals {
    /// Takes over the process's signals. Those that the parent chose to ignore stay ignored, as `nohup` wants.
    pub(super) fn install() -> Arc<Self> {
        let signals = Arc::new(Self::default());
        #[cfg(unix)]
        unix::listen(&signals);
        signals
    }

    /// Says whether [`Signals::caught`] is being looked at; otherwise a signal ends the process.
    pub(super) fn arm(&self, armed: bool) {
        self.armed.store(armed, Ordering::SeqCst);
    }

    /// Says what is to be done before a signal ends the process at once.
    pub(super) fn before_the_end(&self, last: Option<Box<dyn Fn() + Send>>) {
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = last;
    }

    /// What must be done before the process ends without running any destructor.
    #[cfg(unix)]
    fn end(&self) {
        if let Some(last) = &*self.last.lock().unwrap_or_else(PoisonError::into_inner) {
            last();
        }
        crate::output::remove_unfinished();
    }

    /// The number of the signal that asks to stop.
    pub(super) fn caught(&self) -> Option<i32> {
        match self.caught.load(Ordering::Relaxed) {
            0 => None,
            signal => Some(signal),
        }
    }

    /// The name of that signal.
    pub(super) fn caught_name(&self) -> Option<&'static str> {
        self.caught().map(|signal| match signal {
            2 => "SIGINT",
            15 => "SIGTERM",
            _ => "SIGHUP",
        })
    }
}

#[cfg(unix)]
mod unix {
    use std::{
        io::Write,
        sync::mpsc,
        thread::{Builder, sleep},
        time::Duration,
    };

    use super::{Arc, Ordering};
    use signal_hook::{
        consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ},
        iterator::Signals as Listener,
        low_level,
    };

    /// Time in which a run that was asked to stop may do so by itself. What takes longer, such as reading a large file or
    /// encoding a large picture, is ended.
    const PATIENCE: Duration = Duration::from_millis(300);

    /// Starts the thread that receives signals. Where it cannot be started, signals keep the system's meaning.
    pub(super) fn listen(signals: &Arc<super::Signals>) {
        let ignored = ignored();
        // SIGXFSZ is taken only to be survived: the write then reports that the file is too large.
        let wanted = [SIGINT, SIGTERM, SIGHUP, SIGXFSZ];
        let taken = wanted.into_iter().filter(|s| ignored & (1 << (s - 1)) == 0);
        let Ok(mut listener) = Listener::new(taken) else {
            return;
        };
        let signals = Arc::clone(signals);
        let thread = Builder::new().name("signals".to_owned());
        let _ = thread.spawn(move || {
            for signal in listener.forever().filter(|s| *s != SIGXFSZ) {
                let first = signals
                    .caught
                    .compare_exchange(0, signal, Ordering::SeqCst, Ordering::SeqCst);
                if first.is_err() || !signals.armed.load(Ordering::SeqCst) {
                    end(&signals, signal);
                }
                let signals = Arc::clone(&signals);
                let _ = Builder::new().spawn(move || {
                    sleep(PATIENCE);
                    say(&signals);
                    end(&signals, signal);
                });
            }
        });
    }

    fn end(signals: &super::Signals, signal: i32) {
        signals.end();
        low_level::exit(128 + signal);
    }

    /// Says that the run was ended. Nobody may be reading standard error, which is not waited for.
    fn say(signals: &super::Signals) {
        let name = signals.caught_name().unwrap_or("a signal");
        let (done, wait) = mpsc::channel();
        let _ = Builder::new().spawn(move || {
            let _ = writeln!(std::io::stderr(), "error: stopped by {name} before it was done");
            let _ = done.send(());
        });
        let _ = wait.recv_timeout(Duration::from_millis(50));
    }

    /// Bit n - 1 is set where the parent made this process ignore signal n. Read from a file, because asking the
    /// system takes unsafe code; where there is no such file (not Linux), none is held to be ignored.
    fn ignored() -> u64 {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
            .unwrap_or(0)
    }
}

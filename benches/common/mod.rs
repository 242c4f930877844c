//! What the benchmark programs share; each uses a part of it.

#![allow(dead_code)]

pub(crate) mod scenes;

/// Processor seconds that this process has used, all threads together: unlike the time on the wall it hardly
/// depends on what else runs on the machine.
pub(crate) fn cpu_seconds() -> f64 {
    let mut t = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: writes into `t` only.
    #[allow(unsafe_code)]
    unsafe {
        libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut t)
    };
    t.tv_sec as f64 + 1e-9 * t.tv_nsec as f64
}

/// Runs `work` and says what it took in processor seconds.
pub(crate) fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = cpu_seconds();
    let value = work();
    (cpu_seconds() - start, value)
}

/// The middle one of some times.
pub(crate) fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
}

/// One thread for everything that asks for threads.
pub(crate) fn one_thread() -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap()
}

/// Arguments without those that cargo adds, and the number after `--reps`.
pub(crate) fn arguments(default_reps: usize) -> (Vec<String>, usize) {
    let mut args: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench" && a != "--test")
        .collect();
    let mut reps = default_reps;
    if let Some(at) = args.iter().position(|a| a == "--reps") {
        let taken: Vec<String> = args.drain(at..(at + 2).min(args.len())).collect();
        reps = taken
            .get(1)
            .and_then(|n| n.parse().ok())
            .expect("a number after --reps");
    }
    (args, reps)
}

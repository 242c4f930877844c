//! Thousands of scripts of strangers in one process, several at a time: does it grow?
//!
//! `cargo bench --bench soak -- 10000 ../../docs/soak` writes `../../docs/soak.csv` and `../../docs/soak.svg`, and fails
//! where memory at the end is not what it was near the beginning, or where a thread or a descriptor stayed. Linux only.

#[path = "../tests/common/mod.rs"]
mod common;

use std::{
    collections::BTreeMap,
    error::Error,
    fmt::Write as _,
    fs,
    process::Command,
    sync::{
        Mutex,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use common::{GOOD, HOSTILE, fresh, percentile};
use rtscript::{Image, MemoryHost, diag::ErrorKind, meter::Meter, output};
use thumbnails::{
    Config,
    work::{JobHost, Request, thumbnail},
};

#[global_allocator]
static ALLOCATOR: Meter = Meter::new();

/// Scripts between two looks at the process, when nothing runs.
const BATCH: usize = 100;
/// Scripts at a time.
const AT_ONCE: usize = 4;
/// Of each batch, so many mean no good.
const HOSTILE_SHARE: usize = 15;
const PICTURE: &str = "a picture";
/// What a script is given. One that means good takes milliseconds; more than a second is for machines that are busy.
const PATIENCE: Duration = Duration::from_secs(1);
const PATIENCE_WITH_GOOD: Duration = Duration::from_secs(10);

/// What one script did. Nothing in it is on the heap: what is kept would lie among what the scripts have freed, and keep
/// the C library from giving that back.
struct Outcome {
    name: &'static str,
    is_good: bool,
    how: Text,
    seconds: f64,
}

/// The seconds that scripts took, of those that mean good first, by name and how they ended.
type Kinds = BTreeMap<(bool, &'static str, Text), Vec<f32>>;

/// The beginning of a message.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Text([u8; 64]);

impl Text {
    fn new(text: &str) -> Self {
        let mut bytes = [b' '; 64];
        bytes
            .iter_mut()
            .zip(text.bytes())
            .for_each(|(to, from)| *to = from);
        Self(bytes)
    }
}

/// The process between two batches.
struct Look {
    scripts: usize,
    seconds: f64,
    rss_mib: f64,
    threads: usize,
    descriptors: usize,
    good_ms: [f64; 2],
}

/// Has glibc give back what is freed. As it is, it raises the size from which it does so each time something large is
/// freed, and each thread keeps some of the small pieces that it frees, which may have come from another thread and lie
/// behind megabytes that are free: memory then grows for hours to several times what is in use, without a leak.
const MALLOC: (&str, &str) = (
    "GLIBC_TUNABLES",
    "glibc.malloc.tcache_count=0:glibc.malloc.trim_threshold=131072",
);

fn main() -> Result<(), Box<dyn Error>> {
    if std::env::var_os(MALLOC.0).is_none() {
        // It is read when a process starts.
        let mut again = Command::new(std::env::current_exe()?);
        let status = again
            .args(std::env::args().skip(1))
            .env(MALLOC.0, MALLOC.1)
            .status()?;
        return if status.success() {
            Ok(())
        } else {
            Err("see above".into())
        };
    }
    // `cargo bench` adds an argument of its own.
    let mut args = std::env::args().skip(1).filter(|arg| arg != "--bench");
    let count: usize = args.next().map_or(Ok(1000), |count| count.parse())?;
    let target = args.next();
    let gray = Image::new(2, 2, rtscript::scene::Encoding::Raw, vec![[0.5; 3]; 4]);
    let config = Config {
        assets: MemoryHost::new().with("marble.png", output::encode(&gray, output::Format::Png)?),
        ..Config::default()
    };
    let pools: Vec<_> = (0..AT_ONCE)
        .map(|_| rayon::ThreadPoolBuilder::new().num_threads(1).build())
        .collect::<Result<_, _>>()?;

    let start = Instant::now();
    let (mut kinds, mut looks) = (Kinds::new(), Vec::with_capacity(count));
    for first in (0..count).step_by(BATCH) {
        let (next, done) = (AtomicUsize::new(first), Mutex::new(Vec::with_capacity(BATCH)));
        thread::scope(|scope| {
            for pool in &pools {
                scope.spawn(|| {
                    loop {
                        let number = next.fetch_add(1, Ordering::Relaxed);
                        if number >= (first + BATCH).min(count) {
                            return;
                        }
                        let outcome = pool.install(|| run(number, &config));
                        done.lock().expect("no worker panics").push(outcome);
                    }
                });
            }
        });
        // The last thread may not have ended when its work has.
        thread::sleep(Duration::from_millis(50));
        let done = done.into_inner()?;
        let mut good: Vec<f64> = done
            .iter()
            .filter(|o| o.is_good)
            .map(|o| o.seconds * 1000.0)
            .collect();
        looks.push(Look {
            scripts: (first + BATCH).min(count),
            seconds: start.elapsed().as_secs_f64(),
            rss_mib: rss_mib()?,
            threads: fs::read_dir("/proc/self/task")?.count(),
            descriptors: fs::read_dir("/proc/self/fd")?.count(),
            good_ms: [0.5, 0.99].map(|part| percentile(&mut good, part).unwrap_or_default()),
        });
        for o in done {
            kinds
                .entry((!o.is_good, o.name, o.how))
                .or_default()
                .push(o.seconds as f32);
        }
        if let Some(look) = looks.last() {
            println!(
                "{:6} scripts  {:6.0} s  {:7.1} MiB  {} threads  {} descriptors",
                look.scripts, look.seconds, look.rss_mib, look.threads, look.descriptors
            );
        }
    }
    print_kinds(&mut kinds);
    if let Some(target) = target {
        fs::write(format!("{target}.csv"), csv(&looks))?;
        fs::write(format!("{target}.svg"), svg(&looks))?;
    }
    judge(&looks, &kinds)
}

fn run(number: usize, config: &Config) -> Outcome {
    let in_batch = number % BATCH;
    let is_good = in_batch * HOSTILE_SHARE / BATCH == (in_batch + 1) * HOSTILE_SHARE / BATCH;
    let (name, script) = if is_good {
        GOOD[number % GOOD.len()]
    } else {
        HOSTILE[number * HOSTILE_SHARE / BATCH % HOSTILE.len()]
    };
    let request = Request {
        script: fresh(script, number),
        size: (80, 60),
    };
    let start = Instant::now();
    let host = JobHost {
        assets: &config.assets,
        is_cancelled: &AtomicBool::new(false),
        until: start + if is_good { PATIENCE_WITH_GOOD } else { PATIENCE },
    };
    let how = match thumbnail(&request, config, &host) {
        Ok(_) => Text::new(PICTURE),
        Err(error) if error.kind() == ErrorKind::Cancelled => Text::new("out of time"),
        Err(error) => Text::new(&error.diagnostic.message),
    };
    Outcome {
        name,
        is_good,
        how,
        seconds: start.elapsed().as_secs_f64(),
    }
}

/// Memory that the process has in use, from the pages that the kernel counts.
fn rss_mib() -> Result<f64, Box<dyn Error>> {
    let statm = fs::read_to_string("/proc/self/statm")?;
    let pages: f64 = statm
        .split(' ')
        .nth(1)
        .ok_or("no second number in statm")?
        .parse()?;
    Ok(pages * 4096.0 / f64::from(1 << 20))
}

fn print_kinds(kinds: &mut Kinds) {
    println!(
        "\n{:10} {:>6}  {:>7} {:>7} {:>7} s",
        "script", "times", "50 %", "99 %", "100 %"
    );
    for ((_, name, how), seconds) in kinds {
        let [half, most, all] = [0.5, 0.99, 1.0].map(|part| percentile(seconds, part).unwrap_or_default());
        println!(
            "{name:10} {:6}  {half:7.3} {most:7.3} {all:7.3}  {}",
            seconds.len(),
            String::from_utf8_lossy(&how.0).trim_end()
        );
    }
}

fn csv(looks: &[Look]) -> String {
    let mut text = "scripts,seconds,rss_mib,threads,descriptors,good_ms_50,good_ms_99\n".to_owned();
    for l in looks {
        let _ = writeln!(
            text,
            "{},{:.0},{:.1},{},{},{:.1},{:.1}",
            l.scripts, l.seconds, l.rss_mib, l.threads, l.descriptors, l.good_ms[0], l.good_ms[1]
        );
    }
    text
}

/// Memory over scripts as a picture.
fn svg(looks: &[Look]) -> String {
    let (width, height, left, bottom) = (640.0, 280.0, 56.0, 40.0);
    let most = looks.iter().map(|l| l.rss_mib).fold(1.0, f64::max) * 1.15;
    let last = looks.last().map_or(1.0, |l| l.scripts as f64);
    let x = |scripts: f64| left + scripts / last * (width - left - 16.0);
    let y = |mib: f64| height - bottom - mib / most * (height - bottom - 16.0);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" \
         font-size=\"12\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n"
    );
    for i in 0..5 {
        let (mib, scripts) = (most * f64::from(i) / 4.0, last * f64::from(i) / 4.0);
        let _ = writeln!(
            text,
            "<path d=\"M{left} {0:.1}H{1}\" stroke=\"#ddd\"/><text x=\"{2}\" y=\"{3:.1}\" text-anchor=\"end\">{mib:.0}</text>\
             <text x=\"{4:.1}\" y=\"{5}\" text-anchor=\"middle\">{scripts:.0}</text>",
            y(mib),
            width - 16.0,
            left - 6.0,
            y(mib) + 4.0,
            x(scripts),
            height - bottom + 18.0
        );
    }
    let points: Vec<String> = looks
        .iter()
        .map(|l| format!("{:.1},{:.1}", x(l.scripts as f64), y(l.rss_mib)))
        .collect();
    let _ = writeln!(
        text,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"#c33\" stroke-width=\"1.5\"/>\n\
         <text x=\"{}\" y=\"{}\" text-anchor=\"middle\">scripts of strangers run in one process</text>\n\
         <text x=\"{left}\" y=\"12\">resident memory, MiB</text>\n</svg>",
        points.join(" "),
        (left + width) / 2.0,
        height - 6.0
    );
    text
}

/// Compares the second tenth of the run with the last.
fn judge(looks: &[Look], kinds: &Kinds) -> Result<(), Box<dyn Error>> {
    let failed: usize = kinds
        .iter()
        .filter(|((is_hostile, _, how), _)| !is_hostile && *how != Text::new(PICTURE))
        .map(|(_, seconds)| seconds.len())
        .sum();
    let tenth = looks.len().div_ceil(10);
    let (early, late) = (
        looks.iter().skip(tenth).take(tenth),
        looks.iter().rev().take(tenth),
    );
    // The lower quartile, since glibc now and then keeps one of its heaps of 64 MiB for a while.
    let quartile = |looks: &mut dyn Iterator<Item = &Look>| {
        percentile(&mut looks.map(|l| l.rss_mib).collect::<Vec<_>>(), 0.25).unwrap_or_default()
    };
    let (before, after) = (quartile(&mut early.clone()), quartile(&mut late.clone()));
    let growth = after / before - 1.0;
    let most = looks.iter().map(|l| l.rss_mib).fold(0.0, f64::max);
    println!(
        "\n{before:.1} MiB in the second tenth, {after:.1} MiB in the last, {most:.1} at most: {:+.1} %",
        growth * 100.0
    );
    let kept = |count: fn(&Look) -> usize| late.clone().map(count).max() > early.clone().map(count).max();
    if growth > 0.05 || kept(|l| l.threads) || kept(|l| l.descriptors) || failed > 0 {
        return Err(format!("something stayed, or one of {failed} good scripts failed").into());
    }
    Ok(())
}

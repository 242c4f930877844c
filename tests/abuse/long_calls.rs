//! Calls over the largest values that strangers may make, one after the other without end: a script ends soon after its
//! time, for it looks at the clock between any two steps once milliseconds have passed, and in whatever takes longer.

use std::{
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use rtscript::{Host, Limits, RunOptions, Script, diag::ErrorKind, host::HostError, script::Language};

use crate::{Quiet, run};

/// What a script may take; less than making the largest values of all takes a debug build.
const TIME: Duration = Duration::from_millis(400);
/// How much later it may end, on a machine that other tests keep busy. The longest of these calls takes 10 milliseconds with
/// optimisation, 80 without; where a script looked at the clock every 512 steps alone, it was seconds.
const LATE: Duration = Duration::from_millis(1500);

/// What a call works on, and the call.
const CALLS: &[(&str, &str)] = &[
    (TWO_LONG, "a.index_of(v)"),
    (TWO_LONG, "a.contains(v)"),
    (TWO_LONG, "v in a"),
    (TWO_LONG, "a == v"),
    (TWO_LONG, "a.dedup(); a.pad(9900, 1)"),
    (TWO_LONG, "a.reverse()"),
    (TWO_LONG, "a.splice(10, 9800, v.extract(5, 9800))"),
    (MIXED, "let b = a; b.sort()"),
    (MIXED, "let b = a; b.sort_desc()"),
    (MIXED, "let b = a; b.sort(less)"),
    (MIXED, "a.order_by(less)"),
    (MIXED, "let b = a; b.dedup(less)"),
    (ZEROS, "b.to_string()"),
    (MIXED, "a.reduce(gather)"),
    (MIXED, "zip(a.extract(0, 3000), a)"),
    (MIXED, "a.to_string()"),
    (MIXED, "flatten([a])"),
    (LONG_TEXT, "let t = s; t.replace(\"a\", \"b\")"),
    (LONG_TEXT, "s.index_of(\"aaaaaaaaaaaaaaab\")"),
    (LONG_TEXT, "s[-1] = 'b'"),
    (LONG_TEXT, "s.to_upper()"),
    (LONG_TEXT, "textSize(s)"),
    (SPACES, "s.split(\"\")"),
    (SPACES, "s.to_chars()"),
    (WIDE_MAP, "let n = m; n.mixin(m); n == m"),
    (WIDE_MAP, "m.to_json()"),
    ("", "linspace(0, 1, 9999)"),
    (COMB, "polygon(a)"),
    (COMB, "curve(a, 0.01, #{ kind: \"linear\" })"),
    (
        "",
        "subdivide(#{ positions: [[-1, -1, 0], [1, -1, 0], [1, 1, 1], [-1, 1, 0]], faces: [[0, 1, 2, 3]] }, 8)",
    ),
    (BUBBLES, "isosurface(f)"),
];

const TWO_LONG: &str = "let a = []; a.pad(9900, 1); let v = []; v.pad(9900, 2);";
const MIXED: &str = "fn less(x, y) { x - y }
    fn gather(list, x) { if type_of(list) == \"()\" { list = []; } list.push(x); list }
    let a = []; for i in 0..9000 { a.push(i * 7919 % 9001); }";
const LONG_TEXT: &str = "let s = \"a\"; s.pad(60000, \"a\");";
const SPACES: &str = "let s = \" \"; s.pad(9000, \" \");";
const ZEROS: &str = "let b = blob(9000, 0);";
const WIDE_MAP: &str = "let m = #{}; for i in 0..900 { m[`k${i}`] = i; }";
const COMB: &str = "let a = [[2.4, -1, 0], [0, -1, 0]]; for i in 0..2400 { a.push([i * 0.001, i % 2, 0]); }";
const BUBBLES: &str = "let f = sdfSphere(0.5); for i in 0..60 { f = f.smoothUnion(sdfSphere(0.5).moved(i * 0.01, 0, 0), 0.1); }";

/// How long after its time a script ends that makes a call over and over.
fn late(values: &str, call: &str) -> Duration {
    let mut limits = Limits::untrusted();
    limits.script_time = TIME;
    limits.compile_time *= 10;
    // Only time ends it.
    (limits.operations, limits.primitives) = (u64::MAX, usize::MAX);
    let start = Instant::now();
    let error = run(&format!("{values}\nloop {{ {call}; }}"), &limits, &Quiet).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Limit, "{call}: {error}");
    assert!(
        error.to_string().contains("the limit 'script_time'"),
        "{call}: {error}"
    );
    start.elapsed().saturating_sub(TIME)
}

#[test]
fn no_call_keeps_a_script_long_beyond_its_time() {
    for (values, call) in CALLS {
        // Other work on the machine may delay any one of them.
        let least = (0..5).map(|_| late(values, call)).find(|late| *late < LATE);
        assert!(least.is_some(), "{call} goes on for more than {LATE:?}");
    }
}

/// Calls over larger values, each of which takes a good part of a second to its end.
const LONGER: &[(&str, &str)] = &[
    (SHUFFLED, "a.sort()"),
    (SHUFFLED, "a.sort_desc()"),
    (SHUFFLED, "a.order()"),
    (SHUFFLED, "let b = a.extract(0, 30000); b.sort(|x, y| x - y)"),
    (SHUFFLED, "let b = a.extract(0, 30000); b.order_by(|x, y| x < y)"),
    (SHUFFLED, "a.dedup()"),
    (SHUFFLED, "a.dedup(|x, y| x == y)"),
    (SHUFFLED, "a.index_of(-1)"),
    (SHUFFLED, "a == a"),
    (SHUFFLED, "a.map(Fn(\"abs\"))"),
    (NUMBERS, "a.to_string()"),
    (NUMBERS, "`${a}`"),
    (A_MILLION, "s.split(\"\")"),
    (A_MILLION, "s.split_rev('a')"),
];

const SHUFFLED: &str = "let a = []; for i in 0..300000 { a.push((i * 7919) % 300007); }";
const NUMBERS: &str = "let a = []; a.pad(140000, 12345);";
const A_MILLION: &str = "let s = \"a\"; s.pad(1000000, \"a\");";

/// Notes when a call begins, and may want it to stop then.
struct Watching {
    stops: bool,
    begun: Mutex<Option<Instant>>,
    wants_to_stop: AtomicBool,
}

impl Host for Watching {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, HostError> {
        Quiet.read(path, max_bytes)
    }

    fn print(&self, _text: &str) {
        *self.begun.lock().unwrap() = Some(Instant::now());
        self.wants_to_stop.store(self.stops, Ordering::Relaxed);
    }

    fn should_stop(&self) -> bool {
        self.wants_to_stop.load(Ordering::Relaxed)
    }
}

/// From the beginning of a call until its run has ended and nothing is left of it, for which the host need not wait.
fn takes(values: &str, call: &str, stops: bool) -> Duration {
    let mut limits = Limits::default();
    (limits.operations, limits.script_time) = (u64::MAX, Duration::from_secs(3600));
    let host = Watching {
        stops,
        begun: Mutex::new(None),
        wants_to_stop: AtomicBool::new(false),
    };
    let (language, shared) = napping(Duration::ZERO);
    let text = format!("{values}\nprint(0);\n{call};");
    let script = Script::compile_in(&language, "a.rhai", &text, &limits).unwrap();
    let ended = script.run(&host, &RunOptions::default());
    drop((language, script));
    while Arc::strong_count(&shared) > 1 {
        std::thread::sleep(Duration::from_millis(1));
    }
    match ended {
        Ok(_) => assert!(!stops, "{call} goes on"),
        Err(e) if stops => assert_eq!(e.kind(), ErrorKind::Cancelled, "{call}: {e}"),
        Err(e) => panic!("{call}: {e}"),
    }
    let begun = host.begun.lock().unwrap().take();
    begun.unwrap().elapsed()
}

#[test]
fn no_call_goes_on_when_its_host_wants_it_to_stop() {
    for (values, call) in LONGER {
        let whole = takes(values, call, false);
        let most = whole / 2;
        // Other work on the machine may delay any one of them.
        let least = (0..10)
            .map(|_| takes(values, call, true))
            .find(|took| *took < most);
        assert!(
            least.is_some(),
            "{call} takes {whole:?}, and no less when it is to stop"
        );
    }
}

/// A function of the program that nothing can interrupt, and what it shares with the program.
fn napping(nap: Duration) -> (Language, Arc<AtomicBool>) {
    let awake = Arc::new(AtomicBool::new(false));
    let shared = Arc::clone(&awake);
    let mut language = Language::new();
    language.engine_mut(move |engine| {
        let awake = Arc::clone(&shared);
        engine.register_fn("nap", move || {
            std::thread::sleep(nap);
            awake.store(true, Ordering::Relaxed);
        });
    });
    (language, awake)
}

#[test]
fn a_host_that_wants_to_stop_does_not_wait_for_a_call_to_end() {
    let (language, awake) = napping(Duration::from_secs(3));
    let script = "print(0); nap(); loop { }";
    let script = Script::compile_in(&language, "a.rhai", script, &Limits::default()).unwrap();
    let host = Watching {
        stops: true,
        begun: Mutex::new(None),
        wants_to_stop: AtomicBool::new(false),
    };
    let error = script.run(&host, &RunOptions::default()).unwrap_err();
    let begun = host.begun.lock().unwrap().take().unwrap();
    assert!(begun.elapsed() < Duration::from_secs(2), "{:?}", begun.elapsed());
    assert!(!awake.load(Ordering::Relaxed), "the call was waited for");
    assert_eq!(error.kind(), ErrorKind::Cancelled);
    // With a place where the wish was seen before the call began.
    assert!(
        error.to_string().contains("error: the run was stopped"),
        "{error}"
    );
}

#[test]
fn a_run_that_nobody_stops_leaves_nothing_behind() {
    for script in ["nap();", "nap(); throw 1;", "fn f() { f() } f();"] {
        let (language, shared) = napping(Duration::ZERO);
        let compiled = Script::compile_in(&language, "a.rhai", script, &Limits::default()).unwrap();
        drop(language);
        drop(compiled.run(&Quiet, &RunOptions::default()));
        drop(compiled);
        assert_eq!(Arc::strong_count(&shared), 1, "{script}");
    }
}

/// Wants to stop at the first line that is printed, and would read and keep whatever it is asked to.
#[derive(Default)]
struct Tired {
    is_tired: AtomicBool,
    was_asked: AtomicBool,
}

impl Host for Tired {
    fn read(&self, _path: &str, _max_bytes: u64) -> Result<Vec<u8>, HostError> {
        self.was_asked.store(true, Ordering::Relaxed);
        Ok(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec())
    }

    fn print(&self, _text: &str) {
        self.is_tired.store(true, Ordering::Relaxed);
    }

    fn should_stop(&self) -> bool {
        self.is_tired.load(Ordering::Relaxed)
    }
}

#[test]
fn a_host_that_wants_to_stop_is_asked_for_no_file() {
    for (script, asks) in [
        ("print(0); mesh(\"a.obj\");", false),
        ("mesh(\"a.obj\"); print(0); loop { }", true),
    ] {
        let host = Tired::default();
        let error = run(script, &Limits::default(), &host).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Cancelled, "{script}");
        assert_eq!(host.was_asked.load(Ordering::Relaxed), asks, "{script}");
    }
}

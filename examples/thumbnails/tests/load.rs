//! The service under 200 requests at once, many of them by clients that mean no good: nobody who behaves fails or waits
//! longer than the service's timeout.

mod common;

use std::{
    io::{self, BufRead, BufReader, Read, Write},
    net::{SocketAddr, TcpListener, TcpStream},
    process::{Command, Stdio},
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

use common::{GOOD, HOSTILE, fresh, percentile};
use rtscript::{Image, MemoryHost, meter::Meter, output};
use thumbnails::{Config, http, work::Service};
use tokio::runtime;

#[global_allocator]
static ALLOCATOR: Meter = Meter::new();

/// Starts a service that lives as long as the test.
fn serve(config: Config) -> SocketAddr {
    let (service, _workers) = Service::start(config).unwrap();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    listener.set_nonblocking(true).unwrap();
    let address = listener.local_addr().unwrap();
    thread::spawn(move || {
        let runtime = runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .unwrap();
        runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(listener).unwrap();
            axum::serve(listener, http::router(Arc::clone(&service)))
                .await
                .unwrap();
        });
    });
    address
}

fn config() -> Config {
    let gray = Image::new(2, 2, rtscript::scene::Encoding::Raw, vec![[0.5; 3]; 4]);
    Config {
        assets: MemoryHost::new().with("marble.png", output::encode(&gray, output::Format::Png).unwrap()),
        workers: 2,
        // The test is built without much optimisation, and not alone on its machine.
        slice: Duration::from_millis(500),
        budget: Duration::from_secs(1),
        long_lane: 8,
        body_timeout: Duration::from_secs(2),
        ..Config::default()
    }
}

struct Answer {
    status: u16,
    head: String,
    body: Vec<u8>,
}

impl Answer {
    fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }
}

fn head(length: usize) -> String {
    format!(
        "POST /thumbnail?width=64&height=48 HTTP/1.1\r\nhost: test\r\ncontent-length: {length}\r\nconnection: close\r\n\r\n"
    )
}

fn connect(address: SocketAddr, patience: Duration) -> io::Result<TcpStream> {
    let stream = TcpStream::connect(address)?;
    stream.set_read_timeout(Some(patience))?;
    Ok(stream)
}

fn exchange(mut stream: TcpStream, request: &[u8]) -> io::Result<Answer> {
    stream.write_all(request)?;
    receive(stream)
}

fn receive(mut stream: TcpStream) -> io::Result<Answer> {
    let mut bytes = Vec::new();
    stream.read_to_end(&mut bytes)?;
    let broken = || io::Error::other("no HTTP answer");
    let end = bytes
        .windows(4)
        .position(|w| w == b"\r\n\r\n")
        .ok_or_else(broken)?;
    let head = String::from_utf8_lossy(&bytes[..end]).to_lowercase();
    let status = head
        .split(' ')
        .nth(1)
        .and_then(|code| code.parse().ok())
        .ok_or_else(broken)?;
    Ok(Answer {
        status,
        head,
        body: bytes[end + 4..].to_vec(),
    })
}

fn post(address: SocketAddr, script: &str, patience: Duration) -> io::Result<Answer> {
    let request = head(script.len()) + script;
    exchange(connect(address, patience)?, request.as_bytes())
}

fn get(address: SocketAddr, path: &str) -> Answer {
    let request = format!("GET {path} HTTP/1.1\r\nhost: test\r\nconnection: close\r\n\r\n");
    exchange(
        connect(address, Duration::from_secs(10)).unwrap(),
        request.as_bytes(),
    )
    .unwrap()
}

/// A client that means no good; whether it got an answer.
fn attack(address: SocketAddr, number: usize) -> io::Result<Option<u16>> {
    let patience = Duration::from_secs(60);
    let (_, script) = HOSTILE[number % HOSTILE.len()];
    let script = fresh(script, number);
    match number % 7 {
        // Sends a byte now and then.
        0 => {
            let mut stream = connect(address, patience)?;
            stream.write_all(head(1000).as_bytes())?;
            for _ in 0..15 {
                thread::sleep(Duration::from_millis(100));
                if stream.write_all(b" ").is_err() {
                    return Ok(None);
                }
            }
            receive(stream).map(|answer| Some(answer.status))
        }
        // Asks for something that takes long, and does not wait.
        1 => {
            let mut stream = connect(address, patience)?;
            stream.write_all((head(script.len()) + &*script).as_bytes())?;
            Ok(None)
        }
        // Sends too much, or no script, or no HTTP.
        2 => {
            let answer = match number % 3 {
                0 => post(address, &" ".repeat(300 << 10), patience),
                1 => exchange(
                    connect(address, patience)?,
                    &[head(4).as_bytes(), &[0xff; 4]].concat(),
                ),
                _ => exchange(connect(address, patience)?, b"\x16\x03\x01\x02\x00\r\n\r\n"),
            };
            Ok(answer.ok().map(|answer| answer.status))
        }
        _ => post(address, &script, patience).map(|answer| Some(answer.status)),
    }
}

#[test]
fn who_behaves_is_served_whatever_others_do() {
    const CLIENTS: usize = 200;
    let config = config();
    let patience = config.timeout;
    let address = serve(config);
    let start = Instant::now();
    let clients: Vec<_> = (0..CLIENTS)
        .map(|number| {
            thread::spawn(move || {
                let asked = Instant::now();
                if number % 5 < 2 {
                    return (
                        None,
                        attack(address, number).map(|status| status.unwrap_or(0)),
                        asked.elapsed(),
                    );
                }
                let (name, script) = GOOD[number % GOOD.len()];
                let answer = post(address, &fresh(script, number), patience);
                let status = answer.map(|answer| {
                    assert!(
                        answer.status != 200 || answer.body.starts_with(b"\x89PNG"),
                        "{name}"
                    );
                    answer.status
                });
                (Some(name), status, asked.elapsed())
            })
        })
        .collect();
    let (mut good, mut hostile, mut statuses) = (Vec::new(), Vec::new(), Vec::new());
    for client in clients {
        let (name, status, took) = client.join().unwrap();
        match name {
            Some(name) => {
                assert!(matches!(status, Ok(200)), "{name}: {status:?} after {took:?}");
                good.push(took.as_secs_f64());
            }
            None => {
                hostile.push(took.as_secs_f64());
                statuses.push(status.expect("who attacks is answered, or hung up on by the service"));
            }
        }
    }
    let at =
        |times: &mut Vec<f64>| [0.5, 0.9, 0.99, 1.0].map(|part| percentile(times, part).unwrap_or_default());
    println!(
        "{CLIENTS} clients at once, {:.1} s in all; seconds at 50, 90, 99, 100 %:",
        start.elapsed().as_secs_f64()
    );
    println!("  {} good:    {:.2?}", good.len(), at(&mut good));
    println!("  {} hostile: {:.2?}", hostile.len(), at(&mut hostile));
    statuses.sort_unstable();
    println!("  statuses of the hostile, 0 without one: {statuses:?}");
    assert!(
        [408, 413, 422].iter().all(|status| statuses.contains(status)),
        "{statuses:?}"
    );

    // Nothing is left of it, and the next one is served.
    let drained = || {
        let health = get(address, "/health").text();
        health.contains("\"short\":0") && health.contains("\"long\":0")
    };
    while !drained() {
        assert!(
            start.elapsed() < Duration::from_secs(120),
            "{}",
            get(address, "/health").text()
        );
        thread::sleep(Duration::from_millis(50));
    }
    assert_eq!(post(address, GOOD[0].1, patience).unwrap().status, 200);
}

#[test]
fn errors_say_where() {
    let address = serve(config());
    let answer = post(
        address,
        "sphere(0, 0, 0, 1);\nspere(1);\n",
        Duration::from_secs(30),
    )
    .unwrap();
    assert_eq!(answer.status, 422);
    let body: serde_json::Value = serde_json::from_slice(&answer.body).unwrap();
    assert_eq!(body["error"]["kind"], "unknown-function");
    assert_eq!(
        (&body["error"]["line"], &body["error"]["column"]),
        (&2.into(), &1.into())
    );
    assert_eq!(body["error"]["source"], "spere(1);");
    let missing = post(
        address,
        "diffuse(image(\"/etc/passwd\"));",
        Duration::from_secs(30),
    )
    .unwrap();
    assert!(missing.text().contains("\"denied\""), "{}", missing.text());
}

#[test]
fn equal_requests_have_equal_pictures() {
    let address = serve(config());
    let twice = [0, 1].map(|_| post(address, GOOD[1].1, Duration::from_secs(30)).unwrap());
    assert_eq!((twice[0].status, &twice[0].body), (200, &twice[1].body));
    assert!(
        twice[0].head.contains("content-type: image/png"),
        "{}",
        twice[0].head
    );
    // The second came from the cache.
    assert!(get(address, "/health").text().contains("\"answered\":1"));
}

#[test]
fn who_finds_no_room_may_come_again() {
    let address = serve(Config {
        short_lane: 1,
        long_lane: 0,
        ..config()
    });
    let clients: Vec<_> = (0..20)
        .map(|number| {
            let script = fresh(HOSTILE[10].1, number);
            thread::spawn(move || post(address, &script, Duration::from_secs(30)).unwrap())
        })
        .collect();
    for client in clients {
        let answer = client.join().unwrap();
        assert_eq!(answer.status, 503, "{}", answer.text());
        assert!(answer.head.contains("retry-after: 5"), "{}", answer.head);
    }
}

#[cfg(unix)]
#[test]
fn the_service_ends_when_it_is_asked_to() {
    let mut service = Command::new(env!("CARGO_BIN_EXE_thumbnails"))
        .arg("127.0.0.1:0")
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(service.stdout.as_mut().unwrap())
        .read_line(&mut line)
        .unwrap();
    let address = line.trim().rsplit('/').next().unwrap().parse().unwrap();
    let marble = GOOD.iter().find(|(name, _)| *name == "marble").unwrap().1;
    assert_eq!(
        post(address, marble, Duration::from_secs(30)).unwrap().status,
        200
    );
    // One that is under way is answered still.
    let mirrors = HOSTILE[10].1;
    let waiting = thread::spawn(move || post(address, mirrors, Duration::from_secs(60)).unwrap());
    thread::sleep(Duration::from_millis(300));
    let killed = Command::new("kill")
        .args(["-TERM", &service.id().to_string()])
        .status()
        .unwrap();
    assert!(killed.success());
    assert!([200, 422, 503].contains(&waiting.join().unwrap().status));
    assert!(service.wait().unwrap().success());
    assert!(TcpStream::connect(address).is_err());
}

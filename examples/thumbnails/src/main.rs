//! `cargo run --release -- 127.0.0.1:8080`, then
//! `curl --data-binary @../../scripts/sphereflake.rhai 'http://127.0.0.1:8080/thumbnail?width=320&height=240' > a.png`

use std::{error::Error, sync::Arc};

use rtscript::{MemoryHost, NoHost, RunOptions, Script, meter::Meter, output};
use thumbnails::{Config, http, work::Service};
use tokio::{net::TcpListener, runtime, signal};

/// Counts what each script holds, so that the limit `script_memory` counts.
#[global_allocator]
static ALLOCATOR: Meter = Meter::new();

fn main() -> Result<(), Box<dyn Error>> {
    let address = std::env::args().nth(1);
    let address = address.as_deref().unwrap_or("127.0.0.1:8080");
    let config = Config {
        assets: assets()?,
        ..Config::default()
    };
    let (service, workers) = Service::start(config)?;
    let router = http::router(Arc::clone(&service));
    // It only moves bytes: one thread does.
    let runtime = runtime::Builder::new_current_thread().enable_all().build()?;
    runtime.block_on(async {
        let listener = TcpListener::bind(address).await?;
        println!("listening on http://{}", listener.local_addr()?);
        axum::serve(listener, router)
            .with_graceful_shutdown(asked_to_stop())
            .await
    })?;
    // Whoever was connected has an answer. What is left, nobody waits for.
    service.queue.close();
    for worker in workers {
        worker.join().map_err(|_| "a worker panicked")?;
    }
    Ok(())
}

/// The files that scripts can read: here one texture, made by a script.
fn assets() -> Result<MemoryHost, Box<dyn Error>> {
    let limits = rtscript::Limits::default();
    let script = Script::compile("marble.rhai", include_str!("../scripts/marble.rhai"), &limits)?;
    let run = script.run(&NoHost, &RunOptions::default())?.value;
    let image = rtscript::render(&run.scene, &rtscript::RenderOptions::default(), &NoHost)?
        .value
        .image;
    Ok(MemoryHost::new().with("marble.png", output::encode(&image, output::Format::Png)?))
}

/// Ends with SIGINT or SIGTERM. Nothing more is accepted then, and what was accepted is answered.
async fn asked_to_stop() {
    #[cfg(unix)]
    {
        use signal::unix::{SignalKind, signal};
        if let Ok(mut terminated) = signal(SignalKind::terminate()) {
            tokio::select! {
                _ = terminated.recv() => {}
                _ = signal::ctrl_c() => {}
            }
            return;
        }
    }
    let _ = signal::ctrl_c().await;
}

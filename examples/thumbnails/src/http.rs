//! Requests and answers.

use std::{
    collections::HashMap,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};

use axum::{
    Router,
    body::{Body, Bytes, to_bytes},
    extract::{Query, State},
    http::{HeaderName, StatusCode, header},
    response::{IntoResponse, Response},
    routing::{get, post},
};
use serde_json::{Value, json};
use tokio::{sync::oneshot, time::timeout};

use crate::{
    queue::Lane,
    work::{Failure, Job, Request, Service},
};

/// What the handlers share.
struct Shared {
    service: Arc<Service>,
    cache: Mutex<Cache>,
}

/// The service's two addresses.
pub fn router(service: Arc<Service>) -> Router {
    let shared = Arc::new(Shared {
        service,
        cache: Mutex::default(),
    });
    Router::new()
        .route("/thumbnail", post(thumbnail))
        .route("/health", get(health))
        .with_state(shared)
}

async fn health(State(shared): State<Arc<Shared>>) -> Response {
    let [short, long] = shared.service.queue.waiting();
    let answered = shared.service.answered.load(Ordering::Relaxed);
    json_response(
        StatusCode::OK,
        &json!({ "short": short, "long": long, "answered": answered }),
    )
}

async fn thumbnail(
    State(shared): State<Arc<Shared>>,
    Query(query): Query<HashMap<String, String>>,
    body: Body,
) -> Response {
    let config = &shared.service.config;
    let edge = |name: &str, default: u32| match query.get(name) {
        None => Some(default),
        Some(text) => text
            .parse()
            .ok()
            .filter(|edge| (1..=config.longest_edge).contains(edge)),
    };
    let (Some(width), Some(height)) = (edge("width", 160), edge("height", 120)) else {
        let message = format!(
            "width and height are whole numbers from 1 to {}",
            config.longest_edge
        );
        return refuse(StatusCode::BAD_REQUEST, "request", &message);
    };
    // A client that sends a byte now and then is not waited for.
    let bytes = match timeout(config.body_timeout, to_bytes(body, config.limits.source_bytes)).await {
        Err(_) => {
            return refuse(
                StatusCode::REQUEST_TIMEOUT,
                "request",
                "the script did not arrive in time",
            );
        }
        Ok(Err(_)) => {
            let message = format!("a script has at most {} bytes", config.limits.source_bytes);
            return refuse(StatusCode::PAYLOAD_TOO_LARGE, "limit", &message);
        }
        Ok(Ok(bytes)) => bytes,
    };
    let Ok(script) = String::from_utf8(bytes.into()) else {
        return refuse(StatusCode::BAD_REQUEST, "request", "the script is not UTF-8");
    };
    let request = Request {
        script,
        size: (width, height),
    };
    if let Some(png) = shared.cache().get(&request) {
        return picture(png);
    }
    let (sender, receiver) = oneshot::channel();
    let is_cancelled = Arc::new(AtomicBool::new(false));
    // This future is dropped when the client hangs up, and the guard with it.
    let _guard = CancelOnDrop(Arc::clone(&is_cancelled));
    let job = Job {
        request: request.clone(),
        deadline: Instant::now() + config.timeout,
        is_cancelled,
        answer: sender,
    };
    if shared.service.queue.push(Lane::Short, job).is_err() {
        return busy();
    }
    match receiver.await {
        Ok(Ok(png)) => {
            let png = Bytes::from(png);
            shared.cache().insert(request, png.clone(), config.cache_bytes);
            picture(png)
        }
        Ok(Err(failure)) => explain(failure),
        // A worker dropped the job without an answer.
        Err(_) => busy(),
    }
}

/// Tells the workers that nobody waits any more.
struct CancelOnDrop(Arc<AtomicBool>);

impl Drop for CancelOnDrop {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

fn explain(failure: Failure) -> Response {
    match failure {
        Failure::Busy => busy(),
        Failure::TooSlow => refuse(
            StatusCode::UNPROCESSABLE_ENTITY,
            "limit",
            "the picture takes too long: use fewer samples, or a simpler scene",
        ),
        Failure::Internal(message) => refuse(StatusCode::INTERNAL_SERVER_ERROR, "internal", &message),
        Failure::Script(error) => {
            let diagnostic = &error.diagnostic;
            let body = json!({ "error": {
                "kind": diagnostic.code.name(),
                "message": diagnostic.message,
                "line": diagnostic.line,
                "column": diagnostic.column,
                "source": diagnostic.source_line,
                "hints": diagnostic.hints,
            }});
            json_response(StatusCode::UNPROCESSABLE_ENTITY, &body)
        }
    }
}

/// The client did nothing wrong, and may come again.
fn busy() -> Response {
    let answer = refuse(
        StatusCode::SERVICE_UNAVAILABLE,
        "busy",
        "too many pictures are being made",
    );
    ([(header::RETRY_AFTER, "5")], answer).into_response()
}

fn refuse(status: StatusCode, kind: &str, message: &str) -> Response {
    json_response(status, &json!({ "error": { "kind": kind, "message": message } }))
}

fn json_response(status: StatusCode, body: &Value) -> Response {
    (
        status,
        [(header::CONTENT_TYPE, "application/json")],
        body.to_string(),
    )
        .into_response()
}

fn picture(png: Bytes) -> Response {
    // A script has one picture for ever.
    const FOR_EVER: (HeaderName, &str) = (header::CACHE_CONTROL, "public, max-age=31536000, immutable");
    ([(header::CONTENT_TYPE, "image/png"), FOR_EVER], png).into_response()
}

/// Pictures that were made. The key is the whole request, not a hash of it: two scripts with one hash, which somebody
/// might make on purpose, shall not share a picture.
#[derive(Default)]
struct Cache {
    pictures: HashMap<Request, Bytes>,
    bytes: usize,
}

impl Shared {
    fn cache(&self) -> std::sync::MutexGuard<'_, Cache> {
        self.cache.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Cache {
    fn get(&self, request: &Request) -> Option<Bytes> {
        self.pictures.get(request).cloned()
    }

    /// Forgets everything rather than keep count of what was used last.
    fn insert(&mut self, request: Request, png: Bytes, most_bytes: usize) {
        self.bytes += request.script.len() + png.len();
        if self.bytes > most_bytes {
            self.bytes = request.script.len() + png.len();
            self.pictures.clear();
        }
        self.pictures.insert(request, png);
    }
}

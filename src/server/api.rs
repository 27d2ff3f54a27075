//! The interface behind the page. `docs/api.md` says it in words.

use std::convert::Infallible;
use std::io::Read as _;
use std::sync::Arc;

use axum::body::Body;
use axum::extract::{Path, RawQuery, State};
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use serde_json::{Value, json};
use tokio_stream::StreamExt as _;
use tokio_stream::wrappers::{BroadcastStream, ReceiverStream};

use super::shared::Shared;
use super::{Taken, files};
use crate::daemon::{Asked, Order};
use crate::store::{SO_FAR, round_name};
use enfilade_config::{Partial, Settings};
use enfilade_report::{Error, counted};

type Page = State<Arc<Shared>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Accepted {
    round: Option<u32>,
    so_far: Option<u64>,
    candidate: usize,
}

/// Proves to a browser that has the key that this page has it too, and says by which word this start is signed for.
pub(super) async fn hello(State(page): Page, RawQuery(query): RawQuery) -> Response {
    let query = query.unwrap_or_default();
    match page.access.greet(query.strip_prefix("nonce=").unwrap_or_default()) {
        Some((start, proof)) => answer(&json!({"start": start, "proof": proof})),
        None => refused("expected a nonce of 16 to 64 hexadecimal digits"),
    }
}

pub(super) async fn drawings(State(page): Page) -> Response {
    answer(&page.board.overview())
}

pub(super) async fn drawing(State(page): Page, Path(id): Path<String>) -> Response {
    let Some(mut found) = page.board.drawing(&id) else { return not_found() };
    let home = page.board.paths(&id).and_then(|(_, folder)| folder);
    found["sets"] = json!(home.map_or_else(Vec::new, |h| files::sets(&h)));
    answer(&found)
}

/// Names of the files of a set.
pub(super) async fn set(State(page): Page, Path((id, set)): Path<(String, String)>) -> Response {
    let Some((_, Some(home))) = page.board.paths(&id) else { return not_found() };
    let listed = tokio::task::spawn_blocking(move || files::names(&home, &set)).await;
    match listed {
        Ok(Some(names)) => answer(&json!(names)),
        _ => not_found(),
    }
}

pub(super) async fn file(
    State(page): Page,
    Path((id, set, name)): Path<(String, String, String)>,
) -> Response {
    let Some((_, Some(home))) = page.board.paths(&id) else { return not_found() };
    let wanted = name.clone();
    let found = tokio::task::spawn_blocking(move || files::open(&home, &set, &wanted)).await;
    let (file, length) = match found {
        Ok(files::Found::File(found)) => found,
        Ok(files::Found::TooLarge) => {
            let why = format!("the file has more than {} MB, and was not read", files::FILE_BYTES_MAX >> 20);
            return said(StatusCode::PAYLOAD_TOO_LARGE, &why);
        }
        _ => return not_found(),
    };
    let (kind, is_download) = files::kind(&name);
    let head = [(header::CONTENT_TYPE, kind.to_owned()), (header::CONTENT_LENGTH, length.to_string())];
    let mut response = (head, pieces(file, length)).into_response();
    if kind == files::REPORT {
        // In an origin of its own, without a way to anywhere.
        let policy = "sandbox allow-scripts; default-src 'none'; img-src data:; style-src 'unsafe-inline'; \
                      script-src 'unsafe-inline'; frame-ancestors 'none'; form-action 'none'; base-uri 'none'";
        response.headers_mut().insert(header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(policy));
    }
    if is_download && let Ok(value) = format!("attachment; filename*=UTF-8''{}", percent(&name)).parse() {
        response.headers_mut().insert(header::CONTENT_DISPOSITION, value);
    }
    response
}

/// Bytes of a file that are in memory at once for one who reads it, twice.
const PIECE_BYTES: usize = 256 << 10;

/// A file as it is read: no more of it is in memory than is being sent.
fn pieces(file: std::fs::File, length: u64) -> Body {
    let (send, pieces) = tokio::sync::mpsc::channel(1);
    tokio::task::spawn_blocking(move || {
        let mut rest = file.take(length);
        loop {
            let mut piece = Vec::new();
            let read = rest.by_ref().take(PIECE_BYTES as u64).read_to_end(&mut piece).map(|_| piece);
            let has_failed = read.is_err();
            if read.as_ref().is_ok_and(Vec::is_empty) {
                return;
            }
            // Whoever listened may be gone.
            if send.blocking_send(read).is_err() || has_failed {
                return;
            }
        }
    });
    Body::from_stream(ReceiverStream::new(pieces))
}

pub(super) async fn log(State(page): Page) -> Response {
    answer(&page.board.log())
}

/// News as they come: `data:` lines of JSON; `{"kind": "reload"}` where some were missed.
pub(super) async fn events(State(page): Page) -> Response {
    let Some(news) = page.board.listen() else {
        return said(StatusCode::SERVICE_UNAVAILABLE, "too many pages are open");
    };
    let stream = BroadcastStream::new(news).map(|news| {
        let text = news.unwrap_or_else(|_| json!({"kind": "reload"}).to_string());
        Ok::<Event, Infallible>(Event::default().data(text))
    });
    Sse::new(stream).keep_alive(KeepAlive::default()).into_response()
}

pub(super) async fn cancel(State(page): Page, Path(id): Path<String>) -> Response {
    let Some((drawing, _)) = page.board.paths(&id) else { return not_found() };
    if !page.board.is_busy(&id) {
        let why = "no job of the drawing runs or waits, so there is none to cancel; nothing was done";
        return said(StatusCode::CONFLICT, why);
    }
    order(&page, Order::Cancel(drawing), &json!({}))
}

pub(super) async fn again(State(page): Page, Path(id): Path<String>, body: String) -> Response {
    let Some((drawing, _)) = page.board.paths(&id) else { return not_found() };
    let asked: Asked = match object(&body) {
        Ok(asked) => asked,
        Err(e) => return refused(&e.to_string()),
    };
    let home = page.board.paths(&id).and_then(|(_, folder)| folder);
    if let Some(seen) = asked.so_far
        && let Some(why) = not_so_far(&page, &id, home.as_deref(), &asked, seen)
    {
        return refused(&why);
    }
    if let Some(round) = asked.round
        && !home.as_ref().is_some_and(|home| files::sets(home).contains(&round_name(round)))
    {
        return refused(&format!("there is no round {round}; nothing was done"));
    }
    let set = asked.so_far.map(|_| SO_FAR.to_owned()).or(asked.round.map(round_name));
    let known = home.map_or(0, |home| options_of(&home, set));
    if let Some(n) = asked.pin.iter().chain(&asked.like).find(|n| !(1..=known).contains(*n)) {
        return refused(&format!(
            "the round has {}, found number {n}; nothing was done",
            counted(known as u64, "option")
        ));
    }
    // As many vectors as are pinned: whether so many may be is the settings' matter.
    let pin = (!asked.pin.is_empty()).then(|| vec![Vec::new(); asked.pin.len()]);
    let stated = Partial { objective: asked.objective.clone(), pin, ..Partial::default() };
    let settings = match Settings::new(stated) {
        Ok(settings) => settings,
        Err(e) => return refused(&e.to_string()),
    };
    // With the thresholds that were left out.
    let taken =
        asked.objective.as_ref().map_or(json!({}), |_| json!({"objective": settings.objective_text()}));
    page.board.expect(&id);
    order(&page, Order::Again { drawing, asked }, &taken)
}

/// Why options of the best so far cannot be asked for, if they cannot.
fn not_so_far(
    page: &Shared,
    id: &str,
    home: Option<&std::path::Path>,
    asked: &Asked,
    seen: u64,
) -> Option<String> {
    if asked.round.is_some() {
        return Some("round or so_far is wanted, one of them; nothing was done".into());
    }
    if page.board.is_busy(id) {
        return Some("the search goes on: cancel it, and its best so far stays; nothing was done".into());
    }
    let result = home.and_then(|home| files::read(home, SO_FAR, "result.json"));
    let result: Option<Value> = result.and_then(|bytes| serde_json::from_slice(&bytes).ok());
    match result.and_then(|r| r["evaluations"].as_u64()) {
        None => Some("nothing is kept of a stopped search; nothing was done".into()),
        Some(n) if n != seen => Some(format!(
            "the best so far is another by now, of {}, expected that of {seen}; nothing was done",
            counted(n, "layout")
        )),
        Some(_) => None,
    }
}

pub(super) async fn accept(State(page): Page, Path(id): Path<String>, body: String) -> Response {
    let Some((drawing, home)) = page.board.paths(&id) else { return not_found() };
    let (which, candidate) = match object(&body) {
        Ok(Accepted { round: Some(n), so_far: None, candidate }) => (Taken::Round(n), candidate),
        Ok(Accepted { round: None, so_far: Some(n), candidate }) => (Taken::SoFar(n), candidate),
        Ok(_) => return refused("round or so_far is wanted, one of them; nothing was done"),
        Err(e) => return refused(&e.to_string()),
    };
    let Some(home) = home else { return refused("no round yet; nothing was done") };
    let accepting = page.clone();
    let done =
        tokio::task::spawn_blocking(move || (accepting.accept)(&drawing, &home, which, candidate)).await;
    match done {
        Ok(Ok(path)) => answer(
            &json!({"drawing": path.file_name().map(|n| super::board::shown(std::path::Path::new(n)))}),
        ),
        Ok(Err(e @ (Error::Usage(_) | Error::Input(_)))) => refused(&e.to_string()),
        Ok(Err(e)) => said(StatusCode::INTERNAL_SERVER_ERROR, &e.to_string()),
        Err(_) => said(StatusCode::INTERNAL_SERVER_ERROR, "accepting failed"),
    }
}

/// How many options a set has, by its own word, the newest round where none is named; 0 where there is no such set.
fn options_of(home: &std::path::Path, set: Option<String>) -> usize {
    let newest = || files::sets(home).into_iter().rfind(|s| s.starts_with("round-"));
    let Some(set) = set.or_else(newest) else { return 0 };
    let result = files::read(home, &set, "result.json");
    let result: Option<Value> = result.and_then(|bytes| serde_json::from_slice(&bytes).ok());
    result.map_or(0, |r| r["candidates"].as_array().map_or(0, Vec::len))
}

/// An order's body: an object, where a list of its values would do for the reader of JSON.
fn object<T: serde::de::DeserializeOwned>(body: &str) -> Result<T, serde_json::Error> {
    let object: serde_json::Map<String, Value> = serde_json::from_str(body)?;
    serde_json::from_value(Value::Object(object))
}

/// An address that nothing lies at.
pub(super) async fn unknown_address() -> Response {
    said(StatusCode::NOT_FOUND, "there is nothing at this address")
}

/// A method that an address does not take; the header `Allow` names those it does.
pub(super) async fn unknown_method() -> Response {
    said(StatusCode::METHOD_NOT_ALLOWED, "the address takes another method, see the header Allow")
}

/// Passes an order on; `taken`: what there is to say of it.
fn order(page: &Shared, order: Order, taken: &Value) -> Response {
    match page.orders.send(order) {
        Ok(()) => (StatusCode::ACCEPTED, answer(taken)).into_response(),
        Err(_) => said(StatusCode::SERVICE_UNAVAILABLE, "the daemon is ending"),
    }
}

fn answer(value: &Value) -> Response {
    ([(header::CONTENT_TYPE, "application/json")], value.to_string()).into_response()
}

fn refused(why: &str) -> Response {
    said(StatusCode::BAD_REQUEST, why)
}

fn not_found() -> Response {
    said(StatusCode::NOT_FOUND, "there is no such thing here")
}

/// A refusal that says why.
pub(super) fn said(status: StatusCode, why: &str) -> Response {
    (status, [(header::CONTENT_TYPE, "application/json")], json!({"error": why}).to_string()).into_response()
}

/// A file name for a header (RFC 5987).
fn percent(name: &str) -> String {
    let one = |b: u8| {
        if b.is_ascii_alphanumeric() || b"-._".contains(&b) {
            char::from(b).to_string()
        } else {
            format!("%{b:02X}")
        }
    };
    name.bytes().map(one).collect()
}

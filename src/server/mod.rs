//! The local page and its interface: what the daemon does, options side by side, a few orders.
//!
//! Loopback only, and even there nobody is trusted: see `guard`. Requests name drawings by ids and files by
//! the names that lie in a round; no path ever comes from outside. All assets are in the program.

mod api;
mod board;
mod connections;
mod files;
mod guard;

use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::{Arc, mpsc};
use std::thread;
use std::time::Duration;

use axum::Router;
use axum::extract::{DefaultBodyLimit, State};
use axum::http::{StatusCode, header};
use axum::middleware;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use serde::{Deserialize, Serialize};

pub use board::Board;
pub use connections::{BODY_TIME_MAX, CONNECTIONS_MAX, HEAD_BYTES_MAX, HEAD_TIME_MAX};
pub use guard::Access;

use crate::daemon::{Notice, Order};
use crate::report::{Error, Place};
use crate::store::{Disk as _, SystemDisk, write_secret};

/// Bytes of a token before they are written in hexadecimal.
const TOKEN_BYTES: usize = 32;
/// Largest request body, bytes: orders are short.
pub const BODY_BYTES_MAX: usize = 16 << 10;

/// How long a page may take to say that it is there.
const PROBE_TIME: Duration = Duration::from_secs(1);
/// Names of the files that say where pages are: this, a digest of the folder, and the ending.
const DOOR_NAME: (&str, &str) = ("page-", ".json");

/// What an option is accepted of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// A finished round.
    Round(u32),
    /// The best so far, after so many evaluations.
    SoFar(u64),
}

/// Makes an accepted option a new drawing: drawing, result folder, of what, candidate from 1 → the new drawing.
pub type Accept = dyn Fn(&Path, &Path, Taken, usize) -> Result<PathBuf, Error> + Send + Sync;

/// A running page; it ends with the process.
pub struct Page {
    shared: Arc<Shared>,
    address: SocketAddr,
}

/// What the threads of daemon and page share.
struct Shared {
    board: Board,
    access: Access,
    orders: mpsc::Sender<Order>,
    accept: Box<Accept>,
}

/// Where a running page is found: kept in a file that only the user can read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Door {
    /// `http://127.0.0.1:PORT/`.
    pub address: String,
    /// What its interface asks for: `Authorization: Bearer TOKEN`.
    pub token: String,
    /// Process of the daemon.
    pub pid: u32,
}

impl Page {
    /// Opens the page on `port` of this machine alone; 0: any free one.
    ///
    /// # Errors
    /// [`Error::Environment`] where the port is taken or the system gives no random numbers.
    pub fn open(port: u16, orders: mpsc::Sender<Order>, accept: Box<Accept>) -> Result<Self, Error> {
        let fail =
            |what: &str, e: String| Error::environment("page", Place::default(), format!("{what}: {e}"));
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(|e| {
            fail(&format!("port {port} of this machine, choose another with --page"), e.to_string())
        })?;
        let address = listener.local_addr().map_err(|e| fail("port", e.to_string()))?;
        listener.set_nonblocking(true).map_err(|e| fail("port", e.to_string()))?;
        let access = Access::new(address.port(), secret()?, secret()?);
        let shared = Arc::new(Shared { board: Board::default(), access, orders, accept });
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .map_err(|e| fail("starting", e.to_string()))?;
        let app = router(shared.clone());
        thread::Builder::new()
            .name("page".into())
            .spawn(move || {
                runtime.block_on(async move {
                    if let Ok(listener) = tokio::net::TcpListener::from_std(listener) {
                        connections::serve(listener, app).await;
                    }
                });
            })
            .map_err(|e| fail("starting", e.to_string()))?;
        Ok(Self { shared, address })
    }

    /// Shows a notice of the daemon on the page.
    pub fn take(&self, notice: &Notice) {
        self.shared.board.take(notice);
    }

    /// Address with the token, to be opened once.
    pub fn link(&self) -> String {
        self.door().link()
    }

    /// How others find the page.
    pub fn door(&self) -> Door {
        Door {
            address: format!("http://{}/", self.address),
            token: self.shared.access.token().into(),
            pid: std::process::id(),
        }
    }
}

impl Door {
    /// Address with the token, to be opened once.
    pub fn link(&self) -> String {
        format!("{}?token={}", self.address, self.token)
    }

    /// Leaves word where the page of this watched folder is.
    ///
    /// # Errors
    /// From the disk.
    pub fn write(&self, root: &Path) -> Result<(), Error> {
        let text = serde_json::to_string(self)
            .map_err(|e| Error::environment("page", Place::default(), e.to_string()))?;
        write_secret(&door_file(root)?, text.as_bytes())
    }

    /// The page of a watched folder, if its daemon still answers.
    pub fn find(root: &Path) -> Option<Self> {
        Self::read(&door_file(root).ok()?).filter(|door| door.life() == Life::Lives)
    }

    /// Removes the word of pages whose daemons have ended.
    pub fn sweep() {
        let state = crate::service::Folders::of_user().ok().map(|own| own.state);
        let entries = state.and_then(|folder| std::fs::read_dir(folder).ok());
        for entry in entries.into_iter().flatten().flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            let is_one = name.starts_with(DOOR_NAME.0) && name.ends_with(DOOR_NAME.1);
            if is_one && Self::read(&entry.path()).is_some_and(|door| door.life() == Life::Ended) {
                // One that stays is passed over by whoever reads it.
                let _ = SystemDisk.remove_file(&entry.path());
            }
        }
    }

    fn read(file: &Path) -> Option<Self> {
        serde_json::from_slice(&std::fs::read(file).ok()?).ok()
    }

    /// Asks who listens there: by now it may be somebody else, to whom this token means nothing.
    fn life(&self) -> Life {
        let address = self.address.strip_prefix("http://").and_then(|a| a.strip_suffix('/')?.parse().ok());
        let Some(address) = address.filter(|a: &SocketAddr| a.ip().is_loopback()) else { return Life::Ended };
        let mut stream = match TcpStream::connect_timeout(&address, PROBE_TIME) {
            Ok(stream) => stream,
            Err(e) if e.kind() == ErrorKind::ConnectionRefused => return Life::Ended,
            Err(_) => return Life::Unknown,
        };
        let ask = format!(
            "GET /page.css HTTP/1.1\r\nHost: {address}\r\nAuthorization: Bearer {}\r\nConnection: close\r\n\r\n",
            self.token
        );
        let mut answer = [0; ALIVE.len()];
        let asked = stream
            .set_read_timeout(Some(PROBE_TIME))
            .and_then(|()| stream.set_write_timeout(Some(PROBE_TIME)))
            .and_then(|()| stream.write_all(ask.as_bytes()))
            .and_then(|()| stream.read_exact(&mut answer));
        match asked {
            Ok(()) if &answer == ALIVE => Life::Lives,
            Ok(()) => Life::Ended,
            Err(_) => Life::Unknown,
        }
    }
}

/// How a page answers its own token.
const ALIVE: &[u8; 12] = b"HTTP/1.1 200";

/// Whether the daemon of a page still runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Life {
    Lives,
    /// Nobody listens there, or somebody else.
    Ended,
    /// Somebody listens and says nothing.
    Unknown,
}

/// In the user's own state folder: watched folders may be shared with others.
fn door_file(root: &Path) -> Result<PathBuf, Error> {
    let root = std::fs::canonicalize(root).unwrap_or_else(|_| root.into());
    let digest = crate::watch::sha256_hex(root.as_os_str().as_encoded_bytes());
    Ok(crate::service::Folders::of_user()?.state.join(format!(
        "{}{}{}",
        DOOR_NAME.0,
        &digest[..16],
        DOOR_NAME.1
    )))
}

/// A new secret, hexadecimal.
fn secret() -> Result<String, Error> {
    let mut bytes = [0u8; TOKEN_BYTES];
    getrandom::fill(&mut bytes)
        .map_err(|e| Error::environment("page", Place::default(), format!("no random numbers: {e}")))?;
    Ok(bytes.iter().map(|b| format!("{b:02x}")).collect())
}

fn router(shared: Arc<Shared>) -> Router {
    Router::new()
        .route("/", get(index))
        .route("/page.css", get(|| asset("text/css; charset=utf-8", include_str!("page/page.css"))))
        .route("/page.js", get(|| asset("text/javascript; charset=utf-8", include_str!("page/page.js"))))
        .route(
            "/options.js",
            get(|| asset("text/javascript; charset=utf-8", include_str!("page/options.js"))),
        )
        .route("/plots.js", get(|| asset("text/javascript; charset=utf-8", include_str!("page/plots.js"))))
        .route("/api/drawings", get(api::drawings))
        .route("/api/drawings/{id}", get(api::drawing))
        .route("/api/drawings/{id}/{set}", get(api::set))
        .route("/api/drawings/{id}/{set}/{name}", get(api::file))
        .route("/api/drawings/{id}/cancel", post(api::cancel))
        .route("/api/drawings/{id}/again", post(api::again))
        .route("/api/drawings/{id}/accept", post(api::accept))
        .route("/api/log", get(api::log))
        .route("/api/events", get(api::events))
        .fallback(api::unknown_address)
        .method_not_allowed_fallback(api::unknown_method)
        .layer(DefaultBodyLimit::max(BODY_BYTES_MAX))
        .layer(middleware::from_fn_with_state(shared.clone(), guard::check))
        .with_state(shared)
}

async fn index(State(_): State<Arc<Shared>>) -> Response {
    asset("text/html; charset=utf-8", include_str!("page/index.html")).await
}

/// For a browser without the token, as after another start of the daemon: it holds nothing of the daemon's.
async fn locked() -> Response {
    let page = asset("text/html; charset=utf-8", include_str!("page/locked.html")).await;
    (StatusCode::FORBIDDEN, page).into_response()
}

async fn asset(kind: &'static str, text: &'static str) -> Response {
    (StatusCode::OK, [(header::CONTENT_TYPE, kind)], text).into_response()
}

//! The local page and its interface: what the daemon does, options side by side, a few orders.
//!
//! Loopback only, and even there nobody is trusted: see `guard` and `login`. Requests name drawings by ids and files by
//! the names that lie in a round; no path ever comes from outside. All assets are in the program.

mod api;
mod board;
mod connections;
mod files;
mod guard;
mod login;

use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::{Arc, mpsc};
use std::thread;
use std::time::Duration;

use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::http::{StatusCode, header};
use axum::middleware;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use serde::{Deserialize, Serialize};

pub use board::Board;
pub use connections::{BODY_TIME_MAX, CONNECTIONS_MAX, HEAD_BYTES_MAX, HEAD_TIME_MAX};
pub use guard::Access;
pub use login::Login;

use crate::daemon::{Notice, Order};
use crate::store::{Disk as _, SystemDisk, read_own, write_secret};
use enfilade_report::{Error, Place};
use guard::HELLO;

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
    login: Login,
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
    /// What its interface asks programs for: `Authorization: Bearer TOKEN`.
    pub token: String,
    /// What browsers sign with.
    pub key: String,
    /// Process of the daemon.
    pub pid: u32,
}

impl Page {
    /// Opens the page on `port` of this machine alone; 0: the one remembered in `login`, else any free one. A
    /// remembered port that somebody has taken meanwhile is given up with its key.
    ///
    /// # Errors
    /// [`Error::Environment`] where the port is taken or the system gives no random numbers.
    pub fn open(
        port: u16,
        login: Option<Login>,
        orders: mpsc::Sender<Order>,
        accept: Box<Accept>,
    ) -> Result<Self, Error> {
        let fail =
            |what: &str, e: String| Error::environment("page", Place::default(), format!("{what}: {e}"));
        let remembered = login.as_ref().filter(|_| port == 0).and_then(|login| bind(login.port).ok());
        let listeners = remembered.map_or_else(|| bind(port), Ok).map_err(|e| {
            fail(&format!("port {port} of this machine, choose another with --page"), e.to_string())
        })?;
        let address = listeners[0].local_addr().map_err(|e| fail("port", e.to_string()))?;
        for listener in &listeners {
            listener.set_nonblocking(true).map_err(|e| fail("port", e.to_string()))?;
        }
        let login = login.filter(|login| login.port == address.port());
        let login = login.map_or_else(|| Login::new(address.port()), Ok)?;
        let access = Access::new(address.port(), secret()?, login.key.clone(), secret()?);
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
                    let listeners = listeners.into_iter().map(tokio::net::TcpListener::from_std);
                    if let Ok(listeners) = listeners.collect::<Result<Vec<_>, _>>() {
                        connections::serve(&listeners, app).await;
                    }
                });
            })
            .map_err(|e| fail("starting", e.to_string()))?;
        Ok(Self { shared, address, login })
    }

    /// Shows a notice of the daemon on the page.
    pub fn take(&self, notice: &Notice) {
        self.shared.board.take(notice);
    }

    /// As [`Door::link`].
    ///
    /// # Errors
    /// As there.
    pub fn link(&self) -> Result<String, Error> {
        self.door().link()
    }

    /// Port and key, to be remembered.
    pub fn login(&self) -> &Login {
        &self.login
    }

    /// How others find the page.
    pub fn door(&self) -> Door {
        Door {
            address: format!("http://{}/", self.address),
            token: self.shared.access.token().into(),
            key: self.shared.access.key().into(),
            pid: std::process::id(),
        }
    }
}

impl Door {
    /// An address with the key, to be opened once in a browser; what follows the `#` is not sent. Its name is another each
    /// time: whoever had the port while the daemon was down may have left a worker or a copy of a page of theirs under the
    /// names before, and the browser would give them the key.
    ///
    /// # Errors
    /// [`Error::Environment`] where the system gives no random numbers.
    pub fn link(&self) -> Result<String, Error> {
        let name = new_name()?;
        Ok(format!("{}#key={}", self.address.replace("127.0.0.1", &name), self.key))
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

    /// Writes a file of the user's alone that leads a browser to the page, and says where it is: what stands on a
    /// command line all users of the machine can read.
    ///
    /// # Errors
    /// From the disk.
    pub fn write_opener(&self) -> Result<PathBuf, Error> {
        let file = crate::service::Folders::of_user()?.state.join("open.html");
        let text = format!(
            "<!doctype html><meta charset=\"utf-8\"><title>Enfilade</title>\
             <meta http-equiv=\"refresh\" content=\"0; url={0}\"><a href=\"{0}\">Enfilade</a>\n",
            self.link()?
        );
        write_secret(&file, text.as_bytes())?;
        Ok(file)
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
        serde_json::from_slice(&read_own(file).ok()?).ok()
    }

    /// Asks who listens there: by now it may be somebody else, who has not the key and learns nothing of it.
    fn life(&self) -> Life {
        let address = self.address.strip_prefix("http://").and_then(|a| a.strip_suffix('/')?.parse().ok());
        let Some(address) = address.filter(|a: &SocketAddr| a.ip().is_loopback()) else { return Life::Ended };
        let mut stream = match TcpStream::connect_timeout(&address, PROBE_TIME) {
            Ok(stream) => stream,
            Err(e) if e.kind() == ErrorKind::ConnectionRefused => return Life::Ended,
            Err(_) => return Life::Unknown,
        };
        let Ok(nonce) = secret() else { return Life::Unknown };
        let ask =
            format!("GET {HELLO}?nonce={nonce} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n");
        let mut answer = String::new();
        let asked = stream
            .set_read_timeout(Some(PROBE_TIME))
            .and_then(|()| stream.set_write_timeout(Some(PROBE_TIME)))
            .and_then(|()| stream.write_all(ask.as_bytes()))
            .and_then(|()| stream.take(ANSWER_BYTES_MAX).read_to_string(&mut answer));
        match asked {
            Ok(_) if is_proved(&answer, &self.key, &nonce) => Life::Lives,
            Ok(_) => Life::Ended,
            Err(_) => Life::Unknown,
        }
    }
}

/// Most bytes of an answer to a greeting.
const ANSWER_BYTES_MAX: u64 = 4096;

/// Whether whoever gave the answer has the key.
fn is_proved(answer: &str, key: &str, nonce: &str) -> bool {
    let body = answer.split_once("\r\n\r\n").map_or("", |(_, body)| body);
    let said: serde_json::Value = serde_json::from_str(body).unwrap_or_default();
    let start = said["start"].as_str().unwrap_or_default();
    said["proof"].as_str().is_some_and(|p| p == login::proof(key, start, nonce))
}

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
    own_file(root, DOOR_NAME)
}

/// A file of the user's own about a watched folder, by what its name begins and ends with.
fn own_file(root: &Path, (begin, end): (&str, &str)) -> Result<PathBuf, Error> {
    let root = std::fs::canonicalize(root).unwrap_or_else(|_| root.into());
    let digest = crate::watch::sha256_hex(root.as_os_str().as_encoded_bytes());
    Ok(crate::service::Folders::of_user()?.state.join(format!("{begin}{}{end}", &digest[..16])))
}

/// Hexadecimal digits of the name of an address.
const NAME_DIGITS: usize = 16;

/// A name that browsers lead to this machine (RFC 6761, 6.3), and that none of them has heard before.
#[cfg(not(target_os = "macos"))]
fn new_name() -> Result<String, Error> {
    Ok(format!("{}.localhost", &secret()?[..NAME_DIGITS]))
}

/// Safari asks the system for such names, and the system does not know them.
#[cfg(target_os = "macos")]
fn new_name() -> Result<String, Error> {
    Ok("127.0.0.1".into())
}

/// Takes a port of this machine, 0: any, on both of its addresses: a browser asks that of IPv6 first. Where there is no
/// IPv6, nobody else has its address either.
fn bind(port: u16) -> std::io::Result<Vec<TcpListener>> {
    let mut tries = if port == 0 { FREE_TRIES } else { 1 };
    loop {
        tries -= 1;
        let first = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        match TcpListener::bind((Ipv6Addr::LOCALHOST, first.local_addr()?.port())) {
            Ok(second) => return Ok(vec![first, second]),
            Err(e) if matches!(e.kind(), ErrorKind::AddrInUse | ErrorKind::PermissionDenied) => {
                if tries == 0 {
                    return Err(e);
                }
            }
            Err(_) => return Ok(vec![first]),
        }
    }
}

/// Free ports that are tried: of some the other address is taken.
const FREE_TRIES: usize = 16;

/// A new secret, hexadecimal.
fn secret() -> Result<String, Error> {
    let mut bytes = [0u8; TOKEN_BYTES];
    getrandom::fill(&mut bytes)
        .map_err(|e| Error::environment("page", Place::default(), format!("no random numbers: {e}")))?;
    Ok(bytes.iter().map(|b| format!("{b:02x}")).collect())
}

fn router(shared: Arc<Shared>) -> Router {
    let with_asset = |router: Router<Arc<Shared>>, (path, kind, text): (&'static str, _, _)| {
        router.route(path, get(move || asset(kind, text)))
    };
    ASSETS
        .into_iter()
        .fold(Router::new(), with_asset)
        .route(HELLO, get(api::hello))
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

/// What everybody on this machine may read: it holds nothing of the daemon's. Address, media type and text.
const ASSETS: [(&str, &str, &str); 7] = [
    ("/", HTML, include_str!("page/index.html")),
    ("/page.css", "text/css; charset=utf-8", include_str!("page/page.css")),
    ("/page.js", SCRIPT, include_str!("page/page.js")),
    ("/login.js", SCRIPT, include_str!("page/login.js")),
    ("/news.js", SCRIPT, include_str!("page/news.js")),
    ("/options.js", SCRIPT, include_str!("page/options.js")),
    ("/plots.js", SCRIPT, include_str!("page/plots.js")),
];
const HTML: &str = "text/html; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

async fn asset(kind: &'static str, text: &'static str) -> Response {
    (StatusCode::OK, [(header::CONTENT_TYPE, kind)], text).into_response()
}

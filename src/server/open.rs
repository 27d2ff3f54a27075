//! The page itself: a server on this machine alone.

use std::io::ErrorKind;
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener};
use std::sync::{Arc, mpsc};
use std::thread;

use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::http::{StatusCode, header};
use axum::middleware;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};

use super::assets::ASSETS;
use super::guard::{self, Access};
use super::shared::Shared;
use super::{Accept, BODY_BYTES_MAX, Board, Door, HELLO, Login, api, connections, secret};
use crate::daemon::{Notice, Order};
use enfilade_report::{Error, Place};

/// A running page; it ends with the process.
pub struct Page {
    shared: Arc<Shared>,
    address: SocketAddr,
    login: Login,
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
        let access = Arc::new(Access::new(address.port(), secret()?, login.key.clone(), secret()?));
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
        .layer(middleware::from_fn_with_state(shared.access.clone(), guard::check))
        .with_state(shared)
}

async fn asset(kind: &'static str, text: &'static str) -> Response {
    (StatusCode::OK, [(header::CONTENT_TYPE, kind)], text).into_response()
}

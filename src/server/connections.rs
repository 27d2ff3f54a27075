//! Connections to the page: so many at once and no longer than it takes, since anybody on this machine may open them.

use std::future::poll_fn;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::Poll;
use std::time::Duration;

use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::task::AbortHandle;

/// Longest time that the head of a request may take, and that a connection may wait for its next request.
pub const HEAD_TIME_MAX: Duration = Duration::from_secs(10);
/// Longest time that the body of a request may take once its head is there.
pub const BODY_TIME_MAX: Duration = Duration::from_secs(10);
/// Largest head of a request, bytes.
pub const HEAD_BYTES_MAX: usize = 64 << 10;
/// Open connections, however many files the system allows.
pub const CONNECTIONS_MAX: usize = 256;
/// So many of the files that this process may have open can be connections: the rest is for watching and jobs.
const SHARE_OF_FILES: u64 = 2;
/// Pause after the system gave no connection.
const ACCEPT_PAUSE: Duration = Duration::from_millis(200);

/// Whether a connection has sent a request with the token.
#[derive(Clone, Debug, Default)]
pub(super) struct Known(Arc<AtomicBool>);

impl Known {
    pub(super) fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// How many connections may be open where the system allows so many files.
fn connections_max(files: Option<u64>) -> usize {
    let share = files.map_or(usize::MAX, |n| usize::try_from(n / SHARE_OF_FILES).unwrap_or(usize::MAX));
    share.clamp(1, CONNECTIONS_MAX)
}

/// How many files this process may have open; `None`: no limit known.
#[cfg(unix)]
fn files_allowed() -> Option<u64> {
    rustix::process::getrlimit(rustix::process::Resource::Nofile).current
}

#[cfg(not(unix))]
fn files_allowed() -> Option<u64> {
    None
}

/// One that is open.
struct Open {
    known: Known,
    task: AbortHandle,
}

/// Which of them is closed for a new one, oldest first: the first that never showed the token, where there is one.
fn first_to_go(is_known: impl Iterator<Item = bool>) -> Option<usize> {
    is_known.into_iter().position(|known| !known)
}

/// The next connection of any of them.
async fn next(listeners: &[TcpListener]) -> std::io::Result<TcpStream> {
    let accepted = poll_fn(|cx| {
        let first = listeners.iter().map(|l| l.poll_accept(cx)).find(Poll::is_ready);
        first.unwrap_or(Poll::Pending)
    });
    accepted.await.map(|(stream, _)| stream)
}

/// Serves until the process ends.
pub(super) async fn serve(listeners: &[TcpListener], app: Router) {
    let most = connections_max(files_allowed());
    let mut open: Vec<Open> = Vec::new();
    loop {
        let accepted = next(listeners).await;
        open.retain(|c| !c.task.is_finished());
        if accepted.is_err() || open.len() >= most {
            match first_to_go(open.iter().map(|c| c.known.is_set())) {
                Some(i) => open.remove(i).task.abort(),
                // All are of those who may: the new one has to come again.
                None if accepted.is_ok() => continue,
                None => {}
            }
        }
        match accepted {
            Ok(stream) => {
                let known = Known::default();
                let task = tokio::spawn(answer(stream, app.clone(), known.clone())).abort_handle();
                open.push(Open { known, task });
            }
            Err(_) => tokio::time::sleep(ACCEPT_PAUSE).await,
        }
    }
}

async fn answer(stream: TcpStream, app: Router, known: Known) {
    let service = TowerToHyperService::new(app.layer(Extension(known)));
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD_TIME_MAX)
        .max_buf_size(HEAD_BYTES_MAX)
        .serve_connection(TokioIo::new(stream), service);
    // A connection that breaks is the other side's matter.
    let _ = connection.await;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::server::board::LISTENERS_MAX;

    #[test]
    fn connections_leave_files_for_watching() {
        assert_eq!(connections_max(None), CONNECTIONS_MAX);
        assert_eq!(connections_max(Some(1 << 20)), CONNECTIONS_MAX);
        assert_eq!(connections_max(Some(128)), 64);
        assert_eq!(connections_max(Some(0)), 1);
        assert!(connections_max(Some(128)) > LISTENERS_MAX, "open pages leave room for orders");
    }

    #[test]
    fn the_oldest_without_the_token_goes_first() {
        assert_eq!(first_to_go([true, false, false].into_iter()), Some(1));
        assert_eq!(first_to_go([true, true].into_iter()), None);
    }
}

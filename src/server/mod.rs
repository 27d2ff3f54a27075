//! The local page and its interface: what the daemon does, options side by side, a few orders.
//!
//! Loopback only, and even there nobody is trusted: see `guard` and `login`. Requests name drawings by ids and files by
//! the names that lie in a round; no path ever comes from outside. All assets are in the program.

#[cfg(feature = "page")]
mod api;
#[cfg(feature = "page")]
mod assets;
#[cfg(feature = "page")]
mod board;
#[cfg(not(feature = "page"))]
mod closed;
#[cfg(feature = "page")]
mod connections;
mod door;
#[cfg(feature = "page")]
mod files;
#[cfg(feature = "page")]
mod guard;
#[cfg_attr(not(feature = "page"), allow(dead_code, reason = "only a page asks who knocks"))]
mod login;
#[cfg(feature = "page")]
mod open;
#[cfg(feature = "page")]
mod shared;

use std::path::{Path, PathBuf};

#[cfg(feature = "page")]
pub use board::Board;
#[cfg(not(feature = "page"))]
pub use closed::Page;
#[cfg(feature = "page")]
pub use connections::{BODY_TIME_MAX, CONNECTIONS_MAX, HEAD_BYTES_MAX, HEAD_TIME_MAX};
pub use door::Door;
#[cfg(feature = "page")]
pub use guard::Access;
pub use login::Login;
#[cfg(feature = "page")]
pub use open::Page;

use enfilade_report::{Error, Place};

/// Bytes of a token before they are written in hexadecimal.
const TOKEN_BYTES: usize = 32;
/// Largest request body, bytes: orders are short.
pub const BODY_BYTES_MAX: usize = 16 << 10;
/// Where the page proves that it has the key.
const HELLO: &str = "/api/hello";

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

/// A file of the user's own about a watched folder, by what its name begins and ends with.
fn own_file(root: &Path, (begin, end): (&str, &str)) -> Result<PathBuf, Error> {
    let root = std::fs::canonicalize(root).unwrap_or_else(|_| root.into());
    let digest = crate::watch::sha256_hex(root.as_os_str().as_encoded_bytes());
    Ok(crate::service::Folders::of_user()?.state.join(format!("{begin}{}{end}", &digest[..16])))
}

/// A new secret, hexadecimal.
fn secret() -> Result<String, Error> {
    let mut bytes = [0u8; TOKEN_BYTES];
    getrandom::fill(&mut bytes)
        .map_err(|e| Error::environment("page", Place::default(), format!("no random numbers: {e}")))?;
    Ok(bytes.iter().map(|b| format!("{b:02x}")).collect())
}

//! Where a running page is found, and whether it still is.

use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::{HELLO, login, own_file, secret};
use crate::store::{Disk as _, SystemDisk, read_own, write_secret};
use enfilade_report::{Error, Place};

/// How long a page may take to say that it is there.
const PROBE_TIME: Duration = Duration::from_secs(1);
/// Names of the files that say where pages are: this, a digest of the folder, and the ending.
const DOOR_NAME: (&str, &str) = ("page-", ".json");

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

/// Hexadecimal digits of the name of an address.
pub(super) const NAME_DIGITS: usize = 16;

/// A name that browsers lead to this machine (RFC 6761, 6.3), and that none of them has heard before.
#[cfg(not(target_os = "macos"))]
pub(super) fn new_name() -> Result<String, Error> {
    Ok(format!("{}.localhost", &secret()?[..NAME_DIGITS]))
}

/// Safari asks the system for such names, and the system does not know them.
#[cfg(target_os = "macos")]
pub(super) fn new_name() -> Result<String, Error> {
    Ok("127.0.0.1".into())
}

//! How a browser and the page know each other: by a key that neither ever sends.
//!
//! The key comes to the browser once, behind the `#` of the link, which browsers do not send. From then on the browser
//! signs each request with it, and the page signs its answer to a greeting, so that a program that has taken the port
//! learns nothing that it could use. Key and port are remembered for each watched folder, in the user's own state
//! folder: the address stays, and so does the login, over restarts.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::secret;
use crate::store::{read_own, write_secret};
use enfilade_report::{Error, Place};

/// Bytes of a block of SHA-256.
const BLOCK: usize = 64;
/// Most letters of a nonce.
const NONCE_MAX: usize = 64;

/// The port and the key of a folder's page.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Login {
    /// The port that the key belongs to: on another one it means nothing.
    pub port: u16,
    /// Hexadecimal.
    pub key: String,
}

impl Login {
    /// A new key for this port.
    pub(super) fn new(port: u16) -> Result<Self, Error> {
        Ok(Self { port, key: secret()? })
    }

    /// What is remembered of the page of a watched folder.
    pub fn of(root: &Path) -> Option<Self> {
        serde_json::from_slice(&read_own(&login_file(root).ok()?).ok()?).ok()
    }

    /// Remembers it.
    ///
    /// # Errors
    /// From the disk.
    pub fn write(&self, root: &Path) -> Result<(), Error> {
        let text = serde_json::to_string(self)
            .map_err(|e| Error::environment("page", Place::default(), e.to_string()))?;
        write_secret(&login_file(root)?, text.as_bytes())
    }
}

fn login_file(root: &Path) -> Result<PathBuf, Error> {
    super::own_file(root, ("login-", ".json"))
}

/// HMAC-SHA-256 (RFC 2104), hexadecimal.
pub(super) fn mac(key: &str, text: &str) -> String {
    let mut block = [0u8; BLOCK];
    if key.len() > BLOCK {
        block[..32].copy_from_slice(&Sha256::digest(key));
    } else {
        block[..key.len()].copy_from_slice(key.as_bytes());
    }
    let with = |pad: u8| block.map(|b| b ^ pad);
    let inner = Sha256::new_with_prefix(with(0x36)).chain_update(text).finalize();
    let outer = Sha256::new_with_prefix(with(0x5c)).chain_update(inner).finalize();
    outer.iter().map(|b| format!("{b:02x}")).collect()
}

/// Whether a text can be a nonce.
pub(super) fn is_nonce(text: &str) -> bool {
    (16..=NONCE_MAX).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_hexdigit())
}

/// What the page answers to a greeting: that it has the key, and by which word its start is known.
pub(super) fn proof(key: &str, start: &str, nonce: &str) -> String {
    mac(key, &format!("page\n{start}\n{nonce}"))
}

/// What a request is signed with.
pub(super) fn signature(key: &str, start: &str, method: &str, nonce: &str, address: &str) -> String {
    mac(key, &format!("{method}\n{start}\n{nonce}\n{address}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// RFC 4231, test cases 2 and 6, the second with a key of letters.
    #[test]
    fn macs_are_those_of_the_standard() {
        let found = mac("Jefe", "what do ya want for nothing?");
        assert_eq!(found, "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
        assert_ne!(mac(&"k".repeat(65), ""), mac(&"k".repeat(64), ""));
    }

    #[test]
    fn nonces_are_short_numbers() {
        assert!(is_nonce(&"a0".repeat(16)));
        for text in ["", "abc", "a0a0a0a0a0a0a0a0\n", &"0".repeat(65), "page\n0123456789abcdef"] {
            assert!(!is_nonce(text), "{text:?}");
        }
    }
}

//! A daemon with its page, and requests to it as programs and browsers make them.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

const PATIENCE: Duration = Duration::from_secs(900);

pub struct Daemon {
    pub child: Child,
    pub folder: tempfile::TempDir,
    pub port: u16,
    /// For programs.
    pub token: String,
    /// What browsers sign with.
    pub key: String,
}

impl Drop for Daemon {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

pub fn start() -> Daemon {
    start_with("gallery.dxf", "")
}

/// A folder with one drawing, the folder's settings and its own home, watched.
pub fn start_with(drawing: &str, settings: &str) -> Daemon {
    start_searching(drawing, settings, 60)
}

/// The same with searches of so many layouts.
pub fn start_searching(drawing: &str, settings: &str, evaluations: u32) -> Daemon {
    let folder = tempfile::tempdir().unwrap();
    let plans = folder.path().join("plans");
    let sample = enfilade_fixtures::repository("samples/gallery.dxf");
    fs::create_dir_all(plans.join(drawing).parent().unwrap()).unwrap();
    fs::copy(sample, plans.join(drawing)).unwrap();
    fs::write(plans.join("enfilade.toml"), settings).unwrap();
    let (child, port, token, key) = spawn_searching(folder.path(), evaluations);
    Daemon { child, folder, port, token, key }
}

impl Daemon {
    /// Killed, and started anew on the same folder, with searches of so many layouts.
    pub fn restart(&mut self, evaluations: u32) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
        (self.child, self.port, self.token, self.key) = spawn_searching(self.folder.path(), evaluations);
    }
}

/// A daemon on `plans` in this home: its process, port, token and key.
pub fn spawn(home: &Path) -> (Child, u16, String, String) {
    spawn_searching(home, 60)
}

fn spawn_searching(home: &Path, evaluations: u32) -> (Child, u16, String, String) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_enfilade"))
        .args(["watch", "--page", "--evaluations", &evaluations.to_string(), "--log"])
        .arg(home.join("watch.log"))
        .arg(home.join("plans"))
        .env("HOME", home)
        .env_remove("XDG_STATE_HOME")
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let link = lines.find_map(|l| l.unwrap().strip_prefix("page: ").map(str::to_owned)).unwrap();
    // Nobody may be left to write to.
    std::thread::spawn(move || lines.for_each(drop));
    let (address, key) = link.split_once("/#key=").unwrap();
    let (name, port) = address.strip_prefix("http://").unwrap().split_once(':').unwrap();
    let is_new = name.strip_suffix(".localhost").is_some_and(|n| n.len() == 16);
    assert!(is_new || cfg!(target_os = "macos"), "{link}");
    let port = port.parse().unwrap();
    let doors = fs::read_dir(home.join(".local/state/enfilade")).unwrap().map(|e| e.unwrap().path());
    let door = doors.filter(|p| p.file_name().unwrap().to_str().unwrap().starts_with("page-"));
    let read = |p: PathBuf| serde_json::from_slice::<Value>(&fs::read(p).unwrap()).unwrap();
    let door = door.map(read).find(|d| d["key"] == key).unwrap();
    (child, port, door["token"].as_str().unwrap().to_owned(), key.to_owned())
}

/// HMAC-SHA-256, hexadecimal, as a browser makes it.
pub fn mac(key: &str, text: &str) -> String {
    use sha2::{Digest, Sha256};
    let pad = |with: u8| -> Vec<u8> {
        let mut block = key.as_bytes().to_vec();
        block.resize(64, 0);
        block.iter().map(|b| b ^ with).collect()
    };
    let inner = Sha256::digest([pad(0x36), text.as_bytes().to_vec()].concat());
    let outer = Sha256::digest([pad(0x5c), inner.to_vec()].concat());
    outer.iter().map(|b| format!("{b:02x}")).collect()
}

pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: Vec<u8>,
}

impl Daemon {
    pub fn plans(&self) -> PathBuf {
        self.folder.path().join("plans")
    }

    /// One request as it stands, with the heads given.
    pub fn raw(&self, method: &str, path: &str, heads: &[(&str, &str)], body: impl AsRef<[u8]>) -> Answer {
        let body = body.as_ref();
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        let heads: String = heads.iter().map(|(n, v)| format!("{n}: {v}\r\n")).collect();
        let length = body.len();
        let head = format!(
            "{method} {path} HTTP/1.1\r\n{heads}Connection: close\r\nContent-Length: {length}\r\n\r\n"
        );
        stream.write_all(&[head.as_bytes(), body].concat()).unwrap();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        let split = bytes.windows(4).position(|w| w == b"\r\n\r\n").unwrap();
        let head = String::from_utf8(bytes[..split].to_vec()).unwrap().to_lowercase();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        Answer { status, head, body: bytes[split + 4..].to_vec() }
    }

    pub fn ask(&self, method: &str, path: &str, body: impl AsRef<[u8]>) -> Answer {
        let host = format!("127.0.0.1:{}", self.port);
        let auth = format!("Bearer {}", self.token);
        self.raw(method, path, &[("Host", &host), ("Authorization", &auth), ("X-Enfilade", "1")], body)
    }

    /// The word of the running start, where it proves that it has `key`.
    pub fn greet(&self, key: &str) -> Option<String> {
        let nonce = "00112233445566778899aabbccddeeff";
        let host = format!("127.0.0.1:{}", self.port);
        let answer = self.raw("GET", &format!("/api/hello?nonce={nonce}"), &[("Host", &host)], "");
        let said: Value = serde_json::from_slice(&answer.body).unwrap();
        let start = said["start"].as_str().unwrap();
        (said["proof"] == mac(key, &format!("page\n{start}\n{nonce}"))).then(|| start.to_owned())
    }

    /// A request as a browser signs it.
    pub fn signed(&self, start: &str, nonce: &str, method: &str, path: &str) -> String {
        format!("Enfilade {nonce}.{}", mac(&self.key, &format!("{method}\n{start}\n{nonce}\n{path}")))
    }

    pub fn json(&self, path: &str) -> Value {
        let answer = self.ask("GET", path, "");
        assert_eq!(answer.status, 200, "{path}: {}", answer.head);
        serde_json::from_slice(&answer.body).unwrap()
    }

    pub fn until<T>(&self, what: &str, mut look: impl FnMut() -> Option<T>) -> T {
        let start = Instant::now();
        loop {
            if let Some(found) = look() {
                return found;
            }
            assert!(start.elapsed() < PATIENCE, "{what} did not come: {}", self.json("/api/drawings"));
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    pub fn drawing(&self, name: &str) -> Option<Value> {
        let all = self.json("/api/drawings");
        all["drawings"].as_array().unwrap().iter().find(|d| d["name"] == name).cloned()
    }

    /// The settings of a round of the gallery.
    pub fn round_settings(&self, round: &str) -> Value {
        let path = self.plans().join("gallery.enfilade").join(round).join("result.json");
        let result: Value = serde_json::from_slice(&fs::read(path).unwrap()).unwrap();
        result["settings"].clone()
    }

    pub fn until_done(&self, name: &str) -> String {
        self.until(name, || {
            self.drawing(name).filter(|d| d["state"] == "done").map(|d| d["id"].as_str().unwrap().to_owned())
        })
    }
}

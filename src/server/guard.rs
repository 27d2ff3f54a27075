//! Who may ask what: host, origin, token and header of every request.
//!
//! Loopback is no boundary: any page in the user's browser can send requests here, and any user of the machine. So the
//! `Host` must be ours (against DNS rebinding), a foreign `Origin` is refused, what says anything of the daemon needs
//! the token of this start or a signature by the key of the page, and what changes something needs a header that no
//! form can send. There is no cookie: a browser would send it to every port of this machine.

use std::collections::HashSet;
use std::sync::{Arc, Mutex, PoisonError};

use axum::body::{Body, to_bytes};
use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, Uri, header};
use axum::middleware::Next;
use axum::response::Response;

use super::assets::ASSETS;
use super::connections::{BODY_TIME_MAX, Known};
use super::door::NAME_DIGITS;
use super::login::{is_nonce, proof, signature};
use super::{BODY_BYTES_MAX, HELLO};

/// Header of every request that changes something.
pub const ORDER_HEADER: &str = "x-enfilade";

/// Why a request that nobody signed is refused.
const UNKNOWN: &str = "no valid token or signature: open the page with `enfilade open`";
/// Orders of one start; more are refused, as each is taken once.
const ORDERS_MAX: usize = 100_000;

/// What this start of the page accepts.
#[derive(Debug)]
pub struct Access {
    port: u16,
    token: String,
    key: String,
    start: String,
    /// Nonces of the orders that were taken: each is taken once.
    taken: Mutex<HashSet<String>>,
}

/// How a request is answered before anything else.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It goes on.
    Pass,
    /// 403, and why.
    Refuse(&'static str),
    /// It goes on as of a method that no route takes: the answer is 405, with those that the address takes, or 404.
    NoRoute,
    /// It goes on, whoever asks: it says nothing of the daemon.
    Public,
}

impl Access {
    /// `token` is for the programs of this user, `key` for browsers; `start` tells this start from others.
    pub fn new(port: u16, token: String, key: String, start: String) -> Self {
        Self { port, token, key, start, taken: Mutex::default() }
    }

    /// See [`Access::new`].
    pub fn token(&self) -> &str {
        &self.token
    }

    /// See [`Access::new`].
    pub(super) fn key(&self) -> &str {
        &self.key
    }

    /// The word of this start, and the proof that the page has the key.
    pub(super) fn greet(&self, nonce: &str) -> Option<(&str, String)> {
        is_nonce(nonce).then(|| (self.start.as_str(), proof(&self.key, &self.start, nonce)))
    }

    /// By its number, or by a name that browsers lead to this machine themselves, whoever asks: no web site can have it.
    fn is_own_host(&self, host: &str) -> bool {
        let Some(name) = host.strip_suffix(&format!(":{}", self.port)) else { return false };
        name == "127.0.0.1" || name.strip_suffix(".localhost").is_some_and(is_own_name)
    }

    /// Judges a request by its head.
    pub fn judge(&self, method: &Method, uri: &Uri, headers: &HeaderMap) -> Verdict {
        let text = |name: &str| headers.get(name).map(|v| v.to_str().unwrap_or("?"));
        if headers.get_all(header::HOST).iter().count() != 1
            || !text("host").is_some_and(|h| self.is_own_host(h))
        {
            return Verdict::Refuse("unknown host");
        }
        // A request may name its host a second time, in its address.
        if uri.authority().is_some_and(|named| !self.is_own_host(named.as_str())) {
            return Verdict::Refuse("unknown host");
        }
        let is_own_origin = |o: &str| o.strip_prefix("http://").is_some_and(|h| self.is_own_host(h));
        if text("origin").is_some_and(|o| !is_own_origin(o)) {
            return Verdict::Refuse("foreign origin");
        }
        // Other ports of this machine are the same site, and none of ours.
        if text("sec-fetch-site").is_some_and(|s| !matches!(s, "same-origin" | "none")) && is_of_api(uri) {
            return Verdict::Refuse("asked for by another page");
        }
        let is_read = matches!(*method, Method::GET | Method::HEAD);
        if is_read && (!is_of_api(uri) || uri.path() == HELLO) {
            return Verdict::Public;
        }
        let nonce = match self.who(method, uri, text("authorization")) {
            Who::Program => None,
            Who::Browser(nonce) => nonce,
            Who::Nobody => return Verdict::Refuse(UNKNOWN),
        };
        if !is_read && *method != Method::POST {
            return Verdict::NoRoute;
        }
        if !is_read && text(ORDER_HEADER) != Some("1") {
            return Verdict::Refuse("the header X-Enfilade: 1 is missing");
        }
        if !is_read && nonce.is_some_and(|nonce| !self.is_first(nonce)) {
            return Verdict::Refuse("this order was taken before; nothing was done");
        }
        Verdict::Pass
    }

    /// Whoever shows the token, or has signed: a header, or, of what only reads, the address.
    fn who(&self, method: &Method, uri: &Uri, authorization: Option<&str>) -> Who {
        let Some((scheme, word)) = authorization.and_then(|a| a.split_once(' ')) else {
            let signed = uri.query().and_then(|q| q.strip_prefix("mac="));
            let is_signed = |mac| is_equal(mac, &self.signed("GET", "", uri.path()));
            let is_read = matches!(*method, Method::GET | Method::HEAD);
            return if is_read && signed.is_some_and(is_signed) { Who::Browser(None) } else { Who::Nobody };
        };
        let word = word.trim_start_matches(' ');
        if scheme.eq_ignore_ascii_case("bearer") && is_equal(word, &self.token) {
            return Who::Program;
        }
        let signed = word.split_once('.').filter(|(nonce, _)| is_nonce(nonce));
        let Some((nonce, mac)) = signed.filter(|_| scheme.eq_ignore_ascii_case("enfilade")) else {
            return Who::Nobody;
        };
        let address = uri.path_and_query().map_or("/", |a| a.as_str());
        if is_equal(mac, &self.signed(method.as_str(), nonce, address)) {
            return Who::Browser(Some(nonce.to_owned()));
        }
        Who::Nobody
    }

    fn signed(&self, method: &str, nonce: &str, address: &str) -> String {
        signature(&self.key, &self.start, method, nonce, address)
    }

    /// Whether the order of this nonce is new.
    fn is_first(&self, nonce: String) -> bool {
        let mut taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
        taken.len() < ORDERS_MAX && taken.insert(nonce)
    }
}

/// Whether a name can be one of [`new_name`](super::door::new_name).
fn is_own_name(name: &str) -> bool {
    name.len() == NAME_DIGITS && name.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'))
}

/// Who asks.
enum Who {
    Program,
    /// With the nonce of the request, where it has one.
    Browser(Option<String>),
    Nobody,
}

/// Whether an address says something of the daemon; what is not there does too.
fn is_of_api(uri: &Uri) -> bool {
    !ASSETS.iter().any(|(path, _, _)| *path == uri.path())
}

/// Compares secrets in a time that does not tell where they differ.
fn is_equal(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |d, (x, y)| d | (x ^ y)) == 0
}

/// Judges, and puts the headers on every answer that keep foreign text from becoming code.
pub(super) async fn check(State(access): State<Arc<Access>>, request: Request, next: Next) -> Response {
    let mut response = match access.judge(request.method(), request.uri(), request.headers()) {
        Verdict::Pass => {
            request.extensions().get::<Known>().iter().for_each(|known| known.set());
            match whole(request).await {
                Ok(request) => next.run(request).await,
                Err(refusal) => refusal,
            }
        }
        Verdict::Public => next.run(request).await,
        Verdict::NoRoute => next.run(unroutable(request)).await,
        Verdict::Refuse(why) => super::api::said(StatusCode::FORBIDDEN, why),
    };
    let headers = response.headers_mut();
    let policy = "default-src 'self'; img-src 'self' data:; object-src 'none'; worker-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
    headers.entry(header::CONTENT_SECURITY_POLICY).or_insert(HeaderValue::from_static(policy));
    headers.insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    headers.insert(header::REFERRER_POLICY, HeaderValue::from_static("no-referrer"));
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    headers.insert("cross-origin-resource-policy", HeaderValue::from_static("same-origin"));
    response
}

/// The request under a method that no route can take, now or ever: it needs no header of orders, as it changes nothing.
fn unroutable(request: Request) -> Request {
    let (mut head, _) = request.into_parts();
    head.method = Method::from_bytes(b"NONE").unwrap_or(Method::TRACE);
    Request::from_parts(head, Body::empty())
}

/// A request with all of its body; of one that only reads, none is asked for.
async fn whole(request: Request) -> Result<Request, Response> {
    let no_text = |what: &str| {
        let why = format!("the {what} is not UTF-8, expected UTF-8; nothing was done");
        super::api::said(StatusCode::BAD_REQUEST, &why)
    };
    if percent_encoding::percent_decode_str(request.uri().path()).decode_utf8().is_err() {
        return Err(no_text("address"));
    }
    if matches!(*request.method(), Method::GET | Method::HEAD) {
        return Ok(request);
    }
    let (head, body) = request.into_parts();
    match tokio::time::timeout(BODY_TIME_MAX, to_bytes(body, BODY_BYTES_MAX)).await {
        Ok(Ok(bytes)) if std::str::from_utf8(&bytes).is_err() => Err(no_text("body")),
        Ok(Ok(bytes)) => Ok(Request::from_parts(head, Body::from(bytes))),
        Ok(Err(_)) => {
            let why = format!(
                "the request is not whole, or has more than {BODY_BYTES_MAX} bytes; nothing was done"
            );
            Err(super::api::said(StatusCode::PAYLOAD_TOO_LARGE, &why))
        }
        Err(_) => {
            let why =
                format!("the request was not whole within {} s; nothing was done", BODY_TIME_MAX.as_secs());
            Err(super::api::said(StatusCode::REQUEST_TIMEOUT, &why))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn access() -> Access {
        Access::new(4711, "t".repeat(64), "k".repeat(64), "5".repeat(32))
    }

    fn judge_by(access: &Access, method: &str, uri: &str, heads: &[(&str, &str)]) -> Verdict {
        let mut headers = HeaderMap::new();
        for (name, value) in heads {
            let name = header::HeaderName::from_bytes(name.as_bytes()).unwrap();
            headers.append(name, value.parse().unwrap());
        }
        access.judge(&method.parse().unwrap(), &uri.parse().unwrap(), &headers)
    }

    fn judge(method: &str, uri: &str, heads: &[(&str, &str)]) -> Verdict {
        judge_by(&access(), method, uri, heads)
    }

    /// Rules 1–4 of the page, one row a case.
    #[test]
    fn only_our_own_requests_pass() {
        let t = "t".repeat(64);
        let bearer = format!("Bearer {t}");
        let own = ("host", "127.0.0.1:4711");
        let auth = ("authorization", bearer.as_str());
        let order = (ORDER_HEADER, "1");
        let pass = |m, u, h: &[(&str, &str)]| judge(m, u, h) == Verdict::Pass;
        assert!(pass("GET", "/api/drawings", &[own, auth]));
        // Names of schemes know no case (RFC 9110, 11.1).
        let lower = format!("bearer {t}");
        assert!(pass("GET", "/api/drawings", &[own, ("authorization", &lower)]));
        assert!(!pass("GET", "/api/drawings", &[own, ("authorization", &format!("Basic {t}"))]));
        assert!(pass("POST", "/api/x", &[own, auth, order, ("origin", "http://127.0.0.1:4711")]));
        let named = ("host", "0123456789abcdef.localhost:4711");
        let origin = ("origin", "http://0123456789abcdef.localhost:4711");
        assert!(pass("POST", "/api/x", &[named, auth, order, origin]));
        for host in [
            "evil.test",
            "evil.test:4711",
            "127.0.0.1",
            "127.0.0.1:80",
            "localhost:4711",
            ".localhost:4711",
            "evil.localhost:4711",
            "0123456789ABCDEF.localhost:4711",
            "0123456789abcdef.localhost",
            "0123456789abcdef.localhost:80",
            "0123456789abcdef.localhost.evil.test:4711",
            "a.0123456789abcdef.localhost:4711",
            "0123456789abcdef.evil.test:4711",
            "[::1]:4711",
            "",
        ] {
            assert!(!pass("GET", "/api/x", &[("host", host), auth]), "{host}");
            assert!(matches!(judge("GET", "/", &[("host", host)]), Verdict::Refuse(_)), "{host}");
        }
        assert!(!pass("GET", "/api/x", &[own, ("host", "evil.test"), auth]));
        for origin in [
            "http://evil.test",
            "null",
            "https://127.0.0.1:4711",
            "http://127.0.0.1:4712",
            "http://evil.localhost:4711",
        ] {
            assert!(!pass("POST", "/api/x", &[own, auth, order, ("origin", origin)]), "{origin}");
        }
        for site in ["cross-site", "same-site"] {
            assert!(!pass("GET", "/api/x", &[own, auth, ("sec-fetch-site", site)]), "{site}");
        }
        assert!(pass("GET", "/api/x", &[own, auth, ("sec-fetch-site", "same-origin")]));
        assert!(pass("GET", "http://127.0.0.1:4711/api/x", &[own, auth]));
        for address in ["http://evil.test/api/x", "http://127.0.0.1:80/api/x", "http://a@127.0.0.1:4711/"] {
            assert!(matches!(judge("GET", address, &[own, auth]), Verdict::Refuse(_)), "{address}");
        }
        assert!(!pass("POST", "/api/x", &[own, auth]));
        for method in ["DELETE", "PUT", "PATCH", "OPTIONS", "TRACE", "BREW"] {
            assert_eq!(judge(method, "/api/x", &[own, auth]), Verdict::NoRoute, "{method}");
            assert_eq!(judge(method, "/api/x", &[own, auth, order]), Verdict::NoRoute, "{method}");
            assert!(matches!(judge(method, "/api/x", &[own, order]), Verdict::Refuse(_)), "{method}");
            let foreign = [own, auth, ("origin", "http://evil.test")];
            assert!(matches!(judge(method, "/api/x", &foreign), Verdict::Refuse(_)), "{method}");
        }
        for address in ["/api/drawings", "/api/events", "/elsewhere"] {
            assert!(matches!(judge("GET", address, &[own]), Verdict::Refuse(_)), "{address}");
        }
        assert!(!pass("GET", "/api/drawings", &[own, ("authorization", "Bearer ttt")]));
        assert!(!pass("GET", "/api/drawings", &[own, ("cookie", &format!("enfilade-4711={t}"))]));
        let offered = format!("/api/drawings?token={t}");
        assert!(!pass("GET", &offered, &[own]));
        // The page without anything of the daemon is for everybody here; the key is no token.
        assert_eq!(judge("GET", "/", &[own]), Verdict::Public);
        assert_eq!(judge("GET", "/api/hello?nonce=0", &[own]), Verdict::Public);
        let key = format!("Bearer {}", "k".repeat(64));
        assert!(!pass("GET", "/api/drawings", &[own, ("authorization", &key)]));
    }

    /// A signature is good for one address, one method, one start and, where it orders, once.
    #[test]
    fn signatures_are_of_one_request() {
        let access = access();
        let (own, order) = (("host", "127.0.0.1:4711"), (ORDER_HEADER, "1"));
        let (key, start, nonce) = ("k".repeat(64), "5".repeat(32), "0123456789abcdef");
        let head = |key: &str, start: &str, method: &str, address: &str| {
            format!("Enfilade {nonce}.{}", signature(key, start, method, nonce, address))
        };
        let pass = |method: &str, address: &str, head: &str| {
            judge_by(&access, method, address, &[own, order, ("authorization", head)]) == Verdict::Pass
        };
        let good = head(&key, &start, "GET", "/api/log");
        assert!(pass("GET", "/api/log", &good) && pass("GET", "/api/log", &good));
        assert!(!pass("GET", "/api/drawings", &good) && !pass("POST", "/api/log", &good));
        assert!(!pass("GET", "/api/log", &head(&"K".repeat(64), &start, "GET", "/api/log")));
        assert!(!pass("GET", "/api/log", &head(&key, &"6".repeat(32), "GET", "/api/log")), "another start");
        let accept = head(&key, &start, "POST", "/api/drawings/a/accept");
        assert!(pass("POST", "/api/drawings/a/accept", &accept));
        assert!(!pass("POST", "/api/drawings/a/accept", &accept), "a replay");
        // Of an address, for pictures: it reads, and orders nothing.
        let signed = |path: &str| format!("{path}?mac={}", signature(&key, &start, "GET", "", path));
        let by_address =
            |method: &str, address: &str| judge_by(&access, method, address, &[own, order]) == Verdict::Pass;
        assert!(by_address("GET", &signed("/api/drawings/a/round-01/a.png")));
        assert!(!by_address("POST", &signed("/api/drawings/a/accept")));
        let other = signed("/api/drawings/a/round-01/a.png").replace("a.png", "b.png");
        assert!(!by_address("GET", &other));
        // What the page proves is no signature of a request.
        let (word, proof) = access.greet(nonce).unwrap();
        assert_eq!((word, proof), (start.as_str(), proof_of(&key, &start, nonce)));
        assert_eq!(access.greet("GET\n5"), None);
    }

    fn proof_of(key: &str, start: &str, nonce: &str) -> String {
        super::proof(key, start, nonce)
    }
}

//! Who may ask what: host, origin, token and header of every request.
//!
//! Loopback is no boundary: any page in the user's browser can send requests here. So the `Host` must be ours
//! (against DNS rebinding), a foreign `Origin` is refused, everything needs the token of this start, and what
//! changes something needs a header that no form can send.

use std::sync::Arc;

use axum::body::{Body, to_bytes};
use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, Uri, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::connections::{BODY_TIME_MAX, Known};
use super::{BODY_BYTES_MAX, Shared};

/// Header of every request that changes something.
pub const ORDER_HEADER: &str = "x-enfilade";

/// Why a request without the token of this start is refused.
const NO_TOKEN: &str = "no valid token: open the page with `enfilade open`";

/// What this start of the page accepts.
#[derive(Clone, Debug)]
pub struct Access {
    port: u16,
    token: String,
    /// Value of the cookie that the token is exchanged for.
    session: String,
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
    /// The token in the address is exchanged for a cookie, and vanishes from the address.
    Welcome,
}

impl Access {
    /// `token` goes into the address once and into the `Authorization` of programs, `session` into the cookie.
    pub fn new(port: u16, token: String, session: String) -> Self {
        Self { port, token, session }
    }

    /// See [`Access::new`].
    pub fn token(&self) -> &str {
        &self.token
    }

    /// Browsers keep cookies by host, not by port: its name has the port.
    fn cookie_name(&self) -> String {
        format!("enfilade-{}", self.port)
    }

    fn is_own_host(&self, host: &str) -> bool {
        let is_own = |name: &&str| host.eq_ignore_ascii_case(&format!("{name}:{}", self.port));
        ["127.0.0.1", "localhost", "[::1]"].iter().any(is_own)
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
        let is_read = matches!(*method, Method::GET | Method::HEAD);
        let offered = uri.query().unwrap_or_default().split('&').find_map(|p| p.strip_prefix("token="));
        if is_read && uri.path() == "/" && offered.is_some_and(|t| is_equal(t, &self.token)) {
            return Verdict::Welcome;
        }
        if !self.is_known(text("authorization"), headers) {
            return Verdict::Refuse(NO_TOKEN);
        }
        if !is_read && *method != Method::POST {
            return Verdict::NoRoute;
        }
        if !is_read && text(ORDER_HEADER) != Some("1") {
            return Verdict::Refuse("the header X-Enfilade: 1 is missing");
        }
        Verdict::Pass
    }

    fn is_known(&self, authorization: Option<&str>, headers: &HeaderMap) -> bool {
        let bearer =
            authorization.and_then(|a| a.split_once(' ')).filter(|(s, _)| s.eq_ignore_ascii_case("bearer"));
        if let Some((_, token)) = bearer {
            return is_equal(token.trim_start_matches(' '), &self.token);
        }
        let name = self.cookie_name();
        let cookies = headers.get_all(header::COOKIE).iter().filter_map(|v| v.to_str().ok());
        let pairs = cookies.flat_map(|c| c.split(';')).filter_map(|c| c.trim().split_once('='));
        pairs.filter(|(n, _)| *n == name).any(|(_, value)| is_equal(value, &self.session))
    }
}

/// Compares secrets in a time that does not tell where they differ.
fn is_equal(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |d, (x, y)| d | (x ^ y)) == 0
}

/// Judges, and puts the headers on every answer that keep foreign text from becoming code.
pub(super) async fn check(State(shared): State<Arc<Shared>>, request: Request, next: Next) -> Response {
    let access = &shared.access;
    let is_page = asks_for_the_page(&request);
    let mut response = match access.judge(request.method(), request.uri(), request.headers()) {
        Verdict::Pass => {
            request.extensions().get::<Known>().iter().for_each(|known| known.set());
            match whole(request).await {
                Ok(request) => next.run(request).await,
                Err(refusal) => refusal,
            }
        }
        Verdict::NoRoute => next.run(unroutable(request)).await,
        Verdict::Refuse(NO_TOKEN) if is_page => super::locked().await,
        Verdict::Refuse(why) => super::api::said(StatusCode::FORBIDDEN, why),
        Verdict::Welcome => {
            let cookie =
                format!("{}={}; Path=/; HttpOnly; SameSite=Strict", access.cookie_name(), access.session);
            (StatusCode::SEE_OTHER, [(header::LOCATION, "/".to_owned()), (header::SET_COOKIE, cookie)])
                .into_response()
        }
    };
    let headers = response.headers_mut();
    let policy = "default-src 'self'; img-src 'self' data:; object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
    headers.insert(header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(policy));
    headers.insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    headers.insert(header::REFERRER_POLICY, HeaderValue::from_static("no-referrer"));
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    headers.insert("cross-origin-resource-policy", HeaderValue::from_static("same-origin"));
    response
}

/// Whether somebody looks at the answer, and waits for the page itself.
fn asks_for_the_page(request: &Request) -> bool {
    let accepted = request.headers().get_all(header::ACCEPT).iter().filter_map(|v| v.to_str().ok());
    let mut kinds = accepted.flat_map(|v| v.split(',')).filter_map(|k| k.split(';').next());
    *request.method() == Method::GET
        && request.uri().path() == "/"
        && kinds.any(|k| k.trim().eq_ignore_ascii_case("text/html"))
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

    fn judge(method: &str, uri: &str, heads: &[(&str, &str)]) -> Verdict {
        let access = Access::new(4711, "t".repeat(64), "s".repeat(64));
        let mut headers = HeaderMap::new();
        for (name, value) in heads {
            let name = header::HeaderName::from_bytes(name.as_bytes()).unwrap();
            headers.append(name, value.parse().unwrap());
        }
        access.judge(&method.parse().unwrap(), &uri.parse().unwrap(), &headers)
    }

    /// Rules 1–4 of the page, one row a case.
    #[test]
    fn only_our_own_requests_pass() {
        let (t, s) = ("t".repeat(64), "s".repeat(64));
        let (bearer, cookie) = (format!("Bearer {t}"), format!("a=b; enfilade-4711={s}"));
        let own = ("host", "127.0.0.1:4711");
        let auth = ("authorization", bearer.as_str());
        let order = (ORDER_HEADER, "1");
        let pass = |m, u, h: &[(&str, &str)]| judge(m, u, h) == Verdict::Pass;
        assert!(pass("GET", "/api/drawings", &[own, auth]));
        assert!(pass("GET", "/api/drawings", &[("host", "localhost:4711"), ("cookie", &cookie)]));
        // Names of hosts and of schemes know no case (RFC 9110, 4.2.3 and 11.1).
        let lower = format!("bearer {t}");
        assert!(pass("GET", "/api/drawings", &[("host", "LocalHost:4711"), ("authorization", &lower)]));
        assert!(!pass("GET", "/api/drawings", &[own, ("authorization", &format!("Basic {t}"))]));
        assert!(pass("POST", "/api/x", &[own, auth, order, ("origin", "http://127.0.0.1:4711")]));
        for host in
            ["evil.test", "evil.test:4711", "127.0.0.1", "127.0.0.1:80", "localhost.evil.test:4711", ""]
        {
            assert!(!pass("GET", "/", &[("host", host), auth]), "{host}");
        }
        assert!(!pass("GET", "/", &[own, ("host", "evil.test"), auth]));
        for origin in ["http://evil.test", "null", "https://127.0.0.1:4711", "http://127.0.0.1:4712"] {
            assert!(!pass("POST", "/api/x", &[own, auth, order, ("origin", origin)]), "{origin}");
        }
        assert!(pass("GET", "http://localhost:4711/api/x", &[own, auth]));
        for address in ["http://evil.test/api/x", "http://127.0.0.1:80/api/x", "http://a@127.0.0.1:4711/"] {
            assert!(!pass("GET", address, &[own, auth]), "{address}");
        }
        assert!(!pass("POST", "/api/x", &[own, auth]));
        for method in ["DELETE", "PUT", "PATCH", "OPTIONS", "TRACE", "BREW"] {
            assert_eq!(judge(method, "/api/x", &[own, auth]), Verdict::NoRoute, "{method}");
            assert_eq!(judge(method, "/api/x", &[own, auth, order]), Verdict::NoRoute, "{method}");
            assert!(matches!(judge(method, "/api/x", &[own, order]), Verdict::Refuse(_)), "{method}");
            let foreign = [own, auth, ("origin", "http://evil.test")];
            assert!(matches!(judge(method, "/api/x", &foreign), Verdict::Refuse(_)), "{method}");
        }
        assert!(!pass("GET", "/api/drawings", &[own]));
        assert!(!pass("GET", "/api/drawings", &[own, ("authorization", "Bearer ttt")]));
        assert!(!pass("GET", "/api/drawings", &[own, ("cookie", "enfilade-4711=no; enfilade-4712=s")]));
        // The cookie's value is no token and the token no cookie.
        assert!(!pass("GET", "/api/drawings", &[own, ("cookie", &format!("enfilade-4711={t}"))]));
        assert_eq!(judge("GET", &format!("/?token={t}"), &[own]), Verdict::Welcome);
        assert_ne!(judge("GET", &format!("/?token={s}"), &[own]), Verdict::Welcome);
        assert_ne!(judge("POST", &format!("/?token={t}"), &[own]), Verdict::Welcome);
        assert_ne!(judge("GET", &format!("/?token={t}"), &[("host", "evil.test")]), Verdict::Welcome);
    }
}

//! The local page as browsers, programs and attackers meet it: a real daemon, real sockets.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use enfilade::server::{BODY_BYTES_MAX, BODY_TIME_MAX, CONNECTIONS_MAX, HEAD_BYTES_MAX, HEAD_TIME_MAX};
use rand::{RngExt, SeedableRng};
use serde_json::{Value, json};

#[path = "page/daemon.rs"]
mod daemon;

use daemon::{Daemon, mac, spawn, start, start_searching, start_with};

/// Every order of the page by its interface, from the first round to the accepted option.
#[test]
fn the_interface_shows_and_obeys() {
    let daemon = start();
    let id = daemon.until_done("gallery.dxf");
    let at = |rest: &str| format!("/api/drawings/{id}{rest}");
    let found = daemon.json(&at(""));
    assert_eq!(found["sets"], json!(["analysis", "round-01"]));
    let result = daemon.json(&at("/round-01/result.json"));
    let first = result["candidates"][0]["file"].as_str().unwrap();
    let file = daemon.ask("GET", &at(&format!("/round-01/{first}")), "");
    assert_eq!(file.body, fs::read(daemon.plans().join("gallery.enfilade/round-01").join(first)).unwrap());
    assert!(file.head.contains("content-disposition: attachment"), "{}", file.head);
    assert_eq!(daemon.ask("GET", &at("/round-01/initial-degree.png"), "").status, 200);

    assert_eq!(daemon.ask("POST", &at("/again"), r#"{"objective": "degree up 7"}"#).status, 400);
    assert_eq!(daemon.ask("POST", &at("/again"), "no json").status, 400);
    for wrong in [
        r#"{"pin": [0]}"#,
        r#"{"like": 6}"#,
        r#"{"pin": [1], "round": 9}"#,
        r#"{"pin": [1, 2, 3, 4, 5]}"#,
        r#"{"round": 9}"#,
        r#"{"round": 0}"#,
        "[]",
        r#"[null, 1, [], null]"#,
        "null",
    ] {
        assert_eq!(daemon.ask("POST", &at("/again"), wrong).status, 400, "{wrong}");
    }
    assert_eq!(daemon.ask("POST", &at("/accept"), "[1, 1]").status, 400);
    for (method, path, status) in [
        ("GET", at("/cancel"), 405),
        ("DELETE", at("/cancel"), 405),
        ("POST", at("/cancel"), 409),
        ("POST", "/api/drawings/0123456789abcdef/cancel".into(), 404),
        ("POST", "/api/drawings".into(), 405),
        ("GET", "/api/nowhere".into(), 404),
        ("GET", "/nowhere".into(), 404),
        ("POST", at("/again"), 400),
        ("GET", "/api/drawings/%ff".into(), 400),
        ("POST", "/api/drawings/%ff/cancel".into(), 400),
    ] {
        let answer = daemon.ask(method, &path, "");
        let why: Value = serde_json::from_slice(&answer.body).unwrap();
        let is_said = why["error"].as_str().is_some_and(|w| !w.is_empty());
        assert_eq!((answer.status, is_said), (status, true), "{method} {path}: {}", answer.head);
    }
    let answer = daemon.ask("POST", &at("/again"), b"{\"pin\": \xff}");
    assert!(
        answer.status == 400 && String::from_utf8_lossy(&answer.body).contains("UTF-8"),
        "{}",
        answer.head
    );
    let names = daemon.json(&at("/round-01"));
    assert!(names.as_array().unwrap().contains(&json!("initial-degree.png")), "{names}");
    assert_eq!(daemon.ask("GET", &at("/round-09"), "").status, 404);
    assert_eq!(daemon.ask("POST", &at("/again"), "x".repeat(BODY_BYTES_MAX + 1)).status, 413);
    // A threshold that is left out is said with the order.
    let taken = daemon.ask("POST", &at("/again"), r#"{"objective": "entropy max", "pin": [2], "round": 1}"#);
    let said = String::from_utf8_lossy(&taken.body);
    assert_eq!((taken.status, &*said), (202, r#"{"objective":"entropy max 0.7"}"#));
    daemon.until("round 2", || {
        daemon.json(&at(""))["sets"].as_array().unwrap().contains(&json!("round-02")).then_some(())
    });
    let second = daemon.json(&at("/round-02/result.json"));
    let names: Vec<&str> =
        second["objectives"].as_array().unwrap().iter().map(|o| o["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["entropy"], "a penalty weighs and is no objective");
    assert_eq!(daemon.round_settings("round-02")["pinned"], json!([result["candidates"][1]["parameters"]]));

    daemon.until_done("gallery.dxf");
    copy_round(&daemon.plans().join("gallery.enfilade"), "so-far");
    assert_eq!(daemon.json(&at(""))["sets"], json!(["analysis", "so-far", "round-01", "round-02"]));
    let layouts = result["evaluations"].as_u64().unwrap();
    for (wrong, why) in [
        (json!({"candidate": 1}), "one of them"),
        (json!({"round": 1, "so_far": layouts, "candidate": 1}), "one of them"),
        (json!({"so_far": layouts + 1, "candidate": 1}), "another by now"),
        (json!({"so_far": layouts, "candidate": 9}), "the best so far has options 1 to"),
    ] {
        let answer = daemon.ask("POST", &at("/accept"), wrong.to_string());
        let said = String::from_utf8_lossy(&answer.body);
        assert!(answer.status == 400 && said.contains(why), "{wrong}: {said}");
    }
    let of_so_far = json!({"so_far": layouts, "candidate": 1}).to_string();
    assert_eq!(daemon.ask("POST", &at("/accept"), &of_so_far).status, 200);
    let accepted = daemon.ask("POST", &at("/accept"), r#"{"round": 1, "candidate": 1}"#);
    assert_eq!(accepted.status, 200, "{}", String::from_utf8_lossy(&accepted.body));
    assert!(daemon.plans().join("gallery-r02.dxf").is_file());
    // The same again is the same drawing.
    let again = daemon.ask("POST", &at("/accept"), r#"{"round": 1, "candidate": 1}"#);
    assert_eq!((again.status, &again.body), (200, &accepted.body));
    assert!(!daemon.plans().join("gallery-r03.dxf").exists());
    // The accepted drawing is the next save of a watched folder; it can be called off.
    let next = daemon.until("the accepted drawing", || daemon.drawing("gallery-r02.dxf"));
    let cancel = format!("/api/drawings/{}/cancel", next["id"].as_str().unwrap());
    assert_eq!(daemon.ask("POST", &cancel, "").status, 202);
    daemon.until("the end of it", || {
        daemon.drawing("gallery-r02.dxf").filter(|d| d["state"] == "stopped" || d["state"] == "done")
    });
    let log = fs::read_to_string(daemon.folder.path().join("watch.log")).unwrap();
    assert!(log.contains("gallery.dxf started"), "{log}");
}

/// Who cancels a search gets the best that it found by then, as on the command line; a restart leaves it so.
#[test]
fn a_cancelled_search_leaves_its_best() {
    const LAYOUTS: u32 = 10_000_000;
    let mut daemon = start_searching("gallery.dxf", "", LAYOUTS);
    let searching = |d: &Value| d["progress"]["stage"].as_str().is_some_and(|s| s.starts_with("optimise"));
    let begun = daemon.until("the search", || {
        daemon
            .drawing("gallery.dxf")
            .filter(|d| searching(d) && d["progress"]["evaluations"].as_u64() > Some(50))
    });
    let id = begun["id"].as_str().unwrap().to_owned();
    let at = |rest: &str| format!("/api/drawings/{id}{rest}");
    assert_eq!(daemon.json(&at(""))["sets"], json!(["analysis"]));
    assert_eq!(daemon.ask("POST", &at("/cancel"), "").status, 202);
    let stopped = |daemon: &Daemon| daemon.drawing("gallery.dxf").filter(|d| d["state"] == "stopped");
    let end = daemon.until("its end", || stopped(&daemon));
    assert_eq!(end["summary"], "cancelled; its best so far is kept");
    assert_eq!(daemon.json(&at(""))["sets"], json!(["analysis", "so-far"]));
    let result = daemon.json(&at("/so-far/result.json"));
    assert!(!result["candidates"].as_array().unwrap().is_empty(), "{result}");
    daemon.restart(LAYOUTS);
    let end = daemon.until("the word on it", || stopped(&daemon));
    assert!(end["summary"].as_str().unwrap().starts_with("cancelled before"), "{end}");
    let order = json!({"so_far": result["evaluations"], "candidate": 1}).to_string();
    assert_eq!(daemon.ask("POST", &at("/accept"), &order).status, 200);
    assert!(daemon.plans().join("gallery-r02.dxf").is_file());
}

/// Results in a folder of their own, below it those of folders below: found again by whoever asks for a round.
#[test]
fn results_elsewhere_are_found_again() {
    let daemon = start_with("sub/gallery.dxf", "out = \"results\"\n[watch]\ndepth = 1\n");
    let id = daemon.until_done("gallery.dxf");
    let at = |rest: &str| format!("/api/drawings/{id}{rest}");
    assert_eq!(daemon.json(&at(""))["sets"], json!(["analysis", "round-01"]));
    let home = daemon.plans().join("results/sub/gallery.enfilade");
    assert!(home.join("round-01/result.json").is_file());
    assert_eq!(daemon.ask("POST", &at("/again"), r#"{"pin": [2], "round": 1}"#).status, 202);
    daemon.until("round 2", || home.join("round-02/result.json").is_file().then_some(()));
    daemon.until_done("gallery.dxf");
    let accepted = daemon.ask("POST", &at("/accept"), r#"{"round": 1, "candidate": 1}"#);
    assert_eq!(accepted.status, 200, "{}", String::from_utf8_lossy(&accepted.body));
    assert!(daemon.plans().join("sub/gallery-r02.dxf").is_file());
    assert!(!daemon.plans().join("sub/gallery.enfilade").exists());
}

/// Where the page's own file cannot be written, what is said helps: results sent elsewhere would not.
#[test]
fn a_page_that_cannot_be_found_again_says_what_helps() {
    let folder = tempfile::tempdir().unwrap();
    let [plans, taken] = ["plans", "taken"].map(|name| folder.path().join(name));
    fs::create_dir(&plans).unwrap();
    fs::write(&taken, "").unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_enfilade"))
        .args(["watch", "--page"])
        .arg(&plans)
        .env("HOME", folder.path())
        .env("XDG_STATE_HOME", &taken)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let said = lines.find_map(|l| l.ok().filter(|l| l.contains("will not find the page")));
    child.kill().unwrap();
    child.wait().unwrap();
    let said = said.unwrap();
    assert!(said.contains("XDG_STATE_HOME") && !said.contains("--out"), "{said}");
}

/// What is left alone is shown with its reason, and what changes of it without a start.
#[test]
fn files_left_alone_are_shown() {
    let daemon = start();
    daemon.until_done("gallery.dxf");
    fs::copy(daemon.plans().join("gallery.dxf"), daemon.plans().join("#gallery.dxf")).unwrap();
    let left = |daemon: &Daemon| daemon.json("/api/drawings")["ignored"].as_array().unwrap().clone();
    let first = daemon.until("the file left alone", || left(&daemon).first().cloned());
    assert!(first["file"].as_str().unwrap().ends_with("#gallery.dxf"), "{first}");
    assert_eq!(first["why"], "autosave copy of LibreCAD");
    fs::write(daemon.plans().join("enfilade.toml"), "[watch]\nignore = [\"gall*\"]\n").unwrap();
    daemon.until("two files left alone", || (left(&daemon).len() == 2).then_some(()));
    assert_eq!(daemon.json("/api/drawings")["drawings"], json!([]));
}

/// The rules of a local page, from outside (tests of hosts, tokens and origins in detail: `server::guard`).
#[test]
fn strangers_get_nothing() {
    let daemon = start();
    let id = daemon.until_done("gallery.dxf");
    let host = format!("127.0.0.1:{}", daemon.port);
    let auth = format!("Bearer {}", daemon.token);
    let (own, known) = (("Host", host.as_str()), ("Authorization", auth.as_str()));
    let status =
        |method: &str, path: &str, heads: &[(&str, &str)]| daemon.raw(method, path, heads, "").status;
    assert_eq!(status("GET", "/", &[("Host", "evil.test"), known]), 403);
    // The page itself is the same for everybody: it holds nothing of the daemon's, and sets no cookie.
    for (path, heads, wanted) in [
        ("/", vec![own], 200),
        ("/page.js", vec![own], 200),
        ("/?token=0123", vec![own, ("Cookie", "enfilade-1=2")], 200),
        ("/", vec![("Host", "evil.test")], 403),
        ("/", vec![own, ("Origin", "http://evil.test")], 403),
        ("/api/log", vec![own], 403),
        ("/api/log", vec![own, known, ("Sec-Fetch-Site", "same-site")], 403),
        ("/nowhere", vec![own], 403),
    ] {
        let answer = daemon.raw("GET", path, &heads, "");
        let said = String::from_utf8_lossy(&answer.body);
        assert_eq!(answer.status, wanted, "{path} {heads:?}: {}", answer.head);
        assert!(answer.head.contains("content-security-policy: default-src 'self'"), "{}", answer.head);
        assert!(answer.head.contains("no-store") && !answer.head.contains("set-cookie"), "{}", answer.head);
        assert!(!answer.head.contains("access-control"), "{}", answer.head);
        let secrets = [&daemon.token, &daemon.key, "gallery.dxf"];
        assert!(secrets.iter().all(|secret| !said.contains(*secret)), "{path}");
    }
    assert_eq!(status("GET", "http://evil.test/api/drawings", &[own, known]), 403);
    assert_eq!(status("GET", "/api/log", &[own, ("Authorization", "Bearer no")]), 403);
    let order = format!("/api/drawings/{id}/cancel");
    assert_eq!(status("POST", &order, &[own, known]), 403);
    assert_eq!(
        status("POST", &order, &[own, known, ("X-Enfilade", "1"), ("Origin", "http://evil.test")]),
        403
    );
    assert_eq!(status("GET", &order, &[own, known]), 405);
    for method in ["DELETE", "PUT", "OPTIONS", "BREW"] {
        let answer = daemon.raw(method, &order, &[own, known], "");
        assert!(answer.status == 405 && answer.head.contains("allow: post"), "{method}: {}", answer.head);
        assert_eq!(status(method, "/api/nowhere", &[own, known]), 404, "{method}");
        assert_eq!(status(method, &order, &[own]), 403, "{method}");
    }

    let plans = daemon.plans();
    fs::write(daemon.folder.path().join("secret"), "secret").unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(
        daemon.folder.path().join("secret"),
        plans.join("gallery.enfilade/round-01/planted.png"),
    )
    .unwrap();
    // A picture that would fill the memory, and a round that is a link to another.
    let home = plans.join("gallery.enfilade");
    fs::File::create(home.join("round-01/sparse.png")).unwrap().set_len(2 << 30).unwrap();
    let sparse = daemon.ask("GET", &format!("/api/drawings/{id}/round-01/sparse.png"), "");
    let said = String::from_utf8_lossy(&sparse.body);
    assert!(sparse.status == 413 && said.contains("256 MB"), "{said}");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("round-01", home.join("round-08")).unwrap();
        assert_eq!(status("GET", &format!("/api/drawings/{id}/round-08/result.json"), &[own, known]), 404);
        let accepted =
            daemon.ask("POST", &format!("/api/drawings/{id}/accept"), r#"{"round": 8, "candidate": 1}"#);
        let said = String::from_utf8_lossy(&accepted.body);
        assert!(accepted.status == 400 && said.contains("is a link"), "{said}");
        assert!(!plans.join("gallery-r02.dxf").exists());
    }
    for path in [
        format!("/api/drawings/{id}/round-01/planted.png"),
        format!("/api/drawings/{id}/round-01/..%2f..%2f..%2fsecret"),
        format!("/api/drawings/{id}/..%2f..%2f/secret"),
        format!("/api/drawings/{id}/round-01/../../../../secret"),
        format!("/api/drawings/{id}/round-01/%2e%2e"),
        "/api/drawings/../../etc/passwd".into(),
        "/api/drawings/%2e%2e/x/y".into(),
        "/etc/passwd".into(),
    ] {
        assert_eq!(status("GET", &path, &[own, known]), 404, "{path}");
    }

    assert_loopback_only(daemon.port);
    assert_door_is_closed(daemon.folder.path());
}

/// Whoever listens on another port of this machine, or on the page's own while the daemon is down, gets nothing that the
/// daemon would take: no cookie, no token, and signatures that are good for one start, one address and, to order, once.
#[test]
fn what_other_servers_hear_opens_nothing() {
    let mut daemon = start();
    let id = daemon.until_done("gallery.dxf");
    let host = format!("127.0.0.1:{}", daemon.port);
    let (own, order) = (("Host", host.as_str()), ("X-Enfilade", "1"));
    let start = daemon.greet(&daemon.key).unwrap();
    assert!(daemon.greet(&"0".repeat(64)).is_none());
    let accept = format!("/api/drawings/{id}/accept");
    let heard = daemon.signed(&start, "0123456789abcdef", "POST", &accept);
    let send = |daemon: &Daemon, head: &str| {
        let body = r#"{"round": 1, "candidate": 1}"#;
        let own = format!("127.0.0.1:{}", daemon.port);
        let heads = [("Host", own.as_str()), order, ("Authorization", head)];
        daemon.raw("POST", &accept, &heads, body).status
    };
    assert_eq!(send(&daemon, &heard), 200);
    assert_eq!(send(&daemon, &heard), 403, "a replay");
    let read = daemon.signed(&start, "0123456789abcdef", "GET", "/api/log");
    assert_eq!(daemon.raw("GET", "/api/log", &[own, ("Authorization", &read)], "").status, 200);
    let picture = format!("/api/drawings/{id}/round-01/initial-degree.png");
    let address = format!("{picture}?mac={}", mac(&daemon.key, &format!("GET\n{start}\n\n{picture}")));
    assert_eq!(daemon.raw("GET", &address, &[own], "").status, 200);
    let report = format!("/api/drawings/{id}/round-01/report.html");
    let mut shown = daemon.raw("GET", &report, &[own, ("Authorization", &read)], "");
    assert_eq!(shown.status, 403);
    shown = daemon.ask("GET", &report, "");
    assert!(shown.status == 200 && shown.head.contains("sandbox allow-scripts"), "{}", shown.head);

    // Down and up again: the same address and key, another start. Nothing that was heard before is good.
    let unused = daemon.signed(&start, "fedcba9876543210", "POST", &accept);
    let restart = |daemon: &mut Daemon| {
        let (child, port, token, key) = spawn(daemon.folder.path());
        daemon.child = child;
        (port, token, key)
    };
    let end = |daemon: &mut Daemon| {
        daemon.child.kill().unwrap();
        daemon.child.wait().unwrap();
    };
    end(&mut daemon);
    let (port, token, key) = restart(&mut daemon);
    assert_eq!((port, &key), (daemon.port, &daemon.key), "the address and the login stay");
    assert_ne!(token, daemon.token);
    let own_host = format!("127.0.0.1:{port}");
    assert_eq!(send(&daemon, &unused), 403, "a signature of another start");
    let before = format!("Bearer {}", daemon.token);
    assert_eq!(send(&daemon, &before), 403, "the token of another start");
    assert_eq!(daemon.raw("GET", &address, &[("Host", &own_host)], "").status, 403);
    assert_ne!(daemon.greet(&daemon.key).unwrap(), start);

    // Somebody takes the port meanwhile, and hears what a page would send: the daemon gives it up with its key.
    end(&mut daemon);
    let stranger = std::net::TcpListener::bind(("127.0.0.1", port)).unwrap();
    let (elsewhere, token, key) = restart(&mut daemon);
    drop(stranger);
    assert!(elsewhere != port && key != daemon.key);
    let old = std::mem::replace(&mut daemon.key, key);
    (daemon.port, daemon.token) = (elsewhere, token);
    assert!(daemon.greet(&old).is_none(), "the key of the port that was taken is no more");
    assert!(daemon.greet(&daemon.key).is_some());

    // The same where the stranger has it at the other address of this machine, where browsers ask first.
    end(&mut daemon);
    let Ok(stranger) = std::net::TcpListener::bind(("::1", daemon.port)) else { return };
    let (elsewhere, token, key) = restart(&mut daemon);
    drop(stranger);
    assert!(elsewhere != daemon.port && key != daemon.key);
    (daemon.port, daemon.token, daemon.key) = (elsewhere, token, key);
    assert!(daemon.greet(&daemon.key).is_some());
}

/// Pages of ended daemons are forgotten at the next start, also where somebody else listens on their port by now; that
/// of a daemon that runs stays.
#[test]
fn pages_of_ended_daemons_are_forgotten() {
    let (daemon, mut ended) = (start(), start());
    let state = |of: &Daemon| of.folder.path().join(".local/state/enfilade");
    let doors = |of: &Daemon| {
        let entries = fs::read_dir(state(of)).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
        entries.filter(|name| name.starts_with("page-")).collect::<std::collections::BTreeSet<String>>()
    };
    ended.child.kill().unwrap();
    ended.child.wait().unwrap();
    let dead = doors(&ended).pop_first().unwrap();
    fs::copy(state(&ended).join(&dead), state(&daemon).join("page-dead.json")).unwrap();
    let address = format!("http://127.0.0.1:{}/", daemon.port);
    let stranger = json!({"address": address, "token": "x", "key": "0", "pid": 1});
    fs::write(state(&daemon).join("page-stranger.json"), stranger.to_string()).unwrap();
    assert_eq!(doors(&daemon).len(), 3);
    let other = daemon.folder.path().join("other");
    fs::create_dir(&other).unwrap();
    let by_user = |args: &[&str], folder: &Path| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_enfilade"));
        command.args(args).arg(folder).env("HOME", daemon.folder.path()).env_remove("XDG_STATE_HOME");
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    };
    let mut second = by_user(&["watch", "--page"], &other).spawn().unwrap();
    let mut lines = BufReader::new(second.stdout.take().unwrap()).lines();
    assert!(lines.any(|l| l.unwrap().starts_with("page: ")));
    let left = doors(&daemon);
    second.kill().unwrap();
    second.wait().unwrap();
    assert_eq!(left.len(), 2, "{left:?}");
    assert!(!left.contains("page-dead.json") && !left.contains("page-stranger.json"), "{left:?}");
    // One that is turned away does not hide the page of the daemon that watches.
    let refused = by_user(&["watch", "--page"], &daemon.plans()).output().unwrap();
    assert_eq!(refused.status.code(), Some(4), "{refused:?}");
    let open = by_user(&["open", "--print"], &daemon.plans()).output().unwrap();
    assert!(String::from_utf8_lossy(&open.stdout).contains(&daemon.key), "{open:?}");
    let gone = by_user(&["open", "--print"], &other).output().unwrap();
    assert!(String::from_utf8_lossy(&gone.stderr).contains("no page of a daemon"), "{gone:?}");
}

/// Whoever holds connections open without the token keeps nobody out and stops no watching; each ends in its time.
#[test]
fn half_open_connections_keep_nobody_out() {
    let daemon = start();
    let id = daemon.until_done("gallery.dxf");
    let open = |text: &str| {
        let mut stream = TcpStream::connect(("127.0.0.1", daemon.port)).unwrap();
        stream.set_read_timeout(Some(HEAD_TIME_MAX + Duration::from_secs(60))).unwrap();
        // The oldest are closed while the newer ones come.
        let _ = stream.write_all(text.as_bytes());
        stream
    };
    let ended = |mut stream: &TcpStream| {
        let mut rest = Vec::new();
        let _ = stream.read_to_end(&mut rest);
        String::from_utf8_lossy(&rest).into_owned()
    };
    let since = Instant::now();
    let held: Vec<TcpStream> = (0..CONNECTIONS_MAX + 20).map(|_| open("GET / HTTP/1.1\r\nX:")).collect();
    assert_eq!(daemon.ask("GET", "/api/drawings", "").status, 200);
    ended(&held[0]);
    assert!(since.elapsed() < HEAD_TIME_MAX, "the oldest goes at once, as there are too many");
    fs::copy(daemon.plans().join("gallery.dxf"), daemon.plans().join("second.dxf")).unwrap();
    daemon.until_done("second.dxf");
    held.iter().for_each(|stream| drop(ended(stream)));

    let head = format!(
        "POST /api/drawings/{id}/again HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nAuthorization: Bearer {}\r\n\
         X-Enfilade: 1\r\nContent-Length: 1000\r\n\r\n{{",
        daemon.port, daemon.token
    );
    let since = Instant::now();
    let said = ended(&open(&head));
    assert!(said.starts_with("HTTP/1.1 408"), "{said}");
    assert!(since.elapsed() >= BODY_TIME_MAX, "a slow body has its time");
    assert_eq!(daemon.ask("GET", "/api/drawings", "").status, 200);
    let long = format!("GET / HTTP/1.1\r\nX: {}", "x".repeat(HEAD_BYTES_MAX));
    let said = ended(&open(&long));
    assert!(said.starts_with("HTTP/1.1 431"), "{said}");
    let log = fs::read_to_string(daemon.folder.path().join("watch.log")).unwrap();
    assert!(!log.contains("out of reach"), "{log}");
}

/// How long the interface is thrown at; longer by `ENFILADE_FUZZ_SECS`.
const FUZZ_SECS: u64 = 3;

/// Whatever is sent, the answer is a refusal or an answer, never a fault, and the daemon goes on.
#[test]
fn the_interface_survives_anything() {
    let secs = std::env::var("ENFILADE_FUZZ_SECS").ok().and_then(|s| s.parse().ok()).unwrap_or(FUZZ_SECS);
    let daemon = start();
    let id = daemon.until_done("gallery.dxf");
    let (host, auth) = (format!("127.0.0.1:{}", daemon.port), format!("Bearer {}", daemon.token));
    let parts = [
        "GET",
        "POST",
        "PUT",
        " ",
        "/",
        "/api/drawings",
        &id,
        "/round-01",
        "/result.json",
        "/accept",
        "/again",
        "/cancel",
        "%00",
        "%2e%2e",
        "..",
        "\\",
        "?",
        "&token=",
        "\u{fc}",
        "HTTP/1.1",
        "\r\n",
        "\n",
        "\0",
        "Host: ",
        &host,
        "Authorization: ",
        &auth,
        "X-Enfilade: 1",
        "Content-Length: ",
        "99999999999999999999",
        "Transfer-Encoding: chunked",
        "{",
        "}",
        "\"round\": ",
        "-1",
        "4294967296",
        "\"candidate\": 0",
        "\"objective\": \"degree max 1e999\"",
        "null",
        "[[[[[[",
    ];
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(8);
    let (start, mut thrown) = (Instant::now(), 0u64);
    while start.elapsed() < Duration::from_secs(secs) {
        thrown += 1;
        let noise: String =
            (0..rng.random_range(1..12)).map(|_| parts[rng.random_range(0..parts.len())]).collect();
        if thrown % 2 == 0 {
            // As a body of an order that is allowed.
            let what = ["accept", "again", "cancel"][rng.random_range(0..3)];
            let answer = daemon.ask("POST", &format!("/api/drawings/{id}/{what}"), &noise);
            assert!(answer.status < 500, "{what} {noise:?}: {}", answer.head);
        } else {
            let mut stream = TcpStream::connect(("127.0.0.1", daemon.port)).unwrap();
            stream.set_read_timeout(Some(Duration::from_secs(2))).unwrap();
            let heads = format!("Host: {host}\r\nAuthorization: {auth}\r\nConnection: close\r\n\r\n");
            let sent = if thrown % 4 == 1 { format!("GET /{noise} HTTP/1.1\r\n{heads}") } else { noise };
            let _ = stream.write_all(sent.as_bytes());
            let _ = stream.shutdown(std::net::Shutdown::Write);
            let mut answer = Vec::new();
            let _ = stream.read_to_end(&mut answer);
            assert!(!answer.starts_with(b"HTTP/1.1 5"), "{sent:?}: {}", String::from_utf8_lossy(&answer));
        }
    }
    println!("{thrown} requests");
    assert_eq!(daemon.ask("GET", "/api/drawings", "").status, 200);
}

/// The listening sockets of that port have the addresses of this machine alone: nobody else can have the other one, which
/// browsers ask first for a name of this machine.
fn assert_loopback_only(port: u16) {
    let port = format!(":{port:04X}");
    for (table, own) in
        [("/proc/net/tcp", "0100007F"), ("/proc/net/tcp6", "00000000000000000000000001000000")]
    {
        let Ok(table) = fs::read_to_string(table) else { continue };
        let listens = table.lines().filter_map(|l| {
            let words: Vec<&str> = l.split_whitespace().collect();
            (words.get(3) == Some(&"0A") && words[1].ends_with(&port)).then(|| words[1].to_owned())
        });
        let wanted = std::net::TcpListener::bind(("::1", 0)).is_ok() || own.len() == 8;
        let wanted: Vec<String> = wanted.then(|| format!("{own}{port}")).into_iter().collect();
        assert_eq!(listens.collect::<Vec<_>>(), wanted);
    }
}

/// The token lies in a file of the user's alone, outside the watched folder.
fn assert_door_is_closed(home: &Path) {
    #[cfg(target_os = "linux")]
    {
        use std::os::unix::fs::PermissionsExt;
        let state = home.join(".local/state/enfilade");
        let door = fs::read_dir(&state).unwrap().next().unwrap().unwrap();
        assert_eq!(door.metadata().unwrap().permissions().mode() & 0o777, 0o600);
    }
    let open = Command::new(env!("CARGO_BIN_EXE_enfilade"))
        .args(["open", "--print"])
        .arg(home.join("plans"))
        .env("HOME", home)
        .env_remove("XDG_STATE_HOME")
        .output()
        .unwrap();
    assert!(String::from_utf8_lossy(&open.stdout).starts_with("http://"), "{open:?}");
}

/// The first round under another name.
fn copy_round(home: &Path, name: &str) {
    let to = home.join(name);
    fs::create_dir(&to).unwrap();
    for entry in fs::read_dir(home.join("round-01")).unwrap().map(|e| e.unwrap()) {
        fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
    }
}

/// A round with the first one's pictures and ten thousand options.
fn plant_ten_thousand(home: &Path) {
    let [from, to] = ["round-01", "round-00"].map(|r| home.join(r));
    copy_round(home, "round-00");
    let mut result: Value = serde_json::from_slice(&fs::read(from.join("result.json")).unwrap()).unwrap();
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(10);
    let shaken = |value: &mut Value, rng: &mut rand_chacha::ChaCha8Rng| {
        *value = json!(value.as_f64().unwrap_or(0.0) * rng.random_range(0.5..1.5));
    };
    let first = result["candidates"].as_array().unwrap().clone();
    let many = (0..10_000).map(|i| {
        let mut option = first[i % first.len()].clone();
        option["mean"].as_object_mut().unwrap().values_mut().for_each(|v| shaken(v, &mut rng));
        shaken(&mut option["score"], &mut rng);
        option["parameters"].as_array_mut().unwrap().iter_mut().for_each(|v| shaken(v, &mut rng));
        option
    });
    result["candidates"] = many.collect::<Vec<_>>().into();
    fs::write(to.join("result.json"), result.to_string()).unwrap();
}

/// Where the modules named in `tests/program/page/README.md` are; `None`, and said, where browsers need not be tested.
fn modules() -> Option<std::ffi::OsString> {
    let modules = std::env::var_os("ENFILADE_NODE_MODULES");
    if modules.is_none() {
        assert!(
            std::env::var_os("ENFILADE_HOSTS").is_none_or(|v| v != "required"),
            "no puppeteer-core and axe-core; scripts/setup installs them"
        );
        println!("skipped: ENFILADE_NODE_MODULES names no folder with puppeteer-core and axe-core");
    }
    modules
}

/// A script of `tests/program/page` with the page's address and what else it is to know; it must find no fault.
fn browse(daemon: &Daemon, modules: std::ffi::OsString, script: &str, told: &str) {
    let out = Command::new("node")
        .arg(enfilade_fixtures::repository("tests/program/page").join(script))
        .arg(format!("http://127.0.0.1:{}/#key={}", daemon.port, daemon.key))
        .arg(told)
        .env("HOME", daemon.folder.path())
        .env_remove("XDG_STATE_HOME")
        .env("NODE_PATH", modules)
        .output()
        .unwrap();
    let [said, faults] = [&out.stdout, &out.stderr].map(|b| String::from_utf8_lossy(b));
    assert!(out.status.success(), "{said}\n{faults}");
    println!("{said}");
}

/// What was the only drawing is not shown on, with buttons, once it is gone.
#[test]
fn a_browser_shows_no_drawing_that_is_gone() {
    let Some(modules) = modules() else { return };
    let daemon = start();
    daemon.until_done("gallery.dxf");
    browse(&daemon, modules, "gone.mjs", daemon.plans().join("gallery.dxf").to_str().unwrap());
}

/// Another drawing that goes changes the list alone: what is open, filtered, typed and chosen stays.
#[test]
fn a_browser_keeps_what_is_looked_at_when_another_drawing_goes() {
    let Some(modules) = modules() else { return };
    let daemon = start();
    let other = daemon.plans().join("other.dxf");
    fs::write(&other, "0\nSECTION\n2\nENTITIES\nx\n0\n0\nEOF\n").unwrap();
    daemon.until_done("gallery.dxf");
    daemon.until("the other", || daemon.drawing("other.dxf").filter(|d| d["state"] == "failed"));
    browse(&daemon, modules, "another.mjs", other.to_str().unwrap());
}

/// Ten tabs at once: each gets the news, and each finds the daemon again once it was started anew.
#[test]
fn a_browser_has_as_many_tabs_as_it_likes() {
    let Some(modules) = modules() else { return };
    let daemon = start();
    daemon.until_done("gallery.dxf");
    let again = json!({
        "pid": daemon.child.id(),
        "program": env!("CARGO_BIN_EXE_enfilade"),
        "args": ["watch", "--page", daemon.plans().display().to_string()],
        "drawing": daemon.plans().join("gallery.dxf"),
    });
    browse(&daemon, modules, "tabs.mjs", &again.to_string());
}

/// Whoever had the port while the daemon was down left a worker and a page that lasts: no link leads there, and a link
/// with another key takes nobody's key away.
#[test]
fn a_browser_is_led_where_nobody_was_before() {
    let Some(modules) = modules() else { return };
    let daemon = start();
    daemon.until_done("gallery.dxf");
    let told = json!({
        "pid": daemon.child.id(),
        "program": env!("CARGO_BIN_EXE_enfilade"),
        "folder": daemon.plans().display().to_string(),
    });
    browse(&daemon, modules, "addresses.mjs", &told.to_string());
}

/// Chromium with every action of the page, and axe.
#[test]
fn a_browser_does_every_action() {
    let Some(modules) = modules() else { return };
    let daemon = start_with("gallery.dxf", "seed = 3\n[watch]\ndepth = 1\n");
    fs::copy(daemon.plans().join("gallery.dxf"), daemon.plans().join("<img src=x onerror=alert(1)>.dxf"))
        .unwrap();
    daemon.until_done("gallery.dxf");
    plant_ten_thousand(&daemon.plans().join("gallery.enfilade"));
    copy_round(&daemon.plans().join("gallery.enfilade"), "so-far");
    fs::write(daemon.plans().join("#<b>.dxf"), "").unwrap();
    // A list longer than a phone, a name in two folders, and one that would turn the direction of writing.
    fs::create_dir(daemon.plans().join("<i>wing")).unwrap();
    let sheets = (1..=30).map(|n| format!("sheet-{n:02}.dxf"));
    let broken = ["broken.dxf", "<i>wing/broken.dxf", "\u{202e}fxd.thgir.dxf"].map(str::to_owned);
    let unreadable: Vec<String> = sheets.chain(broken).collect();
    for name in &unreadable {
        fs::write(daemon.plans().join(name), "0\nSECTION\n2\nENTITIES\nx\n0\n0\nEOF\n").unwrap();
    }
    daemon.until("every drawing", || {
        let all = daemon.json("/api/drawings")["drawings"].as_array().cloned()?;
        let is_over = |d: &Value| d["state"] == "done" || d["state"] == "failed";
        // The gallery and its copy, too.
        (all.len() == unreadable.len() + 2 && all.iter().all(is_over)).then_some(())
    });
    let restart = json!({
        "pid": daemon.child.id(),
        "program": env!("CARGO_BIN_EXE_enfilade"),
        "args": ["watch", format!("--page={}", daemon.port), "--evaluations", "60", daemon.plans().display().to_string()],
    });
    browse(&daemon, modules, "drive.mjs", &restart.to_string());
    assert!(daemon.plans().join("gallery-r02.dxf").is_file(), "nothing was accepted");
    assert_eq!(daemon.round_settings("round-02")["like"].as_array().map(Vec::is_empty), Some(false));
    assert_eq!(daemon.round_settings("round-02")["pinned"].as_array().map(Vec::len), Some(1));
    assert_eq!(daemon.round_settings("round-03")["pinned"].as_array().map(Vec::len), Some(1));
    assert_eq!(daemon.round_settings("round-03")["objectives"][0]["threshold"], 0.5);
}

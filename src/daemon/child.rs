//! A job in a process of its own: what a drawing makes it do (hang, eat memory, die) ends with it, is told with
//! its reason, and the next drawing is taken up (hazard 23).
//!
//! The parent writes one [`Request`] to the child's standard input and leaves it open: its end, with the parent's,
//! is the child's end; one more byte asks for the best so far. The child answers on standard output in frames: a line
//! of JSON, then the bytes it announces.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::turns::SHORT;
use super::{Asked, JobEvent, JobOutput, JobRequest, OutFile, RunJob, Share};
use crate::worked::Work;
use enfilade_report::{Cancel, Error, KEEP_GRACE, Place, Problem, Severity};

/// Code of a job that needs more memory than it may have.
pub(super) const OUT_OF_MEMORY: &str = "job-out-of-memory";
/// Code of a job whose process was ended from outside.
pub(super) const JOB_KILLED: &str = "job-killed";

/// A job says so often how much processor time it has taken.
const WORK_SAID: Duration = Duration::from_millis(500);

/// A stop is seen within this time.
const LOOK: Duration = Duration::from_millis(20);
/// A child whose answers have ended is given this long to end by itself, so that the reason told is its own.
const ENDING: Duration = Duration::from_secs(5);
/// Of what a child says on standard error, the last bytes are kept.
const WORDS_BYTES_MAX: usize = 8 << 10;
/// Most bytes of one line of a frame.
const LINE_BYTES_MAX: u64 = 64 << 20;
/// How far a long job stands back: beside an ordinary one it has about a tenth of the processor.
#[cfg(target_os = "linux")]
const LONG_NICE: i32 = 10;
/// Most bytes of one frame.
const FRAME_BYTES_MAX: u64 = 4 << 30;

/// What a job's process is allowed, and how it is started.
#[derive(Clone, Debug)]
pub struct Limits {
    /// The program with its arguments; the drawing's path follows them.
    pub program: OsString,
    /// See `program`.
    pub args: Vec<OsString>,
    /// Handed to the job as it is.
    pub options: Value,
    /// Memory, bytes; `None`: what the machine has.
    pub memory_bytes: Option<u64>,
    /// Seconds of all cores together; the daemon watches the clock.
    pub cpu_secs: Option<u64>,
    /// Seconds of work in which the drawing must be understood.
    pub read_secs: Option<f64>,
}

impl Limits {
    /// Memory of this job, bytes.
    fn memory_of(&self, request: &JobRequest) -> Option<u64> {
        request.share.memory_bytes.or(self.memory_bytes)
    }
}

/// What a child is asked.
#[derive(Debug, Serialize, Deserialize)]
pub struct Request {
    version: String,
    sha256: String,
    round: u32,
    asked: Asked,
    /// As in [`Limits`].
    pub options: Value,
    memory_bytes: Option<u64>,
    cpu_secs: Option<u64>,
    read_secs: Option<f64>,
    is_long: bool,
    bytes: u64,
    earlier: u64,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum Frame {
    Progress { value: Value },
    Analysis { files: Vec<(PathBuf, u64)> },
    SoFar { files: Vec<(PathBuf, u64)>, progress: Value },
    Keep { is_anew: bool, bytes: u64 },
    Worked { secs: f64 },
    Done { files: Vec<(PathBuf, u64)>, is_degraded: bool, summary: String },
    Failed { exit_code: u8, problem: Option<Told> },
}

/// A [`Problem`] on its way.
#[derive(Debug, Serialize, Deserialize)]
struct Told {
    code: String,
    file: String,
    line: Option<usize>,
    entity: String,
    text: String,
}

/// Runs a job in a process of its own.
///
/// # Errors
/// Those of the job; `job-out-of-memory`, `job-too-long`, `job-panicked`, `job-died` where the process ended
/// without an answer; [`Error::Environment`] where none could be started; [`Error::Stopped`] within 50 ms.
pub fn run(
    limits: &Limits,
    request: &JobRequest,
    tell: &mut dyn FnMut(JobEvent),
    cancel: &Cancel,
) -> Result<JobOutput, Error> {
    let name = request.drawing.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut child = start(limits, request, &name)?;
    let (stdin, stdout, stderr) = (child.stdin.take(), child.stdout.take(), child.stderr.take());
    let head = Request::of(limits, request);
    let (bytes, earlier) = (request.bytes.clone(), request.earlier.clone());
    let (ask, asked) = mpsc::channel::<()>();
    // Held open until the job has ended: see the module.
    let writer = thread::spawn(move || {
        let mut stdin = stdin?;
        let line = serde_json::to_vec(&head).ok()?;
        // A child that died does not read; its end says why.
        let parts: [&[u8]; 4] = [&line, b"\n", &bytes, &earlier];
        parts.iter().try_for_each(|p| stdin.write_all(p)).and_then(|()| stdin.flush()).ok()?;
        asked.iter().try_for_each(|()| stdin.write_all(b"\n").and_then(|()| stdin.flush())).ok()
    });
    let (send, frames) = mpsc::sync_channel(16);
    let reader = thread::spawn(move || {
        let mut from = BufReader::new(stdout?);
        while let Ok(Some(frame)) = read_frame(&mut from) {
            send.send(frame).ok()?;
        }
        Some(())
    });
    let words = thread::spawn(move || stderr.map_or_else(Vec::new, last_words));
    let outcome = attend(&frames, &ask, tell, cancel);
    drop(frames);
    // It has answered, or nobody wants an answer any more, or no answer can come: then its own end has the reason.
    let its_end = if matches!(outcome, Ok(None)) { own_end(&mut child, ENDING) } else { None };
    let _ = child.kill();
    let _ = child.wait();
    drop(ask);
    let _ = (writer.join(), reader.join());
    let words = words.join().unwrap_or_default();
    match outcome? {
        Some(output) => Ok(output),
        None => Err(end_of(
            &name,
            (limits.memory_of(request), limits.cpu_secs),
            its_end,
            &String::from_utf8_lossy(&words),
        )),
    }
}

/// How a child ended by itself; `None` where it still runs after `patience`.
fn own_end(child: &mut Child, patience: Duration) -> Option<io::Result<ExitStatus>> {
    let began = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return Some(Ok(status)),
            Err(e) => return Some(Err(e)),
            Ok(None) if began.elapsed() >= patience => return None,
            Ok(None) => thread::sleep(LOOK),
        }
    }
}

fn start(limits: &Limits, request: &JobRequest, name: &str) -> Result<Child, Error> {
    let mut command = Command::new(&limits.program);
    command.args(&limits.args).args([&request.drawing, &request.results]);
    // The reason is in the first line, which a backtrace would push out of what is kept.
    command.env("RUST_BACKTRACE", "0");
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().map_err(|e| {
        let text = format!("the job's process could not be started: {e}");
        Error::environment("job-start", Place::file(name), text)
    })
}

impl Request {
    fn of(limits: &Limits, request: &JobRequest) -> Self {
        Self {
            version: enfilade_config::VERSION.into(),
            sha256: request.sha256.clone(),
            round: request.round,
            asked: request.asked.clone(),
            options: limits.options.clone(),
            memory_bytes: limits.memory_of(request),
            cpu_secs: limits.cpu_secs,
            read_secs: limits.read_secs,
            is_long: request.share.is_long,
            bytes: request.bytes.len() as u64,
            earlier: request.earlier.len() as u64,
        }
    }
}

type Parcel = (Frame, Vec<Vec<u8>>);

/// Hands on what the child tells, until it has answered (`Some`), has ended without (`None`), or is to stop. One that is
/// stopped for its best is asked for it, and has [`KEEP_GRACE`].
fn attend(
    frames: &mpsc::Receiver<Parcel>,
    ask: &mpsc::Sender<()>,
    tell: &mut dyn FnMut(JobEvent),
    cancel: &Cancel,
) -> Result<Option<JobOutput>, Error> {
    let mut asked: Option<Instant> = None;
    loop {
        if cancel.is_stopped() {
            let is_waited_for = cancel.keeps_best() && asked.is_none_or(|t| t.elapsed() < KEEP_GRACE);
            if !is_waited_for || asked.is_none() && ask.send(()).is_err() {
                return Err(Error::Stopped);
            }
            asked.get_or_insert_with(Instant::now);
        }
        let (frame, mut parts) = match frames.recv_timeout(LOOK) {
            Ok(parcel) => parcel,
            Err(RecvTimeoutError::Timeout) => continue,
            Err(RecvTimeoutError::Disconnected) => return Ok(None),
        };
        match frame {
            Frame::Progress { value } => tell(JobEvent::Progress(value)),
            Frame::Analysis { files } => tell(JobEvent::Analysis(out_files(files, parts))),
            Frame::SoFar { files, progress } => {
                tell(JobEvent::SoFar { files: out_files(files, parts), progress })
            }
            Frame::Worked { secs } => {
                // A child that says nonsense has said nothing.
                Duration::try_from_secs_f64(secs).into_iter().for_each(|d| tell(JobEvent::Worked(d)));
            }
            Frame::Keep { is_anew, .. } => {
                tell(JobEvent::Keep { bytes: parts.pop().unwrap_or_default(), is_anew })
            }
            Frame::Done { files, is_degraded, summary } => {
                return Ok(Some(JobOutput { files: out_files(files, parts), is_degraded, summary }));
            }
            Frame::Failed { exit_code, problem } => return Err(error_of(exit_code, problem)),
        }
    }
}

fn out_files(names: Vec<(PathBuf, u64)>, parts: Vec<Vec<u8>>) -> Vec<OutFile> {
    names.into_iter().zip(parts).map(|((path, _), bytes)| OutFile { path, bytes }).collect()
}

impl Frame {
    /// Lengths of the byte strings that follow.
    fn lengths(&self) -> Vec<u64> {
        match self {
            Self::Analysis { files } | Self::SoFar { files, .. } | Self::Done { files, .. } => {
                files.iter().map(|f| f.1).collect()
            }
            Self::Keep { bytes, .. } => vec![*bytes],
            Self::Progress { .. } | Self::Worked { .. } | Self::Failed { .. } => Vec::new(),
        }
    }
}

/// The next frame; `None` at the end of all.
fn read_frame(from: &mut impl BufRead) -> io::Result<Option<Parcel>> {
    let mut line = Vec::new();
    if from.by_ref().take(LINE_BYTES_MAX).read_until(b'\n', &mut line)? == 0 {
        return Ok(None);
    }
    let frame: Frame = serde_json::from_slice(&line)?;
    let lengths = frame.lengths();
    if lengths.iter().fold(0, |a: u64, b| a.saturating_add(*b)) > FRAME_BYTES_MAX {
        return Err(io::ErrorKind::FileTooLarge.into());
    }
    let parts = lengths.into_iter().map(|n| read_exactly(from, n)).collect::<io::Result<_>>()?;
    Ok(Some((frame, parts)))
}

fn read_exactly(from: &mut impl Read, length: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = from.take(length).read_to_end(&mut bytes)? as u64;
    if read < length { Err(io::ErrorKind::UnexpectedEof.into()) } else { Ok(bytes) }
}

fn last_words(mut from: impl Read) -> Vec<u8> {
    let (mut kept, mut buffer) = (Vec::new(), [0u8; 4096]);
    while let Ok(n @ 1..) = from.read(&mut buffer) {
        kept.extend_from_slice(&buffer[..n]);
        kept.drain(..kept.len().saturating_sub(WORDS_BYTES_MAX));
    }
    kept
}

/// Why a process ended without an answer; `status` is that of its own end, `None` where it had to be ended.
fn end_of(
    name: &str,
    (memory_bytes, cpu_secs): (Option<u64>, Option<u64>),
    status: Option<io::Result<ExitStatus>>,
    words: &str,
) -> Error {
    let last = words.lines().rev().find(|l| !l.trim().is_empty()).unwrap_or("without a word").trim();
    let Some(status) = status else {
        let text = "the job's process gave no answer that is understood and was ended";
        let text = format!("{text}: {last}; please report it with the drawing; the next drawing is taken up");
        return Error::input("job-died", Place::file(name), text);
    };
    if status.as_ref().ok().and_then(ExitStatus::code) == Some(i32::from(Error::Stopped.exit_code())) {
        return Error::Stopped;
    }
    let how = status.map_or_else(|e| e.to_string(), |s| s.to_string());
    let (code, text) = if words.contains("memory allocation of") {
        let limit = memory_bytes.map_or("what there is".into(), |b| format!("{} MB", b >> 20));
        (OUT_OF_MEMORY, format!("the job needs more memory than {limit} (job-memory-mb) and was ended"))
    } else if is_out_of_time(&how) {
        let limit = cpu_secs.unwrap_or_default();
        (
            "job-too-long",
            format!(
                "the job needs more than {limit} s of processor time (job-limit-secs a core) and was ended"
            ),
        )
    } else if is_killed(&how) {
        let text = "the job's process was killed from outside, as the system does where memory is short";
        return Error::environment(JOB_KILLED, Place::file(name), text);
    } else if let Some(panic) = words.lines().position(|l| l.contains("panicked at")) {
        let said: Vec<&str> = words.lines().skip(panic + 1).take(1).collect();
        let text = "this is an error of the program, please report it with the drawing";
        ("job-panicked", format!("{text}: {}", said.concat()))
    } else {
        let text = format!("the job's process ended ({how}): {last}; please report it with the drawing");
        ("job-died", text)
    };
    Error::input(code, Place::file(name), format!("{text}; the next drawing is taken up"))
}

/// Whether a process ended by SIGXCPU, in the words of the standard library.
fn is_out_of_time(how: &str) -> bool {
    how.contains("SIGXCPU")
}

/// Whether a process ended by SIGKILL, which comes from outside only.
fn is_killed(how: &str) -> bool {
    how.contains("SIGKILL")
}

/// An [`Error`] by its exit code, the one number that both ends know it by.
fn error_of(exit_code: u8, problem: Option<Told>) -> Error {
    let Some(told) = problem else { return Error::Stopped };
    let place = Place { file: told.file, line: told.line, entity: told.entity };
    let problem = Problem { code: known(told.code), severity: Severity::Error, place, text: told.text };
    match exit_code {
        2 => Error::Input(problem),
        3 => Error::Usage(problem),
        _ => Error::Environment(problem),
    }
}

/// A problem's code for as long as the process lives; each is kept once, and there are as many as the program has.
fn known(code: String) -> &'static str {
    static CODES: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut codes = CODES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = codes.get(code.as_str()) {
        return known;
    }
    let kept: &'static str = Box::leak(code.into_boxed_str());
    codes.insert(kept);
    kept
}

/// The child's part: reads the request from standard input, does the job under its limits, answers on standard
/// output. `prepare` makes the job of the request's options.
///
/// # Errors
/// [`Error::Usage`] for a request that is none or of another version; else what is answered is no error here.
pub fn serve(
    drawing: &Path,
    results: &Path,
    prepare: impl FnOnce(Value) -> Result<Arc<RunJob>, Error>,
) -> Result<(), Error> {
    let mut from = BufReader::new(io::stdin());
    let (head, request) = read_request(&mut from, drawing, results).map_err(|e| {
        Error::usage(
            "job-request",
            Place::default(),
            format!("no request of a daemon: {e}; nothing was done"),
        )
    })?;
    if head.version != enfilade_config::VERSION {
        let text = "the program was replaced while the daemon runs; start the daemon again";
        return answer(&Err(Error::environment("job-version", Place::default(), text)));
    }
    limit(&head);
    count_work(head.is_long);
    let cancel = Cancel::default();
    let on_stop = cancel.clone();
    thread::spawn(move || {
        let mut word = [0];
        while from.read(&mut word).is_ok_and(|n| n > 0) {
            on_stop.stop_keeping();
        }
        std::process::exit(i32::from(Error::Stopped.exit_code()));
    });
    let reading = Reading::watch(head.read_secs, &cancel);
    let mut tell = |event: JobEvent| {
        if !event.is_reading() {
            reading.is_understood.store(true, Ordering::Relaxed);
        }
        let _ = match event {
            JobEvent::Progress(value) => send(&Frame::Progress { value }, &[]),
            JobEvent::Worked(worked) => send(&Frame::Worked { secs: worked.as_secs_f64() }, &[]),
            JobEvent::Analysis(files) => send(&Frame::Analysis { files: names(&files) }, &parts(&files)),
            JobEvent::SoFar { files, progress } => {
                send(&Frame::SoFar { files: names(&files), progress }, &parts(&files))
            }
            JobEvent::Keep { bytes, is_anew } => {
                send(&Frame::Keep { is_anew, bytes: bytes.len() as u64 }, &[&bytes])
            }
        };
    };
    let outcome = prepare(head.options).and_then(|job| job(&request, &mut tell, &cancel));
    answer(&outcome.map_err(|e| reading.reason(drawing, e)))
}

/// A drawing that takes more work to be read than it may.
pub(super) fn reading_too_long(drawing: &Path, limit_secs: f64) -> Error {
    let text = format!(
        "reading the drawing took longer than the limit of {limit_secs} s of work (read-limit-secs), and the job was \
         stopped: draw less on the layers of walls, or raise the limit"
    );
    Error::input(
        "reading-too-long",
        Place::file(drawing.file_name().unwrap_or_default().to_string_lossy()),
        text,
    )
}

/// Whether a drawing is understood within its limit of work.
struct Reading {
    limit_secs: Option<f64>,
    is_understood: Arc<AtomicBool>,
    is_late: Arc<AtomicBool>,
}

impl Reading {
    /// Stops what is late.
    fn watch(limit_secs: Option<f64>, cancel: &Cancel) -> Self {
        let of = Self { limit_secs, is_understood: Arc::default(), is_late: Arc::default() };
        let Some(limit) = limit_secs.map(Duration::from_secs_f64) else { return of };
        let (understood, late, cancel) = (of.is_understood.clone(), of.is_late.clone(), cancel.clone());
        let work = Work::begin();
        thread::spawn(move || {
            while !understood.load(Ordering::Relaxed) {
                if work.is_over(limit) {
                    late.store(true, Ordering::Relaxed);
                    return cancel.stop();
                }
                thread::sleep(LOOK);
            }
        });
        of
    }

    /// Why the job ended.
    fn reason(&self, drawing: &Path, error: Error) -> Error {
        match self.limit_secs {
            Some(limit) if matches!(error, Error::Stopped) && self.is_late.load(Ordering::Relaxed) => {
                reading_too_long(drawing, limit)
            }
            _ => error,
        }
    }
}

fn read_request(
    from: &mut impl BufRead,
    drawing: &Path,
    results: &Path,
) -> io::Result<(Request, JobRequest)> {
    let mut line = Vec::new();
    from.by_ref().take(LINE_BYTES_MAX).read_until(b'\n', &mut line)?;
    let head: Request = serde_json::from_slice(&line)?;
    let bytes = read_exactly(from, head.bytes)?;
    let earlier = read_exactly(from, head.earlier)?;
    let request = JobRequest {
        drawing: drawing.into(),
        bytes: Arc::new(bytes),
        sha256: head.sha256.clone(),
        content: String::new(),
        config: String::new(),
        share: Share { memory_bytes: head.memory_bytes, is_long: head.is_long },
        round: head.round,
        asked: head.asked.clone(),
        earlier: Arc::new(earlier),
        results: results.into(),
    };
    Ok((head, request))
}

fn answer(outcome: &Result<JobOutput, Error>) -> Result<(), Error> {
    let sent = match outcome {
        Ok(JobOutput { files, is_degraded, summary }) => {
            let (is_degraded, summary) = (*is_degraded, summary.clone());
            send(&Frame::Done { files: names(files), is_degraded, summary }, &parts(files))
        }
        Err(error) => {
            let problem = error.problem().map(|p| Told {
                code: p.code.into(),
                file: p.place.file.clone(),
                line: p.place.line,
                entity: p.place.entity.clone(),
                text: p.text.clone(),
            });
            send(&Frame::Failed { exit_code: error.exit_code(), problem }, &[])
        }
    };
    sent.map_err(|e| Error::environment("job-answer", Place::default(), e.to_string()))
}

fn names(files: &[OutFile]) -> Vec<(PathBuf, u64)> {
    files.iter().map(|f| (f.path.clone(), f.bytes.len() as u64)).collect()
}

fn parts(files: &[OutFile]) -> Vec<&[u8]> {
    files.iter().map(|f| f.bytes.as_slice()).collect()
}

fn send(frame: &Frame, parts: &[&[u8]]) -> io::Result<()> {
    let mut out = io::stdout().lock();
    serde_json::to_writer(&mut out, frame)?;
    out.write_all(b"\n")?;
    parts.iter().try_for_each(|p| out.write_all(p))?;
    out.flush()
}

/// The system holds the job to its limits. Where it cannot be told to, the daemon's clock remains.
#[cfg(unix)]
fn limit(head: &Request) {
    use rustix::process::{Resource, Rlimit, setrlimit};
    // Address space would count what graphics drivers reserve and never use.
    let memory = if cfg!(target_os = "linux") { Resource::Data } else { Resource::As };
    let limits = [(memory, head.memory_bytes), (Resource::Cpu, head.cpu_secs), (Resource::Core, Some(0))];
    for (what, most) in limits {
        if most.is_some() {
            let _ = setrlimit(what, Rlimit { current: most, maximum: most });
        }
    }
}

#[cfg(not(unix))]
fn limit(_: &Request) {}

/// Says now and then how much processor time the job has taken; from [`SHORT`] on it leaves the processor to shorter
/// ones.
fn count_work(is_long: bool) {
    if is_long {
        stand_back();
    }
    let (work, mut is_back) = (Work::begin(), is_long);
    thread::spawn(move || {
        loop {
            thread::sleep(WORK_SAID);
            let worked = work.worked();
            if worked > SHORT && !is_back {
                is_back = true;
                stand_back();
            }
            // Nobody listens any more: the job ends by that too.
            if send(&Frame::Worked { secs: worked.as_secs_f64() }, &[]).is_err() {
                return;
            }
        }
    });
}

/// Leaves the processor to others. Linux keeps a priority for each thread; those that begin later have that of the one
/// that began them.
#[cfg(target_os = "linux")]
fn stand_back() {
    use rustix::process::{Pid, setpriority_process};
    let threads = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let ids = threads.filter_map(|t| t.file_name().to_str()?.parse().ok().and_then(Pid::from_raw));
    // A thread that has just ended needs none.
    ids.for_each(|id| {
        let _ = setpriority_process(Some(id), LONG_NICE);
    });
}

#[cfg(not(target_os = "linux"))]
fn stand_back() {}

#[cfg(unix)]
#[cfg(test)]
mod tests {
    use super::*;

    fn shell(script: &str) -> Limits {
        let args = ["-c", script, "job"].map(OsString::from).to_vec();
        let memory_bytes = Some(64 << 20);
        Limits {
            program: "/bin/sh".into(),
            args,
            options: Value::Null,
            memory_bytes,
            cpu_secs: Some(7),
            read_secs: None,
        }
    }

    fn request() -> JobRequest {
        JobRequest {
            drawing: "/plans/-plan.dxf".into(),
            bytes: Arc::new(vec![7; 100_000]),
            sha256: "ab".into(),
            content: String::new(),
            config: String::new(),
            share: Share::default(),
            round: 3,
            asked: Asked {
                objective: Some("degree max".into()),
                round: Some(2),
                so_far: None,
                pin: vec![1, 3],
                like: Some(2),
            },
            earlier: Arc::new(b"earlier".to_vec()),
            results: "/plans/-plan.enfilade".into(),
        }
    }

    fn end(script: &str) -> (&'static str, String) {
        let error = run(&shell(script), &request(), &mut |_| {}, &Cancel::default()).unwrap_err();
        let problem = error.problem().unwrap();
        (problem.code, problem.text.clone())
    }

    #[test]
    fn what_a_child_tells_arrives_whole() {
        let script = r#"echo '{"kind":"progress","value":{"done":1}}'
            printf '{"kind":"analysis","files":[["a.png",3],["b.png",0]]}\nabc'
            printf '{"kind":"keep","is_anew":true,"bytes":2}\nxy'
            printf '{"kind":"done","files":[["c.dxf",4]],"is_degraded":true,"summary":"one"}\n'; echo EOF; exec sleep 60"#;
        let mut told = Vec::new();
        let output = run(&shell(script), &request(), &mut |e| told.push(e), &Cancel::default()).unwrap();
        assert_eq!(output.files, [OutFile::new("c.dxf", "EOF\n")]);
        assert_eq!((output.is_degraded, output.summary.as_str()), (true, "one"));
        let JobEvent::Progress(value) = &told[0] else { panic!("{told:?}") };
        assert_eq!(value["done"], 1);
        let JobEvent::Analysis(files) = &told[1] else { panic!("{told:?}") };
        assert_eq!(files, &[OutFile::new("a.png", "abc"), OutFile::new("b.png", "")]);
        assert!(matches!(&told[2], JobEvent::Keep { bytes, is_anew: true } if bytes == b"xy"));
    }

    /// One who asks for the best so far gets it before the child's end; one who does not wait gets nothing.
    #[test]
    fn a_child_that_is_stopped_may_leave_its_best() {
        let mut asked = serde_json::to_vec(&Request::of(&shell(""), &request())).unwrap();
        asked.extend([b"\n", &request().bytes[..], &request().earlier[..]].concat());
        let script = format!(
            r#"echo '{{"kind":"progress","value":{{}}}}'; head -c {} >/dev/null; head -c 1 >/dev/null
            printf '{{"kind":"sofar","files":[["a.dxf",3]],"progress":{{}}}}\nabc'
            echo '{{"kind":"failed","exit_code":5,"problem":null}}'; exec sleep 60"#,
            asked.len()
        );
        for is_kept in [true, false] {
            let (cancel, mut told) = (Cancel::default(), Vec::new());
            let stop = |event| {
                if is_kept {
                    cancel.stop_keeping()
                } else {
                    cancel.stop()
                }
                told.push(event);
            };
            let mut stop = stop;
            let end = run(&shell(&script), &request(), &mut stop, &cancel);
            assert!(matches!(end, Err(Error::Stopped)), "{end:?}");
            let files = told
                .iter()
                .filter_map(|e| if let JobEvent::SoFar { files, .. } = e { Some(files) } else { None });
            let found: Vec<_> = files.collect();
            assert_eq!(found.len(), usize::from(is_kept));
            assert!(found.iter().all(|f| **f == [OutFile::new("a.dxf", "abc")]));
        }
    }

    /// A child that talks without end is heard no further than the limits.
    #[test]
    fn what_a_child_says_is_bounded() {
        let words = [vec![b'a'; WORDS_BYTES_MAX], vec![b'z'; WORDS_BYTES_MAX]].concat();
        assert_eq!(last_words(&words[..]), vec![b'z'; WORDS_BYTES_MAX]);
        assert!(read_frame(&mut BufReader::new(io::repeat(b' '))).is_err());
        let announced = |bytes: u64| {
            let line = serde_json::to_vec(&Frame::Keep { is_anew: true, bytes }).unwrap();
            read_frame(&mut &[&line[..], b"\n"].concat()[..]).unwrap_err().kind()
        };
        assert_eq!(announced(FRAME_BYTES_MAX), io::ErrorKind::UnexpectedEof);
        assert_eq!(announced(FRAME_BYTES_MAX + 1), io::ErrorKind::FileTooLarge);
    }

    /// The request as the child reads it is the request as it was made.
    #[test]
    fn a_request_survives_its_way() {
        let head = Request::of(&shell(""), &request());
        let mut bytes = serde_json::to_vec(&head).unwrap();
        bytes.push(b'\n');
        bytes.extend(request().bytes.iter().chain(request().earlier.iter()));
        let here = (Path::new("/plans/-plan.dxf"), Path::new("/plans/-plan.enfilade"));
        let (head, back) = read_request(&mut &bytes[..], here.0, here.1).unwrap();
        assert_eq!((head.memory_bytes, head.cpu_secs), (Some(64 << 20), Some(7)));
        assert_eq!((back.bytes, back.earlier, back.round), (request().bytes, request().earlier, 3));
        assert_eq!(back.asked, request().asked);
        bytes.pop();
        assert!(read_request(&mut &bytes[..], here.0, here.1).is_err(), "a request cut short is none");
    }

    /// Hazard 23: however a process ends, the reason is told.
    #[test]
    fn every_end_has_its_reason() {
        for (script, code, word) in [
            ("echo 'memory allocation of 9 bytes failed' >&2; kill -ABRT $$", "job-out-of-memory", "64 MB"),
            ("kill -XCPU $$", "job-too-long", "7 s"),
            ("printf \"thread 'x' panicked at a.rs:1:\\nwall 7\\n\" >&2; exit 101", "job-panicked", "wall 7"),
            ("echo tired >&2; kill -SEGV $$", "job-died", "tired"),
            ("exit 0", "job-died", "without a word"),
            ("kill -KILL $$", JOB_KILLED, "from outside"),
            ("echo 'no frame'; exit 1", "job-died", "exit status: 1"),
            // What it does after its last frame is its own end still.
            ("exec >&-; sleep 0.2; echo tired >&2; exit 3", "job-died", "exit status: 3): tired"),
            ("echo 'no frame'; sleep 0.2; kill -XCPU $$", "job-too-long", "7 s"),
        ] {
            let (found, text) = end(script);
            assert_eq!(found, code, "{script}: {text}");
            assert!(text.contains(word), "{script}: {text}");
        }
        let failed = r#"echo '{"kind":"failed","exit_code":2,"problem":{"code":"dxf-x","file":"p.dxf","line":5,"entity":"","text":"bad"}}'"#;
        let error = run(&shell(failed), &request(), &mut |_| {}, &Cancel::default()).unwrap_err();
        assert_eq!((error.exit_code(), error.to_string().as_str()), (2, "p.dxf:5: bad"));
        let lost = Limits { program: "/no/such/program".into(), ..shell("") };
        let error = run(&lost, &request(), &mut |_| {}, &Cancel::default()).unwrap_err();
        assert_eq!(error.exit_code(), 4);
    }

    /// A child without an answer that does not end is ended, which nobody outside did.
    #[test]
    fn a_child_that_stays_without_an_answer_is_ended() {
        let began = Instant::now();
        let (code, text) = end("exec >&-; echo waiting >&2; exec sleep 600");
        assert_eq!(code, "job-died", "{text}");
        assert!(text.contains("was ended: waiting"), "{text}");
        assert!(began.elapsed() >= ENDING, "it was given no time");
    }

    /// A child that hears nothing is ended, and everything that waits for it goes on.
    #[test]
    fn a_deaf_child_is_killed_by_a_stop() {
        let cancel = Cancel::default();
        let (stop, began) = (cancel.clone(), Instant::now());
        let script = r#"echo '{"kind":"progress","value":1}'; exec sleep 600"#;
        let outcome = run(&shell(script), &request(), &mut |_| stop.stop(), &cancel);
        assert!(matches!(outcome, Err(Error::Stopped)));
        assert!(began.elapsed() < Duration::from_secs(300), "the sleeper was waited for");
    }
}

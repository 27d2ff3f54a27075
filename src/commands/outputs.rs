//! Where a command may write: no output takes the place of a drawing, of its settings, or of another output.

use std::path::{Path, PathBuf};

use super::is_standard_output;
use crate::cli::{AnalyseArgs, Command, Common, ServiceCommand};
use crate::watch::{bytes_of, is_data};
use enfilade_cad::ENDINGS;
use enfilade_config::{is_settings, settings_files};
use enfilade_report::{Error, Place, Report};

/// What the user names to be written.
struct Output<'a> {
    option: &'static str,
    path: &'a Path,
    is_folder: bool,
}

/// Refuses a command line whose outputs would take the place of what must stay, before anything is done.
///
/// # Errors
/// [`Error::Usage`], `output-taken`, with the option and why.
pub(super) fn judge(command: &Command) -> Result<(), Error> {
    let inputs: Vec<PathBuf> = inputs_of(command).into_iter().flat_map(with_settings).collect();
    let outputs = outputs_of(command);
    for (i, output) in outputs.iter().enumerate() {
        let twin =
            outputs[..i].iter().find(|o| !o.is_folder && !output.is_folder && is_same(o.path, output.path));
        let why = match twin {
            Some(twin) => Some(format!("the file of {} too", twin.option)),
            None => fault(output, &inputs),
        };
        if let Some(why) = why {
            let text = format!(
                "{}: found {why}, expected another place to write to; nothing was done",
                output.option
            );
            return Err(Error::usage("output-taken", Place::file(output.path.to_string_lossy()), text));
        }
    }
    if let Command::Analyse(args) = command {
        judge_standard_output(args)?;
        judge_tables(args)?;
    }
    if let Command::Watch(args) = command
        && let Some(log) = &args.log
    {
        judge_log(log, &args.looking.folders)?;
    }
    Ok(())
}

/// Whether a table's name promises GeoJSON.
pub(super) fn is_geojson(to: &Path) -> bool {
    to.extension().is_some_and(|e| e.eq_ignore_ascii_case("geojson"))
}

/// Tables are CSV or GeoJSON: another ending would promise another format.
fn judge_tables(args: &AnalyseArgs) -> Result<(), Error> {
    for (name, to) in [("--cells", &args.tables.cells), ("--edges", &args.tables.edges)] {
        let Some(to) = to.as_deref().filter(|to| !is_standard_output(to)) else { continue };
        if !is_geojson(to) && !to.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")) {
            let text = format!(
                "{name}: found {:?}, expected a name that ends in .csv or .geojson; nothing was done",
                to.display()
            );
            return Err(Error::usage("table-format", Place::default(), text));
        }
    }
    Ok(())
}

/// Standard output takes one of the tables or the result, not several.
fn judge_standard_output(args: &AnalyseArgs) -> Result<(), Error> {
    let named =
        [("--cells", &args.tables.cells), ("--edges", &args.tables.edges), ("--json", &args.common.json)]
            .into_iter();
    let there: Vec<&str> =
        named.filter(|(_, to)| to.as_deref().is_some_and(is_standard_output)).map(|n| n.0).collect();
    if there.len() > 1 {
        let text = format!(
            "{}: found standard output (-) for each, expected it for one; nothing was done",
            there.join(", ")
        );
        return Err(Error::usage("output-taken", Place::default(), text));
    }
    Ok(())
}

/// A log below a watched folder must not have a name that is looked at there: each line would be a new save.
fn judge_log(log: &Path, folders: &[PathBuf]) -> Result<(), Error> {
    let is_looked_at = is_data(log) || log.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    let at = real(log);
    if is_looked_at && folders.iter().any(|f| at.starts_with(real(f))) {
        let text = "--log: found a name that is watched there, as of settings or data of a drawing, expected another; nothing was done";
        return Err(Error::usage("output-taken", Place::file(log.to_string_lossy()), text));
    }
    Ok(())
}

fn with_settings(drawing: &Path) -> Vec<PathBuf> {
    std::iter::once(drawing.to_path_buf()).chain(settings_files(drawing)).collect()
}

fn inputs_of(command: &Command) -> Vec<&Path> {
    match command {
        Command::Check(a) => vec![&a.file],
        Command::Analyse(a) => vec![&a.file],
        Command::Resolution(a) => vec![&a.file],
        Command::Works(a) => vec![&a.file],
        Command::Brief(a) => vec![&a.file],
        Command::Run(a) => vec![&a.file],
        Command::Accept(a) => vec![&a.file],
        Command::Jobs(a) => a.files.iter().map(PathBuf::as_path).collect(),
        Command::Parts(a) => vec![&a.file],
        Command::Merge(a) => vec![&a.list],
        Command::Join(a) => vec![&a.list],
        Command::Watch(_)
        | Command::JobChild { .. }
        | Command::RunJob(_)
        | Command::Status(_)
        | Command::Open(_)
        | Command::Service(_)
        | Command::Doctor { .. }
        | Command::Completions { .. }
        | Command::Man
        | Command::Init(_) => vec![],
    }
}

fn outputs_of(command: &Command) -> Vec<Output<'_>> {
    let mut out = Vec::new();
    match command {
        Command::Check(a) => {
            push(&mut out, "--preview", a.preview.as_deref(), false);
            push(&mut out, "--graph", a.graph.as_deref(), false);
            push_common(&mut out, &a.common);
        }
        Command::Analyse(a) => {
            push(&mut out, "--cells", a.tables.cells.as_deref(), false);
            push(&mut out, "--edges", a.tables.edges.as_deref(), false);
            push_common(&mut out, &a.common);
        }
        Command::Resolution(a) => push_common(&mut out, &a.common),
        Command::Works(a) => {
            push(&mut out, "--preview", a.preview.as_deref(), false);
            push_common(&mut out, &a.common);
        }
        Command::Brief(a) => {
            push(&mut out, "--preview", a.preview.as_deref(), false);
            push_common(&mut out, &a.common);
        }
        Command::Run(a) => push_common(&mut out, &a.common),
        Command::Jobs(a) => {
            push(&mut out, "--output", a.output.as_deref(), false);
            push_common(&mut out, &a.common);
        }
        Command::Parts(a) => {
            push(&mut out, "--output", a.output.as_deref(), false);
            push_common(&mut out, &a.common);
        }
        Command::Join(a) => {
            push(&mut out, "--missing", a.missing.as_deref(), false);
            push(&mut out, "--output", a.output.as_deref(), false);
        }
        Command::Merge(a) => {
            push(&mut out, "--missing", a.missing.as_deref(), false);
            push(&mut out, "--cells", a.tables.cells.as_deref(), false);
            push(&mut out, "--edges", a.tables.edges.as_deref(), false);
            push(&mut out, "--json", a.json.as_deref(), false);
            push(&mut out, "--out", a.out.as_deref(), true);
        }
        Command::Watch(a) => {
            push(&mut out, "--log", a.log.as_deref(), false);
            push(&mut out, "--fallback", a.looking.fallback.as_deref(), true);
            push_common(&mut out, &a.common);
        }
        Command::RunJob(a) => push(&mut out, "--out", a.out.as_deref(), true),
        Command::Service(a) => {
            if let ServiceCommand::Install(a) = &a.what {
                push(&mut out, "--out", a.out.as_deref(), true);
                push(&mut out, "--fallback", a.looking.fallback.as_deref(), true);
            }
        }
        Command::Accept(_)
        | Command::JobChild { .. }
        | Command::Status(_)
        | Command::Open(_)
        | Command::Doctor { .. }
        | Command::Completions { .. }
        | Command::Man
        | Command::Init(_) => {}
    }
    out
}

fn push<'a>(out: &mut Vec<Output<'a>>, option: &'static str, path: Option<&'a Path>, is_folder: bool) {
    let named = path.filter(|p| !is_standard_output(p));
    out.extend(named.map(|path| Output { option, path, is_folder }));
}

fn push_common<'a>(out: &mut Vec<Output<'a>>, common: &'a Common) {
    push(out, "--json", common.json.as_deref(), false);
    push(out, "--out", common.out.as_deref(), true);
}

/// What speaks against writing there.
fn fault(output: &Output<'_>, inputs: &[PathBuf]) -> Option<String> {
    if output.is_folder && output.path.is_dir() {
        return None;
    }
    if inputs.iter().any(|input| is_same(input, output.path)) {
        return Some("the drawing itself, or its settings".into());
    }
    if is_settings(output.path) {
        return Some("the name of a drawing's settings".into());
    }
    let ending = output.path.extension().unwrap_or_default();
    if ENDINGS.iter().any(|known| ending.eq_ignore_ascii_case(known)) {
        return Some(format!("the name of a drawing (.{})", ending.to_string_lossy()));
    }
    (!output.is_folder && is_drawing(output.path)).then(|| "a drawing there".into())
}

/// Whether a drawing lies there, whatever its name.
fn is_drawing(path: &Path) -> bool {
    let Some(bytes) = bytes_of(path) else { return false };
    let shown = path.to_string_lossy();
    enfilade_cad::read(&shown, &bytes, &enfilade_cad::ReadOptions::default(), &mut Report::default()).is_ok()
}

fn is_same(a: &Path, b: &Path) -> bool {
    real(a) == real(b)
}

/// The path without links; of what is not there yet, that of its folder with the name.
fn real(path: &Path) -> PathBuf {
    let absolute = super::absolute(path);
    std::fs::canonicalize(&absolute).unwrap_or_else(|_| match (absolute.parent(), absolute.file_name()) {
        (Some(folder), Some(name)) => {
            std::fs::canonicalize(folder).unwrap_or_else(|_| folder.into()).join(name)
        }
        _ => absolute,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::Cli;
    use clap::Parser as _;

    /// One row a case: the command line, `@` being the folder, and what is said against it.
    #[test]
    fn no_output_takes_the_place_of_a_drawing_or_of_settings() {
        let dir = tempfile::tempdir().unwrap();
        let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/gallery.dxf");
        for name in ["plan.dxf", "drawing.txt", "drawing.json"] {
            std::fs::copy(&sample, dir.path().join(name)).unwrap();
        }
        std::fs::write(dir.path().join("notes.txt"), "no drawing").unwrap();
        std::fs::create_dir(dir.path().join("results.dxf")).unwrap();
        let table = [
            ("check @/plan.dxf --preview @/plan.dxf", "ends in .png"),
            ("check @/plan.dxf --preview @/new.DXF", "ends in .png"),
            ("check @/plan.dxf --json=@/drawing.txt", "ends in .json"),
            ("check @/plan.dxf --json=@/plan.enfilade.toml", "ends in .json"),
            ("check @/plan.dxf --json=@/other.enfilade.toml", "ends in .json"),
            ("check @/plan.dxf --preview @/x.Enfilade.toml", "ends in .png"),
            ("check @/plan.dxf --json=@/sub/enfilade.toml", "ends in .json"),
            ("analyse @/plan.dxf --json=@/other-enfilade.toml.txt", "ends in .json"),
            ("jobs @/plan.dxf -o @/other.enfilade.toml", "name of a drawing's settings"),
            ("check @/plan.dxf --json=@/notenfilade.toml", "ends in .json"),
            ("check @/plan.dxf --json=@/a --preview @/a", "ends in .png"),
            ("analyse @/plan.dxf --out @/plan.dxf", "itself"),
            ("analyse @/plan.dxf --cells @/a.ifc", "name of a drawing"),
            ("analyse @/plan.dxf --cells @/a.parquet", "ends in .csv"),
            ("analyse @/plan.dxf --cells @/a.geojson", ""),
            ("analyse @/plan.dxf --edges @/enfilade.toml", "settings"),
            ("analyse @/plan.dxf --json=@/x.glb", "ends in .json"),
            ("resolution @/plan.dxf --json=@/x.gltf", "ends in .json"),
            ("analyse @/plan.dxf --cells - --json=-", "--cells, --json: found standard output"),
            ("analyse @/plan.dxf --cells - --edges @/e.csv", ""),
            ("run @/plan.dxf --json=@/plan.dxf", "ends in .json"),
            ("run @/plan.dxf --out @/new.dxf", "name of a drawing"),
            ("jobs @/plan.dxf -o @/plan.dxf", "itself"),
            ("jobs @/plan.dxf -o @/../new.ifczip", "name of a drawing"),
            ("run-job {} --out @/new.dxf", "name of a drawing"),
            ("watch @ --log @/plan.dxf", "name of a drawing"),
            ("watch @ --log @/enfilade.toml", "settings"),
            ("watch @ --log @/scene.bin", "watched there"),
            ("watch @ --fallback @/new.dxf", "name of a drawing"),
            ("service install --out @/new.dxf @", "name of a drawing"),
            ("check @/plan.dxf --preview @/notes.txt --json=-", "ends in .png"),
            ("check @/plan.dxf --json=@/a --preview @/b.png", ""),
            ("check @/plan.dxf --json=@/drawing.json", "a drawing there"),
            ("check @/plan.dxf --json=@/a.json --graph @/a.json", "the file of --graph too"),
            ("jobs @/plan.dxf -o @/plan.enfilade.toml", "itself, or its settings"),
            ("jobs @/plan.dxf -o @/sub/enfilade.toml", "name of a drawing's settings"),
            ("jobs @/plan.dxf -o @/notenfilade.toml", ""),
            ("run @/plan.dxf --out @/results.dxf", ""),
            ("jobs @/plan.dxf -o -", ""),
            ("parts @/plan.dxf --parts 2 -o @/plan.dxf", "itself"),
            ("merge @/notes.txt --missing @/notes.txt", "itself"),
            ("merge @/notes.txt --cells @/plan.dxf", "name of a drawing"),
            ("watch @ --log @/watch.log", ""),
            ("man", ""),
        ];
        for (line, said) in table {
            let line = line.replace('@', &dir.path().to_string_lossy());
            let words = std::iter::once("enfilade").chain(line.split(' '));
            let cli = match Cli::try_parse_from(words) {
                Ok(cli) => cli,
                Err(e) => {
                    assert!(said.starts_with("ends in") && e.to_string().contains(said), "{line}: {e}");
                    continue;
                }
            };
            match judge(&cli.command) {
                Ok(()) => assert_eq!(said, "", "{line}"),
                Err(Error::Usage(p)) => {
                    let is_ending = said == "ends in .csv";
                    assert!(!said.is_empty() && p.text.contains(said), "{line}: {p}");
                    assert!(p.code == "output-taken" || is_ending, "{line}: {p}");
                }
                Err(other) => panic!("{line}: {other}"),
            }
        }
    }
}

//! `enfilade accept`: an option becomes a drawing beside the old one, and what is demolished goes for good.

use std::path::{Path, PathBuf};

use super::beside::{beside, read_settings};
use super::{Which, absolute, open, results_of, round_result};
use crate::cli::AcceptArgs;
use crate::output::say;
use crate::store::{self, Revision, SystemDisk, led_beside};
use enfilade_cad::drawing::Format;
use enfilade_config::{Partial, WorkTable, settings_files};
use enfilade_pipeline::Input;
use enfilade_pipeline::accept::Chosen;
use enfilade_report::{Error, Place, counted};

/// An option that became a drawing.
pub(super) struct Accepted {
    /// What it is an option of: `round 3`.
    of: String,
    pub(super) next: PathBuf,
    side_car: PathBuf,
    /// Whether it was not there before.
    pub(super) is_new: bool,
    /// Demolished entities or elements that were taken out.
    cleaned: usize,
}

/// Which option is accepted, and how.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choice {
    /// Of what.
    pub(super) of: Which,
    /// What of it.
    pub(super) chosen: Chosen,
    /// Whether what is demolished is taken out.
    pub(super) is_clean: bool,
}

pub(super) fn accept(args: &AcceptArgs) -> Result<u8, Error> {
    let file = led_beside(&args.file);
    let chosen = args.number.map(Chosen::numbered).or(args.point.map(Chosen::Point));
    let Some(chosen) = chosen else { return clean(&file) };
    let of = if args.so_far { Which::SoFar(None) } else { args.round.map_or(Which::Newest, Which::Round) };
    let results = results_of(&args.file, args.out.clone())?;
    let accepted = accept_option(&file, &results, Choice { of, chosen, is_clean: args.clean })?;
    let Accepted { of, next, side_car, is_new, cleaned } = accepted;
    if !is_new {
        say(&format!("{chosen} of {of} was accepted before, as {}; nothing was written", next.display()));
        return Ok(0);
    }
    say(&format!("{chosen} of {of} is now {}", next.display()));
    if args.clean {
        say(&taken_out(&next, cleaned));
    }
    say(&format!("its moves, bounds and settings for the next round: {}", side_car.display()));
    Ok(0)
}

/// What became of what is demolished.
fn taken_out(drawing: &Path, count: usize) -> String {
    let file = drawing.to_string_lossy();
    match count {
        0 if matches!(enfilade_cad::format_of(&file, &[]), Format::Gltf | Format::Glb) => {
            "glTF: what is demolished stays in the file".into()
        }
        0 => "nothing in it is demolished".into(),
        1 => "1 demolished element was taken out".into(),
        n => format!("{} were taken out", counted(n as u64, "demolished element")),
    }
}

/// Makes an option in the folder `results` a new drawing.
pub(super) fn accept_option(file: &Path, results: &Path, choice: Choice) -> Result<Accepted, Error> {
    let (path, bytes) = open(file)?;
    let (origin, result) = round_result(results, choice.of)?;
    let accepted = enfilade_pipeline::accept::accept(
        &Input::new(&path, &bytes, 1),
        beside(file),
        &result,
        origin,
        choice.chosen,
    )?;
    let (drawing, cleaned) = match choice.is_clean {
        true => enfilade_cad::without_demolished(&path, &accepted.drawing)?,
        false => (accepted.drawing, 0),
    };
    let Revision { path: next, is_new } =
        store::write_revision(&SystemDisk, &absolute(file), &drawing).map_err(|e| not_beside(e, results))?;
    let side_car = settings_files(&next)[0].clone();
    // The user may have changed the settings of an option accepted before.
    if is_new || !side_car.exists() {
        store::replace_file(&SystemDisk, &side_car, accepted.side_car.as_bytes())?;
    }
    Ok(Accepted { of: origin.to_string(), next, side_car, is_new, cleaned })
}

/// Writes a drawing without what is demolished in it beside it.
fn clean(file: &Path) -> Result<u8, Error> {
    let (path, bytes) = open(file)?;
    let input = Input::new(&path, &bytes, 1);
    let (drawing, count) = enfilade_cad::without_demolished(input.file(), &input.bytes)?;
    if count == 0 {
        say(&format!("{}: {}; nothing was written", file.display(), taken_out(file, 0)));
        return Ok(0);
    }
    let new = store::write_revision(&SystemDisk, &absolute(file), &drawing)?;
    let side_car = carry_on(file, &new, &[])?;
    if !new.is_new {
        say(&format!("it was cleaned before, as {}; nothing was written", new.path.display()));
        return Ok(0);
    }
    say(&format!("{}: {}", new.path.display(), taken_out(file, count)));
    if let Some(side_car) = side_car {
        say(&format!("its settings: {}", side_car.display()));
    }
    Ok(0)
}

/// Gives a new drawing the settings that stand beside the old one, with more decided works; where they lie, if there are
/// any. What the user has changed there since stays.
pub(super) fn carry_on(old: &Path, new: &Revision, works: &[WorkTable]) -> Result<Option<PathBuf>, Error> {
    let [own, _] = settings_files(old);
    let mut beside = read_settings(&own)?.unwrap_or_default();
    beside.works.extend(works.iter().cloned());
    if beside == Partial::default() {
        return Ok(None);
    }
    let side_car = settings_files(&new.path)[0].clone();
    if new.is_new || !side_car.exists() {
        let text = toml::Table::try_from(&beside).and_then(|mut said| {
            said.retain(|_, value| value.as_array().is_none_or(|list| !list.is_empty()));
            toml::to_string(&said)
        });
        let text = text.map_err(|e| {
            Error::environment("side-car", Place::file(side_car.to_string_lossy()), e.to_string())
        })?;
        store::replace_file(&SystemDisk, &side_car, text.as_bytes())?;
    }
    Ok(Some(side_car))
}

/// What to do where nothing may be written beside a drawing: results lie elsewhere then, an accepted drawing cannot.
fn not_beside(error: Error, results: &Path) -> Error {
    let Some(problem) = error.problem() else { return error };
    let (why, remedy) = match problem.code {
        "no-permission" => ("where nothing may be written", "allow it"),
        store::DISK_FULL => ("where the disk is full", "free some space"),
        _ => return error,
    };
    let text = format!(
        "an accepted drawing is written beside the one it follows, {why}; {remedy}, or take the option's own file from {}",
        results.display()
    );
    Error::environment(problem.code, problem.place.clone(), text)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where nothing may be written beside a drawing, what to do is said; other refusals speak for themselves.
    #[test]
    fn an_option_that_cannot_be_written_beside_its_drawing_is_named() {
        let refused = |kind: std::io::ErrorKind| {
            let error = store::disk_error("writing", Path::new("/plans/a-r02.dxf"), &kind.into());
            not_beside(error, Path::new("/elsewhere/a.enfilade")).to_string()
        };
        let said = refused(std::io::ErrorKind::ReadOnlyFilesystem);
        for part in ["/plans/a-r02.dxf", "beside the one it follows", "own file from /elsewhere/a.enfilade"] {
            assert!(said.contains(part), "{part}: {said}");
        }
        let full = refused(std::io::ErrorKind::StorageFull);
        assert!(full.contains("free some space, or take") && !full.contains("--out"), "{full}");
        assert!(!refused(std::io::ErrorKind::NotFound).contains("/elsewhere"));
    }
}

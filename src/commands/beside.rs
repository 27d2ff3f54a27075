//! What files beside a drawing say of it: settings of its own and of its folder, the data of a scene, the building of
//! the same name.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::watch::{bytes_of, is_scene};
use enfilade_config::{Beside, Partial, Settings, Twin, for_folder, settings_files, unread_side_cars};
use enfilade_report::{Error, Place};

/// Largest file of settings that is read.
const SETTINGS_BYTES_MAX: u64 = 16 << 20;

/// Settings of a drawing: the command line, its side-car, its folder's file, the defaults; and where the
/// results go.
///
/// # Errors
/// [`Error::Usage`] with the place of what is wrong.
pub fn settings_for(drawing: &Path, command_line: Partial) -> Result<(Settings, Option<PathBuf>), Error> {
    let partial = settings_partial(drawing, command_line)?;
    let out = partial.out.clone().map(PathBuf::from);
    Ok((Settings { beside: beside(drawing), unread: unread(drawing), ..Settings::new(partial)? }, out))
}

/// Names beside a drawing that are nearly those of its settings, each with the right one.
pub(super) fn unread(drawing: &Path) -> Vec<(String, String)> {
    // Where names differ by case alone and the file system does not mind, it was read.
    let was_read = |(found, right): &(String, String)| {
        found.eq_ignore_ascii_case(right) && drawing.with_file_name(right).is_file()
    };
    let mut unread = unread_side_cars(drawing, &files_beside(drawing));
    unread.retain(|u| !was_read(u));
    unread
}

/// Names of the files in a drawing's folder.
fn files_beside(drawing: &Path) -> Vec<String> {
    let folder = drawing.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let files = entries.flatten().filter(|e| e.file_type().is_ok_and(|t| t.is_file()));
    files.map(|e| e.file_name().to_string_lossy().into_owned()).collect()
}

/// What is read of files beside a drawing.
pub(super) fn beside(drawing: &Path) -> Beside {
    let scene = is_scene(drawing).then(|| bytes_of(drawing)).flatten().unwrap_or_default();
    let named = enfilade_cad::gltf::outer_files(&scene);
    let mut left = enfilade_cad::gltf::PICTURES_MAX;
    let mut picture = |name: String| {
        let data = data_beside(drawing, &name, left)?;
        left -= data.len() as u64;
        Some((name, data))
    };
    let most = enfilade_cad::gltf::OUTER_MAX;
    Beside {
        twin: twin(drawing),
        buffers: named
            .data
            .into_iter()
            .filter_map(|n| Some((n.clone(), data_beside(drawing, &n, most)?)))
            .collect(),
        pictures: named.pictures.into_iter().filter_map(&mut picture).collect(),
    }
}

/// A file in or below a drawing's own folder; none where it is no file, lies elsewhere by a link, or has more bytes
/// than `most`.
fn data_beside(drawing: &Path, name: &str, most: u64) -> Option<Arc<[u8]>> {
    let file = std::fs::canonicalize(drawing.with_file_name(name)).ok()?;
    let scene = std::fs::canonicalize(drawing).ok()?;
    let is_here = file.starts_with(scene.parent()?);
    let size = std::fs::metadata(&file).ok().filter(std::fs::Metadata::is_file)?.len();
    let is_taken = is_here && size <= most;
    Some(is_taken.then(|| std::fs::read(&file).ok())??.into())
}

/// The IFC of the same name beside a glTF, unpacked.
fn twin(drawing: &Path) -> Option<Twin> {
    let own = is_scene(drawing).then(|| building_like(drawing))?;
    Some(Twin::from(own.or_else(|| twin_of_before(drawing))?))
}

/// The building beside a file that bears its name: `.ifc` in any case, else packed.
fn building_like(file: &Path) -> Option<Vec<u8>> {
    let plain = file.with_extension("ifc");
    let mut found: Vec<(usize, PathBuf)> = Vec::new();
    for name in files_beside(file) {
        let path = file.with_file_name(&name);
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
        let rank = ["ifc", "ifczip"].iter().position(|e| *e == ending);
        found.extend(
            rank.filter(|_| path.file_stem() == file.file_stem() && path != plain).map(|r| (r, path)),
        );
    }
    found.sort();
    let bytes =
        std::iter::once(plain).chain(found.into_iter().map(|f| f.1)).find_map(|path| bytes_of(&path))?;
    // What cannot be unpacked goes on as it is, to be told where it is read.
    let unpacked =
        enfilade_cad::ifc::is_zip(&bytes).then(|| enfilade_cad::ifc::unzip("", &bytes).ok()).flatten();
    Some(unpacked.unwrap_or(bytes))
}

/// The IFC beside the drawing that an accepted one was made of.
fn twin_of_before(drawing: &Path) -> Option<Vec<u8>> {
    let said = settings_partial(drawing, Partial::default()).ok()?;
    let is_here = |name: &&str| Path::new(name).file_name().is_some_and(|n| n == *name);
    let mut before = said.lineage.iter().rev().map(|l| l.drawing.as_str()).filter(is_here);
    before.find_map(|name| building_like(&drawing.with_file_name(name)))
}

/// What the command line says of a drawing, then its own settings, then those of its folder; each where those before say
/// nothing.
///
/// # Errors
/// [`Error::Usage`] and [`Error::Environment`] with the file, and the line where there is one.
pub(super) fn settings_partial(drawing: &Path, command_line: Partial) -> Result<Partial, Error> {
    let mut out = command_line;
    let [own, folder] = settings_files(drawing);
    if let Some(more) = read_settings(&own)? {
        no_watch_in(&own, &more)?;
        out = out.over(more);
    }
    Ok(match read_settings(&folder)? {
        Some(more) => out.over(more),
        None => out,
    })
}

/// What `[watch]` says is of a folder; in the settings of one drawing nobody would look at it.
fn no_watch_in(side_car: &Path, said: &Partial) -> Result<(), Error> {
    if said.watch.is_none() {
        return Ok(());
    }
    let text = "[watch]: found in the settings of one drawing, expected in the enfilade.toml of the watched folder; \
                nothing was done";
    Err(Error::usage("watch-of-one-drawing", Place::file(side_car.to_string_lossy()), text))
}

/// What one settings file says, its folders for results as paths; `None` where there is no such file.
///
/// # Errors
/// As [`settings_partial`].
pub(super) fn read_settings(file: &Path) -> Result<Option<Partial>, Error> {
    use std::io::ErrorKind;
    let place = || Place::file(file.to_string_lossy());
    if std::fs::metadata(file).is_ok_and(|found| !found.is_file()) {
        let text = "found no file of that name but a folder, a pipe or a device; nothing was done";
        return Err(Error::environment("settings-unreadable", place(), text));
    }
    let size = std::fs::metadata(file).map_or(0, |found| found.len());
    if size > SETTINGS_BYTES_MAX {
        let text = format!(
            "found {} MB, expected at most {} MB (SETTINGS_BYTES_MAX); nothing was done",
            size >> 20,
            SETTINGS_BYTES_MAX >> 20
        );
        return Err(Error::usage("settings-too-large", place(), text));
    }
    match std::fs::read_to_string(file) {
        Ok(text) => {
            let mut read = Partial::from_toml(&file.to_string_lossy(), &text)?;
            if file.ends_with("enfilade.toml") {
                for_folder(&file.to_string_lossy(), &text)?;
            }
            let fallback = read.watch.as_mut().and_then(|w| w.fallback.as_mut());
            for folder in read.out.as_mut().into_iter().chain(fallback) {
                *folder = below_of(file, folder)?;
            }
            Ok(Some(read))
        }
        // Beside a drawing with the longest of names no side-car can lie.
        Err(e) if matches!(e.kind(), ErrorKind::NotFound | ErrorKind::InvalidFilename) => Ok(None),
        Err(e) if e.kind() == ErrorKind::InvalidData => {
            let text = "found letters that are not UTF-8, expected text saved as UTF-8; nothing was done";
            Err(Error::usage("settings-unreadable", place(), text))
        }
        Err(e) => Err(Error::environment("settings-unreadable", place(), format!("{e}; nothing was done"))),
    }
}

/// A folder that a settings file names, below the file's own. Whoever may write to a shared folder must not decide
/// where else this user's programs write.
fn below_of(file: &Path, folder: &str) -> Result<String, Error> {
    use std::path::Component::{CurDir, Normal};
    let own = file.parent().unwrap_or(Path::new(""));
    let is_below = Path::new(folder).components().all(|c| matches!(c, Normal(_) | CurDir));
    if !is_below || leads_out(own, Path::new(folder)) {
        let text = format!(
            "found results to go to `{folder}`, expected a folder below that of this file, also by its links; any \
             other is named on the command line (--out, --fallback); nothing was done"
        );
        return Err(Error::usage("settings-outside", Place::file(file.to_string_lossy()), text));
    }
    Ok(own.join(folder).to_string_lossy().into_owned())
}

/// Whether a link on the way from a folder to one below it leads out of the first, or to what is not there yet.
fn leads_out(own: &Path, below: &Path) -> bool {
    let here = if own.as_os_str().is_empty() { Path::new(".") } else { own };
    let real = std::fs::canonicalize(here).ok();
    let is_out = |at: PathBuf| {
        let is_link = std::fs::symlink_metadata(&at).is_ok_and(|m| m.is_symlink());
        let leads_to = || std::fs::canonicalize(&at).ok();
        is_link && !real.as_ref().zip(leads_to()).is_some_and(|(own, to)| to.starts_with(own))
    };
    below.ancestors().filter(|part| !part.as_os_str().is_empty()).any(|part| is_out(own.join(part)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whoever may write to a shared folder must not decide where else this user's programs write.
    #[test]
    fn settings_name_no_folder_elsewhere() {
        let below = |folder| below_of(Path::new("/shared/enfilade.toml"), folder);
        assert_eq!(below("results/./a").unwrap(), "/shared/results/./a");
        for folder in ["../results", "/results", "a/../../results", ".."] {
            assert_eq!(below(folder).unwrap_err().problem().unwrap().code, "settings-outside", "{folder}");
        }
    }

    /// A link is no way round that: what it leads to is judged.
    #[cfg(unix)]
    #[test]
    fn settings_name_no_folder_elsewhere_by_a_link() {
        use std::os::unix::fs::symlink;
        let [shared, elsewhere] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let at = |name: &str| shared.path().join(name);
        std::fs::create_dir(at("results")).unwrap();
        symlink("results", at("inside")).unwrap();
        symlink(elsewhere.path(), at("out")).unwrap();
        symlink(elsewhere.path().join("new"), at("dangling")).unwrap();
        symlink(elsewhere.path(), at("results/deep")).unwrap();
        let below = |folder| below_of(&at("enfilade.toml"), folder);
        for folder in ["results", "inside", "inside/new", "new/deeper", "./results"] {
            assert!(below(folder).is_ok(), "{folder}");
        }
        for folder in ["out", "out/new", "dangling", "results/deep/a", "inside/deep"] {
            assert_eq!(below(folder).unwrap_err().problem().unwrap().code, "settings-outside", "{folder}");
        }
    }

    /// A pipe in a side-car's place would be waited for.
    #[test]
    fn a_side_car_that_is_no_file_is_refused() {
        let dir = tempfile::tempdir().unwrap();
        assert!(read_settings(&dir.path().join("enfilade.toml")).unwrap().is_none());
        let error = read_settings(dir.path()).unwrap_err();
        assert_eq!(error.problem().unwrap().code, "settings-unreadable");
        assert!(error.to_string().contains("no file"), "{error}");
    }

    /// Only a folder is watched: the table in a drawing's own settings would do nothing.
    #[test]
    fn a_side_car_says_nothing_of_watching() {
        let dir = tempfile::tempdir().unwrap();
        let drawing = dir.path().join("plan.dxf");
        std::fs::write(dir.path().join("enfilade.toml"), "[watch]\nquiet-secs = 2.0\n").unwrap();
        assert!(settings_partial(&drawing, Partial::default()).unwrap().watch.is_some());
        std::fs::write(dir.path().join("plan.enfilade.toml"), "[watch]\njob-limit-secs = 9.0\n").unwrap();
        let error = settings_partial(&drawing, Partial::default()).unwrap_err();
        assert_eq!(error.problem().unwrap().code, "watch-of-one-drawing");
        assert!(error.to_string().contains("plan.enfilade.toml: [watch]"), "{error}");
    }
}

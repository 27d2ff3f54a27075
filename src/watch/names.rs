//! Which names are drawings, and why others are left alone (hazards 5, 6, 29).

use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};

use globset::{GlobBuilder, GlobMatcher};

use enfilade_report::{Error, Place};

/// Suffix of the folders that hold our results.
pub const OUTPUT_SUFFIX: &str = ".enfilade";
/// Suffix of the side-car with one drawing's settings, and name of the folder's settings file.
const SETTINGS_SUFFIX: &str = "enfilade.toml";

/// Endings of files in which a `.gltf` keeps its data.
const DATA_ENDINGS: [&str; 3] = ["bin", "glbin", "glbuf"];

/// One name pattern that is left alone, with the reason shown to the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IgnoreRule {
    /// Glob, compared without regard to case.
    pub glob: String,
    /// Why.
    pub why: String,
}

/// The patterns every installation leaves alone: temporary, lock, backup and conflict names of CAD
/// programs, office programs, editors, browsers, operating systems and cloud clients (hazard 5).
pub fn builtin_ignores() -> Vec<IgnoreRule> {
    const RULES: &[(&str, &str)] = &[
        (".*", "hidden file"),
        ("~*", "temporary or lock file of an office or CAD program"),
        ("#*", "autosave copy of LibreCAD"),
        ("*~", "backup copy"),
        ("*.bak", "backup copy"),
        ("*.old", "backup copy"),
        ("*.orig", "backup copy"),
        ("*.dwl", "lock file of AutoCAD"),
        ("*.dwl2", "lock file of AutoCAD"),
        ("*.sv$", "autosave of AutoCAD"),
        ("*.ac$", "temporary file of AutoCAD"),
        ("sav*.tmp", "save in progress of AutoCAD"),
        ("*.tmp", "temporary file"),
        ("*.temp", "temporary file"),
        ("*.lck", "lock file"),
        ("*.lock", "lock file"),
        ("*.swp", "swap file of an editor"),
        ("*.swx", "swap file of an editor"),
        ("*.fcstd[0-9]*", "backup copy of FreeCAD"),
        ("*.fcbak", "backup copy of FreeCAD"),
        ("*.[0-9][0-9][0-9][0-9].rvt", "backup copy of Revit"),
        ("*.part", "download in progress"),
        ("*.partial", "download in progress"),
        ("*.filepart", "transfer in progress"),
        ("*.crdownload", "download in progress"),
        ("*.download", "download in progress"),
        ("*conflicted copy*", "conflict copy of a cloud client; merge it by hand"),
        ("*.sync-conflict-*", "conflict copy of Syncthing; merge it by hand"),
        ("*(sfconflict *", "conflict copy of Seafile; merge it by hand"),
        ("*_conf(*", "conflict copy of a cloud client; merge it by hand"),
        ("thumbs.db", "file of the operating system"),
        ("desktop.ini", "file of the operating system"),
    ];
    RULES.iter().map(|(glob, why)| IgnoreRule { glob: (*glob).into(), why: (*why).into() }).collect()
}

/// Folders whose content is left alone wherever they lie.
const IGNORED_FOLDERS: &[(&str, &str)] = &[
    ("@eadir", "folder of a Synology drive"),
    ("#recycle", "recycle bin of a network drive"),
    ("$recycle.bin", "recycle bin"),
    ("__macosx", "folder of an unpacked archive"),
    ("lost+found", "folder of the file system"),
    ("*_backup", "backup folder of Revit"),
];

/// Endings of documents that hold drawings in a form that is not read, and what to do: whoever saves one into a
/// watched folder waits for options that never come.
const UNREAD: &[(&str, &str)] = &[
    ("dwg", "a DWG is not read; save the drawing as DXF"),
    ("dxb", "a DXB is not read; save the drawing as DXF"),
    ("fcstd", "a FreeCAD document is not read; export DXF or IFC, or use the workbench"),
    ("ifcxml", "IFC as XML is not read; save it as .ifc"),
    ("pln", "a project of Archicad is not read; export IFC or DXF"),
    ("rvt", "a project of Revit is not read; export IFC or DXF"),
    ("skp", "a model of SketchUp is not read; export glTF or DXF"),
    ("3dm", "a model of Rhino is not read; export DXF or glTF"),
    ("vwx", "a file of Vectorworks is not read; export IFC or DXF"),
];

/// What is done with a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// A drawing: taken up when it has settled.
    Take,
    /// Settings of ours, or data of scenes: their drawings are looked at again.
    Settings,
    /// Looks like a drawing, or holds one in a form that is not read; the text says why it is left alone.
    Ignore(String),
    /// Some other file.
    Other,
}

/// The rules on names for one root.
#[derive(Debug)]
pub struct Names {
    root: PathBuf,
    depth: usize,
    extensions: Vec<String>,
    files: Vec<(GlobMatcher, String)>,
    folders: Vec<(GlobMatcher, String)>,
    nested: Vec<PathBuf>,
}

impl Names {
    /// The rules for `root`: folders down to `depth`, drawings with one of `extensions`, the built-in
    /// ignore list and the user's globs. `nested` roots inside this one are left to themselves.
    ///
    /// # Errors
    /// `bad-glob` names a glob that cannot be read.
    pub fn new(
        root: &Path,
        depth: usize,
        extensions: &[String],
        user_globs: &[String],
        nested: &[PathBuf],
    ) -> Result<Self, Error> {
        let mut rules = builtin_ignores();
        let because = |glob: &String| IgnoreRule { glob: glob.clone(), why: format!("ignored by `{glob}`") };
        rules.extend(user_globs.iter().map(because));
        let files =
            rules.iter().map(|r| Ok((matcher(&r.glob)?, r.why.clone()))).collect::<Result<_, Error>>()?;
        let folders = IGNORED_FOLDERS
            .iter()
            .map(|(glob, why)| Ok((matcher(glob)?, (*why).to_owned())))
            .collect::<Result<_, Error>>()?;
        let nested = nested.iter().filter(|n| *n != root && n.starts_with(root)).cloned().collect();
        Ok(Self {
            root: root.into(),
            depth,
            extensions: extensions.iter().map(|e| e.to_ascii_lowercase()).collect(),
            files,
            folders,
            nested,
        })
    }

    /// What is done with the file at `path`.
    pub fn verdict(&self, path: &Path) -> Verdict {
        let (Ok(below), Some(name)) = (path.strip_prefix(&self.root), path.file_name()) else {
            return Verdict::Other;
        };
        if let Some(folder) = path.parent()
            && folder != self.root
            && let Some(why) = self.folder_reason(folder)
        {
            return if self.has_extension(path) { Verdict::Ignore(why) } else { Verdict::Other };
        }
        let name_path = Path::new(name);
        let hit = self.files.iter().find(|(m, _)| m.is_match(name_path) || m.is_match(below));
        match hit {
            Some((_, why)) if self.mentions_extension(name) => Verdict::Ignore(why.clone()),
            Some(_) => Verdict::Other,
            None if self.has_extension(path) => Verdict::Take,
            None if is_settings(name) || self.is_data(path) => Verdict::Settings,
            None => unread_reason(path).map_or(Verdict::Other, |why| Verdict::Ignore(why.into())),
        }
    }

    /// Why the folder at `path` is not looked into; `None` when it is.
    pub fn folder_reason(&self, path: &Path) -> Option<String> {
        let below = path.strip_prefix(&self.root).ok()?;
        let parts: Vec<&OsStr> = below
            .components()
            .filter_map(|c| if let Component::Normal(n) = c { Some(n) } else { None })
            .collect();
        if let Some(why) = parts.iter().find_map(|name| self.one_folder_reason(name)) {
            return Some(why);
        }
        if parts.len() > self.depth {
            return Some(format!("lies {} folders deep; {} are watched", parts.len(), self.depth));
        }
        self.nested.iter().any(|n| path.starts_with(n)).then(|| "watched on its own".into())
    }

    fn one_folder_reason(&self, name: &OsStr) -> Option<String> {
        let bytes = name.as_encoded_bytes();
        if bytes.len() >= OUTPUT_SUFFIX.len()
            && bytes[bytes.len() - OUTPUT_SUFFIX.len()..].eq_ignore_ascii_case(OUTPUT_SUFFIX.as_bytes())
        {
            return Some("result of ours".into());
        }
        if bytes.starts_with(b".") {
            return Some("hidden folder".into());
        }
        self.folders.iter().find(|(m, _)| m.is_match(Path::new(name))).map(|(_, why)| why.clone())
    }

    fn has_extension(&self, path: &Path) -> bool {
        path.extension()
            .and_then(OsStr::to_str)
            .is_some_and(|e| self.extensions.contains(&e.to_ascii_lowercase()))
    }

    fn is_data(&self, path: &Path) -> bool {
        self.extensions.iter().any(|e| e == "gltf") && is_data(path)
    }

    /// Whether an extension of ours stands anywhere in the name (`plan.dxf~`, `plan.dxf.part`): only
    /// such ignored files are worth a word to the user.
    fn mentions_extension(&self, name: &OsStr) -> bool {
        let name = name.to_string_lossy().to_ascii_lowercase();
        self.extensions.iter().any(|e| name.contains(&format!(".{e}")))
    }
}

fn matcher(glob: &str) -> Result<GlobMatcher, Error> {
    GlobBuilder::new(glob)
        .case_insensitive(true)
        .literal_separator(true)
        .build()
        .map(|g| g.compile_matcher())
        .map_err(|e| Error::usage("bad-glob", Place::default(), format!("ignore pattern `{glob}`: {e}")))
}

fn unread_reason(path: &Path) -> Option<&'static str> {
    let ending = path.extension()?.to_str()?;
    UNREAD.iter().find(|(known, _)| ending.eq_ignore_ascii_case(known)).map(|(_, why)| *why)
}

fn is_settings(name: &OsStr) -> bool {
    name.to_str().is_some_and(|n| n == SETTINGS_SUFFIX || n.ends_with(&format!(".{SETTINGS_SUFFIX}")))
}

/// Whether a `.gltf` may keep its data in a file of that name.
pub fn is_data(path: &Path) -> bool {
    has_ending(path, &DATA_ENDINGS)
}

/// Whether a drawing is a glTF that may keep its data in files beside it.
pub fn has_data_beside(drawing: &Path) -> bool {
    has_ending(drawing, &["gltf"])
}

/// Whether a drawing is a scene: a glTF or a GLB.
pub fn is_scene(drawing: &Path) -> bool {
    has_ending(drawing, &["glb", "gltf"])
}

/// Whether a file is a building by its ending.
pub fn is_building(path: &Path) -> bool {
    has_ending(path, &["ifc", "ifczip"])
}

/// Whether a file is the building that a scene beside it is understood with.
pub fn is_building_of(path: &Path, scene: &Path) -> bool {
    is_building(path)
        && is_scene(scene)
        && path.parent() == scene.parent()
        && path.file_stem() == scene.file_stem()
}

fn has_ending(path: &Path, endings: &[&str]) -> bool {
    path.extension().is_some_and(|e| endings.iter().any(|ending| e.eq_ignore_ascii_case(ending)))
}

/// Whether a name is one that we give to drawings inside a round (`candidate-3.dxf`, `initial.dxf`), or to notes of theirs
/// (`candidate-3-notes.dxf`).
///
/// Such a file outside a result folder is left alone only if its content is ours too (hazard 6).
pub fn is_output_name(path: &Path) -> bool {
    let Some(stem) = path.file_stem().and_then(OsStr::to_str) else { return false };
    let of_notes = stem.strip_suffix("-notes");
    let stem = of_notes.unwrap_or(stem);
    let number = stem.strip_prefix("candidate-");
    let is_best = stem == "best" && of_notes.is_some();
    stem == "initial"
        || is_best
        || number.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(depth: usize, globs: &[&str]) -> Names {
        let globs: Vec<String> = globs.iter().map(|g| (*g).to_owned()).collect();
        Names::new(Path::new("/w"), depth, &["dxf".into(), "ifc".into()], &globs, &["/w/own".into()]).unwrap()
    }

    /// `tests/data/watch/names.txt`: `verdict<TAB>path below the root`, watched two folders deep.
    #[test]
    fn table_of_names() {
        let names = names(2, &["draft-*", "old/**"]);
        let table = include_str!("../../tests/data/watch/names.txt");
        let mut rows = 0;
        for line in table.lines().filter(|l| !l.is_empty() && !l.starts_with("; ")) {
            let (want, path) = line.split_once('\t').unwrap();
            let got = match names.verdict(&Path::new("/w").join(path)) {
                Verdict::Take => "take",
                Verdict::Settings => "settings",
                Verdict::Ignore(why) => {
                    assert!(!why.is_empty(), "{path}");
                    "ignore"
                }
                Verdict::Other => "other",
            };
            assert_eq!(got, want, "{path}");
            rows += 1;
        }
        assert!(rows >= 60, "{rows} rows");
    }

    #[test]
    fn data_of_scenes_count_where_scenes_are_watched() {
        let of = |e: &str| Names::new(Path::new("/w"), 1, &[e.into()], &[], &[]).unwrap();
        for (path, verdict) in [
            ("/w/house.bin", Verdict::Settings),
            ("/w/data/house.GLBIN", Verdict::Settings),
            ("/w/a/b/house.bin", Verdict::Other),
            ("/w/house.bin~", Verdict::Other),
            ("/w/house.enfilade/round-01/house.bin", Verdict::Other),
        ] {
            assert_eq!(of("gltf").verdict(Path::new(path)), verdict, "{path}");
            assert_eq!(of("dxf").verdict(Path::new(path)), Verdict::Other, "{path}");
        }
    }

    #[test]
    fn reasons_are_shown() {
        let names = names(2, &["draft-*"]);
        let why = |p: &str| match names.verdict(Path::new(p)) {
            Verdict::Ignore(why) => why,
            other => panic!("{p}: {other:?}"),
        };
        assert_eq!(why("/w/#plan.dxf"), "autosave copy of LibreCAD");
        assert_eq!(why("/w/draft-1.dxf"), "ignored by `draft-*`");
        assert_eq!(why("/w/plan.enfilade/round-01/candidate-1.dxf"), "result of ours");
        assert_eq!(why("/w/a/b/c/plan.dxf"), "lies 3 folders deep; 2 are watched");
        assert_eq!(why("/w/own/plan.dxf"), "watched on its own");
        assert_eq!(names.verdict(Path::new("/elsewhere/plan.dxf")), Verdict::Other);
    }

    #[cfg(unix)]
    #[test]
    fn names_need_not_be_text() {
        use std::os::unix::ffi::OsStrExt;
        let names = names(0, &[]);
        let path = |bytes: &[u8]| Path::new("/w").join(OsStr::from_bytes(bytes));
        assert_eq!(names.verdict(&path(b"pl\xffan.dxf")), Verdict::Take);
        assert_eq!(names.verdict(&path(b"a\nb.dxf")), Verdict::Take);
        assert!(matches!(names.verdict(&path(b"#pl\xffan.dxf")), Verdict::Ignore(_)));
        assert!(matches!(names.verdict(&path(b"~\xff.dxf")), Verdict::Ignore(_)));
    }

    #[test]
    fn output_names() {
        for name in [
            "candidate-1.dxf",
            "candidate-12.ifc",
            "initial.dxf",
            "candidate-1-notes.dxf",
            "initial-notes.dxf",
            "best-notes.dxf",
        ] {
            assert!(is_output_name(Path::new(name)), "{name}");
        }
        for name in [
            "candidate-.dxf",
            "candidate-1b.dxf",
            "plan-r02.dxf",
            "plan2.dxf",
            "initial-2.dxf",
            "plan-notes.dxf",
        ] {
            assert!(!is_output_name(Path::new(name)), "{name}");
        }
    }

    #[test]
    fn a_bad_glob_is_named() {
        let error = Names::new(Path::new("/w"), 0, &[], &["a[".into()], &[]).unwrap_err();
        assert_eq!(error.problem().unwrap().code, "bad-glob");
        assert!(error.to_string().contains("a["));
    }
}

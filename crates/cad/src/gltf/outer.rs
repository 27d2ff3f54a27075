//! Files that a scene names: which names are taken, and why others are not (hazard 43).

use std::collections::BTreeSet;

use percent_encoding::percent_decode_str;

use super::glb::json_of;
use super::json::{self, Json};

/// Endings that the standard gives files of buffers, lower case.
const DATA_ENDINGS: [&str; 3] = [".bin", ".glbin", ".glbuf"];

/// Endings of pictures that viewers of scenes open, lower case.
const PICTURE_ENDINGS: [&str; 9] =
    [".png", ".jpg", ".jpeg", ".webp", ".ktx", ".ktx2", ".basis", ".dds", ".avif"];

/// The file that a buffer's URI names in or below the drawing's own folder, from there with `/` between folders, or why
/// it is not opened.
pub(super) fn name_of(uri: &str) -> Result<String, String> {
    let no = |why: &str| {
        Err(format!("names {uri:?}, {why}; it is not opened; export as .glb or with embedded data"))
    };
    match contained(uri) {
        Err(why) => no(why),
        Ok(name) if !has_ending(&name, &DATA_ENDINGS) => no("expected a file of data (.bin)"),
        Ok(name) => Ok(name),
    }
}

/// The same for a picture's URI.
fn picture_name_of(uri: &str) -> Result<String, String> {
    let no =
        |why: &str| Err(format!("names {uri:?}, {why}; it is not copied, options do not show this picture"));
    match contained(uri) {
        Err(why) => no(why),
        Ok(name) if !has_ending(&name, &PICTURE_ENDINGS) => no("expected a picture (.png, .jpg)"),
        Ok(name) => Ok(name),
    }
}

fn has_ending(name: &str, endings: &[&str]) -> bool {
    let name = name.to_lowercase();
    endings.iter().any(|e| name.ends_with(e))
}

/// A relative path that stays below where it starts, or why it does not.
fn contained(uri: &str) -> Result<String, &'static str> {
    const ELSEWHERE: &str = "which lies elsewhere, expected a file in or below the drawing's own folder";
    const ROUNDABOUT: &str = "a roundabout way, expected the names of folders and of a file alone";
    let path = percent_decode_str(uri).decode_utf8().map_err(|_| "which is no text")?;
    let is_address =
        path.find(':').is_some_and(|colon| path[..colon].chars().all(|c| c.is_ascii_alphanumeric()));
    if is_address {
        return Err("an address, expected a file in or below the drawing's own folder");
    }
    if path.is_empty() || path.contains(['\0', ':']) {
        return Err("which names no file");
    }
    // Whichever way slashes lean, some system goes up or to the root by them.
    let slashes = ['/', '\\'];
    if path.starts_with(slashes) || leaves(path.split(slashes)) {
        return Err(ELSEWHERE);
    }
    let path = path.strip_prefix("./").unwrap_or(&path);
    if path.contains('\\') || path.split('/').any(|part| ["", ".", ".."].contains(&part)) {
        return Err(ROUNDABOUT);
    }
    Ok(path.to_owned())
}

/// Whether a way goes above where it starts.
fn leaves<'p>(parts: impl Iterator<Item = &'p str>) -> bool {
    let mut depth = 0usize;
    for part in parts {
        match part {
            "" | "." => {}
            ".." if depth == 0 => return true,
            ".." => depth -= 1,
            _ => depth += 1,
        }
    }
    false
}

/// Names of files in or below the drawing's own folder that a scene wants to have beside it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Outer {
    /// Data of its buffers.
    pub data: BTreeSet<String>,
    /// Pictures of its textures.
    pub pictures: BTreeSet<String>,
}

/// What a scene wants to have beside it; nothing where the bytes are no scene.
pub fn outer_files(bytes: &[u8]) -> Outer {
    let Some(json) = json_of(bytes).and_then(|text| json::parse(text).ok()) else {
        return Outer::default();
    };
    let named = |key: &str, name: fn(&str) -> Result<String, String>| {
        outer_uris(&json, key).filter_map(|(_, uri)| name(uri).ok()).collect()
    };
    Outer { data: named("buffers", name_of), pictures: named("images", picture_name_of) }
}

/// What will be missing of a scene's pictures where an option of it lies, each with its place in the list of images;
/// `beside`: those that were found.
pub(super) fn missing_pictures(json: &Json, beside: &BTreeSet<String>) -> Vec<(usize, String)> {
    let lost = |(i, uri): (usize, &str)| match picture_name_of(uri) {
        Err(why) => Some((i, why)),
        Ok(name) if beside.contains(&name) => None,
        Ok(name) => Some((
            i,
            format!("names {name:?}, which is not there or too large; options do not show this picture"),
        )),
    };
    outer_uris(json, "images").filter_map(lost).collect()
}

/// URIs of a list's items that are no data themselves, each with its place in the list.
fn outer_uris<'j>(json: &'j Json, key: &str) -> impl Iterator<Item = (usize, &'j str)> {
    let uris = json.list(key).iter().enumerate().filter_map(|(i, b)| Some((i, b.text("uri")?)));
    uris.filter(|(_, uri)| !uri.starts_with("data:"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_data_in_the_same_folder_are_taken() {
        for name in [
            "walls.bin",
            "A..B.bin",
            "...bin",
            "W%C3%A4nde%201.bin",
            "x.GLBIN",
            "%2e%2e.bin",
            "sub/a.bin",
            "./a.bin",
        ] {
            assert!(name_of(name).is_ok(), "{name}");
        }
        assert_eq!(name_of("W%C3%A4nde%201.bin").as_deref(), Ok("Wände 1.bin"));
        assert_eq!(name_of("./sub/a.bin").as_deref(), Ok("sub/a.bin"));
        for (name, why) in [
            ("../walls.bin", "lies elsewhere"),
            ("%2e%2e/a.bin", "lies elsewhere"),
            ("%2e%2e%2fa.bin", "lies elsewhere"),
            ("sub/../a.bin", "a roundabout way"),
            ("sub/%2E%2E/../a.bin", "lies elsewhere"),
            ("sub//a.bin", "a roundabout way"),
            ("././a.bin", "a roundabout way"),
            ("sub\\a.bin", "a roundabout way"),
            (".//etc/a.bin", "a roundabout way"),
            ("..\\a.bin", "lies elsewhere"),
            ("/etc/passwd", "lies elsewhere"),
            ("\\\\host\\a.bin", "lies elsewhere"),
            ("a%00.bin", "names no file"),
            ("", "names no file"),
            ("file:///etc/a.bin", "an address"),
            ("http://example.org/a.bin", "an address"),
            ("C:a.bin", "an address"),
            ("passwd", "expected a file of data"),
            ("result.json", "expected a file of data"),
            ("%ff.bin", "is no text"),
        ] {
            let said = name_of(name).unwrap_err();
            assert!(said.contains(why) && said.contains("it is not opened"), "{name}: {said}");
        }
    }

    #[test]
    fn a_scene_names_each_of_its_files_once() {
        let scene = br#"{"buffers":[{"uri":"a.bin"},{"uri":"data:;base64,AA=="},{"uri":"../b.bin"},{"uri":"c.bin"},{"uri":"a.bin"},{}],
            "images":[{"uri":"textures/Holz%201.PNG"},{"uri":"data:image/png;base64,AA=="},{"bufferView":0},{"uri":"../x.png"},
            {"uri":"passwd"},{"uri":"b.jpg"}]}"#;
        let named = outer_files(scene);
        assert_eq!(named.data.iter().collect::<Vec<_>>(), ["a.bin", "c.bin"]);
        assert_eq!(named.pictures.iter().collect::<Vec<_>>(), ["b.jpg", "textures/Holz 1.PNG"]);
        let lost = missing_pictures(&json::parse(scene).unwrap(), &["b.jpg".to_string()].into());
        let lost: Vec<(usize, &str)> = lost.iter().map(|(i, why)| (*i, why.as_str())).collect();
        assert!(
            matches!(lost[..], [(0, a), (3, b), (4, c)] if a.contains("not there")
            && b.contains("lies elsewhere") && c.contains("expected a picture")),
            "{lost:?}"
        );
        assert_eq!(outer_files(b"{"), Outer::default());
        assert_eq!(outer_files(b"glTF"), Outer::default());
    }
}

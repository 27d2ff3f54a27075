//! Buffers in files of their own: which names are taken, and why others are not.

use percent_encoding::percent_decode_str;

use super::json;

/// Endings that the standard gives files of buffers, lower case.
const ENDINGS: [&str; 3] = [".bin", ".glbin", ".glbuf"];

/// The file that a buffer's URI names in the drawing's own folder, or why it is not opened.
pub(super) fn name_of(uri: &str) -> Result<String, String> {
    let no = |why: &str| {
        Err(format!("names {uri:?}, {why}; it is not opened; export as .glb or with embedded data"))
    };
    let Ok(name) = percent_decode_str(uri).decode_utf8() else { return no("which is no text") };
    let is_address =
        name.find(':').is_some_and(|colon| name[..colon].chars().all(|c| c.is_ascii_alphanumeric()));
    if is_address {
        return no("an address, expected a file in the drawing's own folder");
    }
    if name.contains(['/', '\\', '\0', ':']) || name.is_empty() {
        return no("which lies elsewhere, expected a file in the drawing's own folder");
    }
    if !ENDINGS.iter().any(|e| name.to_lowercase().ends_with(e)) {
        return no("expected a file of data (.bin)");
    }
    Ok(name.into_owned())
}

/// Names of the files in the drawing's own folder that hold data of a `.gltf`, in its order; none where the bytes are
/// no JSON.
pub fn files_of(bytes: &[u8]) -> Vec<String> {
    if super::is_glb(bytes) {
        return Vec::new();
    }
    let Ok(json) = json::parse(bytes) else { return Vec::new() };
    let mut out: Vec<String> = Vec::new();
    for uri in json.list("buffers").iter().filter_map(|b| b.text("uri")).filter(|u| !u.starts_with("data:")) {
        if let Ok(name) = name_of(uri)
            && !out.contains(&name)
        {
            out.push(name);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_data_in_the_same_folder_are_taken() {
        for name in ["walls.bin", "A..B.bin", "...bin", "W%C3%A4nde%201.bin", "x.GLBIN", "%2e%2e.bin"] {
            assert!(name_of(name).is_ok(), "{name}");
        }
        assert_eq!(name_of("W%C3%A4nde%201.bin").as_deref(), Ok("Wände 1.bin"));
        for (name, why) in [
            ("../walls.bin", "lies elsewhere"),
            ("%2e%2e/a.bin", "lies elsewhere"),
            ("%2e%2e%2fa.bin", "lies elsewhere"),
            ("sub/a.bin", "lies elsewhere"),
            ("..\\a.bin", "lies elsewhere"),
            ("/etc/passwd", "lies elsewhere"),
            ("a%00.bin", "lies elsewhere"),
            ("", "lies elsewhere"),
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
        let scene = br#"{"buffers":[{"uri":"a.bin"},{"uri":"data:;base64,AA=="},{"uri":"../b.bin"},{"uri":"c.bin"},{"uri":"a.bin"},{}]}"#;
        assert_eq!(files_of(scene), ["a.bin", "c.bin"]);
        assert!(files_of(b"{").is_empty());
    }
}

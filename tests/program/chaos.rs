//! A writer of all bad habits: plain, slow, in two passes, by renames, with pauses.

use std::fs;
use std::path::Path;
use std::thread;
use std::time::Duration;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Saves `whole` over `path` in one of six ways, drawn by `rng`.
pub fn save(path: &Path, whole: &[u8], rng: &mut ChaCha8Rng) {
    let (temp, old) = (path.with_extension("tmp"), path.with_extension("bak"));
    match rng.random_range(0..6) {
        0 => fs::write(path, whole).unwrap(),
        1 => {
            for end in [0, whole.len() / 2, whole.len() - 1, whole.len()] {
                fs::write(path, &whole[..end]).unwrap();
                thread::sleep(Duration::from_millis(rng.random_range(0..60)));
            }
        }
        2 => {
            fs::write(&temp, whole).unwrap();
            fs::rename(&temp, path).unwrap();
        }
        3 => {
            let _ = fs::rename(path, &old);
            thread::sleep(Duration::from_millis(rng.random_range(0..60)));
            fs::write(&temp, whole).unwrap();
            fs::rename(&temp, path).unwrap();
        }
        4 => {
            let _ = fs::remove_file(path);
            fs::write(path, whole).unwrap();
        }
        _ => {
            fs::write(path, b"first EOF of a file that goes on").unwrap();
            fs::write(path, whole).unwrap();
        }
    }
}

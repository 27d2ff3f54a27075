//! stub
use crate::report::{Cancel, Error};
pub fn watch_folders(_: &crate::cli::WatchArgs, _: crate::config::Partial, _: &Cancel) -> Result<(), Error> {
    Ok(())
}
pub fn status(_: &[std::path::PathBuf]) -> Result<u8, Error> {
    Ok(0)
}
pub fn status_text(_: &u8) -> String {
    String::new()
}
pub fn doctor_lines() -> Vec<String> {
    vec![]
}

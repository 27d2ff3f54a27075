//! Any bytes as IFC and as glTF.
#![no_main]

#[path = "../checks/building.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    checks::check(bytes);
});

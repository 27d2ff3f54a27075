//! Any bytes that are a drawing, written back and changed.
#![no_main]

#[path = "../checks/dxf_patch.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    checks::check(bytes);
});

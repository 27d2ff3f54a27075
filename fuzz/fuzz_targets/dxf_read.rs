//! Any bytes as a DXF.
#![no_main]

#[path = "../checks/dxf_read.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    checks::check(bytes);
});

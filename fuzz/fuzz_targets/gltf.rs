//! Any bytes as glTF or GLB.
#![no_main]

#[path = "../checks/building.rs"]
mod building;
#[path = "../checks/gltf.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    checks::check(bytes);
});

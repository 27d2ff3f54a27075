//! Writes the drawings of `samples/` anew: `cargo run --example make_samples`.

mod building;
mod dxf;
mod plans;

fn main() -> std::io::Result<()> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    std::fs::create_dir_all(&folder)?;
    for (name, text) in plans::all() {
        std::fs::write(folder.join(name), text)?;
        println!("samples/{name}");
    }
    for (name, bytes) in building::all() {
        std::fs::write(folder.join(name), bytes)?;
        println!("samples/{name}");
    }
    Ok(())
}

//! Parses the command line, calls, and turns the outcome into an exit code.
fn main() {}

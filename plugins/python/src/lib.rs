//! Enfilade for Python: see `glue`. It is tested from Python; a test program would have no interpreter to link with.

#[cfg(not(test))]
mod glue;

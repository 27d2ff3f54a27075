//! What moves takes with it.

mod mitre;

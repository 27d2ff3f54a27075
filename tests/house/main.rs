//! Rules of the house, the documents, the samples.

mod documents;
mod measures;
mod samples;
mod tidy;

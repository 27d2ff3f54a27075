//! Rules of the house, the documents, the samples.

mod documents;
mod samples;
mod tidy;

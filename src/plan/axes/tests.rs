//! Tests of the understanding.

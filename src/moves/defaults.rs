//! Default moves.

//! The optimiser: vectors, bounds and a seed in; asks and is told; knows no wall.

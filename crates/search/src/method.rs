//! The two methods behind one face.

use super::archive::{Archive, Limits};
use super::guided::Guided;
use super::hierarchy::Hierarchy;
use super::space::Space;
use super::tuning::Tuning;
use super::{Method, Study};

/// State of the method chosen.
#[derive(Clone, Debug)]
pub(super) enum Engine {
    Default(Box<Guided>),
    Paper(Box<Hierarchy>),
}

impl Engine {
    pub(super) fn new(study: &Study, space: &Space, tuning: Tuning) -> Self {
        match study.method {
            Method::Default => Self::Default(Box::new(Guided::new(study, tuning))),
            Method::Paper => Self::Paper(Box::new(Hierarchy::new(study, space.unit(&study.start)))),
        }
    }

    /// Up to `count` points of the unit cube, at least one unless converged.
    pub(super) fn ask(&mut self, archive: &Archive, count: usize) -> Vec<Vec<f64>> {
        match self {
            Self::Default(guided) => guided.ask(archive, count),
            Self::Paper(hierarchy) => hierarchy.ask(archive, count),
        }
    }

    pub(super) fn set_budget(&mut self, evaluations: u64) {
        match self {
            Self::Default(guided) => guided.set_budget(evaluations),
            Self::Paper(hierarchy) => hierarchy.set_budget(evaluations),
        }
    }

    /// Learns from the archive points from `first` on, in the order they were asked.
    pub(super) fn tell(&mut self, archive: &Archive, first: usize) {
        match self {
            Self::Default(guided) => guided.tell(archive, first),
            Self::Paper(hierarchy) => hierarchy.tell(archive, first),
        }
    }

    /// The diverse set as it stands, as archive indices.
    pub(super) fn members(&self, archive: &Archive) -> Vec<usize> {
        match self {
            Self::Default(guided) => guided.members(archive),
            Self::Paper(hierarchy) => hierarchy.members(),
        }
    }

    pub(super) fn limits(&self) -> &Limits {
        match self {
            Self::Default(guided) => guided.limits(),
            Self::Paper(hierarchy) => hierarchy.limits(),
        }
    }

    /// What is left of the thresholds stated.
    pub(super) fn threshold_share(&self) -> f64 {
        match self {
            Self::Default(guided) => guided.threshold_share(),
            Self::Paper(_) => 1.0,
        }
    }

    /// Index of the objective being climbed.
    pub(super) fn stage(&self) -> usize {
        match self {
            Self::Default(guided) => guided.stage(),
            Self::Paper(hierarchy) => hierarchy.stage(),
        }
    }

    pub(super) fn is_spreading(&self) -> bool {
        match self {
            Self::Default(guided) => guided.is_spreading(),
            Self::Paper(hierarchy) => hierarchy.is_spreading(),
        }
    }

    /// Smallest `dn` between members as they stand; 0 while there are fewer than two.
    pub(super) fn min_distance(&self, archive: &Archive) -> f64 {
        match self {
            Self::Default(guided) => guided.min_distance(archive),
            Self::Paper(hierarchy) => hierarchy.min_distance(archive),
        }
    }

    pub(super) fn is_converged(&self, archive: &Archive) -> bool {
        match self {
            Self::Default(guided) => guided.is_converged(archive),
            Self::Paper(hierarchy) => hierarchy.is_converged(),
        }
    }
}

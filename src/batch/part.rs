//! A job that is a part of one large analysis.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{FINISHED, Job, RESULT, sha256_hex};
use crate::store::{Home, led_to, read_own};
use enfilade_overlay::result::to_json;
use enfilade_pipeline::cells::CellOptions;
use enfilade_pipeline::parts::Part;
use enfilade_report::{Error, OutFile};

/// `schema` of a [`FinishedPart`].
pub const PART_SCHEMA: &str = "enfilade.part-result/1";
/// The values of a part, among its results.
const VALUES: &str = "part.bin";

/// Which part of which measures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartOf {
    /// From 1.
    pub number: u32,
    /// How many there are.
    pub count: u32,
    /// Measures of every cell, as `analyse` takes them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub measures: Vec<String>,
    /// Nothing farther counts, as `analyse` takes it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// The drawing as its user named it, which results show and which decides nothing.
    pub named: String,
}

impl PartOf {
    /// What decides its result.
    pub(super) fn deciding(&self) -> Self {
        Self { named: String::new(), ..self.clone() }
    }

    /// What is measured.
    pub fn options(&self) -> CellOptions {
        CellOptions { measures: self.measures.clone(), radius: self.radius, ..CellOptions::default() }
    }
}

/// What a finished part says of itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FinishedPart {
    /// [`PART_SCHEMA`].
    pub schema: String,
    /// Id of the job.
    pub id: String,
    /// Name of the drawing.
    pub drawing: String,
    /// Storey, if one was named.
    pub storey: Option<String>,
    /// From 1.
    pub number: u32,
    /// How many parts there are.
    pub count: u32,
    /// SHA-256 of its values: equal on every machine.
    pub digest: String,
    /// Always 0: the report is that of the whole analysis.
    pub exit_code: u8,
    /// Cells of the whole analysis.
    pub cells: u64,
    /// Time taken.
    pub seconds: f64,
    /// Processor time taken, seconds.
    pub worked_seconds: f64,
    /// All of it in words.
    pub words: String,
}

impl Job {
    /// The job as a part of an analysis, which decides its result too.
    pub fn with_part(mut self, part: PartOf) -> Self {
        self.part = Some(part);
        self.id = self.id_of();
        self
    }

    /// An id that all parts of the same analysis share.
    pub fn analysis_id(&self) -> String {
        let part = self.part.clone().map(|part| PartOf { number: 0, ..part });
        Self { part, ..self.clone() }.id_of()
    }

    /// What an earlier run of the same part left, if it did and its values are as they were written.
    pub fn finished_part(&self) -> Option<FinishedPart> {
        self.part_values().map(|(finished, _)| finished)
    }

    /// The same with the values.
    pub fn part_values(&self) -> Option<(FinishedPart, Vec<u8>)> {
        let result = led_to(&self.out).join(&self.id).join(RESULT);
        let found: FinishedPart = serde_json::from_slice(&read_own(&result.join(FINISHED)).ok()?).ok()?;
        let values = read_own(&result.join(Path::new(VALUES))).ok()?;
        (found.id == self.id && found.digest == sha256_hex(&values)).then_some((found, values))
    }

    /// Stores a finished part, which took so many seconds by the clock and of processor time.
    ///
    /// # Errors
    /// From the disk.
    pub fn publish_part(
        &self,
        home: &Home,
        (of, made): (&PartOf, Part),
        [seconds, worked_seconds]: [f64; 2],
    ) -> Result<FinishedPart, Error> {
        let PartOf { number, count, .. } = *of;
        let finished = FinishedPart {
            schema: PART_SCHEMA.into(),
            id: self.id.clone(),
            drawing: self.name(),
            storey: self.settings.storey.clone(),
            number,
            count,
            digest: sha256_hex(&made.bytes),
            exit_code: 0,
            cells: made.cells,
            seconds,
            worked_seconds,
            words: format!("part {number} of {count} of {} cells", made.cells),
        };
        let files = [OutFile::new(VALUES, made.bytes), OutFile::new(FINISHED, to_json(&finished)?)];
        home.publish_folder(RESULT, &files)?;
        Ok(finished)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use enfilade_config::Partial;

    #[test]
    fn parts_of_one_analysis_have_ids_of_their_own_and_one_together() {
        let job = |part: Option<PartOf>| {
            let job =
                Job::new(Path::new("p.dxf"), b"abc", Partial::default(), Path::new("out"), true).unwrap();
            part.map_or(job.clone(), |part| job.with_part(part))
        };
        let named = |number: u32, named: &str| PartOf {
            number,
            count: 3,
            measures: vec!["all".into()],
            radius: None,
            named: named.into(),
        };
        let part = |number: u32| named(number, "p.dxf");
        let [one, two] = [1, 2].map(|n| job(Some(part(n))));
        let other = job(Some(PartOf { radius: Some(3.0), ..part(1) }));
        assert!(one.id != two.id && one.id != job(None).id && one.id != other.id);
        assert!(one.analysis_id() == two.analysis_id() && one.analysis_id() != other.analysis_id());
        let back = Job::from_json(&one.to_line().unwrap()).unwrap();
        assert_eq!(back, one);
        assert_eq!(job(Some(named(1, "folder/p.dxf"))).id, one.id);
        assert!(!job(None).to_line().unwrap().contains("part"), "a round is listed as before");
    }
}

//! Points of public suites of test cases.

use super::Truth;

/// One point of a section of a suite.
#[derive(Clone, Debug)]
pub struct SuiteCase {
    /// The section, such as `5.2`.
    pub section: &'static str,
    /// What the section tests.
    pub title: &'static str,
    /// What is measured, and where.
    pub point: String,
    /// The unit of the page.
    pub unit: &'static str,
    /// What a reading is multiplied by to be in this unit.
    pub factor: f64,
    /// The scene and the expected reading.
    pub truth: Truth,
}

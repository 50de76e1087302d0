//! The truths of the oracle, and readings held to them.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use etalon_oracle::statistics::{Budget, Estimate};
use etalon_oracle::subjects::Reading;
use etalon_oracle::truths as known;
use etalon_oracle::truths::Truth;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::{Value, json};

use crate::errors::setting;

static TRUTHS: LazyLock<Vec<Truth>> = LazyLock::new(known::truths);

/// All truths as JSON: the list of the exchange folder, with each scene in place of its file.
#[pyfunction]
pub(crate) fn truths(py: Python<'_>) -> String {
    py.detach(|| {
        let files = known::exchange_files(&TRUTHS);
        let text =
            |path: &str| files.iter().find(|file| file.path == path).and_then(|file| str::from_utf8(&file.bytes).ok());
        let json = |path: &str| text(path).and_then(|text| serde_json::from_str::<Value>(text).ok());
        let mut list = json("truths.json").map_or(Value::Null, |mut list| list["truths"].take());
        for truth in list.as_array_mut().into_iter().flatten() {
            for key in ["scene", "white_scene"] {
                truth[key] = truth[key].as_str().and_then(json).unwrap_or(Value::Null);
            }
        }
        list.to_string()
    })
}

/// The files that the scene of each truth names, if it names any.
#[pyfunction]
pub(crate) fn truth_files(py: Python<'_>) -> BTreeMap<&str, BTreeMap<&str, Bound<'_, PyBytes>>> {
    let truths = py.detach(|| &*TRUTHS);
    let files = |truth: &'static Truth| {
        let named = truth.files.iter().map(|file| (file.name.as_str(), PyBytes::new(py, &file.bytes)));
        (truth.name.as_str(), named.collect())
    };
    truths.iter().filter(|truth| !truth.files.is_empty()).map(files).collect()
}

/// The exchange folder: the path and the bytes of each file.
#[pyfunction]
pub(crate) fn exchange_files(py: Python<'_>) -> Vec<(String, Bound<'_, PyBytes>)> {
    let files = py.detach(|| known::exchange_files(&TRUTHS));
    files.into_iter().map(|file| (file.path, PyBytes::new(py, &file.bytes))).collect()
}

/// Holds a reading to a truth; the verdict is JSON.
#[pyfunction]
#[pyo3(signature = (name, mean, standard_error, *, degrees_of_freedom, nonfinite, tests))]
pub(crate) fn judge(
    py: Python<'_>,
    name: &str,
    mean: f64,
    standard_error: f64,
    degrees_of_freedom: Option<f64>,
    nonfinite: u64,
    tests: usize,
) -> PyResult<String> {
    let truth = TRUTHS.iter().find(|truth| truth.name == name);
    let truth = truth.ok_or_else(|| setting(py, format!("there is no truth {name:?}: see etalon.oracle.truths()")))?;
    if standard_error < 0.0 || standard_error.is_nan() {
        return Err(setting(py, format!("the standard error is {standard_error}; it must not be below 0")));
    }
    if degrees_of_freedom.is_some_and(|freedom| freedom <= 0.0 || freedom.is_nan()) {
        return Err(setting(py, "there must be more than 0 degrees of freedom"));
    }
    if tests == 0 {
        return Err(setting(py, "tests is 0; it counts the truths that are judged together"));
    }
    let estimate = Estimate { mean, standard_error, degrees_of_freedom };
    let reading = Reading { estimate, nonfinite, cut_bias: 0.0 };
    let verdict = py.detach(|| known::judge(truth, &reading, Budget::for_tests(tests).each()));
    Ok(json!({
        "truth": truth.name,
        "value": truth.value(),
        "mean": mean,
        "standard_error": standard_error,
        "passed": verdict.pass,
        "statistic": verdict.statistic,
        "p": verdict.p,
        "resolvable_bias": verdict.resolvable_bias,
        "evidence": verdict.evidence,
    })
    .to_string())
}

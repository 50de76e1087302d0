//! Our errors as exceptions of the module `etalon._errors`.

use etalon::picture_files::PictureError;
use etalon::scene_model::Severity;
use etalon::{LoadError, PrepareError, Problem, RenderError, SceneError, SceneErrors};
use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError, PyRuntimeError};
use pyo3::prelude::*;
use serde_json::{Value, json};

/// An exception of this class with this message.
pub(crate) fn exception(py: Python<'_>, class: &str, message: &str) -> PyErr {
    make(py, class, (message,)).unwrap_or_else(|error| error)
}

/// A setting that makes no sense.
pub(crate) fn setting(py: Python<'_>, message: impl Into<String>) -> PyErr {
    exception(py, "SettingError", &message.into())
}

fn make<'py>(py: Python<'py>, class: &str, arguments: impl pyo3::call::PyCallArgs<'py>) -> PyResult<PyErr> {
    let class = py.import("etalon._errors")?.getattr(class)?;
    Ok(PyErr::from_value(class.call1(arguments)?))
}

/// A file that cannot be read, as the `OSError` that Python would raise.
fn io(path: &std::path::Path, error: &std::io::Error) -> PyErr {
    match error.raw_os_error() {
        Some(number) => PyOSError::new_err((number, describe(error), path.display().to_string())),
        None => PyOSError::new_err(format!("cannot read {}: {error}", path.display())),
    }
}

/// The system's reason, without the number that `OSError` shows itself.
fn describe(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_owned()
}

/// A problem as plain data.
pub(crate) fn problem(problem: &Problem) -> Value {
    json!({
        "severity": match problem.severity { Severity::Warning => "warning", Severity::Error => "error" },
        "code": problem.code.name(),
        "path": problem.json_path,
        "message": problem.message,
        "hint": problem.hint,
        "line": problem.line,
        "column": problem.column,
    })
}

fn problems(py: Python<'_>, errors: &SceneErrors) -> PyErr {
    let list: Vec<Value> = errors.problems.iter().map(problem).collect();
    let text = Value::Array(list).to_string();
    make(py, "scene_error", (errors.file_name.as_str(), text)).unwrap_or_else(|error| error)
}

/// Something that is wrong with a scene as a whole.
fn whole(py: Python<'_>, file_name: &str, code: &str, message: &str) -> PyErr {
    let list = json!([{
        "severity": "error", "code": code, "path": "$", "message": message, "hint": null, "line": null, "column": null,
    }]);
    make(py, "scene_error", (file_name, list.to_string())).unwrap_or_else(|error| error)
}

pub(crate) fn of_scene(py: Python<'_>, name: &str, error: &SceneError) -> PyErr {
    match error {
        SceneError::Load(LoadError::Io { path, source }) => io(path, source),
        SceneError::Load(LoadError::Invalid(errors)) => problems(py, errors),
        SceneError::Import(error) => whole(py, name, "import", &error.to_string()),
    }
}

pub(crate) fn of_prepare(py: Python<'_>, name: &str, error: &PrepareError) -> PyErr {
    whole(py, name, "prepare", &error.to_string())
}

pub(crate) fn of_render(py: Python<'_>, error: RenderError) -> PyErr {
    match error {
        RenderError::Setting(_) | RenderError::Outside { .. } | RenderError::PathReuse(_) => {
            setting(py, error.to_string())
        }
        RenderError::NoLight { .. } => exception(py, "NoLightError", &error.to_string()),
        RenderError::Interrupted => PyKeyboardInterrupt::new_err(()),
        RenderError::Threads(error) => PyRuntimeError::new_err(error.to_string()),
        RenderError::Picture(error) => of_picture(py, &error),
    }
}

pub(crate) fn of_picture(py: Python<'_>, error: &PictureError) -> PyErr {
    if let PictureError::Io { path, source, .. } = error {
        return io(path, source);
    }
    exception(py, "PictureError", &error.with_causes())
}

/// A fault of ours: a thread has ended by a panic.
pub(crate) fn internal(panic: &(dyn std::any::Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
    PyRuntimeError::new_err(format!("this is a fault of Etalon: {}", text.unwrap_or("a thread ended by itself")))
}

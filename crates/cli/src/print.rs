//! Standard output and standard error.

use std::io::{ErrorKind, Write};
use std::process::exit;

use miette::Report;
use serde::Serialize;

/// Prints a JSON object on standard output.
pub(crate) fn json(value: &impl Serialize) {
    line(&serde_json::to_string_pretty(value).expect("a report is plain data with text keys"));
}

/// Prints a line on standard output. A reader that has gone (`etalon … | head`) ends the program quietly.
pub(crate) fn line(text: &str) {
    if let Err(error) = writeln!(std::io::stdout().lock(), "{text}") {
        if error.kind() != ErrorKind::BrokenPipe {
            warnings(&[miette::miette!("cannot write to standard output: {error}")]);
        }
        exit(1);
    }
}

/// Prints a line on standard output for whoever reads it; false if nobody can.
pub(crate) fn line_if_read(text: &str) -> bool {
    writeln!(std::io::stdout().lock(), "{text}").is_ok()
}

/// Prints a line on standard error.
pub(crate) fn note(text: &str) {
    // Where standard error has gone there is nobody left to tell.
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// Prints warnings and errors on standard error.
pub(crate) fn warnings<'a>(warnings: impl IntoIterator<Item = &'a Report>) {
    for warning in warnings {
        // Where standard error has gone there is nobody left to tell.
        let _ = writeln!(std::io::stderr().lock(), "{warning:?}");
    }
}

/// How problems are drawn: lines are broken for a terminal only, so that logs can be searched.
pub(crate) fn set_up_reports() {
    use std::io::IsTerminal;
    let hook = miette::set_hook(Box::new(|_| {
        let options = miette::MietteHandlerOpts::new().terminal_links(false).context_lines(1);
        let options = if std::io::stderr().is_terminal() { options } else { options.width(100_000) };
        Box::new(options.build())
    }));
    hook.expect("the hook is set once, first of all");
}

//! A study as one page of HTML that asks for nothing else.

use std::fmt::Write;

use super::StudyReport;
use super::plots::Plot;
use super::report::{LEGEND, about, cells, columns, heading, samplers, verdict};

const STYLE: &str = "\
body{font:15px/1.45 system-ui,sans-serif;margin:2em auto;max-width:1300px;padding:0 1em;color:#222}\
table{border-collapse:collapse;margin:1em 0;font-variant-numeric:tabular-nums}\
th,td{padding:.2em .7em;text-align:right;border-bottom:1px solid #ddd}\
th:first-child,td:first-child{text-align:left}th{border-bottom:2px solid #888}\
.plots{display:grid;grid-template-columns:repeat(auto-fit,minmax(520px,1fr));gap:1em}\
.plots svg{width:100%;height:auto;border:1px solid #eee}nav a{margin-right:1em}";

/// The page, with the plots of each scene drawn in it.
pub(super) fn html(report: &StudyReport, plots: &[Vec<Plot>]) -> String {
    let mut text = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<link rel=\"icon\" href=\"data:,\">\n\
         <title>What accuracy costs in time</title>\n<style>{STYLE}</style>\n</head>\n<body>\n\
         <h1>What accuracy costs in time</h1>\n<p>{}</p>\n<p>{}</p>\n<nav>",
        escaped(&heading(report)),
        escaped(LEGEND).replace("**", "")
    );
    for study in &report.scenes {
        let name = escaped(&study.scene);
        // Writing to a String cannot fail.
        let _ = write!(text, "<a href=\"#{name}\">{name}</a>");
    }
    text.push_str("</nav>\n");
    let verdicts = samplers(report);
    if !verdicts.is_empty() {
        let _ =
            write!(text, "<h2>Owen-Sobol against independent numbers</h2>\n<p>{}</p>\n", escaped(&verdict(&verdicts)));
        text.push_str("<table><tr><th>scene</th><th>time to the same error, independent over Sobol</th><th>slope of Sobol</th><th>slope of independent</th></tr>\n");
        for scene in &verdicts {
            let cells = scene.cells().map(|cell| format!("<td>{}</td>", escaped(&cell)));
            let _ = writeln!(text, "<tr>{}</tr>", cells.concat());
        }
        text.push_str("</table>\n");
    }
    for (study, plots) in report.scenes.iter().zip(plots) {
        let name = escaped(&study.scene);
        let _ = write!(text, "<h2 id=\"{name}\">{name}</h2>\n<p>{}</p>\n<table>\n<tr>", escaped(&about(study)));
        for column in columns() {
            let _ = write!(text, "<th>{}</th>", escaped(column));
        }
        text.push_str("</tr>\n");
        for row in &study.rows {
            text.push_str("<tr>");
            for cell in cells(row, study) {
                let _ = write!(text, "<td>{}</td>", escaped(&cell));
            }
            text.push_str("</tr>\n");
        }
        text.push_str("</table>\n<div class=\"plots\">\n");
        for plot in plots {
            // A size in pixels would keep the plot from fitting the column; the view box stays.
            let _ = writeln!(text, "<figure id=\"{}\" style=\"margin:0\">{}</figure>", escaped(&plot.name), plot.svg);
        }
        text.push_str("</div>\n");
    }
    text.push_str("</body>\n</html>\n");
    text
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

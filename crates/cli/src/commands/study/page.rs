//! A study as one page of HTML that asks for nothing else.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::StudyReport;
use super::measure::{SceneStudy, Stage};
use super::pictures::Pictures;
use super::plots::Plot;
use super::report::{LEGEND, about, cells, columns, heading, headline, samplers, verdict};
use crate::progress::{duration, percent};

const STYLE: &str = "\
*{box-sizing:border-box}body{font:16px/1.45 system-ui,sans-serif;margin:1.5em auto;max-width:1300px;padding:0 1em;color:#222}\
img{width:100%;height:auto;display:block;image-rendering:pixelated;background:#000}\
.cards{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,210px),1fr));gap:1em;margin:1.5em 0}\
.cards a{color:inherit;text-decoration:none;border:1px solid #ddd;border-radius:6px;overflow:hidden}\
.cards b,.cards span{display:block;padding:.3em .7em 0}.cards span{font-size:.88em;padding-bottom:.6em}\
.strip{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(30%,150px),1fr));gap:.4em;margin:1em 0}\
figure{margin:0}figcaption{text-align:center;font-size:.9em}figcaption b{display:block}\
.plots{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,410px),1fr));gap:1em}\
.plots svg{width:100%;height:auto;border:1px solid #eee}\
summary{cursor:pointer;padding:.4em 0}.wide{overflow-x:auto}\
table{border-collapse:collapse;margin:1em 0;font-variant-numeric:tabular-nums;font-size:.92em}\
th,td{padding:.2em .7em;text-align:right;border-bottom:1px solid #ddd;white-space:nowrap}\
th:first-child,td:first-child{text-align:left}th{border-bottom:2px solid #888}";

/// The page, with the pictures and plots of each scene in it.
pub(super) fn html(report: &StudyReport, drawn: &[(Pictures, Vec<Plot>)]) -> String {
    let mut text = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<link rel=\"icon\" href=\"data:,\">\n\
         <title>What accuracy costs in time</title>\n<style>{STYLE}</style>\n</head>\n<body>\n\
         <h1>What accuracy costs in time</h1>\n<nav class=\"cards\">\n"
    );
    for (study, (pictures, _)) in report.scenes.iter().zip(drawn) {
        let (name, headline) = (escaped(&study.scene), escaped(&headline(study)));
        let picture = image(&pictures.reference, &study.scene);
        // Writing to a String cannot fail.
        let _ = writeln!(text, "<a href=\"#{name}\">{picture}<b>{name}</b><span>{headline}</span></a>");
    }
    text.push_str("</nav>\n");
    let verdicts = samplers(report);
    if !verdicts.is_empty() {
        let _ = writeln!(text, "<p>{}</p>", escaped(&verdict(&verdicts)));
        let head =
            ["scene", "time to the same error, independent over Sobol", "slope of Sobol", "slope of independent"];
        let rows = verdicts.iter().map(|scene| scene.cells().to_vec());
        folded(&mut text, "Owen-Sobol against independent numbers", &table(&head, rows));
    }
    folded(&mut text, "What the numbers mean", &format!("<p>{}</p>", escaped(LEGEND).replace("**", "")));
    for (study, (pictures, plots)) in report.scenes.iter().zip(drawn) {
        scene(&mut text, study, pictures, plots);
    }
    let _ = write!(text, "<footer><p>{}</p></footer>\n</body>\n</html>\n", escaped(&heading(report)));
    text
}

/// A scene: what it costs in a few words, the middle of its picture after more and more samples, plots, and all numbers folded away.
fn scene(text: &mut String, study: &SceneStudy, pictures: &Pictures, plots: &[Plot]) {
    let name = escaped(&study.scene);
    let _ =
        writeln!(text, "<h2 id=\"{name}\">{name}</h2>\n<p>{}</p>\n<div class=\"strip\">", escaped(&headline(study)));
    let last = study.pictures.len() - 1;
    for (place, (stage, png)) in study.pictures.iter().zip(&pictures.middles).enumerate() {
        let caption = caption(stage, place == last);
        let alt = format!("{} after {} samples a pixel", study.scene, stage.samples);
        let _ = writeln!(text, "<figure>{}<figcaption>{caption}</figcaption></figure>", image(png, &alt));
    }
    text.push_str("</div>\n<div class=\"plots\">\n");
    for plot in plots {
        // A size in pixels would keep the plot from fitting the column; the view box stays.
        let _ = writeln!(text, "<figure id=\"{}\">{}</figure>", escaped(&plot.name), plot.svg);
    }
    text.push_str("</div>\n");
    let rows = study.rows.iter().map(|row| cells(row, study).to_vec());
    let numbers = format!("<p>{}</p>\n{}", escaped(&about(study)), table(&columns(), rows));
    folded(text, &format!("{name}: all choices"), &numbers);
}

fn caption(stage: &Stage, is_reference: bool) -> String {
    let error = stage.error.map_or_else(|| "error unknown".to_owned(), percent);
    let of = if is_reference { "reference, " } else { "" };
    format!("<b>{error}</b>{of}{}", duration(stage.seconds))
}

fn image(png: &[u8], alt: &str) -> String {
    format!("<img alt=\"{}\" src=\"data:image/png;base64,{}\">", escaped(alt), STANDARD.encode(png))
}

/// A table of cells that are plain text.
fn table(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let line = |tag: &str, cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|cell| format!("<{tag}>{}</{tag}>", escaped(cell))).collect();
        format!("<tr>{}</tr>\n", cells.concat())
    };
    let head: Vec<String> = head.iter().map(|&cell| cell.to_owned()).collect();
    let rows: Vec<String> = rows.map(|cells| line("td", &cells)).collect();
    format!("<div class=\"wide\"><table>\n{}{}</table></div>\n", line("th", &head), rows.concat())
}

/// What is shown when its title is clicked.
fn folded(text: &mut String, title: &str, html: &str) {
    let _ = writeln!(text, "<details><summary>{title}</summary>\n{html}</details>");
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

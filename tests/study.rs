//! The study of a scene and its page, as a user meets them.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::support::{entries, etalon_line, scene};

fn small_study(folder: &Path) -> String {
    let line = "study {} -o {} --width 24 --seconds 0.05s --only sampler,light,effects -q";
    etalon_line(line, [&scene("cornell.json"), folder]).expect(0);
    std::fs::read_to_string(folder.join("study.html")).unwrap()
}

#[test]
fn a_study_writes_tables_plots_and_a_page_that_asks_for_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let page = small_study(folder.path());
    let names = entries(folder.path());
    for name in ["study.html", "study.json", "study.md", "cornell.png", "cornell-numbers.svg", "cornell-prices.svg"] {
        assert!(names.iter().any(|other| other == name), "{name} is not in {names:?}");
    }
    let json: Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join("study.json")).unwrap()).unwrap();
    let rows = json["scenes"][0]["rows"].as_array().unwrap();
    let row = |name: &str| rows.iter().find(|row| row["choice"] == name).unwrap_or_else(|| panic!("no {name}"));
    assert_eq!(rows[0]["choice"], "as it is");
    assert!(row("independent numbers")["slope"].as_f64().unwrap() < row("as it is")["slope"].as_f64().unwrap());
    assert_eq!(row("BSDF only")["shadow_rays_per_path"], 0.0);
    // Pictures are in the page. There is one on the card of the scene, and then one for each number of samples and the reference.
    let page = without_pictures(&page);
    let stages = rows[0]["points"].as_array().unwrap().len() + 1;
    assert_eq!(page.matches("<img").count(), 1 + stages);
    // Nothing is fetched: the only addresses are the names of XML namespaces, which nobody opens.
    let addresses: Vec<&str> =
        page.match_indices("//").map(|(at, _)| &page[at.saturating_sub(6)..(at + 20).min(page.len())]).collect();
    assert!(addresses.iter().all(|address| address.contains("www.w3.org")), "{addresses:?}");
    for tag in ["<script", "<link rel=\"stylesheet", "src=", "@import", "url("] {
        assert!(!page.contains(tag), "{tag}");
    }
    let plots = names.iter().filter(|name| name.ends_with(".svg")).count();
    assert_eq!(page.matches("<svg").count(), plots);
    let markdown = std::fs::read_to_string(folder.path().join("study.md")).unwrap();
    assert!(markdown.contains("| as it is |") && markdown.contains("cornell-prices.svg"));
    assert!(page.contains(" error after ") && markdown.contains(" error after "));
}

/// A page without the pictures that it holds itself.
fn without_pictures(page: &str) -> String {
    let mut parts = page.split(" src=\"data:image/png;base64,");
    let first = parts.next().unwrap().to_owned();
    parts.fold(first, |text, part| text + part.split_once('"').unwrap().1)
}

/// The colour and the dashes that a plot's legend gives to a choice.
#[test]
fn a_choice_has_one_colour_in_all_plots_of_a_page() {
    let folder = tempfile::tempdir().unwrap();
    let line = "study {} {} -o {} --width 12 --seconds 0.01s --only sampler,light -q";
    etalon_line(line, [&scene("cornell.json"), &scene("veach-mis.json"), folder.path()]).expect(0);
    let lines = |name: &str| -> Vec<String> {
        let svg = std::fs::read_to_string(folder.path().join(name)).unwrap();
        let colours = svg.split("stroke=\"#").skip(1).map(|rest| rest[..6].to_owned());
        let mut seen: Vec<String> = colours.filter(|colour| colour != "000000").collect();
        seen.sort();
        seen.dedup();
        seen
    };
    for group in ["numbers", "light"] {
        let [first, second] = ["cornell", "veach-mis"].map(|scene| lines(&format!("{scene}-{group}.svg")));
        assert!(!first.is_empty() && first == second, "{group}: {first:?} {second:?}");
    }
    assert_ne!(lines("cornell-numbers.svg"), lines("cornell-light.svg"));
}

#[test]
fn a_browser_draws_every_plot_of_the_page_on_a_laptop_and_on_a_phone() {
    let browser = ["chromium", "chromium-browser", "google-chrome"]
        .into_iter()
        .find(|name| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success()));
    let Some(browser) = browser else {
        // The test runner shows this with --nocapture; .ci/run installs the browser where it can.
        #[allow(clippy::print_stderr)]
        {
            eprintln!("there is no Chromium here: the page of the study was not opened");
        }
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    small_study(folder.path());
    // A probe at the end of the page tells what was laid out; the page itself has no script.
    let page = folder.path().join("probe.html");
    let probe = "<pre id=\"probe\"></pre><script>
        const plots = [...document.querySelectorAll('svg')].map(s => s.getBoundingClientRect());
        const marks = [...document.querySelectorAll('svg')].map(s => s.querySelectorAll('polyline,rect,circle,line').length);
        document.getElementById('probe').textContent = 'PROBE ' + JSON.stringify({
            plots: plots.map(r => [r.left, r.right, r.width, r.height]), marks,
            wide: document.documentElement.scrollWidth, requests: performance.getEntriesByType('resource').length });
        </script></body>";
    let html = std::fs::read_to_string(folder.path().join("study.html")).unwrap().replace("</body>", probe);
    std::fs::write(&page, html).unwrap();
    for (window, least) in [([1366, 768], 400.0), ([500, 900], 400.0)] {
        let seen = laid_out(browser, folder.path(), &page, window);
        let width = f64::from(window[0]);
        assert_eq!(seen["requests"], 0);
        assert!(seen["wide"].as_f64().unwrap() <= width, "it must be scrolled sideways: {seen}");
        let plots: Vec<[f64; 4]> = serde_json::from_value(seen["plots"].clone()).unwrap();
        assert!(plots.len() >= 3);
        for [left, right, wide, high] in plots {
            assert!(left >= 0.0 && right <= width && wide >= least && high >= 80.0, "{left} {right} {wide} {high}");
        }
        let marks: Vec<u32> = serde_json::from_value(seen["marks"].clone()).unwrap();
        assert!(marks.iter().all(|&marks| marks >= 8), "an empty plot: {marks:?}");
    }
}

/// What the probe of a page tells in a window of this size.
fn laid_out(browser: &str, folder: &Path, page: &Path, [width, height]: [u32; 2]) -> Value {
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"])
        .arg(format!("--window-size={width},{height}"))
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .args(["--dump-dom", &format!("file://{}", page.display())])
        .output()
        .expect("the browser starts");
    let dom = String::from_utf8_lossy(&output.stdout);
    // The word stands in the script too; the last one is what the script wrote, or the script itself if it did not run.
    let start = dom.find("PROBE {").unwrap_or_else(|| panic!("the page did not run: {dom:.2000}"));
    let end = dom[start..].find("</pre>").unwrap() + start;
    serde_json::from_str(&dom[start + "PROBE ".len()..end]).unwrap()
}

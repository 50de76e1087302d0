//! The server as others meet it: who is let in, what is refused, what a page gets.

use std::io::{Read, Write};
use std::net::{IpAddr, Ipv4Addr, TcpStream};
use std::sync::OnceLock;
use std::time::{Duration, Instant, SystemTime};

use etalon_picture::{Attributes, ExrFile, Picture};
use etalon_view::{LoadedScene, SceneSource, Source, Token, Viewer};

const LOOPBACK: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);
const TOKEN: &str = "0123456789abcdef-for-tests";

/// Starts a server in this process and returns its port.
fn serve(source: Source) -> u16 {
    let viewer = Viewer::bind(source, LOOPBACK, 0, Token::new(TOKEN).unwrap()).unwrap();
    let address = viewer.address().to_owned();
    let port = address.split([':', '/']).nth(4).unwrap().parse().unwrap();
    assert_eq!(address, format!("http://127.0.0.1:{port}/{TOKEN}/"));
    std::thread::spawn(move || viewer.run());
    port
}

/// A server that shows a picture of two pixels.
fn picture_port() -> u16 {
    static PORT: OnceLock<u16> = OnceLock::new();
    *PORT.get_or_init(|| {
        let picture = Picture::from_rgb(2, 1, &[[0.25_f32; 3], [0.5, 0.25, 0.125]]).unwrap();
        let file = ExrFile { picture, attributes: Attributes::new() };
        serve(Source::Picture { name: "two.exr".to_owned(), file: Box::new(file) })
    })
}

/// A server that renders a grey ball under an even sky, with 16 × 16 pixels on one thread.
fn scene_port() -> u16 {
    static PORT: OnceLock<u16> = OnceLock::new();
    *PORT.get_or_init(|| {
        let text = r#"{
            "etalon": 1,
            "camera": {"type": "perspective", "position_m": [0, 0, 4], "look_at_m": [0, 0, 0], "vertical_fov_deg": 40},
            "film": {"width": 16, "height": 16},
            "materials": {"grey": {"type": "lambert", "reflectance": 0.5}},
            "objects": [{"name": "ball", "shape": {"type": "sphere", "radius_m": 1}, "material": "grey"}],
            "lights": [{"type": "environment", "radiance": 1}]
        }"#;
        let load = || {
            let (scene, _) = etalon_scene::parse(text, "ball.json").expect("a valid scene");
            let (sha256, began) = ("0".to_owned(), SystemTime::now());
            Ok(LoadedScene { scene, sha256, warnings: Vec::new(), files: Vec::new(), began })
        };
        serve(Source::Scene(Box::new(SceneSource {
            name: "ball.json".to_owned(),
            first: load().unwrap(),
            load: Box::new(load),
            study: Default::default(),
            error: 0.05,
            threads: Some(1),
        })))
    })
}

/// Sends bytes and returns status, head and body of the answer.
fn exchange(port: u16, request: &[u8]) -> (u16, String, Vec<u8>) {
    let mut stream = TcpStream::connect((LOOPBACK, port)).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
    stream.write_all(request).unwrap();
    let mut answer = Vec::new();
    // A server that refuses may close before all is read.
    let _ = stream.read_to_end(&mut answer);
    let end = answer.windows(4).position(|four| four == b"\r\n\r\n").unwrap_or(answer.len());
    let head = String::from_utf8_lossy(&answer[..end]).to_lowercase();
    let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or(0);
    (status, head, answer.get(end + 4..).unwrap_or_default().to_vec())
}

fn request(port: u16, method: &str, path: &str, headers: &[&str], body: &str) -> (u16, String, Vec<u8>) {
    let host = if headers.iter().any(|header| header.starts_with("Host:")) { "" } else { "Host: 127.0.0.1\r\n" };
    let headers: String = headers.iter().map(|header| format!("{header}\r\n")).collect();
    let length = body.len();
    let text = format!(
        "{method} {path} HTTP/1.1\r\n{host}{headers}Content-Length: {length}\r\nConnection: close\r\n\r\n{body}"
    );
    exchange(port, text.as_bytes())
}

fn get(port: u16, path: &str) -> (u16, String, Vec<u8>) {
    request(port, "GET", &format!("/{TOKEN}/{path}"), &[], "")
}

const JSON: &str = "Content-Type: application/json";

fn post(port: u16, path: &str, body: &str) -> u16 {
    request(port, "POST", &format!("/{TOKEN}/do/{path}"), &[JSON], body).0
}

#[test]
fn the_page_and_its_files_come_with_a_policy_that_forbids_all_else() {
    for name in ["", "index.html", "app.js", "style.css"] {
        let (status, head, body) = get(picture_port(), name);
        assert!(status == 200 && !body.is_empty(), "{name}: {head}");
        for policy in ["default-src 'none'", "frame-ancestors 'none'", "x-content-type-options: nosniff", "no-store"] {
            assert!(head.contains(policy), "{name} lacks {policy}: {head}");
        }
    }
}

#[test]
fn without_the_token_there_is_nothing() {
    let port = picture_port();
    for path in [
        "/",
        "/index.html",
        "/ask/picture.png",
        "/0123456789abcdef-for-testz/",
        "//",
        "/0123456789abcdef-for-tests%2f/",
    ] {
        let (status, _, body) = request(port, "GET", path, &[], "");
        let body = String::from_utf8_lossy(&body);
        assert!(status == 403 && body.contains("token") && !body.contains("<html"), "{path}: {status} {body}");
    }
}

#[test]
fn other_hosts_and_origins_are_refused() {
    let port = picture_port();
    let page = format!("/{TOKEN}/");
    let with = |header: &str| request(port, "GET", &page, &[header], "").0;
    assert_eq!(with("Host: localhost:1234"), 200);
    assert_eq!(with("Host: rebound.example.org"), 421);
    assert_eq!(with("Origin: http://127.0.0.1"), 200);
    assert_eq!(with("Origin: http://example.org"), 403);
    assert_eq!(with("Sec-Fetch-Site: cross-site"), 403);
    let (status, ..) = exchange(port, format!("GET {page} HTTP/1.0\r\n\r\n").as_bytes());
    assert_eq!(status, 421);
}

#[test]
fn no_path_leads_to_a_file() {
    for path in [
        "../Cargo.toml",
        "..%2f..%2fCargo.toml",
        "%2e%2e/Cargo.toml",
        "ask/../../Cargo.toml",
        "/etc/passwd",
        "page/app.js",
    ] {
        let (status, _, body) = get(picture_port(), path);
        assert!(status == 404 && !String::from_utf8_lossy(&body).contains("workspace"), "{path}: {status}");
    }
}

#[test]
fn what_is_too_large_is_refused() {
    let port = scene_port();
    let long = " ".repeat(100_000);
    assert_eq!(post(port, "effects", &long), 413);
    let (status, ..) = request(port, "GET", &format!("/{TOKEN}/"), &[&format!("X-Long: {long}")], "");
    assert!(status == 431 || status == 0, "{status}");
}

#[test]
fn orders_that_make_no_sense_are_refused() {
    let port = scene_port();
    assert_eq!(request(port, "POST", &format!("/{TOKEN}/do/control"), &["Content-Type: text/plain"], "{}").0, 415);
    assert_eq!(request(port, "DELETE", &format!("/{TOKEN}/"), &[], "").0, 405);
    assert_eq!(post(port, "control", "{"), 400);
    assert_eq!(post(port, "control", r#"{"target": -1}"#), 422);
    assert_eq!(post(port, "effects", r#"{"without": ["gravity"]}"#), 422);
    let camera = |forward: &str| {
        let body = format!(r#"{{"camera": {{"position_m": [0, 0, 4], "forward": {forward}, "up": [0, 1, 0]}}}}"#);
        post(port, "camera", &body)
    };
    assert_eq!(camera("[0, 0, 0]"), 422);
    assert_eq!(camera("[0, 0, 1e999]"), 400);
    // A picture from a file has nothing to be moved.
    assert_eq!(post(picture_port(), "camera", r#"{"camera": null}"#), 409);
}

#[test]
fn a_picture_from_a_file_is_developed_and_told_pixel_by_pixel() {
    let port = picture_port();
    let (status, head, body) = get(port, "ask/picture.png?exposure=2");
    assert!(status == 200 && body.starts_with(b"\x89PNG") && head.contains("\"exposure_ev\":2.0"), "{head}");
    assert_eq!(get(port, "ask/picture.png?curve=curly").0, 422);
    let (status, _, body) = get(port, "ask/pixel?x=1&y=0");
    let pixel: serde_json::Value = serde_json::from_slice(&body).unwrap();
    assert!(status == 200 && pixel["rgb"] == serde_json::json!([0.5, 0.25, 0.125]), "{pixel}");
    assert_eq!(get(port, "ask/pixel?x=2&y=0").0, 404);
    // A spot that is to look white is told as a colour, which a look takes.
    let (status, _, body) = get(port, "ask/white?x=1&y=0");
    let spot: serde_json::Value = serde_json::from_slice(&body).unwrap();
    let white = spot["white"].as_str().unwrap();
    assert!(status == 200 && white.starts_with("xy:0."), "{spot}");
    assert_eq!(get(port, &format!("ask/picture.png?white={white}")).0, 200);
    assert_eq!(get(port, "ask/white?x=2&y=0").0, 422);
    // It has no errors, no bands and no paths.
    for lacking in ["ask/map.png?kind=relative", "ask/spectrum?x=0&y=0", "ask/paths?x=0&y=0&count=3"] {
        assert_eq!(get(port, lacking).0, 422, "{lacking}");
    }
    assert!(get(port, "ask/save.exr").2.starts_with(&[0x76, 0x2f, 0x31, 0x01]));
}

#[test]
fn a_spectral_picture_of_another_program_has_colour_and_spectra() {
    let mut picture = Picture::new(2, 1).unwrap();
    for (nm, radiance) in [(450, 0.1), (550, 0.2), (650, 0.9)] {
        picture.insert(&format!("S0.{nm},0nm"), vec![radiance, 0.0]).unwrap();
    }
    let file = ExrFile { picture, attributes: Attributes::new() };
    let port = serve(Source::Picture { name: "spectra.exr".to_owned(), file: Box::new(file) });
    assert_eq!(get(port, "ask/picture.png").0, 200);
    let json = |path: &str| -> serde_json::Value { serde_json::from_slice(&get(port, path).2).unwrap() };
    let bands = json("ask/spectrum?x=0&y=0");
    let told: Vec<(f64, f64)> = bands["bands"]
        .as_array()
        .unwrap()
        .iter()
        .map(|band| {
            assert!(band["error"].is_null());
            (band["centre_nm"].as_f64().unwrap(), band["radiance"].as_f64().unwrap())
        })
        .collect();
    assert!(
        told.iter()
            .zip([(450.0, 0.1), (550.0, 0.2), (650.0, 0.9)])
            .all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() < 1e-6)
    );
    let rgb = json("ask/pixel?x=0&y=0")["rgb"].clone();
    assert!(rgb[0].as_f64() > rgb[2].as_f64() && rgb[0].as_f64() > Some(0.1), "{rgb}");
}

/// The first event, and any after it for which `is_enough`.
fn status_when(port: u16, is_enough: impl Fn(&serde_json::Value) -> bool) -> serde_json::Value {
    let mut stream = TcpStream::connect((LOOPBACK, port)).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    stream.write_all(format!("GET /{TOKEN}/ask/events HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n").as_bytes()).unwrap();
    let (mut text, mut bytes, start) = (String::new(), [0; 4096], Instant::now());
    while start.elapsed() < Duration::from_secs(30) {
        let read = stream.read(&mut bytes).unwrap();
        text += &String::from_utf8_lossy(&bytes[..read]);
        let events =
            text.split("data: ").skip(1).filter_map(|event| serde_json::from_str(event.split_once("\n\n")?.0).ok());
        if let Some(status) = events.into_iter().find(&is_enough) {
            return status;
        }
    }
    panic!("not told in 30 s: {text}");
}

#[test]
fn a_scene_is_rendered_to_its_error_and_inspected() {
    let port = scene_port();
    let done = status_when(port, |status| status["phase"] == "done" && status["block"] == 1);
    assert!(done["error"]["relative_rmse"].as_f64().is_some_and(|error| error < 0.07), "{done}");
    assert!(done["predicted"].as_array().is_some_and(|predicted| predicted.len() > 5));
    let ask = |path: &str| -> serde_json::Value {
        let (status, _, body) = get(port, path);
        assert_eq!(status, 200, "{path}: {}", String::from_utf8_lossy(&body));
        serde_json::from_slice(&body).unwrap()
    };
    let pixel = ask("ask/pixel?x=8&y=8");
    assert_eq!((&pixel["object"]["object"], &pixel["object"]["material"]), (&"ball".into(), &"grey".into()));
    // The ball shows its reflectance everywhere. Seven standard errors: of 35 bands one is beyond by chance in 10⁹ tests or fewer, but
    // four replicates know their error poorly, so the mean of all bands is tested.
    let spectrum = ask("ask/spectrum?x=8&y=8&count=4096");
    let bands = spectrum["bands"].as_array().unwrap();
    let mean = bands.iter().map(|band| band["radiance"].as_f64().unwrap()).sum::<f64>() / bands.len() as f64;
    assert!(bands.len() >= 30 && (mean - 0.5).abs() < 0.02, "{mean} in {} bands", bands.len());
    let paths = ask("ask/paths?x=8&y=8&count=5");
    let paths = paths.as_array().unwrap();
    assert!(paths.len() == 5 && paths.iter().all(|path| path["vertices"][0]["object"] == "ball"), "{paths:?}");
    assert!(paths.iter().all(|path| {
        let pixel: Vec<f64> =
            path["vertices"][0]["pixel"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
        (7.0..=10.0).contains(&pixel[0]) && (7.0..=10.0).contains(&pixel[1])
    }));
    assert!(get(port, "ask/map.png?kind=of-mean").2.starts_with(b"\x89PNG"));
    assert_eq!(get(port, "ask/map.png?kind=difference").0, 422);
}

#[test]
fn connections_are_limited() {
    let port = serve(Source::Picture {
        name: "one.exr".to_owned(),
        file: Box::new(ExrFile {
            picture: Picture::from_rgb(1, 1, &[[1.0_f32; 3]]).unwrap(),
            attributes: Attributes::new(),
        }),
    });
    let listen = || {
        let mut stream = TcpStream::connect((LOOPBACK, port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        stream.write_all(format!("GET /{TOKEN}/ask/events HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n").as_bytes()).unwrap();
        let mut head = [0; 12];
        let read = stream.read(&mut head).unwrap_or(0);
        (String::from_utf8_lossy(&head[..read]).to_string(), stream)
    };
    // Sixteen pages look on; the next is told so, and after sixty-four connections the server takes no more.
    let pages: Vec<_> = (0..16).map(|_| listen()).collect();
    assert!(pages.iter().all(|(head, _)| head == "HTTP/1.1 200"), "{pages:?}");
    assert_eq!(listen().0, "HTTP/1.1 503");
    let connect = || {
        let stream = TcpStream::connect((LOOPBACK, port)).unwrap();
        std::thread::sleep(Duration::from_millis(2));
        stream
    };
    let mut idle: Vec<TcpStream> = (0..64).map(|_| connect()).collect();
    // The page that was sent away may have given back its place late.
    idle.extend((0..4).map(|_| connect()));
    std::thread::sleep(Duration::from_millis(100));
    assert_eq!(get(port, "").0, 0);
    drop(idle);
    let start = Instant::now();
    while get(port, "").0 != 200 {
        assert!(start.elapsed() < Duration::from_secs(10), "places are not given back");
        std::thread::sleep(Duration::from_millis(50));
    }
}

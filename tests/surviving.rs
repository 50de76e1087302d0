//! Renders that are killed, interrupted, divided among machines, or find no room: the picture is the same in the end, or what there
//! is of it is kept.

use std::fs;
use std::path::Path;
use std::process::Child;
use std::time::{Duration, Instant};

use crate::support::{command, entries, etalon_line, pixel_bits, scene, signal, words};

/// Three to seven seconds, so that ten kills come before its end.
const SHORT: &str = "--size 96x72 --spp 1000 --seed 5";
const SHORT_IN_MIST: &str = "--size 64x40 --spp 500 --seed 5";
/// Minutes.
const LONG: &str = "--spp 1000000 --size 256x256 --threads 2";

/// A picture's channels and what its file says, without how long it took.
#[track_caller]
fn picture(path: &Path) -> (Vec<(String, Vec<u32>)>, etalon_picture::Attributes) {
    let (bits, file) = pixel_bits(path);
    let mut attributes = file.attributes;
    attributes.remove("renderTimeSeconds").expect("a render says how long it took");
    (bits, attributes)
}

/// Waits until a file is there.
#[track_caller]
fn wait_for(path: &Path, child: &mut Child) {
    let start = Instant::now();
    while !path.exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended without {}", path.display());
        assert!(start.elapsed() < Duration::from_secs(60), "no {} in a minute", path.display());
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_render_killed_at_ten_moments_and_resumed_has_the_same_bytes() {
    killed_and_resumed("cornell.json", SHORT);
}

#[test]
fn a_render_of_mist_killed_at_ten_moments_and_resumed_has_the_same_bytes() {
    killed_and_resumed("fog.json", SHORT_IN_MIST);
}

#[track_caller]
fn killed_and_resumed(name: &str, settings: &str) {
    let folder = tempfile::tempdir().unwrap();
    let (unbroken, broken) = (folder.path().join("unbroken.exr"), folder.path().join("broken.exr"));
    let checkpoint = folder.path().join("broken.exr.checkpoint");
    let path = scene(name);
    etalon_line(&format!("render {{}} -o {{}} {settings} --quiet"), [&path, &unbroken]).expect(0);

    let line = format!("render {{}} -o {{}} {settings} --checkpoint 0.02s --resume --quiet");
    let (mut kills, mut number) = (0, 0x2545_f491_u32);
    while kills < 10 {
        let mut child = command(words(&line, [&path, &broken])).spawn().unwrap();
        // Moments from a fixed sequence (xorshift32), in the midst of rendering, writing and starting.
        number ^= number << 13;
        number ^= number >> 17;
        number ^= number << 5;
        std::thread::sleep(Duration::from_millis(u64::from(30 + number % 200)));
        if child.try_wait().unwrap().is_some() {
            break;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        kills += 1;
        assert!(!broken.exists(), "a picture that is not done");
    }
    assert!(kills == 10, "the render ended after {kills} kills: too short for this machine");
    assert!(checkpoint.exists(), "ten runs without a checkpoint");
    let ran = etalon_line(&line, [&path, &broken]).expect(0);
    assert!(!ran.stderr.contains("no checkpoint"), "{}", ran.stderr);
    assert_eq!(picture(&broken), picture(&unbroken));
    assert!(!checkpoint.exists(), "a checkpoint of what is done");
}

#[test]
fn a_signal_ends_a_render_with_what_there_is_and_it_can_be_resumed() {
    for (name, status) in [("INT", 130), ("TERM", 143)] {
        let folder = tempfile::tempdir().unwrap();
        let (exr, checkpoint) = (folder.path().join("x.exr"), folder.path().join("x.exr.checkpoint"));
        let line = format!("render {{}} -o {{}} {LONG} --json --checkpoint 0.05s");
        let mut child = command(words(&line, [&scene("cornell.json"), &exr])).spawn().unwrap();
        wait_for(&checkpoint, &mut child);
        std::thread::sleep(Duration::from_millis(300));
        // Programs that end others may send it twice.
        signal(&child, name);
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(status), "{said}");
        assert!(said.contains("interrupted at") && said.contains("--resume") && said.contains("x.exr"), "{said}");
        assert_eq!(entries(folder.path()), ["x.exr", "x.exr.checkpoint"]);
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(report["reached"], "interrupted");
        assert_eq!(report["errors"][0]["code"], "interrupted");
        let (_, file) = pixel_bits(&exr);
        assert!(matches!(&file.attributes["unfinished"], etalon_picture::Attribute::Text(t) if t.contains("1000000")));

        // Other pictures are refused, and why.
        for (change, why) in [
            ("--seed 6", "seed"),
            ("--max-depth 3", "max_depth"),
            ("--size 255x256", "size"),
            ("--spp 9", "--spp"),
            ("--error 1%", "--error"),
            ("--adaptive always", "--adaptive"),
            ("--shard 1/2 -o y.part", "share"),
        ] {
            let line = format!("render {{}} -o {{}} {change} --threads 2 --resume --quiet");
            let line = if change.contains("spp") { line } else { line + " --spp 1000000" };
            let line = if change.contains("size") { line } else { line + " --size 256x256" };
            let ran = etalon_line(&line, [&scene("cornell.json"), &exr]).expect(2);
            assert!(ran.stderr.contains("cannot be resumed") && ran.stderr.contains(why), "{change}: {}", ran.stderr);
        }
        // A damaged checkpoint is no checkpoint.
        let mut bytes = fs::read(&checkpoint).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        fs::write(&checkpoint, &bytes).unwrap();
        etalon_line(&format!("{line} --resume"), [&scene("cornell.json"), &exr]).expect(1).says(["damaged"]);
        fs::write(&checkpoint, &bytes[..middle]).unwrap();
        etalon_line(&format!("{line} --resume"), [&scene("cornell.json"), &exr]).expect(1).says(["ends early"]);
    }
}

/// Minutes of one tile: what is under way does not end soon.
#[test]
fn the_same_signal_again_after_a_while_ends_a_render_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let (exr, checkpoint) = (folder.path().join("x.exr"), folder.path().join("x.exr.checkpoint"));
    let line = format!("render {{}} -o {{}} {LONG} --json --checkpoint 0.05s");
    let mut child = command(words(&line, [&scene("cornell.json"), &exr])).spawn().unwrap();
    wait_for(&checkpoint, &mut child);
    signal(&child, "INT");
    std::thread::sleep(Duration::from_millis(700));
    // It may have ended by the first alone.
    if child.try_wait().unwrap().is_none() {
        signal(&child, "INT");
    }
    let start = Instant::now();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
}

#[test]
fn parts_merge_to_the_bytes_of_the_whole_and_wrong_ones_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let (dispersive, size) = (scene("cornell-glass.json"), "--size 80x60 --spp 8 --quiet");
    let whole = folder.path().join("whole.exr");
    let whole_part = folder.path().join("whole.part");
    etalon_line(&format!("render {{}} -o {{}} -o {{}} {size}"), [&dispersive, &whole, &whole_part]).expect(0);
    let expected = picture(&whole);
    let part = |k: u32, n: u32| folder.path().join(format!("{k}-of-{n}.part"));
    for n in [1, 3, 16] {
        for k in 1..=n {
            let line = format!("render {{}} -o {{}} {size} --threads {} --shard {k}/{n}", 1 + k % 3);
            etalon_line(&line, [&dispersive, &part(k, n)]).expect(0);
        }
        let mut arguments = vec!["merge".to_owned(), "--quiet".to_owned(), "-o".to_owned()];
        let merged = folder.path().join(format!("merged-{n}.exr"));
        arguments.push(merged.display().to_string());
        // In any order.
        arguments.extend((1..=n).rev().map(|k| part(k, n).display().to_string()));
        crate::support::etalon(&arguments).expect(0);
        assert_eq!(picture(&merged), expected, "{n} parts");
    }
    let merged = folder.path().join("again.exr");
    etalon_line("merge {} -o {} --quiet", [&whole_part, &merged]).expect(0);
    assert_eq!(picture(&merged), expected);

    let foreign = folder.path().join("foreign.part");
    etalon_line(&format!("render {{}} -o {{}} {size} --shard 2/3 --seed 9"), [&dispersive, &foreign]).expect(0);
    let none = folder.path().join("none.exr");
    let refused = |parts: [&Path; 3], said: &[&str]| {
        let ran = etalon_line("merge {} {} {} -o {}", [parts[0], parts[1], parts[2], &none]).expect(2);
        assert!(said.iter().all(|part| ran.stderr.contains(part)), "{said:?}: {}", ran.stderr);
        assert!(!none.exists());
    };
    let [a, b, c] = [1, 2, 3].map(|k| part(k, 3));
    refused([&a, &b, &b], &["2-of-3.part", "both share 2/3"]);
    refused([&a, &foreign, &c], &["foreign.part", "its seed is 9"]);
    refused([&a, &b, &part(5, 16)], &["5-of-16.part", "one of 16 shares"]);
    refused([&a, &b, &whole], &["whole.exr", "not a checkpoint or part"]);
    etalon_line("merge {} {} -o {}", [&a, &c, &none]).expect(2).says(["share 2/3", "missing"]);
}

#[test]
fn parts_of_a_picture_of_mist_merge_to_the_bytes_of_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let size = "--size 80x60 --spp 8 --quiet";
    let mist = scene("fog.json");
    let (whole, merged) = (folder.path().join("mist.exr"), folder.path().join("merged-mist.exr"));
    etalon_line(&format!("render {{}} -o {{}} {size}"), [&mist, &whole]).expect(0);
    let parts = folder.path().join("mist");
    fs::create_dir(&parts).unwrap();
    for k in 1..=3 {
        let line = format!("render {{}} -o {{}} {size} --threads {} --shard {k}/3", 1 + k % 2);
        etalon_line(&line, [&mist, &parts.join(format!("{k}.part"))]).expect(0);
    }
    etalon_line("merge {} -o {} --quiet", [&parts, &merged]).expect(0);
    assert_eq!(picture(&merged), picture(&whole));
}

#[test]
fn parts_are_named_one_by_one_by_folders_or_by_a_list() {
    let folder = tempfile::tempdir().unwrap();
    let parts = folder.path().join("parts");
    fs::create_dir(&parts).unwrap();
    let part = |k: u32| parts.join(format!("{k}.part"));
    let (size, cornell) = ("--size 64x48 --spp 4 --quiet", scene("cornell.json"));
    for k in 1..=3 {
        etalon_line(&format!("render {{}} -o {{}} {size} --shard {k}/3"), [&cornell, &part(k)]).expect(0);
    }
    fs::write(parts.join("notes.txt"), "no part").unwrap();
    let merged = |name: &str| folder.path().join(name);
    etalon_line("merge {} {} {} -o {} --quiet", [&part(1), &part(2), &part(3), &merged("a.exr")]).expect(0);
    etalon_line("merge {} -o {} --quiet", [&parts, &merged("b.exr")]).expect(0);
    let list = folder.path().join("list");
    fs::write(&list, format!("{}\n\n{}\r\n", part(3).display(), part(1).display())).unwrap();
    etalon_line("merge {} --list {} -o {} --quiet", [&part(2), &list, &merged("c.exr")]).expect(0);
    let mut command = command(words("merge --list - -o {} --quiet", [&merged("d.exr")]));
    fs::write(&list, parts.display().to_string()).unwrap();
    assert!(command.stdin(fs::File::open(&list).unwrap()).status().unwrap().success());
    for name in ["b.exr", "c.exr", "d.exr"] {
        assert_eq!(picture(&merged(name)), picture(&merged("a.exr")), "{name}");
    }
    // A part that is named twice is there twice.
    etalon_line("merge {} {} -o {}", [&parts, &part(1), &merged("e.exr")]).expect(2).says(["both share 1/3"]);
    let empty = folder.path().join("empty");
    fs::create_dir(&empty).unwrap();
    etalon_line("merge {} -o {}", [&empty, &merged("e.exr")]).expect(2).says(["no .part file"]);
    fs::write(&list, "\n").unwrap();
    etalon_line("merge --list {} -o {}", [&list, &merged("e.exr")]).expect(2).says(["no part"]);
    etalon_line("merge --list {} -o {}", [&empty.join("x"), &merged("e.exr")]).expect(2).says(["No such file"]);
    etalon_line("merge -o {}", [&merged("e.exr")]).expect(2).says(["PART"]);
    assert!(!merged("e.exr").exists());
}

/// A file of sums as another build of this version would have written it.
fn of_another_build(from: &Path, to: &Path) {
    use sha2::{Digest, Sha256};
    let bytes = fs::read(from).unwrap();
    let length = u32::from_le_bytes(bytes[8..12].try_into().unwrap()) as usize;
    let (header, rest) = bytes[12..].split_at(length);
    let mut header: serde_json::Value = serde_json::from_slice(header).unwrap();
    let sources = header["subject"]["sources_sha256"].take();
    assert_eq!(sources, etalon_control::SOURCES_SHA256);
    header["subject"]["sources_sha256"] = "another".into();
    let header = serde_json::to_vec(&header).unwrap();
    let mut changed = bytes[..8].to_vec();
    changed.extend(u32::try_from(header.len()).unwrap().to_le_bytes());
    changed.extend(header);
    changed.extend(&rest[..rest.len() - 32]);
    let hash = Sha256::digest(&changed);
    changed.extend(hash);
    fs::write(to, changed).unwrap();
}

#[test]
fn parts_and_checkpoints_of_another_build_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let [one, two, other] = ["1.part", "2.part", "other.part"].map(|name| folder.path().join(name));
    let (size, cornell) = ("--size 64x48 --spp 4 --quiet", scene("cornell.json"));
    for (k, part) in [(1, &one), (2, &two)] {
        etalon_line(&format!("render {{}} -o {{}} {size} --shard {k}/2"), [&cornell, part]).expect(0);
    }
    of_another_build(&two, &other);
    let exr = folder.path().join("x.exr");
    let ran = etalon_line("merge {} {} -o {}", [&one, &other, &exr]).expect(2);
    ran.says(["other.part", "sources of the program", "another", etalon_control::SOURCES_SHA256]);
    etalon_line("merge {} {} -o {} --quiet", [&one, &two, &exr]).expect(0);
    of_another_build(&one, &folder.path().join("1.part.checkpoint"));
    let line = format!("render {{}} -o {{}} {size} --shard 1/2 --resume");
    etalon_line(&line, [&cornell, &one]).expect(2).says(["cannot be resumed", "sources of the program"]);
}

#[test]
fn a_share_is_useful_by_itself_and_says_that_it_is_one() {
    let folder = tempfile::tempdir().unwrap();
    let (part, exr) = (folder.path().join("x.part"), folder.path().join("x.exr"));
    let cornell = scene("cornell.json");
    let line = "render {} -o {} -o {} --size 64x48 --spp 4 --quiet --shard 2/3";
    etalon_line(line, [&cornell, &part, &exr]).expect(0);
    let (bits, file) = pixel_bits(&exr);
    let samples = &bits.iter().find(|(name, _)| name == "samples").expect("pixels differ in it").1;
    // Twelve tiles of 16 × 16 pixels, of which a third.
    assert_eq!(samples.iter().filter(|&&count| f32::from_bits(count) == 4.0).count(), 4 * 256);
    assert!(matches!(&file.attributes["unfinished"], etalon_picture::Attribute::Text(t) if t.contains("2 of 3")));

    etalon_line("render {} -o {} --size 64x48 --spp 4 --shard 2/3", [&cornell, &exr]).expect(2).says([".part"]);
    etalon_line("render {} -o {} --size 64x48 --spp 4 --shard 1/13", [&cornell, &part]).expect(2).says(["12 tiles"]);
    etalon_line("render {} -o {} --shard 1/3 --time 1s", [&cornell, &part]).expect(2).says(["--shard", "--time"]);
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_does_not_lose_what_was_rendered() {
    let folder = tempfile::tempdir().unwrap();
    let (full, cornell) = (folder.path().join("full.exr"), scene("cornell.json"));
    // A device on which every write finds no room; that it will is not known before.
    std::os::unix::fs::symlink("/dev/full", &full).unwrap();
    let line = "render {} -o {} --size 32x24 --spp 4 --quiet";
    let ran = etalon_line(line, [&cornell, &full]).expect(1);
    assert!(ran.stderr.contains("No space left") && ran.stderr.contains("full.exr.checkpoint"), "{}", ran.stderr);
    // With room, the picture is written without rendering again.
    fs::remove_file(&full).unwrap();
    let report = etalon_line(&line.replace("--quiet", "--json --resume"), [&cornell, &full]).expect(0).json();
    assert_eq!(report["spp"], 4);
    assert_eq!(entries(folder.path()), ["full.exr"]);
    let other = folder.path().join("other.exr");
    etalon_line(line, [&cornell, &other]).expect(0);
    assert_eq!(picture(&full), picture(&other));
}

#[test]
fn a_picture_that_memory_cannot_hold_is_refused_before_it_is_rendered() {
    let start = Instant::now();
    let line = "render {} -o {} --size 65536x65536 --replicates 64 --spp 1";
    let ran = etalon_line(line, [&scene("cornell.json"), Path::new("x.exr")]).expect(2);
    assert!(ran.stderr.contains("of memory") && ran.stderr.contains("65536"), "{}", ran.stderr);
    assert!(start.elapsed() < Duration::from_secs(20));
}

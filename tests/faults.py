#!/usr/bin/env python3
"""Faults by meaning: exchanges single expressions of the renderer for wrong ones, one at a time, and asks who notices.

`tests/faults/faults.toml` lists them, and `--catalogue first` or `second` takes one of two lists of 40 that were written from the sources and the scene
format alone, without a look at the tests or the oracle. All faults of a list are compiled into one program, in a copy of the tree under `target/faults`; the environment
variable ETALON_FAULT selects one by its number. So a fault costs a run, not a build.

    tests/faults.py list
    tests/faults.py check                 every fault applies, and the copy with all of them compiles
    tests/faults.py build                 builds `etalon` and the tests with all faults
    tests/faults.py run [NAME ...]        judges faults: by `etalon verify` alone, by the tests alone, and so by both
    tests/faults.py table [FILE]          writes what has been judged as a table, in a page between the mark of the list and the next heading

`run` goes on where it was interrupted: `target/faults/results.jsonl` has a line for each fault and judge. `--by verify` or `--by tests` asks
one judge alone. A judge stops at the first truth or test that fails; `--all` names them all. `verify` asks first for the truths that the key
`truths` of a fault names by words, then for all. With `--quick` it takes the first samples of each truth alone (`verify --coarse`), which takes some
seconds to a minute a fault: what they notice is judged, and what they do not is left open. `--tests` are the options of `cargo test`
that select tests. The tests of the package `xtask` are left out: they compare the lists with the sources, which the copy has exchanged.
Number 0 is no fault: it is judged first, and must pass.
"""

import argparse
import hashlib
import json
import os
import pathlib
import shlex
import subprocess
import sys
import threading
import tomllib

TREE = pathlib.Path(__file__).resolve().parent.parent
WORK = TREE / "target" / "faults"
COPY = WORK / "tree"
BUILD = WORK / "build"
RESULTS = WORK / "results.jsonl"
OPEN, CLOSE = "«", "»"
# The crates that have the switch, and a line of their `lib.rs` that it is declared before. All other crates with faults depend on the first.
SWITCHES = {"crates/optics": "pub mod fresnel;", "crates/control": "pub mod adaptive;"}
# Most seconds of one `verify --coarse` with --quick.
QUICK_S = 180

SWITCH = '''//! Which of the faults of `tests/faults` is switched on.

use std::sync::LazyLock;

static CHOSEN: LazyLock<u32> =
    LazyLock::new(|| std::env::var("ETALON_FAULT").ok().and_then(|number| number.parse().ok()).unwrap_or(0));

/// Whether the fault of this number is.
#[must_use]
#[inline]
pub fn on(number: u32) -> bool {
    *CHOSEN == number
}
'''


def catalogue(name):
    """The faults of a list, in order; their numbers begin at 1."""
    with open(TREE / "tests" / "faults" / f"{name}.toml", "rb") as file:
        faults = tomllib.load(file)["fault"]
    for number, fault in enumerate(faults, 1):
        fault["number"] = number
        text = "\n".join([fault["file"], fault["old"], fault["new"]])
        fault["digest"] = hashlib.sha256(text.encode()).hexdigest()[:16]
    names = [fault["name"] for fault in faults]
    if len(set(names)) != len(names):
        sys.exit("two faults have the same name")
    return faults


def place(fault, text):
    """Where the expression of a fault is in its file: (begin, end). Exits if it is not found once."""
    before, rest = fault["old"].split(OPEN) if OPEN in fault["old"] else ("", fault["old"])
    expression, after = rest.split(CLOSE) if CLOSE in rest else (rest, "")
    count = text.count(before + expression + after)
    if count != 1:
        raise ValueError(f"{fault['name']}: its text is {count} times in {fault['file']}")
    begin = text.index(before + expression + after) + len(before)
    return begin, begin + len(expression)


def applied(path, text, faults):
    """A file with all its faults, each behind its switch."""
    own = any(path.startswith(f"{folder}/") for folder in SWITCHES)
    switch = "crate::fault::on" if own else "etalon_optics::fault::on"
    places = sorted(((*place(fault, text), fault) for fault in faults), key=lambda item: item[:2])
    out, groups, at = [], [], 0
    for begin, end, fault in places:
        # Several faults of one expression share its place.
        if groups and groups[-1][:2] == (begin, end):
            groups[-1][2].append(fault)
        elif begin < at:
            raise ValueError(f"{fault['name']}: overlaps with another fault in {path}")
        else:
            groups.append((begin, end, [fault]))
            at = end
    at = 0
    for begin, end, same in groups:
        choices = "".join(f"if {switch}({fault['number']}) {{ {fault['new']} }} else " for fault in same)
        out += [text[at:begin], f"({choices}{{ {text[begin:end]} }})"]
        at = end
    return "".join(out) + text[at:]


def write_if_changed(path, data):
    """Keeps the time of a file that is as it was, so that it is not compiled again."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_bytes() != data:
        path.write_bytes(data)


def copy(faults):
    """Makes the copy of the tree with all faults."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=TREE, check=True, capture_output=True,
    ).stdout.decode()
    names = [name for name in listed.split("\0") if name and (TREE / name).is_file()]
    by_file = {}
    for fault in faults:
        by_file.setdefault(fault["file"], []).append(fault)
    missing = set(by_file) - set(names)
    if missing:
        sys.exit(f"no such file: {', '.join(sorted(missing))}")
    for name in names:
        data = (TREE / name).read_bytes()
        if name in by_file:
            data = applied(name, data.decode(), by_file[name]).encode()
        if (line := SWITCHES.get(name.removesuffix("/src/lib.rs"))) and name.endswith("/src/lib.rs"):
            data = data.replace(line.encode(), f"#[doc(hidden)]\npub mod fault;\n{line}".encode(), 1)
        write_if_changed(COPY / name, data)
        os.chmod(COPY / name, (TREE / name).stat().st_mode)
    switches = [f"{folder}/src/fault.rs" for folder in SWITCHES]
    for name in switches:
        write_if_changed(COPY / name, SWITCH.encode())
    for path in COPY.rglob("*.rs"):
        name = path.relative_to(COPY).as_posix()
        if name not in names and name not in switches:
            path.unlink()


def cargo(*options, capture=False):
    """Runs cargo in the copy."""
    # The exchange leaves parentheses that are not needed.
    environment = {**os.environ, "CARGO_TARGET_DIR": str(BUILD), "RUSTFLAGS": "-A warnings"}
    command = ["cargo", *options]
    ran = subprocess.run(command, cwd=COPY, env=environment, stdout=subprocess.PIPE if capture else None, text=True)
    if ran.returncode != 0:
        sys.exit(f"{shlex.join(command)} failed")
    return ran.stdout


def build(selection):
    """Builds the program, and the selected tests; returns the programs of the tests with their crates' folders."""
    cargo("build", "--release", "--workspace", "--bin", "etalon")
    if selection is None:
        return []
    # Its tests hold the lists of faults to the sources, and fail in a copy whose expressions are exchanged.
    with open(TREE / "crates" / "xtask" / "Cargo.toml", "rb") as file:
        left_out = tomllib.load(file)["package"]["name"]
    options = ["--release", "--workspace", "--exclude", left_out, "--no-run", "--message-format=json"]
    lines = cargo("test", *options, *selection, capture=True)
    programs = []
    for line in lines.splitlines():
        message = json.loads(line)
        if message.get("executable") and message.get("profile", {}).get("test"):
            programs.append((message["executable"], str(pathlib.Path(message["manifest_path"]).parent)))
    return programs


def judged_by_verify(environment, options, first=""):
    """Names of truths that fail; one alone without --all; None if that is left open. The truths whose names have a word of `first` are asked first."""
    if options.quick:
        for words in [first.split(), []] if first else [[]]:
            if failed := failing_truths(environment, ["--coarse", "--", *words], False, QUICK_S):
                return failed
        return None
    if first and not options.truths and not options.all:
        if failed := failing_truths(environment, ["--", *first.split()], False):
            return failed
    return failing_truths(environment, ["--", *options.truths], options.all)


def failing_truths(environment, asked, ask_all, limit_s=None):
    """Names of the truths that `verify` with these options and words fails, or the name of the first; of those that are judged within the limit."""
    command = [str(BUILD / "release" / "etalon"), "verify", *asked]
    failed = []
    with subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as process:
        # Where a fault keeps errors from falling, a truth takes samples for a long time.
        timer = threading.Timer(limit_s or threading.TIMEOUT_MAX, process.kill)
        timer.daemon = True
        timer.start()
        for line in process.stdout:
            if "  FAILED: " in line:
                failed.append(line.split()[0])
                if not ask_all:
                    process.kill()
                    break
        ended = timer.is_alive()
        timer.cancel()
    if not failed and process.returncode == 2:
        raise ValueError(f"no truth has one of the words: {' '.join(asked)}")
    # Ended by itself without a verdict: it crashed, and somebody notices.
    if not failed and ended and process.returncode != 0:
        failed.append(f"exit status {process.returncode}")
    return failed


def judged_by_tests(environment, options, programs):
    """Names of tests that fail; one program's alone without --all."""
    failed = []
    for program, folder in programs:
        try:
            ran = subprocess.run(
                [program, "--quiet"], cwd=folder, env=environment, capture_output=True, text=True, timeout=options.timeout
            )
        except subprocess.TimeoutExpired:
            failed.append(f"{pathlib.Path(program).name.rsplit('-', 1)[0]} took more than {options.timeout} s")
        else:
            if ran.returncode == 0:
                continue
            names = [line.strip() for line in ran.stdout.split("failures:")[-1].splitlines()[1:]]
            names = [name for name in names if name and " " not in name]
            failed += names or [f"{pathlib.Path(program).name.rsplit('-', 1)[0]}: exit status {ran.returncode}"]
        if not options.all:
            break
    return failed


def results():
    """What has been judged: (name, digest, judge) to the line."""
    found = {}
    if RESULTS.exists():
        for line in RESULTS.read_text().splitlines():
            try:
                row = json.loads(line)
            except json.JSONDecodeError:
                # Cut off as it was written.
                continue
            found[row["name"], row["digest"], row["by"]] = row
    return found


def run(faults, options):
    copy(faults)
    judges = ["verify"] if options.quick else ["verify", "tests"] if options.by == "both" else [options.by]
    programs = build(shlex.split(options.tests) if "tests" in judges else None)
    unknown = set(options.names) - {fault["name"] for fault in faults}
    if unknown:
        sys.exit(f"no fault is named {', '.join(sorted(unknown))}")
    chosen = [fault for fault in faults if not options.names or fault["name"] in options.names]
    # What passes without a fault holds for this tree, these truths and these tests alone.
    head = subprocess.run(["git", "rev-parse", "HEAD"], cwd=TREE, capture_output=True, text=True).stdout
    asked = hashlib.sha256(f"{head} {options.truths} {options.tests} {options.quick}".encode()).hexdigest()[:16]
    none = {"name": "none", "digest": asked, "number": 0}
    for fault in [none, *chosen]:
        for judge in judges:
            if (fault["name"], fault["digest"], judge) in results():
                continue
            # What a fault makes wrong must not be read by the next.
            environment = {**os.environ, "ETALON_FAULT": str(fault["number"]), "ETALON_TABLES": ""}
            if judge == "verify":
                failed = judged_by_verify(environment, options, fault.get("truths", ""))
            else:
                failed = judged_by_tests(environment, options, programs)
            if failed is None and fault is not none:
                print(f"{fault['name']}: {judge} is open", flush=True)
                continue
            failed = failed or []
            if fault is none and failed:
                sys.exit(f"without a fault, {judge} fails: {', '.join(failed)}")
            row = {"name": fault["name"], "digest": fault["digest"], "by": judge, "noticed": bool(failed), "failed": failed}
            with open(RESULTS, "a") as file:
                file.write(json.dumps(row, ensure_ascii=False) + "\n")
            print(f"{fault['name']}: {judge} {'notices: ' + failed[0] if failed else 'passes'}", flush=True)


def table(faults, path, name):
    judged = results()
    judges = {}
    for fault in faults:
        row = {judge: judged.get((fault["name"], fault["digest"], judge)) for judge in ("verify", "tests")}
        if any(row.values()):
            judges[fault["name"]] = row
    live = [fault for fault in faults if "harmless" not in fault]
    lines = ["| fault | what is wrong | `verify` | tests |", "|---|---|---|---|"]
    cell = lambda row: "–" if row is None else f"`{row['failed'][0]}`" if row["noticed"] else "**nothing**"
    for fault in faults:
        if row := judges.get(fault["name"]):
            what = fault["what"] + (f" (no fault: {fault['harmless']})" if "harmless" in fault else "")
            lines.append(f"| {fault['name']} | {what} | {cell(row['verify'])} | {cell(row['tests'])} |")
    counts = []
    for judge in ("verify", "tests"):
        rows = [row for fault in live if (row := judges.get(fault["name"], {}).get(judge))]
        if rows:
            counts.append(f"{judge} notices {sum(row['noticed'] for row in rows)} of {len(rows)} that it judged")
    both = [row for fault in live if all((row := judges.get(fault["name"], {"verify": None})).values())]
    if both:
        counts.append(f"one or both notice {sum(row['verify']['noticed'] or row['tests']['noticed'] for row in both)} of {len(both)}")
    left = sum(fault["name"] not in judges for fault in live)
    text = "\n".join([*lines, "", f"Of {len(live)} faults {left} are open; {', '.join(counts)}.", ""])
    if path:
        mark = f"<!-- written by tests/faults.py table --catalogue {name} -->\n\n"
        before, found, rest = pathlib.Path(path).read_text().partition(mark)
        if not found:
            sys.exit(f"{path} has no line {mark.strip()}")
        _, heading, after = f"\n{rest}".partition("\n## ")
        temporary = pathlib.Path(f"{path}.part")
        temporary.write_text(f"{before}{mark}{text}{heading}{after}")
        temporary.replace(path)
    else:
        print(text, end="")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=["list", "check", "build", "run", "table"])
    parser.add_argument("names", nargs="*", help="of faults, for run; a file, for table")
    parser.add_argument("--catalogue", choices=["faults", "first", "second"], default="faults")
    parser.add_argument("--by", choices=["verify", "tests", "both"], default="both")
    parser.add_argument("--tests", default="", metavar="OPTIONS", help="as cargo test takes them, such as '--lib --test integration'")
    parser.add_argument("--truths", nargs="*", default=[], metavar="WORD", help="words of the names of truths; all by default")
    parser.add_argument("--quick", action="store_true", help="ask `verify --coarse` alone")
    parser.add_argument("--all", action="store_true", help="do not stop at the first truth or test that fails")
    parser.add_argument("--timeout", type=float, default=3600, metavar="SECONDS", help="for one program of tests")
    options = parser.parse_intermixed_args()
    if options.quick and (options.by == "tests" or options.truths or options.all):
        parser.error("--quick asks `verify --coarse` for all truths: no --by tests, --truths or --all beside it")
    faults = catalogue(options.catalogue)
    try:
        if options.command == "list":
            for fault in faults:
                print(f"{fault['number']:>4} {fault['kind']:<12} {fault['name']}: {fault['what']}")
        elif options.command == "check":
            copy(faults)
            cargo("check", "--release", "--workspace", "--bin", "etalon")
            print(f"{len(faults)} faults apply and compile")
        elif options.command == "build":
            copy(faults)
            build(shlex.split(options.tests) if options.by != "verify" else None)
        elif options.command == "run":
            run(faults, options)
        else:
            table(faults, options.names[0] if options.names else None, options.catalogue)
    except ValueError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()

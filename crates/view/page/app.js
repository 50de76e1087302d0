// The page: what it shows follows from the status that the server sends; what is done goes to the server as orders.

import { Camera } from "./camera.js";
import { Effects, spoken } from "./effects.js";
import { Inspector } from "./inspector.js";
import { Paths } from "./paths.js";
import { Stage } from "./stage.js";
import { ask, latest, listen, order, saveAddress } from "./server.js";
import { count, digits, html, percent, seconds } from "./format.js";
import { drawCurve, whenReached } from "./curve.js";
import { log } from "./log.js";

const element = (id) => document.getElementById(id);
const MARKS = [0.05, 0.02, 0.01];

let status = null;
let camera = null;
let sentStage = 0;

const look = () => ({
  exposure: element("exposure-auto").checked ? "auto" : element("exposure").value,
  white: whiteBalance,
  curve: element("tone").value,
});
let whiteBalance = "";

const stage = new Stage(look);
const effects = new Effects();
const paths = new Paths();
const inspector = new Inspector((object) => effects.point(object));

// ---- what the server says ----

const PHASES = {
  preparing: "preparing the scene",
  coarse: "first coarse picture",
  pilot: "trial samples, which find the noisy places",
  rendering: "rendering",
  done: "the samples planned for the stated error are taken",
  paused: "paused",
  costs: "measuring what each effect costs; the picture waits",
  picture: "a picture from a file",
  refused: "the scene cannot be rendered",
};

function update(now) {
  const before = status;
  status = now;
  if (before === null) log("status", { scene: now.name });
  document.title = `${now.error ? `${percent(now.error.relative_rmse)} · ` : ""}${now.name.split(/[\\/]/).at(-1)}`;
  element("name").textContent = now.name.split(/[\\/]/).at(-1);
  element("name").title = now.name;
  const isReached = now.phase === "done" && now.target !== null && now.error?.relative_rmse <= now.target;
  element("phase").dataset.phase = now.phase;
  element("phase").textContent = isReached ? "the stated error is reached" : PHASES[now.phase];
  element("pause").hidden = !now.is_scene || now.phase === "done";
  element("pause").textContent = now.phase === "paused" ? "Go on" : "Pause";
  element("home").hidden = !now.is_moved;
  if (now.camera) {
    camera ??= new Camera(now.camera);
    // Another page may have moved it. What this page sent itself comes back late and is not taken.
    if (!isMoving && now.stage >= sentStage) camera.take(now.camera);
  }
  stage.update(now);
  showAccuracy(now);
  effects.update(now);
  showPinned(now);
  showProblems(now);
  if (before && now.picture !== before.picture) {
    inspector.refresh(now.stage !== before.stage);
    log("error", { picture: now.picture, block: now.block, samples: now.samples, seconds: now.seconds, relative_rmse: now.error?.relative_rmse ?? null, phase: now.phase, stage: now.stage });
  }
  if (before && now.stage !== before.stage && paths.at) paths.close();
}

function showAccuracy(now) {
  const error = now.error;
  element("error").textContent = percent(error?.relative_rmse);
  const interval = error?.interval_95;
  const ends = interval?.map(percent);
  element("error-interval").textContent = !interval || error.heavy_tailed ? "" : ends[0] === ends[1] ? "known to two digits" : `between ${ends[0]} and ${ends[1]}, 95 % sure`;
  const share = percent(error?.relative_rmse);
  const kind = now.block > 1 ? `of a coarse picture, whose pixels stand for ${now.block} × ${now.block}` : "of the picture";
  element("error-words").textContent = error?.relative_rmse != null
    ? `noise ${kind}: a pixel, dark or bright, is off by about ${share} of the mean brightness, which is ${digits(error.mean_y, 3)}.`
    : now.phase === "picture" ? "This file does not say how wrong its pixels are." : "Nothing is known of the error yet.";
  element("curve").toggleAttribute("hidden", !now.is_scene);
  if (now.is_scene) drawCurve(element("curve"), now);
  showMarks(now);
  const parts = [];
  if (now.samples > 0 && now.block === 1) parts.push(`${count(now.samples)} samples a pixel${now.adaptive_gain ? " in the mean, more where the error is larger" : ""}`);
  if (now.seconds > 0) parts.push(`${seconds(now.seconds)}`);
  if (now.paths_per_second > 0 && now.is_scene) parts.push(`${count(now.paths_per_second)} paths a second on ${now.threads} threads`);
  if (now.pages > 1) parts.push(`${now.pages} pages look on`);
  element("counts").textContent = parts.join(" · ");
  element("missing").hidden = now.without.length === 0;
  element("missing").textContent = `The number is noise alone. It does not count what is switched off: ${now.without.map(spoken).join(", ")}.`;
  const notes = [...now.notes];
  if (error?.heavy_tailed) notes.push("A few very bright samples make up much of the noise: it is probably larger than stated.");
  else if (error?.heavy_tailed_pixels) notes.push("A few samples are very bright: the ± of single pixels understates their error. The number of the whole picture can be trusted.");
  for (const lost of now.plan?.approximations ?? []) notes.push(`An approximation, without ${lost}.`);
  element("notes").replaceChildren(...notes.map((note) => html("li", {}, note)));
}

let marksKey = "";
function showMarks(now) {
  element("marks").hidden = !now.is_scene;
  const errors = [...new Set([...MARKS, ...(now.target ? [now.target] : [])])].sort((a, b) => b - a);
  const rows = [...errors.map((error) => ({ error, ...whenReached(now, error) })), { error: 0, words: "", reached: false }];
  const key = JSON.stringify([rows, now.target]);
  if (key === marksKey) return;
  marksKey = key;
  const chosen = now.target ?? 0;
  element("marks").replaceChildren(...rows.map((row) => {
    const radio = html("input", { type: "radio", name: "target", value: String(row.error), checked: row.error === chosen });
    radio.addEventListener("change", () => order("control", { target: row.error }));
    const name = row.error === 0 ? "go on until I pause" : `stop at ${percent(row.error)}`;
    return html("label", {}, html("span", {}, radio, name), html("span", { class: row.reached ? "reached" : "" }, row.words));
  }));
}

function showProblems(now) {
  const banner = element("banner");
  banner.hidden = now.problems.length === 0;
  if (banner.hidden) return;
  const kept = now.picture > 0 ? " You see the last version without." : "";
  const lines = now.problems.map((p) => {
    const place = p.line ? `line ${p.line}, column ${p.column}: ` : "";
    return html("div", {}, `${place}${p.message}${p.hint ? `. ${p.hint}` : ""}`);
  });
  banner.replaceChildren(html("b", {}, `The scene file has ${lines.length === 1 ? "a mistake" : `${lines.length} mistakes`}.${kept}`), ...lines);
}

let pinnedNumber = 0;
let comparedPicture = 0;
function showPinned(now) {
  const { pinned } = now;
  element("unpin").hidden = !pinned;
  element("split-label").hidden = !pinned;
  // A coarse picture has fewer pixels than those that follow, so the two cannot be compared.
  element("pin").disabled = now.block !== 1;
  element("pin").textContent = pinned ? "Pin this one instead" : "Pin this picture";
  document.querySelector("input[name=map][value=difference]").disabled = !pinned;
  document.querySelector("input[name=map][value=samples]").disabled = !now.adaptive_gain && now.is_scene;
  element("compare-words").hidden = Boolean(pinned);
  if ((pinned?.number ?? 0) !== pinnedNumber) {
    pinnedNumber = pinned?.number ?? 0;
    comparedPicture = 0;
    element("split-on").checked = false;
    stage.showPinned(false);
    if (!pinned && stage.mapKind === "difference") chooseMap("");
  }
  if (!pinned) {
    element("verdict").textContent = "";
  } else if (now.block === 1 && now.picture !== comparedPicture && now.picture !== pinned.number) {
    comparedPicture = now.picture;
    compareNow(pinned);
  } else if (now.picture === pinned.number) {
    element("verdict").textContent = `Pinned: ${pinned.title}, ${percent(pinned.relative_rmse)}. Now change something.`;
  }
}

const compareNow = latest(async (pinned) => {
  try {
    const comparison = await ask("comparison");
    // The render began again meanwhile: the next picture of all pixels is compared.
    if (!comparison) {
      comparedPicture = 0;
      return;
    }
    const words = {
      equal: "The two pictures are equal.",
      "within-noise": "The two pictures differ by no more than their noise.",
      differ: "The two pictures differ by more than their noise.",
      untested: "The two pictures differ, but the error of some pixels is not known.",
    }[comparison.verdict];
    const worst = comparison.test?.channels.map((c) => c.worst).filter(Boolean).sort((a, b) => Math.abs(b.t) - Math.abs(a.t))[0];
    const most = worst ? ` Largest: ${digits(Math.abs(worst.t), 2)} standard errors, in columns ${worst.crop[0]} to ${worst.crop[1] - 1}, rows ${worst.crop[2]} to ${worst.crop[3] - 1}.` : "";
    const falseAlarm = comparison.test ? ` Where nothing differs, this test says so wrongly once in ${Math.round(1 / comparison.test.significance)} times.` : "";
    element("verdict").textContent = `${words}${falseAlarm}${most}${comparison.note ? ` Note: ${comparison.note}.` : ""}`;
    log("comparison", { verdict: comparison.verdict });
  } catch (error) {
    element("verdict").textContent = `Pinned: ${pinned.title}. ${error.message}.`;
  }
});

// ---- the camera ----

let isMoving = false;
const sendCamera = latest(async (view, moving) => {
  const { stage: number } = await order("camera", { camera: view, moving });
  sentStage = number;
});

function moved(moving) {
  log("camera", { moving });
  sendCamera(structuredClone(camera.view), moving);
}

// Keys and the wheel have no end: some time after the last of them the camera rests.
let resting = null;
function nudged() {
  isMoving = true;
  moved(true);
  clearTimeout(resting);
  resting = setTimeout(() => {
    isMoving = false;
    moved(false);
  }, 350);
}

function setUpPointer() {
  const { picture, frame } = stage;
  let drag = null;
  let clicked = null;
  picture.addEventListener("pointerdown", (event) => {
    picture.setPointerCapture(event.pointerId);
    const at = stage.pixelAt(event);
    drag = { x: event.clientX, y: event.clientY, at, pan: event.shiftKey || event.button !== 0, moved: false };
  });
  picture.addEventListener("contextmenu", (event) => event.preventDefault());
  picture.addEventListener("pointermove", (event) => {
    if (!drag) {
      inspector.point(stage.pixelAt(event));
      return;
    }
    const [dx, dy] = [event.clientX - drag.x, event.clientY - drag.y];
    if (!drag.moved && Math.hypot(dx, dy) < 5) return;
    if (!camera || !status.is_scene) return;
    if (!drag.moved) {
      drag.moved = true;
      isMoving = true;
      frame.classList.add("is-moving");
      camera.around(inspector.info?.object?.position_m);
    }
    [drag.x, drag.y] = [event.clientX, event.clientY];
    if (drag.pan) camera.pan(-dx / stage.box.height, dy / stage.box.height);
    else camera.orbit((dx / stage.box.height) * Math.PI, (dy / stage.box.height) * Math.PI);
    moved(true);
  });
  const end = (event) => {
    if (!drag) return;
    const { at, moved: isDragged, pan } = drag;
    drag = null;
    frame.classList.remove("is-moving");
    if (isDragged) {
      isMoving = false;
      moved(false);
    } else if (event.type === "pointerup" && at && !pan) {
      clearTimeout(clicked);
      // A second click soon after is a double click.
      clicked = setTimeout(() => (picking ? pick(at) : paths.show(at)), 220);
    }
  };
  picture.addEventListener("pointerup", end);
  picture.addEventListener("pointercancel", end);
  picture.addEventListener("pointerleave", () => inspector.point(null));
  picture.addEventListener("dblclick", () => {
    clearTimeout(clicked);
    refocus();
  });
  picture.addEventListener("wheel", (event) => {
    event.preventDefault();
    if (!camera || !status.is_scene) return;
    if (!isMoving) camera.around(inspector.info?.object?.position_m);
    camera.dolly(Math.exp(Math.sign(event.deltaY) * Math.min(0.25, Math.abs(event.deltaY) / 700)));
    nudged();
  }, { passive: false });
}

function refocus() {
  const object = inspector.info?.object;
  if (!camera || !object?.position_m) return;
  camera.around(object.position_m);
  if (camera.focus(object.depth_m)) moved(false);
}

function goHome() {
  if (!status?.is_moved) return;
  camera = null;
  order("camera", { camera: null, moving: false });
}

const TURN = 0.06;
const STEP = 0.06;
const KEYS = {
  ArrowLeft: () => camera.orbit(-TURN, 0),
  ArrowRight: () => camera.orbit(TURN, 0),
  ArrowUp: () => camera.orbit(0, -TURN),
  ArrowDown: () => camera.orbit(0, TURN),
  w: () => camera.walk(0, 0, STEP),
  s: () => camera.walk(0, 0, -STEP),
  a: () => camera.walk(-STEP, 0, 0),
  d: () => camera.walk(STEP, 0, 0),
  e: () => camera.walk(0, STEP, 0),
  q: () => camera.walk(0, -STEP, 0),
  "+": () => camera.dolly(0.9),
  "-": () => camera.dolly(1 / 0.9),
};

function setUpKeys() {
  document.addEventListener("keydown", (event) => {
    const inForm = /^(INPUT|SELECT|TEXTAREA)$/.test(document.activeElement?.tagName);
    if (event.ctrlKey || event.metaKey || event.altKey || element("help").open || !status) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (key === "Escape") {
      paths.close();
    } else if (inForm && document.activeElement.type !== "checkbox") {
      return;
    } else if (key === " ") {
      if (document.activeElement?.tagName === "BUTTON") return;
      event.preventDefault();
      togglePause();
    } else if (key === "?") {
      element("help").showModal();
    } else if (key === "m") {
      chooseMap(stage.mapKind ? "" : "of-mean");
    } else if (key === "p") {
      pin(true);
    } else if (key === "r") {
      goHome();
    } else if (key === "f") {
      refocus();
    } else if (KEYS[key] && camera && status.is_scene) {
      event.preventDefault();
      if (!isMoving) camera.around(inspector.at && inspector.info?.object?.position_m);
      KEYS[key]();
      nudged();
    }
  });
}

// ---- the rest of the panel ----

function togglePause() {
  if (status?.is_scene) order("control", { paused: status.phase !== "paused" });
}

function pin(pinned) {
  order("pin", { pinned });
  log("pin", { pinned });
}

function chooseMap(kind) {
  document.querySelector(`input[name=map][value="${kind}"]`).checked = true;
  stage.showMap(kind);
}

let picking = false;
function pick([x, y]) {
  picking = false;
  const side = 9;
  const place = (at, most) => Math.max(0, Math.min(at - (side - 1) / 2, most - side));
  whiteBalance = `patch:${place(x, status.size[0])},${place(y, status.size[1])},${side},${side}`;
  element("clipped").textContent = "";
  relook();
}

function relook() {
  element("exposure").disabled = element("exposure-auto").checked;
  element("save-png").href = saveAddress("save.png", look());
  stage.redraw();
}

function setUpPanel() {
  element("pause").addEventListener("click", togglePause);
  element("home").addEventListener("click", goHome);
  element("help-open").addEventListener("click", () => element("help").showModal());
  element("pin").addEventListener("click", () => pin(true));
  element("unpin").addEventListener("click", () => pin(false));
  element("split-on").addEventListener("change", (event) => stage.showPinned(event.target.checked));
  element("map-opacity").addEventListener("input", (event) => (element("map").style.opacity = event.target.value));
  element("map").style.opacity = element("map-opacity").value;
  for (const radio of document.querySelectorAll("input[name=map]")) {
    radio.addEventListener("change", () => stage.showMap(radio.value));
  }
  element("exposure").addEventListener("input", relook);
  element("exposure").addEventListener("dblclick", () => {
    element("exposure").value = 0;
    relook();
  });
  element("exposure-auto").addEventListener("change", relook);
  element("tone").addEventListener("change", relook);
  element("white").addEventListener("change", (event) => {
    if (event.target.value === "pick") {
      picking = true;
      element("clipped").textContent = "Click on something that is to look white.";
      return;
    }
    picking = false;
    whiteBalance = event.target.value;
    relook();
  });
  stage.onLook = (about) => {
    if (about.refused) {
      element("clipped").textContent = about.refused;
      return;
    }
    element("exposure-value").textContent = `${digits(about.exposure_ev, 2)} EV`.replace("unknown", "0");
    if (!picking) element("clipped").textContent = about.clipped ? `${count(about.clipped)} of ${count(about.pixels)} pixels are too bright or too colourful for the screen.` : "";
  };
}

log("begin");
setUpPointer();
setUpKeys();
setUpPanel();
relook();
// Not waiting for news: there may be a picture already.
stage.begin();
listen(update, () => (element("phase").textContent = "the connection to the server is lost; it is tried again"));
window.addEventListener("resize", () => status && showAccuracy(status));

// The page: what it shows follows from the status that the server sends; what is done goes to the server as orders.

import { Camera } from "./camera.js";
import { Compare } from "./compare.js";
import { Effects, spoken } from "./effects.js";
import { Inspector } from "./inspector.js";
import { Look } from "./look.js";
import { Marks } from "./marks.js";
import { Paths } from "./paths.js";
import { Stage } from "./stage.js";
import { latest, listen, order } from "./server.js";
import { count, digits, html, percent, seconds, tileName } from "./format.js";
import { drawCurve } from "./curve.js";
import { log } from "./log.js";

const element = (id) => document.getElementById(id);

let status = null;
let camera = null;
let sentStage = 0;

const look = new Look(() => stage.redraw());
const stage = new Stage(() => look.settings);
const compare = new Compare(stage, chooseMap);
const marks = new Marks((target) => order("control", { target }));
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
  costs: "measuring what each effect costs; the picture is paused",
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
    const isNew = camera === null;
    camera ??= new Camera();
    // Another page may have moved it. What this page sent itself comes back late and is not taken.
    if (isNew || (!isMoving && now.stage >= sentStage)) camera.take(now.camera, now.world_up);
  }
  stage.update(now);
  showAccuracy(now);
  effects.update(now);
  compare.update(now);
  showSamplesMap(now);
  showProblems(now);
  if (before && now.picture !== before.picture) {
    inspector.refresh(now.stage);
    log("error", { picture: now.picture, block: now.block, samples: now.samples, seconds: now.seconds, relative_rmse: now.error?.relative_rmse ?? null, phase: now.phase, stage: now.stage });
  }
  if (before && now.stage !== before.stage && paths.at) paths.close();
}

function showSamplesMap(now) {
  const isEven = !now.adaptive_gain && now.is_scene;
  document.querySelector("input[name=map][value=samples]").disabled = isEven;
  element("map-samples").title = isEven ? "Every pixel has the same number of samples" : "Samples of each pixel over their mean";
}

function showAccuracy(now) {
  const error = now.error;
  element("error").textContent = percent(error?.relative_rmse);
  const interval = error?.interval_95;
  const ends = interval?.map(percent);
  element("error-interval").textContent = !interval || error.heavy_tailed ? "" : `95 % sure: ${ends[0]} to ${ends[1]}`;
  const kind = now.block > 1 ? `The picture is coarse: its pixels stand for ${now.block} × ${now.block} each.` : "Some pixels are better and some are worse: see the map.";
  element("error-words").textContent = error?.relative_rmse != null
    ? `Typical error of a pixel: ${percent(error.relative_rmse)} of the mean brightness. ${kind} The mean brightness is Y\u00a0=\u00a0${digits(error.mean_y, 3)}.`
    : now.phase === "picture" ? "This file does not say how wrong its pixels are." : "Nothing is known of the error yet.";
  const tile = error?.noisiest;
  element("error-largest").hidden = !now.is_scene;
  element("error-largest").textContent = tile?.relative_rmse > 0 ? `Largest error of a tile: ${percent(tile.relative_rmse)} of the mean brightness, in ${tileName(tile.crop)}.` : "";
  element("curve").toggleAttribute("hidden", !now.is_scene);
  if (now.is_scene) drawCurve(element("curve"), now);
  marks.update(now);
  const parts = [];
  if (now.samples > 0 && now.block === 1) parts.push(`${count(now.samples)} samples a pixel${now.adaptive_gain ? " in the mean, more where the error is larger" : ""}`);
  if (now.seconds > 0) parts.push(`${seconds(now.seconds)} since the start`);
  if (now.paths_per_second > 0 && now.is_scene) parts.push(`${count(now.paths_per_second)} paths a second on ${now.threads} threads`);
  if (now.pages > 1) parts.push(`${now.pages} pages look on`);
  element("counts").textContent = parts.join(" · ");
  element("missing").hidden = now.without.length === 0 || now.phase === "refused";
  element("missing").textContent = `This error comes from chance alone. It does not count what is switched off: ${now.without.map(spoken).join(", ")}.`;
  const notes = [...now.notes];
  if (error?.heavy_tailed) notes.push("A few very bright samples make up much of the error: it is probably larger than stated.");
  else if (error?.heavy_tailed_pixels) notes.push("A few samples are very bright: the ± of single pixels understates their error. The error of the picture can be trusted.");
  for (const lost of now.plan?.approximations ?? []) notes.push(`An approximation, without ${lost}.`);
  element("notes").replaceChildren(...notes.map((note) => html("li", {}, note)));
}

function showProblems(now) {
  const banner = element("banner");
  const key = JSON.stringify([now.problems, now.refusal]);
  if (banner.dataset.key === key) return;
  banner.dataset.key = key;
  banner.hidden = now.problems.length === 0 && !now.refusal;
  const kept = now.picture > 0 ? " You see the last version without." : "";
  const lines = now.problems.map((p) => {
    const place = p.line ? `line ${p.line}, column ${p.column}: ` : "";
    return html("div", {}, `${place}${p.message}${p.hint ? `. ${p.hint}` : ""}`);
  });
  const parts = lines.length ? [html("b", {}, `The scene file has ${lines.length === 1 ? "a mistake" : `${lines.length} mistakes`}.${kept}`), ...lines] : [];
  if (now.refusal) parts.push(html("b", {}, `The scene cannot be rendered so.${now.picture > 0 ? " You see the picture before." : ""}`), html("div", {}, now.refusal));
  banner.replaceChildren(...parts);
}

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
      clicked = setTimeout(() => (look.picking ? look.pick(at) : paths.show(at)), 220);
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

// Whether the element that has the focus needs a key for itself.
function isOwnKey(focused, key) {
  if (!focused) return false;
  if (focused.matches("select")) return true;
  if (focused.matches("input[type=radio]")) return key === " " || key.startsWith("Arrow");
  if (focused.matches("input[type=range]")) return key.startsWith("Arrow");
  return key === " " && focused.matches("input, button, a, summary");
}

function setUpKeys() {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || element("help").open || !status) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (key === "Escape") {
      look.stopPicking();
      paths.close();
    } else if (isOwnKey(document.activeElement, key)) {
      return;
    } else if (key === " ") {
      event.preventDefault();
      togglePause();
    } else if (key === "?") {
      element("help").showModal();
    } else if (key === "m") {
      chooseMap(stage.mapKind ? "" : "of-mean");
    } else if (key === "p") {
      compare.pin(true);
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

function chooseMap(kind) {
  document.querySelector(`input[name=map][value="${kind}"]`).checked = true;
  showMap(kind);
}

function showMap(kind) {
  stage.showMap(kind);
  showOpacity();
}

function showOpacity() {
  const opacity = Number(element("map-opacity").value);
  const isOn = stage.mapKind !== "";
  element("map").style.opacity = opacity;
  element("map-opacity").disabled = !isOn;
  element("map-opacity-value").textContent = `${Math.round(100 * opacity)} %`;
  element("map-mixed").hidden = !isOn || opacity === 1;
}

function setUpPanel() {
  element("pause").addEventListener("click", togglePause);
  element("home").addEventListener("click", goHome);
  element("help-open").addEventListener("click", () => element("help").showModal());
  element("map-opacity").addEventListener("input", showOpacity);
  showOpacity();
  for (const radio of document.querySelectorAll("input[name=map]")) {
    radio.addEventListener("change", () => showMap(radio.value));
  }
}

log("begin");
setUpPointer();
setUpKeys();
setUpPanel();
stage.onLook = (about) => look.shown(about);
look.changed();
// Not waiting for news: there may be a picture already.
stage.begin();
listen(update, (why) => (element("phase").textContent = why));
window.addEventListener("resize", () => status && showAccuracy(status));

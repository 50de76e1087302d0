// The picture with what lies over it, and where the cursor is.

import { askPicture, latest } from "./server.js";
import { digits, percent, svg } from "./format.js";
import { log } from "./log.js";

const element = (id) => document.getElementById(id);

export class Stage {
  constructor(look) {
    this.look = look;
    this.size = [1, 1];
    this.shown = 0;
    this.stageNumber = 0;
    this.mapKind = "";
    this.split = 0.5;
    // The tiles of the largest error and of the largest difference, as columns and rows.
    this.noisiest = null;
    this.mostDifferent = null;
    this.picture = element("picture");
    this.frame = element("frame");
    this.fetchPicture = latest(async (number) => this.#fetchPicture(number));
    this.fetchMap = latest(async () => this.#fetchMap());
    this.fetchPinned = latest(async () => this.#fetchPinned());
    new ResizeObserver(() => this.fit()).observe(this.frame);
    this.onLook = () => {};
    this.#splitHandle();
  }

  // The place of the picture in the page: as large as there is room, pixels square.
  fit() {
    const room = this.frame.getBoundingClientRect();
    const [width, height] = this.size;
    const scale = Math.min(room.width / width, room.height / height);
    this.scale = scale;
    const box = { left: (room.width - width * scale) / 2, top: (room.height - height * scale) / 2, width: width * scale, height: height * scale };
    this.box = box;
    for (const id of ["picture", "pinned", "map", "overlay"]) {
      const { style } = element(id);
      for (const side of ["left", "top", "width", "height"]) style[side] = `${box[side]}px`;
      style.imageRendering = scale >= 2.5 ? "pixelated" : "auto";
    }
    element("overlay").setAttribute("viewBox", `0 0 ${width} ${height}`);
    element("overlay").setAttribute("preserveAspectRatio", "none");
    this.#placeSplit();
  }

  // Takes over what the server says, and asks for the picture if there is a new one.
  update(status) {
    this.pinned = status.pinned;
    this.noisiest = status.error?.noisiest?.crop ?? null;
    if (status.size[0] !== this.size[0] || status.size[1] !== this.size[1]) {
      this.size = status.size;
      this.fit();
    }
    if (status.picture > 0 && status.picture !== this.asked) {
      this.asked = status.picture;
      this.fetchPicture(status.picture);
    }
    this.#drawBox();
  }

  // The first picture, if there is one.
  begin() {
    this.fetchPicture();
  }

  redraw() {
    if (this.asked) this.fetchPicture(this.asked);
    if (!element("pinned").hidden) this.fetchPinned();
  }

  async #fetchPicture() {
    const begun = performance.now();
    try {
      const found = await askPicture("picture.png", this.look());
      if (!found) return;
      const { bitmap, about } = found;
      if (about.film[0] !== this.size[0] || about.film[1] !== this.size[1]) {
        this.size = about.film;
        this.fit();
      }
      const [width, height] = this.size;
      this.#paint(this.picture, bitmap, width, height);
      this.shown = about.picture;
      this.asked = Math.max(this.asked ?? 0, about.picture);
      this.stageNumber = about.stage;
      this.about = about;
      element("waiting").hidden = true;
      this.onLook(about);
      log("picture", { ...about, fetch_ms: performance.now() - begun });
      if (this.mapKind) this.fetchMap();
    } catch (error) {
      log("picture-refused", { message: error.message });
      if (this.shown) this.onLook({ refused: error.message });
    }
  }

  #paint(canvas, bitmap, width, height) {
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const context = canvas.getContext("2d");
    context.imageSmoothingEnabled = true;
    context.imageSmoothingQuality = "high";
    // The pixels of a coarse picture stand for whole blocks, of which the last may reach beyond the film.
    const block = canvas === element("picture") || canvas === element("map") ? Math.max(1, Math.ceil(width / bitmap.width)) : 1;
    const exact = block > 1 ? 2 ** Math.round(Math.log2(block)) : 1;
    context.drawImage(bitmap, 0, 0, bitmap.width * exact, bitmap.height * exact);
    bitmap.close();
  }

  showMap(kind) {
    this.mapKind = kind;
    element("map").hidden = true;
    element("legend").hidden = true;
    this.#drawBox();
    if (kind) this.fetchMap();
  }

  // The tile of the largest difference from the pinned picture; null if there is none.
  showDifference(tile) {
    this.mostDifferent = tile;
    this.#drawBox();
  }

  // A box around the tile that the map is about, and its name in the legend. Lines have the same width at all sizes of the picture.
  #drawBox() {
    element("tile-box").replaceChildren();
    if (element("map").hidden) return;
    const isDifference = this.mapKind === "difference";
    const tile = isDifference ? this.mostDifferent : this.noisiest;
    const unit = this.mapKind === "relative" ? " relative to the mean brightness" : "";
    const box = ` Box: the tile with the largest ${isDifference ? "difference" : "error"}${unit}.`;
    element("legend-title").textContent = `${this.legendTitle}${tile ? box : ""}`;
    if (!tile) return;
    const [left, right, top, bottom] = tile;
    const place = { x: left, y: top, width: right - left, height: bottom - top, fill: "none", "vector-effect": "non-scaling-stroke" };
    element("tile-box").replaceChildren(svg("rect", { ...place, stroke: "#000", "stroke-width": 4 }), svg("rect", { ...place, stroke: "#fff", "stroke-width": 2 }));
  }

  async #fetchMap() {
    if (!this.mapKind) return;
    const kind = this.mapKind;
    const obstacle = kind === "difference" ? this.#noDifference() : null;
    if (obstacle) {
      this.#refuseMap(obstacle);
      return;
    }
    try {
      const { bitmap, about } = await askPicture("map.png", { kind });
      if (kind !== this.mapKind) return;
      this.#paint(element("map"), bitmap, this.size[0], this.size[1]);
      element("map").hidden = false;
      element("legend").hidden = false;
      this.#drawLegend(about.legend);
      this.#drawBox();
      log("map", { kind, picture: about.picture, rms: about.legend.rms, range: about.legend.range });
    } catch (error) {
      this.#refuseMap(error.message);
    }
  }

  // Why the picture is not compared with the pinned one; null if it is.
  #noDifference() {
    if (this.about?.block !== 1) return "A coarse picture is not compared: wait for all pixels.";
    return this.about.stage === this.pinned?.stage ? "The pinned picture and this one share their samples: change something first." : null;
  }

  #refuseMap(why) {
    element("map").hidden = true;
    element("legend").hidden = false;
    element("legend-title").textContent = why;
    element("legend-bar").replaceChildren();
    this.#drawBox();
  }

  #drawLegend(legend) {
    const colours = "Yellow: large error. Dark: small error.";
    const titles = {
      relative: `Standard error of each pixel, in percent of the pixel. ${colours} The root mean square is ${percent(legend.rms)}.`,
      "of-mean": `Standard error of each pixel, in percent of the mean brightness. ${colours} The root mean square, ${percent(legend.rms)}, is the error of the picture.`,
      samples: "Samples of each pixel, in units of their mean. Yellow: many samples. Dark: few samples.",
      difference: `This picture minus the pinned picture, in standard errors. Blue: this picture is darker. Red: it is brighter. Colours stop at ±${digits(legend.range[1], 1)}. Single pixels of strong colour come by chance; regions of one colour do not.`,
    };
    let title = titles[legend.kind];
    if (legend.unknown) title += ` Green: unknown (${legend.unknown} pixels).`;
    this.legendTitle = title;
    const bar = element("legend-bar");
    const [left, width] = [16, 308];
    const parts = legend.colours.map((colour, i) =>
      svg("rect", { x: left + (i * width) / legend.colours.length, y: 2, width: width / legend.colours.length + 0.6, height: 12, fill: `rgb(${colour.join(" ")})` }));
    const [low, high] = legend.range;
    const isLog = legend.kind !== "difference";
    const place = (v) => (isLog ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low));
    const name = (v) => (legend.kind === "relative" || legend.kind === "of-mean" ? percent(v) : digits(v, 2));
    let end = -Infinity;
    for (const tick of legend.ticks) {
      const x = left + place(tick) * width;
      const words = name(tick);
      const half = 3.4 * words.length;
      if (x - half < end) continue;
      end = x + half + 4;
      parts.push(svg("line", { x1: x, x2: x, y1: 14, y2: 18, stroke: "#a3a6ab" }), svg("text", { x, y: 30, "text-anchor": "middle" }, words));
    }
    bar.replaceChildren(...parts);
  }

  // The pixel under a pointer, or null outside of the picture.
  pixelAt(event) {
    const room = this.frame.getBoundingClientRect();
    const x = Math.floor((event.clientX - room.left - this.box.left) / this.scale);
    const y = Math.floor((event.clientY - room.top - this.box.top) / this.scale);
    return x >= 0 && y >= 0 && x < this.size[0] && y < this.size[1] ? [x, y] : null;
  }

  // The pinned picture on the left of the split.
  showPinned(on) {
    element("pinned").hidden = !on;
    element("split").hidden = !on;
    if (on) this.fetchPinned();
    this.#placeSplit();
  }

  async #fetchPinned() {
    try {
      const { bitmap } = await askPicture("picture.png", { ...this.look(), pinned: true });
      this.#paint(element("pinned"), bitmap, bitmap.width, bitmap.height);
    } catch {
      element("pinned").hidden = true;
    }
  }

  #placeSplit() {
    if (!this.box) return;
    const handle = element("split");
    handle.style.left = `${this.box.left + this.split * this.box.width}px`;
    handle.style.top = `${this.box.top}px`;
    handle.style.height = `${this.box.height}px`;
    element("pinned").style.clipPath = `inset(0 ${100 * (1 - this.split)}% 0 0)`;
  }

  #splitHandle() {
    const handle = element("split");
    handle.addEventListener("pointerdown", (event) => handle.setPointerCapture(event.pointerId));
    handle.addEventListener("pointermove", (event) => {
      if (!handle.hasPointerCapture(event.pointerId)) return;
      const room = this.frame.getBoundingClientRect();
      this.split = Math.min(1, Math.max(0, (event.clientX - room.left - this.box.left) / this.box.width));
      this.#placeSplit();
    });
  }
}

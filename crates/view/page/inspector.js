// What is known of the pixel under the cursor: its value, what is seen there, its spectrum with standard errors.

import { ask, latest } from "./server.js";
import { count, cssColour, digits, html, percent, seconds, svg, withError } from "./format.js";
import { log } from "./log.js";

const element = (id) => document.getElementById(id);
// Paths of the first answer, and of the best.
const FIRST = 256;
const MOST = 65536;
// How long the cursor rests before paths are traced for its spectrum.
const REST_MS = 120;
// How long until more paths are asked for, and until then where the server had no time for more.
const NEXT_MS = 200;
const WAIT_MS = 1000;

export class Inspector {
  constructor(onObject) {
    this.at = null;
    this.onObject = onObject;
    this.info = null;
    this.stage = 0;
    this.look = latest(async (at) => this.#look(at));
    this.refine = latest(async (at, paths) => this.#refine(at, paths));
  }

  // The cursor came to a pixel, or left the picture.
  point(at) {
    if (at && this.at && at[0] === this.at[0] && at[1] === this.at[1]) return;
    this.at = at;
    clearTimeout(this.rest);
    if (!at) return;
    this.look(at);
    this.rest = setTimeout(() => this.refine(at, FIRST), REST_MS);
  }

  // The picture changed under the cursor.
  refresh(stage) {
    const isNewStage = stage !== this.stage;
    this.stage = stage;
    if (!this.at) return;
    this.look(this.at);
    if (!isNewStage) return;
    // While the camera moves, each picture is one of a new stage.
    const { at } = this;
    clearTimeout(this.rest);
    this.rest = setTimeout(() => this.refine(at, FIRST), REST_MS);
  }

  async #look(at) {
    try {
      this.info = await ask("pixel", { x: at[0], y: at[1] });
    } catch {
      return;
    }
    const { info } = this;
    element("pixel-none").hidden = true;
    element("pixel-some").hidden = false;
    const scale = 1 / Math.max(1, ...info.rgb);
    const words = info.object
      ? ["object ", html("b", {}, info.object.object), ...(info.object.material ? [", material ", html("b", {}, info.object.material)] : [])]
      : [html("span", {}, "nothing is met there")];
    const swatch = html("span", { class: "swatch" });
    swatch.style.background = cssColour(info.rgb, scale);
    element("pixel-what").replaceChildren(swatch, ...words);
    const rows = [["pixel", `column ${at[0]}, row ${at[1]}${info.block > 1 ? `, of a coarse picture (${info.block} × ${info.block})` : ""}`]];
    rows.push(["brightness Y", withError(info.luminance, info.luminance_error)]);
    if (info.luminance_error > 0 && info.luminance > 0) {
      const ofMean = info.mean_luminance > 0 ? `, ${percent(info.luminance_error / info.mean_luminance)} of the mean` : "";
      rows.push(["± is", `one standard error: ${percent(info.luminance_error / info.luminance)} of the pixel${ofMean}`]);
    }
    ["red", "green", "blue"].forEach((name, c) => rows.push([`${name}, linear Rec. 709`, withError(info.rgb[c], info.rgb_error?.[c])]));
    if (info.samples !== null) rows.push(["samples in the picture", count(info.samples)]);
    if (info.object?.depth_m) rows.push(["distance from the eye", `${digits(info.object.depth_m, 4)} m`]);
    const cells = rows.map(([name, value]) => html("tr", {}, html("td", {}, name), html("td", {}, value)));
    element("pixel-values").replaceChildren(...cells);
    this.onObject(info.object);
    log("pixel", { at, object: info.object?.object ?? null, material: info.object?.material ?? null, luminance: info.luminance, luminance_error: info.luminance_error });
  }

  async #refine(at, paths) {
    try {
      const spectrum = await ask("spectrum", { x: at[0], y: at[1], count: paths });
      if (!this.at || at[0] !== this.at[0] || at[1] !== this.at[1]) return;
      this.#draw(spectrum);
      log("spectrum", { at, bands: spectrum.bands.length, samples: spectrum.samples, with_errors: spectrum.bands.filter((b) => b.error !== null).length });
      // The longer the cursor rests, the shorter the bars.
      if (spectrum.samples !== null && spectrum.samples < MOST) {
        const pause = spectrum.samples < paths ? WAIT_MS : NEXT_MS;
        this.rest = setTimeout(() => this.refine(at, Math.min(MOST, 4 * spectrum.samples)), pause);
      }
    } catch (error) {
      element("spectrum").replaceChildren();
      element("spectrum-words").textContent = error.message;
    }
  }

  #draw(spectrum) {
    const chart = element("spectrum");
    const { width, height } = chart.getBoundingClientRect();
    if (width === 0) return;
    const [left, right, top, bottom] = [46, 8, 8, 30];
    const { bands } = spectrum;
    const step = bands.length > 1 ? bands[1].centre_nm - bands[0].centre_nm : 10;
    const [low, high] = [bands[0].centre_nm - step / 2, bands.at(-1).centre_nm + step / 2];
    const tops = bands.map((b) => b.radiance + (b.error ?? 0)).filter(Number.isFinite);
    const peak = Math.max(...tops.filter((v) => v > 0), 1e-30);
    const x = (nm) => left + ((nm - low) / (high - low)) * (width - left - right);
    const y = (v) => top + (1 - Math.min(1.05, Math.max(-0.05, v / (1.06 * peak)))) * (height - top - bottom);
    const parts = [];
    for (const value of [0, 0.5 * peak, peak]) {
      parts.push(svg("line", { x1: left, x2: width - right, y1: y(value), y2: y(value), stroke: "#2c2f33" }));
      parts.push(svg("text", { x: left - 5, y: y(value) + 4, "text-anchor": "end" }, digits(value, 2)));
    }
    for (let nm = Math.ceil(low / 100) * 100; nm <= high; nm += 100) {
      parts.push(svg("text", { x: x(nm), y: height - 4, "text-anchor": "middle" }, nm + 60 > high ? `${nm}` : `${nm} nm`));
    }
    for (const band of bands) {
      const [a, b] = [x(band.centre_nm - step / 2), x(band.centre_nm + step / 2)];
      const colour = ofWavelength(band.centre_nm);
      parts.push(svg("rect", { x: a, y: height - bottom + 2, width: b - a + 0.5, height: 6, fill: colour }));
      if (!Number.isFinite(band.radiance)) continue;
      const base = y(0);
      parts.push(svg("rect", { x: a, y: Math.min(base, y(band.radiance)), width: b - a - 0.5, height: Math.abs(base - y(band.radiance)), fill: colour, opacity: 0.35 }));
      parts.push(svg("line", { x1: a, x2: b - 0.5, y1: y(band.radiance), y2: y(band.radiance), stroke: "#e6e4df", "stroke-width": 1.5 }));
      if (band.error) {
        const middle = (a + b) / 2;
        parts.push(svg("line", { x1: middle, x2: middle, y1: y(band.radiance - band.error), y2: y(band.radiance + band.error), stroke: "#e6e4df" }));
      }
    }
    chart.replaceChildren(...parts);
    const source = spectrum.samples === null
      ? "bands of the picture."
      : `from ${spectrum.samples} extra paths of this pixel, traced in ${seconds(spectrum.seconds)}. They are not part of the picture.`;
    const more = spectrum.samples === null ? "" : spectrum.samples < MOST ? " Hold the cursor still, and the lines get shorter." : " This is the most that is traced.";
    element("spectrum-words").textContent = `Radiance in W/(m² sr nm). Spectrum: ${source} Thin vertical lines are one standard error.${more}`;
  }
}

// A colour for the scale below a spectrum: for orientation only.
function ofWavelength(nm) {
  const hump = (centre, below, above) => Math.exp(-0.5 * ((nm - centre) / (nm < centre ? below : above)) ** 2);
  const rgb = [hump(610, 38, 40) + 0.25 * hump(425, 20, 20), hump(545, 40, 38), hump(455, 24, 28)];
  return cssColour(rgb.map((v) => 0.04 + 0.75 * v));
}

// The paths of a pixel, drawn over the picture and listed vertex by vertex.

import { ask } from "./server.js";
import { cssColour, digits, html, svg } from "./format.js";
import { log } from "./log.js";

const element = (id) => document.getElementById(id);
const COUNT = 24;
// Why a path ended.
const ENDS = {
  escaped: "left the scene",
  roulette: "dropped by chance",
  absorbed: "absorbed",
  "throughput below the floor": "its weight became too small",
  "throughput not finite": "its weight is not finite",
  "limit on depth": "reached the limit of hits",
};
const WEIGHT = "The weight of a place is the factor by which light from there counts in the pixel. It may exceed 1 where chance decides how a path goes on.";
const FIRST = "The picture takes the same paths in the same order. The brightness of the pixel is the mean of what its paths add.";

export class Paths {
  constructor() {
    this.at = null;
    this.chosen = null;
    element("paths-close").addEventListener("click", () => this.close());
  }

  async show(at) {
    let paths;
    try {
      paths = await ask("paths", { x: at[0], y: at[1], count: COUNT });
    } catch (error) {
      element("paths").hidden = false;
      element("paths-at").textContent = at.join(", ");
      element("paths-words").textContent = error.message;
      element("paths-words").title = "";
      element("paths-legend").hidden = true;
      element("paths-list").replaceChildren();
      element("path-lines").replaceChildren();
      this.at = at;
      this.paths = [];
      return;
    }
    this.at = at;
    this.paths = paths;
    this.chosen = null;
    this.brightest = Math.max(...paths.map((p) => p.luminance), 1e-30);
    element("paths").hidden = false;
    element("paths-at").textContent = `in column ${at[0]}, row ${at[1]}`;
    const found = paths.filter((p) => p.luminance > 0).length;
    element("paths-words").textContent = `These are the first ${paths.length} paths of this pixel, traced once more. ${found} of them found light. A line has the colour of the light that its path adds.`;
    element("paths-words").title = FIRST;
    element("paths-legend").hidden = false;
    this.#list();
    this.#draw();
    element("paths").scrollIntoView({ block: "nearest" });
    log("paths", { at, paths: paths.length, found, vertices: paths.reduce((sum, p) => sum + p.vertices.length, 0) });
  }

  close() {
    this.at = null;
    element("paths").hidden = true;
    element("path-lines").replaceChildren();
  }

  #colour(path) {
    if (!(path.luminance > 0)) return "#8a8d92";
    return cssColour(path.rgb, 0.8 / Math.max(...path.rgb, 1e-30));
  }

  #list() {
    const items = this.paths.map((path, index) => {
      const dot = html("span", { class: "dot" });
      dot.style.background = path.luminance > 0 ? this.#colour(path) : "transparent";
      const words = path.luminance > 0 ? `adds brightness ${digits(path.luminance, 3)} (Y)` : "found no light";
      const hits = `${path.vertices.length} ${path.vertices.length === 1 ? "hit" : "hits"}`;
      // Samples count from 0, as in commands and files. People count paths from 1.
      const name = html("span", { title: `sample ${path.sample} of the pixel` }, `path ${path.sample + 1}`);
      const head = html("div", { class: "head" }, dot, name, html("span", { class: path.luminance > 0 ? "" : "lost" }, `${words}; ${hits}; ${ENDS[path.end] ?? path.end}`));
      const item = html("li", {}, head);
      item.addEventListener("pointerenter", () => this.#choose(index, item));
      item.addEventListener("click", () => this.#open(path, item));
      return item;
    });
    element("paths-list").replaceChildren(...items);
    const brightest = this.paths.findIndex((path) => path.luminance === this.brightest);
    if (brightest >= 0) this.#open(this.paths[brightest], items[brightest]);
  }

  #open(path, item) {
    if (item.querySelector("ol")) {
      item.querySelector("ol").remove();
      return;
    }
    const vertices = path.vertices.map((vertex) => {
      const line = html("li", {}, html("b", {}, vertex.object), vertex.material ? ` (${vertex.material})` : "", ", ", html("span", { title: WEIGHT }, `weight ${digits(vertex.throughput, 2)}`));
      for (const [how, radiance] of vertex.light) {
        line.append(html("span", { class: "found" }, `; adds ${digits(radiance, 3)} ${how === "emitter" ? "as a lamp" : `by ${how.replace("-", " ")}`}`));
      }
      return line;
    });
    item.append(html("ol", {}, ...vertices));
  }

  #choose(index, item) {
    this.chosen = index;
    for (const other of element("paths-list").children) other.classList.toggle("is-chosen", other === item);
    this.#draw();
  }

  #draw() {
    const overlay = element("overlay");
    const scale = overlay.getBoundingClientRect().width / Number(overlay.getAttribute("viewBox").split(" ")[2]);
    const px = 1 / scale;
    const parts = [];
    const order = this.paths.map((_, i) => i).sort((a, b) => (a === this.chosen) - (b === this.chosen) || this.paths[a].luminance - this.paths[b].luminance);
    for (const index of order) {
      const path = this.paths[index];
      const isChosen = index === this.chosen;
      const lit = path.luminance > 0;
      const opacity = this.chosen === null ? (lit ? 0.95 : 0.4) : isChosen ? 1 : 0.15;
      const colour = this.#colour(path);
      const group = svg("g", { opacity });
      for (const [, [a, b]] of path.pieces) {
        group.append(svg("line", { x1: a[0], y1: a[1], x2: b[0], y2: b[1], stroke: "#000", "stroke-width": (isChosen ? 5 : 3.4) * px, opacity: 0.45, "stroke-linecap": "round" }));
        group.append(svg("line", { x1: a[0], y1: a[1], x2: b[0], y2: b[1], stroke: colour, "stroke-width": (isChosen ? 2.6 : 1.5) * px, "stroke-linecap": "round" }));
      }
      for (const vertex of path.vertices.filter((v) => v.pixel)) {
        const found = vertex.light.length > 0;
        group.append(svg("circle", { cx: vertex.pixel[0], cy: vertex.pixel[1], r: (found ? 3.6 : 2.6) * px, fill: found ? colour : "#17181a", stroke: found ? "#000" : colour, "stroke-width": px }));
      }
      parts.push(group);
    }
    parts.push(svg("circle", { cx: this.at[0] + 0.5, cy: this.at[1] + 0.5, r: 8 * px, fill: "none", stroke: "#000", "stroke-width": 3 * px }));
    parts.push(svg("circle", { cx: this.at[0] + 0.5, cy: this.at[1] + 0.5, r: 8 * px, fill: "none", stroke: "#fff", "stroke-width": 1.5 * px }));
    element("path-lines").replaceChildren(...parts);
  }
}

// The errors at which the picture is good enough: a radio button for each, and when it is reached.

import { MARKS, whenReached } from "./curve.js";
import { html, percent } from "./format.js";

const element = (id) => document.getElementById(id);
// Stands for no error at all: the render goes on.
const ENDLESS = 0;

// Rows stay in the page once they are there, and only their texts change. A row that is replaced would lose a click or the focus.
export class Marks {
  constructor(onChoice) {
    this.onChoice = onChoice;
    this.rows = new Map();
    this.target = undefined;
    [...MARKS, ENDLESS].forEach((error) => this.#add(error));
  }

  update(status) {
    element("marks").hidden = !status.is_scene;
    const target = status.target ?? ENDLESS;
    if (!this.rows.has(target)) this.#add(target);
    // A choice that the server has not heard of yet stays.
    if (target !== this.target) this.rows.get(target).radio.checked = true;
    this.target = target;
    element("marks-sure").hidden = !status.is_scene;
    element("marks-sure").textContent = "";
    for (const [error, row] of this.rows) {
      if (error === ENDLESS) continue;
      const found = whenReached(status, error);
      this.#tell(row, found);
      if (error === target) element("marks-sure").textContent = found.sure ?? "";
    }
  }

  #tell({ when }, { words, sure, reached }) {
    if (when.textContent !== words) when.textContent = words;
    when.title = sure ?? "";
    when.classList.toggle("reached", reached);
  }

  // A row, above those of smaller errors.
  #add(error) {
    const radio = html("input", { type: "radio", name: "target", value: String(error) });
    radio.addEventListener("change", () => this.onChoice(error));
    const when = html("span");
    const name = error === ENDLESS ? "go on until I pause" : `stop at ${percent(error)}`;
    const label = html("label", {}, html("span", {}, radio, name), when);
    const below = [...this.rows].filter(([other]) => other < error).sort(([a], [b]) => b - a)[0];
    element("marks").insertBefore(label, below ? below[1].label : null);
    this.rows.set(error, { label, radio, when });
  }
}

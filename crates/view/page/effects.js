// The effects of light that the plan knows: why each is simulated, what the picture lacks without it, what it costs.

import { order } from "./server.js";
import { digits, html, percent } from "./format.js";
import { log } from "./log.js";

const element = (id) => document.getElementById(id);

// Rows stay in the page once they are there, so that no click and no focus is lost.
export class Effects {
  constructor() {
    this.key = "";
    this.here = null;
    this.rows = new Map();
    element("costs").addEventListener("click", () => {
      log("costs-asked");
      order("control", { costs: true });
    });
  }

  update(status) {
    element("effects").hidden = !status.plan?.effects;
    element("costs").hidden = !status.is_scene;
    element("costs").disabled = status.phase === "costs";
    const key = JSON.stringify([status.plan?.effects, status.costs, status.without]);
    if (key === this.key || !status.plan?.effects) return;
    this.key = key;
    this.without = status.without;
    const { effects } = status.plan;
    const isListed = (effect) => effect.on || effect.study === "left-out";
    place(element("effects-on"), effects.filter(isListed).map((effect) => this.#row(effect, status)));
    const off = effects.filter((effect) => !isListed(effect));
    element("effects-off-summary").textContent = `Not needed by this scene (${off.length})`;
    element("effects-off").replaceChildren(...off.map((effect) => html("li", {}, html("label", {}, spoken(effect.name)), html("span", { class: "because" }, effect.because))));
  }

  // The object under the cursor: effects that it calls for are marked.
  point(object) {
    this.here = object ? [object.object, object.material] : null;
    for (const item of element("effects-on").children) item.classList.toggle("is-here", this.#isHere(item.dataset.because));
  }

  #isHere(because) {
    return Boolean(this.here?.some((name) => name && because?.includes(`"${name}"`)));
  }

  // The row of an effect, with what is known of it now.
  #row(effect, { is_scene, costs, without }) {
    if (!this.rows.has(effect.name)) this.rows.set(effect.name, this.#newRow(effect.name));
    const { item, box, lost, because, cost } = this.rows.get(effect.name);
    box.disabled = !is_scene;
    box.checked = effect.on && !without.includes(effect.name);
    lost.hidden = effect.study !== "left-out";
    lost.textContent = `${without.includes(effect.name) ? "you switched it off" : "the command line switched it off"}: the picture is now an approximation`;
    because.textContent = `${effect.study === "forced" ? "not needed" : "needed because"}: ${effect.because}`;
    item.dataset.because = effect.because;
    item.classList.toggle("is-here", this.#isHere(effect.because));
    const known = costs.find((cost) => cost.effect === effect.name);
    cost.textContent = known ? inWords(known) : "";
    if (known) item.append(cost);
    else cost.remove();
    return item;
  }

  #newRow(name) {
    const box = html("input", { type: "checkbox" });
    box.addEventListener("change", () => {
      const others = this.without.filter((other) => other !== name);
      order("effects", { without: box.checked ? others : [...others, name] });
      log("effect", { name, on: box.checked });
    });
    const lost = html("span", { class: "lost" });
    const because = html("span", { class: "because" });
    const here = html("span", { class: "here", title: "The object under the cursor, or its material, is the reason" }, "(needed here)");
    const item = html("li", {}, html("label", {}, box, spoken(name), here), lost, because);
    return { item, box, lost, because, cost: html("span", { class: "cost" }) };
  }
}

// Puts these rows into a list, if it does not hold them already.
function place(list, rows) {
  const isSame = list.children.length === rows.length && rows.every((row, index) => list.children[index] === row);
  if (!isSame) list.replaceChildren(...rows);
}

export function spoken(name) {
  return name === "mis" ? "multiple importance sampling" : name.replaceAll("-", " ");
}

// 1.3 → "30 % longer", 0.8 → "20 % less time", 4 → "4.0 times as long".
function times(ratio) {
  if (ratio > 2 || ratio < 0.5) return `${digits(ratio, 2)} times as long`;
  const change = Math.abs(ratio - 1);
  if (change < 0.02) return "the same time (within 2 %)";
  return ratio > 1 ? `${percent(change)} longer` : `${percent(change)} less time`;
}

function inWords(cost) {
  if (cost.problem) return `Its cost cannot be measured: ${cost.problem}`;
  const perPath = `A path takes ${times(cost.path_time)} with it.`;
  if (cost.time_to_error === null) return perPath;
  const sure = cost.uncertainty === null ? "" : ` This time is known to ± ${percent(cost.uncertainty)}.`;
  return `${perPath} The same error takes ${times(cost.time_to_error)} to reach.${sure}`;
}

// The effects of light that the plan knows: why each is simulated, what the picture lacks without it, what it costs.

import { order } from "./server.js";
import { digits, html, percent } from "./format.js";
import { log } from "./log.js";

const element = (id) => document.getElementById(id);

export class Effects {
  constructor() {
    this.key = "";
    this.here = null;
    element("costs").addEventListener("click", () => {
      log("costs-asked");
      order("control", { costs: true });
    });
  }

  update(status) {
    this.isScene = status.is_scene;
    element("effects").hidden = !status.plan?.effects;
    element("costs").hidden = !status.is_scene;
    element("costs").disabled = status.phase === "costs";
    const key = JSON.stringify([status.plan?.effects, status.costs, status.without, this.here]);
    if (key === this.key || !status.plan?.effects) return;
    this.key = key;
    this.without = status.without;
    const { effects } = status.plan;
    const isListed = (effect) => effect.on || effect.study === "left-out";
    element("effects-on").replaceChildren(...effects.filter(isListed).map((effect) => this.#item(effect, status.costs)));
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

  #item(effect, costs) {
    const box = html("input", { type: "checkbox", checked: effect.on, disabled: !this.isScene });
    box.addEventListener("change", () => {
      const others = this.without.filter((name) => name !== effect.name);
      order("effects", { without: box.checked ? others : [...others, effect.name] });
      log("effect", { name: effect.name, on: box.checked });
    });
    const label = html("label", {}, box, spoken(effect.name), effect.study === "left-out" ? html("span", { class: "lost" }, "left out: an approximation") : null);
    const item = html("li", {}, label, html("span", { class: "because" }, `because: ${effect.because}`));
    item.dataset.because = effect.because;
    item.classList.toggle("is-here", this.#isHere(effect.because));
    const cost = costs.find((cost) => cost.effect === effect.name);
    if (cost) item.append(html("span", { class: "cost" }, inWords(cost)));
    return item;
  }
}

export function spoken(name) {
  return name === "mis" ? "multiple importance sampling" : name.replaceAll("-", " ");
}

// 1.3 → "30 % more", 0.8 → "20 % less", 4 → "4.0 times".
function times(ratio) {
  if (ratio > 2 || ratio < 0.5) return `${digits(ratio, 2)} times the time`;
  const change = Math.abs(ratio - 1);
  if (change < 0.02) return "the same time within 2 %";
  return `${percent(change)} ${ratio > 1 ? "more" : "less"} time`;
}

function inWords(cost) {
  if (cost.problem) return `Its cost cannot be measured: ${cost.problem}`;
  const perPath = `With it a path takes ${times(cost.path_time)}`;
  if (cost.time_to_error === null) return `${perPath}.`;
  const sure = cost.uncertainty === null ? "" : ` (± ${percent(cost.uncertainty)})`;
  return `${perPath}, and reaching the same error takes ${times(cost.time_to_error)}${sure}.`;
}

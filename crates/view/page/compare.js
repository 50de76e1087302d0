// The pinned picture, and whether it and the picture of now differ by more than their noise.

import { ask, latest, order } from "./server.js";
import { digits, percent, tileName } from "./format.js";
import { log } from "./log.js";

const element = (id) => document.getElementById(id);

const VERDICTS = {
  equal: "The two pictures are equal.",
  "within-noise": "The two pictures differ by no more than their noise. A difference that is smaller than the noise cannot be seen.",
  differ: "The two pictures differ by more than their noise.",
  untested: "The two pictures differ, but the error of some pixels is not known.",
};

export class Compare {
  constructor(stage, chooseMap) {
    this.stage = stage;
    this.chooseMap = chooseMap;
    this.status = null;
    this.pinnedNumber = 0;
    this.comparedPicture = 0;
    this.toldStage = 0;
    this.compareNow = latest(async () => this.#compare());
    element("pin").addEventListener("click", () => this.pin(true));
    element("unpin").addEventListener("click", () => this.pin(false));
    element("split-on").addEventListener("change", (event) => stage.showPinned(event.target.checked));
  }

  // A coarse picture has fewer pixels than those that follow, so it is not pinned.
  get canPin() {
    return this.status?.block === 1;
  }

  async pin(pinned) {
    if (pinned && !this.canPin) return;
    try {
      await order("pin", { pinned });
      log("pin", { pinned });
    } catch (error) {
      log("pin-refused", { message: error.message });
    }
  }

  update(status) {
    this.status = status;
    const { pinned } = status;
    element("unpin").hidden = !pinned;
    element("split-label").hidden = !pinned;
    element("compare-words").hidden = Boolean(pinned);
    element("pin").disabled = !this.canPin;
    element("pin").textContent = pinned ? "Pin this one instead" : "Pin this picture";
    document.querySelector("input[name=map][value=difference]").disabled = !pinned;
    element("map-difference-words").textContent = pinned ? "in standard errors" : "(pin a picture first)";
    if ((pinned?.number ?? 0) !== this.pinnedNumber) this.#pinnedAnother(pinned);
    this.#follow(status);
  }

  #pinnedAnother(pinned) {
    this.pinnedNumber = pinned?.number ?? 0;
    this.comparedPicture = 0;
    this.toldStage = 0;
    this.stage.showDifference(null);
    element("split-on").checked = false;
    this.stage.showPinned(false);
    if (!pinned && this.stage.mapKind === "difference") this.chooseMap("");
  }

  // Pictures of the same stage share their samples: a test of their difference means nothing.
  #follow({ pinned, stage, block, picture }) {
    if (!pinned) {
      element("verdict").textContent = "";
      return;
    }
    const title = `Pinned: ${pinned.title}, ${percent(pinned.relative_rmse)}.`;
    if (stage === pinned.stage) {
      this.toldStage = stage;
      element("verdict").textContent = `${title} Now change something.`;
      return;
    }
    if (stage !== this.toldStage) {
      this.toldStage = stage;
      this.stage.showDifference(null);
      element("verdict").textContent = `${title} The two are compared as soon as all pixels of this picture are rendered.`;
    }
    if (block === 1 && picture !== this.comparedPicture) {
      this.comparedPicture = picture;
      this.compareNow();
    }
  }

  async #compare() {
    const { stage, pinned } = this.status;
    if (!pinned) return;
    let words;
    let tile = null;
    try {
      const comparison = await ask("comparison");
      // There is no picture of all pixels of this stage yet: the next picture is compared.
      if (!comparison) {
        this.comparedPicture = 0;
        return;
      }
      words = inWords(comparison);
      const largest = largestOf(comparison);
      tile = comparison.verdict === "differ" && largest && !isWhole(largest.crop, comparison) ? largest.crop : null;
      log("comparison", { verdict: comparison.verdict, stage });
    } catch (error) {
      words = `Pinned: ${pinned.title}. ${error.message}.`;
    }
    // Something else may have been pinned or changed meanwhile.
    if (this.status.stage !== stage || this.status.pinned?.number !== pinned.number) return;
    element("verdict").textContent = words;
    this.stage.showDifference(tile);
  }
}

const COLOURS = { R: "red", G: "green", B: "blue" };

// The tile whose mean differs most, with the channel; null where nothing differs. An infinite difference is null in JSON.
function largestOf({ verdict, test }) {
  if (!test || verdict === "equal") return null;
  const size = ({ t }) => (t === null ? Infinity : Math.abs(t));
  const worst = test.channels.filter((c) => c.worst).map((c) => ({ ...c.worst, channel: c.channel }));
  return worst.filter((tile) => size(tile) > 0).sort((a, b) => size(b) - size(a))[0] ?? null;
}

function isWhole([left, right, top, bottom], { width, height }) {
  return left === 0 && top === 0 && right === width && bottom === height;
}

function inWords(comparison) {
  const { verdict, test, note } = comparison;
  const sentences = [VERDICTS[verdict]];
  if (test && verdict === "differ") {
    sentences.push(`If nothing had changed, this test would still say so in 1 of ${Math.round(1 / test.significance)} cases.`);
  }
  const largest = largestOf(comparison);
  if (largest) {
    const where = isWhole(largest.crop, comparison) ? "whole picture" : `tile of ${tileName(largest.crop)}`;
    const by = largest.t === null ? "by more than any number of standard errors" : `by ${digits(Math.abs(largest.t), 2)} standard errors`;
    const colour = COLOURS[largest.channel];
    // The test takes the pinned picture from this one.
    const how = largest.t === null ? `the pictures differ in ${colour}` : `this picture is ${largest.t < 0 ? "darker" : "brighter"} in ${colour}`;
    sentences.push(`Largest difference: ${how} ${by}, in the mean of the ${where}.`);
  }
  if (note) sentences.push(`Note: ${note}.`);
  return sentences.join(" ");
}

// How the picture is shown: exposure, what looks white, tone curve. The values stay.

import { ask, saveAddress } from "./server.js";
import { count, digits } from "./format.js";

const element = (id) => document.getElementById(id);

export class Look {
  constructor(onChange) {
    this.onChange = onChange;
    this.picking = false;
    // The choice of white, and the colour of the spot that was picked last.
    this.white = "";
    this.spot = null;
    element("white").value = "";
    element("exposure").addEventListener("input", () => this.changed());
    element("exposure").addEventListener("dblclick", () => {
      element("exposure").value = 0;
      this.changed();
    });
    element("exposure-auto").addEventListener("change", () => this.changed());
    element("tone").addEventListener("change", () => this.changed());
    element("white").addEventListener("change", (event) => this.#chooseWhite(event.target.value));
  }

  // As the server takes it.
  get settings() {
    return {
      exposure: element("exposure-auto").checked ? "auto" : element("exposure").value,
      white: this.white === "spot" ? this.spot : this.white,
      curve: element("tone").value,
    };
  }

  changed() {
    element("exposure").disabled = element("exposure-auto").checked;
    element("save-png").href = saveAddress("save.png", this.settings);
    this.onChange();
  }

  #chooseWhite(value) {
    this.picking = value === "pick";
    if (this.picking) {
      element("clipped").textContent = "Click on something that is to look white. Esc leaves the white as it is.";
      return;
    }
    this.white = value;
    this.changed();
  }

  stopPicking() {
    if (!this.picking) return;
    this.picking = false;
    element("white").value = this.white;
    element("clipped").textContent = "";
  }

  // The colour of a spot looks white from now on, also where the camera moves or the picture is coarse.
  async pick([x, y]) {
    this.stopPicking();
    try {
      this.spot = (await ask("white", { x, y })).white;
    } catch (error) {
      element("clipped").textContent = error.message;
      return;
    }
    this.white = "spot";
    document.querySelector("#white option[value=spot]").hidden = false;
    element("white").value = this.white;
    this.changed();
  }

  // What the server says of a picture that it developed so.
  shown(about) {
    if (about.refused) {
      element("clipped").textContent = about.refused;
      return;
    }
    element("exposure-value").textContent = `${digits(about.exposure_ev, 2)} EV`.replace("unknown", "0");
    if (this.picking) return;
    element("clipped").textContent = about.clipped ? `${count(about.clipped)} of ${count(about.pixels)} pixels are too bright or too colourful for the screen.` : "";
  }
}

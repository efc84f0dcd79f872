"use strict";
// The viewer of a scene: which images stand in the panes, what the keys do, which pixel is looked at.
{
  const { byId, el } = ct;
  const MODES = { one: "one image", slider: "slider", beside: "side by side", all: "all images" };

  class Viewer {
    constructor() {
      this.root = byId("viewer");
      this.canvas = byId("view");
      this.view = new ct.Viewport(this.canvas);
      this.lane = 0; this.reference = 0; this.layer = "picture"; this.mode = "one";
      this.gain = 0; this.exposure = 0; this.peek = false;
      this.cursor = null; this.locked = false; this.cache = new Map(); this.drawn = new Map();
      this.controls();
      ct.pointer(this);
      ct.keys(this);
      addEventListener("resize", () => { if (this.scene) { this.view.resize(); this.redraw(); } });
    }

    // Show a scene in a section of the page; the last ones looked at stay unpacked.
    async show(index, slot) {
      slot.append(this.root);
      this.root.hidden = false;
      this.wanted = index;
      if (!this.cache.has(index)) this.cache.set(index, ct.unpack(index));
      if (this.cache.size > 4) this.cache.delete(this.cache.keys().next().value);
      let scene = null;
      try { scene = await this.cache.get(index); } catch (error) {
        if (this.wanted === index) this.root.hidden = true;
        throw error;
      }
      if (this.wanted !== index) return;
      const state = ct.state();
      this.scene = scene; this.view.scene = scene; this.drawn.clear();
      const named = scene.lanes.findIndex((lane) => lane.name === state.image);
      this.lane = named >= 0 ? named : Math.min(this.lane, Math.max(0, scene.lanes.length - 1));
      if (state.layer in ct.layers) this.layer = state.layer;
      if (state.mode in MODES) this.mode = state.mode;
      this.buttons();
      this.arrange();
      this.view.fit();
      const pixel = /^(\d+),(\d+)$/.exec(state.pixel || "");
      const known = pixel && { row: Number(pixel[1]), col: Number(pixel[2]) };
      const inside = known && known.row < scene.rows && known.col < scene.columns;
      this.locked = false;
      if (inside) this.look(known, true);
      else if (scene.listed.length) this.look(scene.listed[0], false);
      else this.look({ row: Math.floor(scene.rows / 2), col: Math.floor(scene.columns / 2) }, false);
      this.redraw();
      this.root.dataset.ready = scene.name;
    }

    controls() {
      const choices = (id, entries, set) => {
        const select = byId(id);
        for (const [value, label] of entries) select.append(el("option", { value }, label));
        select.addEventListener("change", () => set(select.value));
      };
      choices("layer", Object.entries(ct.layers).map(([name, layer]) => [name, layer.label]), (name) => this.set({ layer: name }));
      choices("mode", Object.entries(MODES), (mode) => this.set({ mode }));
      byId("gain").addEventListener("input", (event) => this.set({ gain: Number(event.target.value) }));
      byId("exposure").addEventListener("input", (event) => this.set({ exposure: Number(event.target.value) }));
      byId("split").addEventListener("input", () => this.redraw());
      byId("fit").addEventListener("click", () => { this.view.fit(); this.redraw(); });
      byId("zoom-in").addEventListener("click", () => this.zoom(2));
      byId("zoom-out").addEventListener("click", () => this.zoom(0.5));
      byId("next-pixel").addEventListener("click", () => this.step(1));
      byId("previous-pixel").addEventListener("click", () => this.step(-1));
    }

    buttons() {
      byId("images").replaceChildren(...this.scene.lanes.map((lane, i) => el("button", {
        type: "button", "data-lane": lane.name, "aria-pressed": String(i === this.lane),
        onclick: () => this.set({ lane: i }),
      }, el("kbd", {}, String(i + 1)), ` ${lane.name}`)));
    }

    set(changes) {
      Object.assign(this, changes);
      if (!this.scene) return;
      ct.remember({
        image: this.scene.lanes[this.lane] ? this.scene.lanes[this.lane].name : "",
        layer: this.layer === "picture" ? "" : this.layer, mode: this.mode === "one" ? "" : this.mode,
      });
      this.arrange();
      this.redraw();
    }

    image(index, layer) {
      const lane = this.scene.lanes[index];
      const key = `${index} ${layer} ${ct.layers[layer].gain ? this.gain : 0} ${this.exposure}`;
      if (this.drawn.size > 24) this.drawn.clear();
      if (!this.drawn.has(key)) {
        this.drawn.set(key, ct.drawLayer(this.scene, lane, layer, { gain: 10 ** this.gain, exposure: this.exposure }));
      }
      return this.drawn.get(key);
    }

    pane(index, layer) {
      const lane = this.scene.lanes[index];
      const shown = layer === "picture" ? lane.name : `${lane.name}: ${ct.layers[layer].label}`;
      const made = { label: shown, image: this.image(index, layer) };
      const reference = this.scene.lanes[this.reference].name;
      if (!made.image) {
        made.nothing = !lane.levels ? `no image of ${lane.name}`
          : index === this.reference ? `${reference} is what the others are held against` : "not in this page";
      }
      if (layer === "classes" && made.image) {
        const key = `masks ${index}`;
        if (!this.drawn.has(key)) this.drawn.set(key, ct.masks(this.scene, lane));
        made.masks = this.drawn.get(key); made.letters = lane.classes;
      }
      return made;
    }

    // Put the panes together. A held Shift shows the reference's picture in place of everything.
    arrange() {
      if (!this.scene.lanes.length) return;
      const { view, lane, reference, layer } = this;
      view.split = null;
      if (this.peek) view.panes = [this.pane(reference, "picture")];
      else if (this.mode === "one") view.panes = [this.pane(lane, layer)];
      else if (this.mode === "all") view.panes = this.scene.lanes.map((_, i) => this.pane(i, i === reference && layer !== "classes" ? "picture" : layer));
      else {
        view.panes = [this.pane(reference, "picture"), this.pane(lane, layer)];
        if (this.mode === "slider") view.split = Number(byId("split").value) / 100;
      }
      for (const button of byId("images").children) button.setAttribute("aria-pressed", String(button.dataset.lane === this.scene.lanes[lane].name));
      byId("layer").value = layer; byId("mode").value = this.mode;
      byId("gain-field").hidden = !ct.layers[layer].gain;
      byId("split-field").hidden = this.mode !== "slider";
      byId("gain-value").textContent = `× ${this.gain < 4 ? 10 ** this.gain : `1e${this.gain}`}`;
      byId("exposure-value").textContent = `${this.exposure > 0 ? "+" : ""}${this.exposure} stops`;
      this.legend();
    }

    legend() {
      const layer = ct.layers[this.layer];
      const entries = layer.legend ? layer.legend(10 ** this.gain) : [];
      byId("legend").replaceChildren(...entries.map(([label, color, kind]) => el("span", {},
        el("span", { class: `swatch${kind === undefined ? "" : ` hatch${kind}`}`, style: `background-color:${ct.css(color)}` }), label)));
    }

    redraw() {
      if (!this.scene) return;
      if (this.view.split !== null) this.view.split = Number(byId("split").value) / 100;
      this.view.cursor = this.cursor;
      this.view.draw();
      byId("zoom").textContent = `${ct.short(this.view.zoom * 100)} %`;
    }

    zoom(factor, x, y) {
      if (x === undefined && this.cursor) this.view.zoomAt(factor, this.cursor);
      else this.view.zoomBy(factor, x, y);
      this.redraw();
    }

    // Look at a pixel; `lock` keeps it when the mouse moves on.
    look(pixel, lock) {
      this.cursor = pixel; if (lock) this.locked = true;
      ct.inspect(byId("inspector"), this.scene, pixel);
      const at = this.scene.listed.findIndex(({ row, col }) => row === pixel.row && col === pixel.col);
      const { beyond, listed } = this.scene;
      const kept = beyond === null ? "" : `${ct.count(listed.length)} with exact values; pixels that are not equal in every renderer: ${ct.count(beyond)}`;
      byId("listed").textContent = at >= 0 ? `pixel ${at + 1} of ${kept}` : kept;
      if (lock) ct.remember({ pixel: `${pixel.row},${pixel.col}` });
      byId("hint").textContent = this.locked ? "kept; a click on it follows the mouse again" : "follows the mouse; a click keeps a pixel";
      this.redraw();
    }

    // Go to the next pixel with exact values.
    step(by) {
      const { listed } = this.scene;
      if (!listed.length) return;
      const at = listed.findIndex(({ row, col }) => this.cursor && row === this.cursor.row && col === this.cursor.col);
      const next = at < 0 ? (by > 0 ? 0 : listed.length - 1) : (at + by + listed.length) % listed.length;
      this.view.reveal(listed[next]);
      this.look(listed[next], true);
    }

    hold(peek) {
      if (this.peek === peek || !this.scene) return;
      this.peek = peek;
      this.arrange();
      this.redraw();
    }
  }

  ct.Viewer = Viewer;
}

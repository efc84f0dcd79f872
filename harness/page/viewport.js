"use strict";
// One canvas for all images: every pane shows the same part of the scene at the same size.
{
  const LEAST_ZOOM = 0.1, MOST_ZOOM = 64, LETTERS_FROM = 18;

  // Hatching by class: lines at an angle of its own, 0 … 5 as in ct.constants.classes.
  const hatches = [null, [1, 0], [0, 1], [1, 1], [1, -1], [1, 1, 1, -1]];
  const hatch = (context, kind) => {
    const tile = ct.el("canvas", { width: 8, height: 8 });
    const pen = tile.getContext("2d");
    pen.strokeStyle = "rgba(0,0,0,.75)";
    pen.lineWidth = 1.4;
    pen.beginPath();
    const lines = hatches[kind] || [];
    for (let i = 0; i < lines.length; i += 2) {
      const [dx, dy] = [lines[i], lines[i + 1]];
      for (const shift of [-8, 0, 8]) {
        if (dx && dy) { pen.moveTo(-8 + shift, dy > 0 ? -8 : 16); pen.lineTo(16 + shift, dy > 0 ? 16 : -8); }
        else if (dx) { pen.moveTo(0, 4); pen.lineTo(8, 4); } else { pen.moveTo(4, 0); pen.lineTo(4, 8); }
      }
    }
    pen.stroke();
    return context.createPattern(tile, "repeat");
  };

  ct.Viewport = class {
    constructor(canvas) {
      this.canvas = canvas;
      this.context = canvas.getContext("2d");
      this.scratch = ct.el("canvas");
      // Scale in CSS pixels a pixel; x, y is what stands in the middle of a pane.
      this.zoom = 1; this.x = 0; this.y = 0;
      this.scene = null; this.panes = []; this.split = null; this.cursor = null;
    }

    resize() {
      const ratio = devicePixelRatio || 1;
      const { width, height } = this.canvas.getBoundingClientRect();
      this.canvas.width = Math.max(1, Math.round(width * ratio));
      this.canvas.height = Math.max(1, Math.round(height * ratio));
      this.ratio = ratio; this.width = width; this.height = height;
    }

    fit() {
      this.resize();
      const { width, height } = this.rectangle(0);
      const { rows, columns } = this.scene;
      this.zoom = Math.max(LEAST_ZOOM, Math.min(width / columns, height / rows));
      if (this.zoom > 1) this.zoom = Math.floor(this.zoom * 4) / 4;
      this.x = columns / 2; this.y = rows / 2;
    }

    // Where pane i is on the canvas, in CSS pixels. The slider's two lie on each other.
    rectangle(i) {
      const n = this.split === null ? Math.max(1, this.panes.length) : 1;
      const across = n < 2 ? 1 : 2, down = Math.ceil(n / across);
      const width = this.width / across, height = this.height / down;
      const at = this.split === null ? i : 0;
      return { left: (at % across) * width, top: Math.floor(at / across) * height, width, height };
    }

    paneAt(px, py) {
      const count = this.split === null ? Math.max(1, this.panes.length) : 1;
      for (let i = 0; i < count; i += 1) {
        const r = this.rectangle(i);
        if (px >= r.left && px < r.left + r.width && py >= r.top && py < r.top + r.height) return r;
      }
      return this.rectangle(0);
    }

    // From the canvas to the scene, whichever pane it is.
    pixelAt(px, py) {
      const r = this.paneAt(px, py);
      const col = Math.floor(this.x + (px - r.left - r.width / 2) / this.zoom);
      const row = Math.floor(this.y + (py - r.top - r.height / 2) / this.zoom);
      const inside = row >= 0 && col >= 0 && row < this.scene.rows && col < this.scene.columns;
      return inside ? { row, col } : null;
    }

    zoomBy(factor, px = this.width / 2, py = this.height / 2) {
      const r = this.paneAt(px, py);
      const dx = px - r.left - r.width / 2, dy = py - r.top - r.height / 2;
      const zoom = Math.min(MOST_ZOOM, Math.max(LEAST_ZOOM, this.zoom * factor));
      this.x += dx / this.zoom - dx / zoom;
      this.y += dy / this.zoom - dy / zoom;
      this.zoom = zoom;
    }

    // Zoom so that a pixel stays where it is, after it was brought into view.
    zoomAt(factor, { row, col }) {
      this.reveal({ row, col });
      const r = this.rectangle(0);
      this.zoomBy(factor, r.left + r.width / 2 + (col + 0.5 - this.x) * this.zoom,
        r.top + r.height / 2 + (row + 0.5 - this.y) * this.zoom);
      this.reveal({ row, col });
    }

    panBy(dx, dy) {
      this.x = Math.min(Math.max(this.x - dx / this.zoom, 0), this.scene.columns);
      this.y = Math.min(Math.max(this.y - dy / this.zoom, 0), this.scene.rows);
    }

    // Move so far that a pixel is in the panes.
    reveal({ row, col }) {
      const r = this.rectangle(0);
      const halfWidth = Math.max(0, r.width / 2 / this.zoom - 2), halfHeight = Math.max(0, r.height / 2 / this.zoom - 2);
      this.x = Math.min(Math.max(this.x, col + 0.5 - halfWidth), col + 0.5 + halfWidth);
      this.y = Math.min(Math.max(this.y, row + 0.5 - halfHeight), row + 0.5 + halfHeight);
    }

    draw() {
      const context = this.context;
      context.setTransform(1, 0, 0, 1, 0, 0);
      context.fillStyle = "#101114";
      context.fillRect(0, 0, this.canvas.width, this.canvas.height);
      context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
      this.panes.forEach((pane, i) => this.drawPane(pane, this.clipOf(i), this.rectangle(i)));
      this.panes.forEach((pane, i) => this.label(pane.label, this.clipOf(i), this.split !== null && i === 1));
      if (this.split !== null) {
        const x = this.split * this.width;
        context.fillStyle = "#fff"; context.fillRect(x - 1, 0, 2, this.height);
        context.fillStyle = "#000"; context.fillRect(x - 2, 0, 1, this.height); context.fillRect(x + 1, 0, 1, this.height);
      }
    }

    clipOf(i) {
      const r = this.rectangle(i);
      if (this.split === null) return r;
      const at = this.split * r.width;
      return i === 0 ? { ...r, width: at } : { ...r, left: r.left + at, width: r.width - at };
    }

    drawPane(pane, clip, r) {
      const context = this.context;
      context.save();
      context.beginPath(); context.rect(clip.left, clip.top, clip.width, clip.height); context.clip();
      const left = r.left + r.width / 2 - this.x * this.zoom, top = r.top + r.height / 2 - this.y * this.zoom;
      const place = [left, top, this.scene.columns * this.zoom, this.scene.rows * this.zoom];
      if (pane.image) {
        context.imageSmoothingEnabled = this.zoom * this.ratio < 1;
        context.drawImage(pane.image, ...place);
        if (pane.letters && this.zoom >= LETTERS_FROM) this.drawLetters(pane.letters, r, left, top);
        else for (const mask of pane.masks || []) this.drawHatch(mask, place);
      } else {
        context.fillStyle = "#aaa"; context.font = "13px system-ui, sans-serif"; context.textAlign = "center";
        context.fillText(pane.nothing || "no image", clip.left + clip.width / 2, clip.top + clip.height / 2);
      }
      if (this.cursor) {
        const { row, col } = this.cursor;
        const size = Math.max(this.zoom, 5), x = left + (col + 0.5) * this.zoom, y = top + (row + 0.5) * this.zoom;
        for (const [color, grow] of [["#000", 2], ["#fff", 1]]) {
          context.strokeStyle = color; context.lineWidth = 1;
          context.strokeRect(x - size / 2 - grow, y - size / 2 - grow, size + 2 * grow, size + 2 * grow);
        }
      }
      context.restore();
      context.strokeStyle = "#3a3d44"; context.lineWidth = 1; context.strokeRect(r.left, r.top, r.width, r.height);
    }

    drawHatch({ kind, canvas }, place) {
      this.scratch.width = this.canvas.width; this.scratch.height = this.canvas.height;
      const pen = this.scratch.getContext("2d");
      pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
      pen.imageSmoothingEnabled = false;
      pen.drawImage(canvas, ...place);
      pen.globalCompositeOperation = "source-in";
      pen.fillStyle = hatch(pen, kind);
      pen.fillRect(0, 0, this.width, this.height);
      this.context.drawImage(this.scratch, 0, 0, this.width, this.height);
    }

    drawLetters(classes, r, left, top) {
      const context = this.context, { rows, columns } = this.scene;
      context.font = `600 ${Math.min(20, this.zoom * 0.6)}px system-ui, sans-serif`;
      context.textAlign = "center"; context.textBaseline = "middle";
      context.lineWidth = 3; context.strokeStyle = "#000"; context.fillStyle = "#fff";
      const first = { row: Math.max(0, Math.floor((r.top - top) / this.zoom)), col: Math.max(0, Math.floor((r.left - left) / this.zoom)) };
      const last = { row: Math.min(rows, first.row + r.height / this.zoom + 2), col: Math.min(columns, first.col + r.width / this.zoom + 2) };
      for (let row = first.row; row < last.row; row += 1) {
        for (let col = first.col; col < last.col; col += 1) {
          const letter = ct.constants.letters[classes[row * columns + col]];
          if (!letter) continue;
          const x = left + (col + 0.5) * this.zoom, y = top + (row + 0.5) * this.zoom;
          context.strokeText(letter, x, y); context.fillText(letter, x, y);
        }
      }
      context.textBaseline = "alphabetic";
    }

    label(text, clip, right) {
      const context = this.context;
      context.font = "600 12px system-ui, sans-serif";
      const width = context.measureText(text).width + 12;
      if (clip.width < 24) return;
      context.save();
      context.beginPath(); context.rect(clip.left, clip.top, clip.width, clip.height); context.clip();
      const x = right ? clip.left + clip.width - width - 6 : clip.left + 6;
      context.fillStyle = "rgba(0,0,0,.72)"; context.fillRect(x, clip.top + 6, width, 20);
      context.fillStyle = "#fff"; context.textAlign = "left"; context.fillText(text, x + 6, clip.top + 20);
      context.restore();
    }
  };
}

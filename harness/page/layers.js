"use strict";
// What can be shown of a lane: each layer colours arrays of a scene into an image of its size. The
// scales are fixed; only exposure and gain are the viewer's, and they are written beside it.
{
  const c = ct.constants;
  const ramp = (share) => c.ramp[Math.round(Math.min(Math.max(share, 0), 1) * (c.ramp.length - 1))];

  // The middle of a step of a logarithmic map.
  const magnitude = (step, least) => 10 ** (least + (step - 0.5) / c.steps);

  // A byte of the map of differences as a signed number; 0 for none.
  ct.signed = (code) => {
    if (code === 0) return 0;
    if (code === c.undefined) return NaN;
    return code > c.most ? -magnitude(code - c.most, c.leastDifference) : magnitude(code, c.leastDifference);
  };
  ct.unlikeness = (code) => (code === 0 ? 0 : magnitude(code, c.leastUnlike));

  // Blue below, white at 0, orange above: told apart without colour vision.
  const diverging = (share) => {
    const [far, t] = share < 0 ? [[33, 82, 160], -share] : [[190, 86, 0], share];
    const s = Math.min(t, 1);
    return far.map((value) => Math.round(245 + (value - 245) * s));
  };

  // Layers: a name, whether gain matters, a table of colours by the byte of a map, and the legend.
  const decades = (low, high) => Array.from({ length: high - low + 1 }, (_, i) => low + i);
  const logShare = (value, low, high) => (Math.log10(value) - low) / (high - low);
  const byCode = (color) => Array.from({ length: 256 }, (_, code) => color(code));
  const orUndefined = (value, color) => (Number.isNaN(value) ? c.undefinedColor : color(value));

  ct.layers = {
    picture: { label: "picture", exposure: true },
    difference: {
      label: "difference, log scale", map: "difference",
      table: () => byCode((code) => orUndefined(ct.signed(code),
        (v) => (v === 0 ? [0, 0, 0] : ramp(logShare(Math.abs(v), -9, 0))))),
      legend: () => [["0", [0, 0, 0]], ...decades(-9, 0).map((d) => [d ? `1e${d}` : "1", ramp((d + 9) / 9)])],
    },
    absolute: {
      label: "|difference| × gain", map: "difference", gain: true,
      table: (gain) => byCode((code) => orUndefined(ct.signed(code),
        (v) => (v === 0 ? [0, 0, 0] : ramp(Math.abs(v) * gain)))),
      legend: (gain) => [["0", [0, 0, 0]], ...[0, 0.25, 0.5, 0.75, 1].map((s) => [s ? ct.short(s / gain) : "> 0", ramp(s)])],
    },
    signed: {
      label: "signed difference × gain", map: "difference", gain: true,
      table: (gain) => byCode((code) => orUndefined(ct.signed(code), (v) => diverging(v * gain))),
      legend: (gain) => [-1, -0.5, 0, 0.5, 1].map((s) => [`${s > 0 ? "+" : ""}${ct.short(s / gain)}`, diverging(s)]),
    },
    classes: {
      label: "classes of pixels", map: "classes", overlay: true,
      table: () => byCode((code) => c.classColors[code] || c.undefinedColor),
      legend: () => c.classes.map((name, i) => [c.letters[i] ? `${c.letters[i]} ${name}` : name, c.classColors[i], i]),
    },
    unlike: {
      label: "SSIM map", map: "unlike",
      table: () => byCode((code) => (code === 0 ? [0, 0, 0] : ramp(logShare(ct.unlikeness(code), -6, 0)))),
      legend: () => [["1", [0, 0, 0]], ["0.999999", ramp(0)], ["0.9999", ramp(2 / 6)], ["0.99", ramp(4 / 6)],
        ["0.9", ramp(5 / 6)], ["≤ 0", ramp(1)]],
    },
    digits: {
      label: "significant digits", map: "digits",
      table: () => byCode((code) => (code === c.undefined ? c.undefinedColor
        : code >= c.allDigits ? [0, 0, 0] : ramp(1 - code / c.allDigits))),
      legend: () => [0, 2, 4, 6, 8, 10, 12, 14, 16].map((d) => [String(d), ramp(1 - d / c.allDigits)])
        .concat([["all", [0, 0, 0]]]),
    },
  };

  // Draw a layer of a lane on a canvas of the scene's size; null where there is nothing to show.
  ct.drawLayer = (scene, lane, name, { gain, exposure }) => {
    const layer = ct.layers[name];
    const source = layer.map ? lane[layer.map] : lane.levels;
    if (!source) return null;
    const canvas = ct.el("canvas", { width: scene.columns, height: scene.rows });
    const context = canvas.getContext("2d");
    const image = context.createImageData(scene.columns, scene.rows);
    const data = image.data;
    const table = layer.map && layer.table(gain);
    const factor = 2 ** exposure;
    for (let i = 0, to = 0; i < scene.rows * scene.columns; i += 1, to += 4) {
      if (!table) {
        for (let k = 0; k < 3; k += 1) data[to + k] = Math.min(255, source[i * 3 + k] * factor);
      } else if (layer.overlay && source[i] === 0) {
        // Pixels of class equal show the picture itself, dimmed.
        for (let k = 0; k < 3; k += 1) data[to + k] = lane.levels ? lane.levels[i * 3 + k] * 0.35 : 26;
      } else {
        [data[to], data[to + 1], data[to + 2]] = table[source[i]];
      }
      data[to + 3] = 255;
    }
    context.putImageData(image, 0, 0);
    return canvas;
  };

  // Masks of the classes, for the hatching that says the same as the colours.
  ct.masks = (scene, lane) => {
    if (!lane.classes) return [];
    const found = [...new Set(lane.classes)].filter((kind) => kind > 0);
    return found.map((kind) => {
      const canvas = ct.el("canvas", { width: scene.columns, height: scene.rows });
      const context = canvas.getContext("2d");
      const image = context.createImageData(scene.columns, scene.rows);
      lane.classes.forEach((value, i) => { if (value === kind) image.data[i * 4 + 3] = 255; });
      context.putImageData(image, 0, 0);
      return { kind, canvas };
    });
  };
}

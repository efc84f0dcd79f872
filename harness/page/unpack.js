"use strict";
// From what stands in the page to arrays: exact, and only when a scene is looked at.
ct.bytesOf = (text) => Uint8Array.from(atob(text), (character) => character.charCodeAt(0));

ct.inflate = async (text) => {
  const stream = new Blob([ct.bytesOf(text)]).stream();
  const plain = stream.pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(plain).arrayBuffer());
};

// The levels of a PNG in a data URI, three bytes a pixel, with no colour management in between.
ct.levels = async (uri, columns, rows) => {
  const blob = new Blob([ct.bytesOf(uri.slice(uri.indexOf(",") + 1))], { type: "image/png" });
  const picture = await createImageBitmap(blob,
    { colorSpaceConversion: "none", premultiplyAlpha: "none" });
  const canvas = ct.el("canvas", { width: columns, height: rows });
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(picture, 0, 0);
  const four = context.getImageData(0, 0, columns, rows).data;
  const three = new Uint8Array(columns * rows * 3);
  for (let from = 0, to = 0; from < four.length; from += 4) {
    three[to++] = four[from]; three[to++] = four[from + 1]; three[to++] = four[from + 2];
  }
  return three;
};

ct.sceneData = (index) => JSON.parse(ct.byId(`data-${index}`).textContent);

// A scene whole: `lanes` with 8-bit `levels`, `classes` and maps against the first, `objects`
// (−1: none), `pixels` by row * columns + column. What the page does not hold is null.
ct.unpack = async (index) => {
  const packed = ct.sceneData(index);
  const { rows, columns } = packed;
  const size = rows * columns;
  const picture = ct.byId(`picture-${index}`);
  const base = picture && packed.base ? await ct.levels(picture.src, columns, rows) : null;
  const lanes = await Promise.all(packed.lanes.map(async (lane) => {
    const delta = lane.delta && base ? await ct.inflate(lane.delta) : null;
    const maps = packed.maps[lane.name] || {};
    const [difference, digits, unlike, classes] = await Promise.all(
      [maps.difference, maps.digits, maps.unlike, lane.classes].map((text) => text && ct.inflate(text)));
    return {
      name: lane.name, levels: delta && delta.map((value, i) => value + base[i]),
      difference, digits, unlike, classes: classes || (delta && packed.objects && new Uint8Array(size)),
      tolerance: packed.tolerances[lane.name],
      ledger: packed.ledger[lane.name],
    };
  }));
  const exact = packed.pixels ? JSON.parse(new TextDecoder().decode(await ct.inflate(packed.pixels)))
    : { pixels: [], beyond: null };
  const pixels = new Map(exact.pixels.map((pixel) => [pixel.row * columns + pixel.col, pixel]));
  return {
    index, name: packed.name, rows, columns, lanes, pixels, listed: exact.pixels,
    beyond: exact.beyond, command: packed.command, objects: await ct.objects(packed.objects, size),
  };
};

ct.objects = async (packed, size) => {
  if (!packed) return null;
  const bytes = await ct.inflate(packed.map);
  const objects = new Int32Array(size);
  for (let i = 0; i < size; i += 1) {
    let value = 0;
    for (let k = packed.bytes - 1; k >= 0; k -= 1) value = value * 256 + bytes[i * packed.bytes + k];
    objects[i] = value - 1;
  }
  return objects;
};

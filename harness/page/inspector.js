"use strict";
// One pixel in numbers: what every renderer made of it, what is possible, why it is classed so, and
// the rays of the reference. Exact values are there for the listed pixels; others have their levels
// and the step of their difference.
{
  const { el, short } = ct;
  const REASONS = {
    equal: () => "lies in the enclosure, give or take what this renderer cannot hold",
    rounding: () => "an honest renderer of this arithmetic may return it",
    undecidable: () => "is one of the possible values where real arithmetic leaves the pixel open",
    model: (lane) => {
      const habits = lane.ledger.filter((entry) => entry.readings.length);
      const words = [...new Set(habits.map((entry) => entry.situation))];
      return `fits under the habits that it declares${words.length ? `: ${words.join("; ")}` : ""}`;
    },
    suspect: () => "no sample of such arithmetic returns it, but there is no proof that none can",
    wrong: () => "is impossible under the specification and under the declared habits",
  };
  const OPEN = {
    edge: "a decision is open", precision: "a quantity is too wide", budget: "too many outcomes",
  };
  const DECISIONS = {
    nearest: "nearest hit", shadow: "shadow", side: "side", total_reflection: "total reflection",
    gate: "sign of n·l", precision: "precision", none: "",
  };

  const LEFT = new Set(["class", "hits", "margin of the nearest decision"]);
  const cell = (text, attributes = {}) => el("td", attributes, text);
  const table = (heads, rows, attributes = {}) => el("div", { class: "wide", tabindex: 0 },
    el("table", attributes, el("thead", {}, el("tr", {}, heads.map((head) => el("th", { class: LEFT.has(head) ? "text" : "" }, head)))),
      el("tbody", {}, rows)));

  const chip = (name) => {
    const i = ct.constants.classes.indexOf(name);
    return el("span", { class: `chip hatch${i}`, style: `background-color:${ct.css(ct.constants.classColors[i])}` },
      ct.constants.letters[i]);
  };

  // What a row of the table of lanes says of a pixel without exact values.
  const about = (lane, at, isFirst) => {
    if (isFirst) return "";
    if (!lane.difference) return "–";
    const value = ct.signed(lane.difference[at]);
    if (Number.isNaN(value)) return "not a number";
    return value === 0 ? "0" : `${value > 0 ? "+" : "−"}~${short(Math.abs(value), 1)}`;
  };

  const greatest = (value, first) => {
    // What is not a number is null in a record.
    if ([...value, ...first].includes(null)) return "not a number";
    const off = value.map((channel, k) => channel - first[k]);
    return short(off.reduce((most, channel) => (Math.abs(channel) > Math.abs(most) ? channel : most), 0));
  };

  const lanes = (scene, at, exact) => {
    const rows = scene.lanes.map((lane, i) => {
      const levels = lane.levels ? [0, 1, 2].map((k) => lane.levels[at * 3 + k]) : null;
      const name = lane.classes ? ct.constants.classes[lane.classes[at]] : null;
      const known = exact && exact.lanes[lane.name];
      const first = exact && exact.lanes[scene.lanes[0].name];
      const off = known && first && i > 0 ? greatest(known.value, first.value) : about(lane, at, i === 0);
      return el("tr", { "data-lane": lane.name }, el("th", {}, lane.name),
        cell(levels ? levels.join(" ") : "–", { class: "levels" }),
        cell(off, { class: "off" }),
        el("td", { class: "text" }, name ? [chip(name), ` ${name}`] : "–"));
    });
    const first = scene.lanes[0] ? scene.lanes[0].name : "";
    return table(["", "8 bits", `− ${first}`, "class"], rows);
  };

  const values = (scene, exact) => {
    const rows = scene.lanes.filter((lane) => exact.lanes[lane.name]).map((lane) => {
      const { value } = exact.lanes[lane.name];
      return el("tr", { "data-value": lane.name }, el("th", {}, lane.name), value.map((channel) => cell(channel === null ? "not a number" : String(channel))));
    });
    const known = exact.enclosure;
    const bounds = (name, lo, hi) => [["least", lo], ["greatest", hi]].map(([word, bound]) => el("tr", { class: "bound" },
      el("th", {}, `${name}${word}`), bound.map((channel) => cell(channel === null ? "–" : String(channel)))));
    rows.push(...(known.alternatives.length
      ? known.alternatives.slice(0, 4).flatMap(({ lo, hi }, i) => bounds(`${i + 1}: `, lo, hi))
      : bounds("truth: ", known.lo, known.hi)));
    return table(["exact, linear", "red", "green", "blue"], rows, { class: "exact mono" });
  };

  const truth = ({ enclosure: known }) => {
    if (known.class === "certified") {
      const width = Math.max(...known.hi.map((hi, k) => hi - known.lo[k]));
      return `Certified to a width of ${short(width, 2)} in ${known.arithmetic} intervals.`;
    }
    const object = known.object >= 0 ? ` about object ${known.object}` : "";
    return `Undecidable in ${known.arithmetic}: ${OPEN[known.class]}; first ${DECISIONS[known.decision]}${object} at depth ${known.depth}.`;
  };

  const why = (scene, at, exact) => scene.lanes.flatMap((lane) => {
    const name = lane.classes && ct.constants.classes[lane.classes[at]];
    if (!name || name === "equal") return [];
    const off = exact && exact.lanes[lane.name] ? exact.lanes[lane.name].off : null;
    const by = off === null ? "" : ` It is off by ${short(off, 2)}; up to ${short(lane.tolerance, 2)} counts as equal.`;
    return [el("p", {}, chip(name), el("b", {}, ` ${lane.name}`), ` ${REASONS[name](lane)}.${by}`)];
  });

  const tree = (exact) => {
    const { n_rays: count, rays } = exact.tree;
    const rows = rays.map((ray) => {
      const shadow = ray.kind === "shadow";
      const depth = ray.depth + (shadow ? 1 : 0);
      const hit = shadow ? (ray.object < 0 ? "clear" : `behind ${ray.object}`)
        : ray.object < 0 ? "nothing" : `${ray.object}${ray.inside ? " inside" : ""}`;
      const adds = shadow && ray.object >= 0 ? "" : ray.adds.map((v) => short(v, 3)).join(" ");
      const about = `${DECISIONS[ray.margin_decision]}${ray.margin_object >= 0 ? ` ${ray.margin_object}` : ""}`;
      return el("tr", { class: shadow ? "soft" : "" },
        el("th", { style: `padding-left:${0.3 + 0.8 * Math.min(depth, 6)}em` },
          shadow ? `light ${ray.light}` : ray.kind.replace("_", " ")),
        cell(short(ray.weight)), cell(hit, { class: "text" }), cell(ray.t_world === null ? "" : short(ray.t_world, 5)),
        cell(shadow && adds ? `(${adds})` : adds, { class: "mono" }),
        cell(ray.margin === null ? "" : `${short(ray.margin, 2)} ${about}`, { class: "text" }));
    });
    const left = count - rays.length;
    return [el("h4", {}, `Ray tree of the reference: ${count} ${count === 1 ? "ray" : "rays"}`),
      table(["ray", "weight", "hits", "at distance", "adds to the pixel", "margin of the nearest decision"], rows, { class: "tree" }),
      left > 0 ? el("p", { class: "soft" }, `${left} more rays are not in this page; the line above lists them.`) : null];
  };

  // Fill the inspector's element for a pixel {row, col}.
  ct.inspect = (target, scene, { row, col }) => {
    const at = row * scene.columns + col;
    const exact = scene.pixels.get(at) || null;
    const object = scene.objects ? scene.objects[at] : null;
    const { start, end } = scene.command;
    target.replaceChildren(...[
      el("h3", { "data-row": row, "data-col": col }, `Row ${row}, column ${col}`,
        el("span", { class: "soft" }, object === null ? "" : object < 0 ? "shows the background" : `shows object ${object}`)),
      lanes(scene, at, exact),
      ...why(scene, at, exact),
      ...(exact ? [values(scene, exact), el("p", { class: "soft" }, truth(exact))]
        : [el("p", { class: "soft" }, `Exact values of this pixel are not in this page (it holds those of ${ct.count(scene.pixels.size)} pixels); this line gives them:`)]),
      ct.line(`${start} ${row} ${col}${end ? ` ${end}` : ""}`, "command that explains this pixel"),
      ...(exact && exact.tree ? tree(exact)
        : exact ? [el("p", { class: "soft" }, "The ray tree of this pixel is not in this page; the line above shows it.")] : []),
    ].filter((child) => child !== null));
  };
}

"use strict";
// What a tolerance would let pass. The counts are exact: the slider stops at the edges by which the
// record counts. A verdict can only get better with a tolerance, so what passes here passes then.
{
  const c = ct.constants;
  const { byId, el } = ct;
  const { scenes } = c;

  const beyond = (spread, tolerance) => Object.entries(spread.counts)
    .reduce((sum, [edge, count]) => sum + (Number(edge) > tolerance ? count : 0), spread.beyond);

  // Of one lane: pixels beyond the tolerance of each class, and whether they would pass.
  const judged = (scene, lane, tolerance) => {
    const spreads = scene.excess[lane];
    const left = Object.fromEntries(Object.entries(spreads).map(([name, spread]) => [name, beyond(spread, tolerance)]));
    const wrong = left.wrong || 0, suspect = left.suspect || 0;
    const most = Math.max(c.suspectPixels, Math.floor(c.suspectShare * scene.pixels));
    // A pixel that is open in real arithmetic may become undecidable, so that all of them count.
    const open = tolerance ? scene.open : scene.undecidable[lane] || 0;
    return {
      total: Object.values(left).reduce((sum, count) => sum + count, 0), unexplained: wrong + suspect,
      passes: wrong === 0 && suspect <= most && open <= c.undecidableShare * scene.pixels,
    };
  };

  const show = () => {
    const slider = byId("tolerance");
    const at = Number(slider.value);
    const tolerance = at < 0 ? 0 : c.edges[at];
    const text = at < 0 ? "0" : c.edgeTexts[at];
    byId("tolerance-value").textContent = text;
    slider.setAttribute("aria-valuetext", text);
    let passing = 0, equal = 0;
    const rows = scenes.map((scene) => {
      const lanes = c.lanes.map((lane) => (scene.excess[lane] && scene.undecidable[lane] !== null ? judged(scene, lane, tolerance) : null));
      const whole = scene.group !== "incomplete" && lanes.every((lane) => lane !== null);
      // No tolerance mends a reference whose own enclosures contradict it.
      const passes = whole && !scene.violations && lanes.every((lane) => lane.passes);
      const same = whole && lanes.every((lane) => lane.total === 0);
      passing += passes; equal += passes && same;
      const word = !whole ? "incomplete" : !passes ? "fails" : scene.group === "expected" ? "no longer as expected"
        : same ? "equal everywhere" : "passes";
      return el("tr", { "data-name": scene.name }, el("th", {}, scene.name),
        lanes.map((lane) => el("td", { class: lane && lane.unexplained ? "bad" : "" },
          lane === null ? "–" : `${ct.count(lane.total)}${lane.unexplained ? ` (${ct.count(lane.unexplained)})` : ""}`)),
        el("td", { class: `text${word === "passes" || word === "equal everywhere" ? "" : " bad"}` }, word));
    });
    byId("would").textContent = `${passing} of ${scenes.length} scenes would pass, ${equal} of them equal everywhere`;
    byId("play-rows").replaceChildren(...rows);
    const total = c.tolerance + tolerance;
    const line = total ? ` --tolerance ${at < 0 || c.tolerance ? total : text}` : "";
    const pytest = total ? ` --crosstrace-tolerance=${at < 0 || c.tolerance ? total : text}` : "";
    byId("play-lines").replaceChildren(
      ct.line(`crosstrace run SCENE…${line}`, "command with this tolerance"),
      ct.line(`pytest --crosstrace scenes/${pytest}`, "the same for pytest"));
  };

  ct.playground = () => {
    if (!byId("tolerance")) return;
    const kept = c.edgeTexts.indexOf(ct.state().tolerance);
    byId("tolerance").max = String(c.edges.length - 1);
    byId("tolerance").value = String(kept);
    byId("tolerance").addEventListener("input", () => {
      const at = Number(byId("tolerance").value);
      ct.remember({ tolerance: at < 0 ? "" : c.edgeTexts[at] });
      show();
    });
    show();
  };
}

"use strict";
// The first screen: scenes filtered by how they came out and by words, and which one is open. All of
// it stands in the address, so that a reload, a bookmark and the back button keep it.
{
  const { byId } = ct;
  const rows = [...document.querySelectorAll("[data-row-of]")];
  const sections = [...document.querySelectorAll("section.scene")];
  let viewer = null;

  const filter = () => {
    const { show = "all", find = "" } = ct.state();
    const words = find.toLowerCase().split(/\s+/).filter(Boolean);
    let seen = 0;
    for (const row of rows) {
      const fits = (show === "all" || row.dataset.group === show)
        && words.every((word) => row.dataset.words.toLowerCase().includes(word));
      row.hidden = !fits;
      seen += fits;
    }
    for (const button of document.querySelectorAll("[data-show]")) button.setAttribute("aria-pressed", String(button.dataset.show === show));
    if (byId("find") && byId("find").value !== find) byId("find").value = find;
    if (byId("shown")) byId("shown").textContent = seen === rows.length ? "" : `${seen} of ${rows.length} scenes shown`;
  };

  // Show one scene, or the overview where none is named.
  const open = () => {
    const { scene } = ct.state();
    const section = sections.find((one) => one.dataset.name === scene) || null;
    document.body.dataset.view = section ? "scene" : "overview";
    for (const one of sections) one.hidden = one !== section;
    byId("overview").hidden = section !== null;
    if (!section) { if (viewer) viewer.root.hidden = true; return; }
    viewer = viewer || new ct.Viewer();
    ct.viewer = viewer;
    const index = Number(section.dataset.index);
    if (viewer.wanted !== index || viewer.root.hidden) viewer.show(index, section.querySelector(".viewer-slot"));
  };

  const go = (name) => {
    ct.remember({ scene: name, pixel: "" }, true);
  };

  const neighbour = (by) => {
    const names = rows.filter((row) => !row.hidden).map((row) => row.dataset.rowOf);
    const at = names.indexOf(ct.state().scene);
    if (names.length) go(names[(at + by + names.length) % names.length]);
  };

  let before = ct.state().scene;
  const refresh = () => {
    filter();
    open();
    const { scene } = ct.state();
    if (scene !== before) {
      scrollTo(0, 0);
      // Who navigates by keys goes on from the new view's heading.
      const heading = scene ? document.querySelector("section.scene:not([hidden]) h2") : byId("overview-title");
      if (heading) heading.focus({ preventScroll: true });
    }
    before = scene;
  };

  document.addEventListener("click", (event) => {
    const target = event.target.closest("[data-show], [data-open], [data-step]");
    if (!target) return;
    if (target.dataset.show) { ct.remember({ show: target.dataset.show === "all" ? "" : target.dataset.show }); filter(); }
    if (target.dataset.open !== undefined) { event.preventDefault(); go(target.dataset.open); }
    if (target.dataset.step) neighbour(Number(target.dataset.step));
  });
  if (byId("find")) byId("find").addEventListener("input", () => { ct.remember({ find: byId("find").value }); filter(); });
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches("input:not([type=range]), select, textarea")) return;
    if (event.key === "Escape" && ct.state().scene) go("");
    if (event.key === "]") neighbour(1);
    if (event.key === "[") neighbour(-1);
  });
  addEventListener("hashchange", refresh);
  // Printed, every scene is there.
  addEventListener("beforeprint", () => { for (const one of sections) one.hidden = false; byId("overview").hidden = false; });
  addEventListener("afterprint", open);
  document.documentElement.classList.add("script");
  ct.playground();
  refresh();
  document.body.dataset.ready = "yes";
}

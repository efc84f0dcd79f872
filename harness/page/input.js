"use strict";
// What the mouse, a finger and the keys do to a viewer.
{
  const { byId } = ct;

  ct.pointer = (viewer) => {
    let from = null;
    const place = (event) => {
      const box = viewer.canvas.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    const nearSplit = (x) => viewer.view.split !== null && Math.abs(x - viewer.view.split * viewer.view.width) < 8;
    viewer.canvas.addEventListener("pointerdown", (event) => {
      const [x, y] = place(event);
      viewer.canvas.setPointerCapture(event.pointerId);
      from = { x, y, moved: false, split: nearSplit(x) };
    });
    viewer.canvas.addEventListener("pointermove", (event) => {
      if (!viewer.scene) return;
      const [x, y] = place(event);
      if (from) {
        if (Math.hypot(x - from.x, y - from.y) > 3) from.moved = true;
        if (!from.moved) return;
        if (from.split) byId("split").value = String(Math.min(100, Math.max(0, x / viewer.view.width * 100)));
        else viewer.view.panBy(x - from.x, y - from.y);
        Object.assign(from, { x, y });
        viewer.redraw();
        return;
      }
      viewer.canvas.style.cursor = nearSplit(x) ? "ew-resize" : "crosshair";
      const pixel = viewer.view.pixelAt(x, y);
      const { cursor } = viewer;
      const same = pixel && cursor && pixel.row === cursor.row && pixel.col === cursor.col;
      if (pixel && !viewer.locked && !same) viewer.look(pixel, false);
    });
    viewer.canvas.addEventListener("pointerup", (event) => {
      const [x, y] = place(event);
      const pixel = from && !from.moved && viewer.view.pixelAt(x, y);
      from = null;
      if (!pixel) return;
      const same = viewer.locked && viewer.cursor && pixel.row === viewer.cursor.row && pixel.col === viewer.cursor.col;
      viewer.locked = !same;
      viewer.look(pixel, !same);
    });
    viewer.canvas.addEventListener("wheel", (event) => {
      if (!viewer.scene) return;
      event.preventDefault();
      viewer.zoom(2 ** (-event.deltaY / 240), ...place(event));
    }, { passive: false });
  };

  ct.keys = (viewer) => {
    const typing = (target) => target.matches && target.matches("input:not([type=range]), select, textarea");
    document.addEventListener("keydown", (event) => {
      if (!viewer.scene || viewer.root.hidden || event.ctrlKey || event.metaKey || event.altKey || typing(event.target)) return;
      if (event.key === "Shift") { if (!event.repeat) viewer.hold(true); return; }
      // With Shift held the digits type other characters.
      const digit = /^Digit([1-9])$/.exec(event.code);
      if (digit && Number(digit[1]) <= viewer.scene.lanes.length) { viewer.set({ lane: Number(digit[1]) - 1 }); return; }
      const does = {
        "+": () => viewer.zoom(2), "=": () => viewer.zoom(2), "-": () => viewer.zoom(0.5),
        0: () => byId("fit").click(), n: () => viewer.step(1), p: () => viewer.step(-1),
      }[event.key];
      if (does) { does(); return; }
      const move = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] }[event.key];
      if (move && event.target === viewer.canvas && viewer.cursor) {
        event.preventDefault();
        const { rows, columns } = viewer.scene;
        const far = event.shiftKey ? 10 : 1;
        const pixel = {
          row: Math.min(rows - 1, Math.max(0, viewer.cursor.row + move[0] * far)),
          col: Math.min(columns - 1, Math.max(0, viewer.cursor.col + move[1] * far)),
        };
        viewer.view.reveal(pixel);
        viewer.look(pixel, true);
      }
    });
    document.addEventListener("keyup", (event) => { if (event.key === "Shift") viewer.hold(false); });
    addEventListener("blur", () => viewer.hold(false));
  };
}

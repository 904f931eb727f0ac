// Pointer, wheel, fingers and keys on the drawn path.

// One finger scrolls the page and shows the place that it touches, two move and zoom the part: `state.touchMoves` gives one
// finger to the part, too.
function listenToPointer(view) {
  const target = view.overlay, pointers = new Map();
  const place = (event) => {
    const box = target.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const show = (at) => {
    const i = view.pick(...at);
    if (i >= 0) view.actions.focus("s", view.run.s[i], view.run.index, i);
  };
  target.addEventListener("wheel", (event) => {
    event.preventDefault();
    const step = event.deltaMode === 1 ? event.deltaY * 16 : event.deltaY;
    view.state.camera.zoom(Math.exp(-0.0015 * step), ...place(event));
    view.actions.redraw();
  }, { passive: false });
  target.addEventListener("dblclick", () => view.actions.reset());
  target.addEventListener("pointerdown", (event) => {
    if (event.pointerType !== "touch" || view.state.touchMoves) target.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, place(event));
    if (event.pointerType === "touch") show(place(event));
  });
  for (const kind of ["pointerup", "pointercancel", "lostpointercapture"]) {
    target.addEventListener(kind, (event) => pointers.delete(event.pointerId));
  }
  target.addEventListener("pointerleave", (event) => {
    if (event.pointerType === "touch") pointers.delete(event.pointerId);
    else if (!pointers.size) view.actions.unfocus();
  });
  target.addEventListener("pointermove", (event) => {
    const now = place(event), before = pointers.get(event.pointerId);
    const other = [...pointers].find(([id]) => id !== event.pointerId);
    const finger = event.pointerType === "touch" && !view.state.touchMoves;
    if (!before || (finger && !other)) show(now);
    else moveCamera(view.state.camera, before, now, other && other[1], event);
    if (!before) return;
    pointers.set(event.pointerId, now);
    view.actions.redraw();
  });
}

// Where a second finger is down, `other`, both zoom and move; else one point is dragged.
function moveCamera(camera, before, now, other, event) {
  const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
  if (other) {
    const reach = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
    camera.pan(dx / 2, dy / 2);
    camera.zoom(reach(now) / Math.max(1, reach(before)), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
  } else if (camera.view === "3d" && !event.shiftKey && event.buttons !== 2) {
    camera.turn(dx * 0.008, dy * 0.008);
  } else {
    camera.pan(dx, dy);
  }
}

function listenToKeys(view) {
  const moves = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  view.overlay.addEventListener("keydown", (event) => {
    const camera = view.state.camera, move = moves[event.key];
    if (move && camera.view === "3d" && !event.shiftKey) camera.turn(-0.1 * move[0], -0.1 * move[1]);
    else if (move) camera.pan(40 * move[0], 40 * move[1]);
    else if (event.key === "+" || event.key === "=") camera.zoom(1.25, camera.width / 2, camera.height / 2);
    else if (event.key === "-") camera.zoom(0.8, camera.width / 2, camera.height / 2);
    else if (event.key === "0") camera.fit();
    else if (event.key === "Enter") view.actions.play();
    else return;
    event.preventDefault();
    event.stopPropagation();
    view.actions.redraw();
  });
}

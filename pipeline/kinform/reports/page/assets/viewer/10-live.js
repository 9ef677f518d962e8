// A page that is served while its design is worked on: it is loaded again when there is a newer one, and keeps its view.

const KEPT = "kinform view";

function remember(controls) {
  const { state, state: { camera, scene } } = controls;
  const finding = scene.findings[state.finding];
  sessionStorage.setItem(KEPT, JSON.stringify({
    name: scene.name,
    camera: { turn: camera.turn, rise: camera.rise, target: camera.target, distance: camera.distance, own: camera.own },
    layers: state.layers,
    hidden: [...state.hidden].map((k) => scene.parts[k].name),
    explosion: state.explosion,
    cut: state.cut,
    motion: state.motion?.name ?? "",
    time: state.time,
    part: scene.parts[state.part]?.name ?? "",
    joint: scene.joints[state.joint]?.name ?? "",
    finding: finding ? [finding.code, ...finding.parts, ...finding.joints].join("\n") : "",
    open: [...document.querySelectorAll("details[open][id]")].map((box) => box.id),
    scroll: scrollY,
    theme: document.documentElement.dataset.theme ?? "",
  }));
}

// What is still there is shown as it was; a finding that is gone is no longer chosen.
function recall(controls) {
  const text = sessionStorage.getItem(KEPT);
  if (!text) return;
  const kept = JSON.parse(text);
  const { state, state: { scene } } = controls;
  if (kept.name !== scene.name) return;
  if (kept.theme) document.documentElement.dataset.theme = kept.theme;
  controls.theme();
  for (const id of kept.open) {
    const box = document.getElementById(id);
    if (box) box.open = true;
  }
  for (const [layer, on] of Object.entries(kept.layers)) {
    const box = document.querySelector(`[data-layer="${layer}"]`);
    if (box && box.checked !== on) controls.flip(layer);
  }
  for (const box of document.querySelectorAll("[data-hides]")) {
    if (!kept.hidden.includes(scene.parts[Number(box.dataset.hides)].name)) continue;
    box.checked = false;
    state.hidden.add(Number(box.dataset.hides));
  }
  const motion = state.motions.findIndex((entry) => entry.name === kept.motion);
  if (document.getElementById("motion")) {
    controls.pickMotion(motion, false);
    if (motion >= 0) controls.go(kept.time);
  }
  controls.explode(kept.explosion);
  Object.assign(state.cut, kept.cut);
  controls.section(state.cut.axis);
  const index = (list, name) => list.findIndex((entry) => entry.name === name);
  if (kept.part && index(scene.parts, kept.part) >= 0) controls.choose("part", index(scene.parts, kept.part));
  else if (kept.joint && index(scene.joints, kept.joint) >= 0) controls.choose("joint", index(scene.joints, kept.joint));
  else if (kept.finding) {
    const same = scene.findings.findIndex((entry) => [entry.code, ...entry.parts, ...entry.joints].join("\n") === kept.finding);
    if (same >= 0) controls.choose("finding", same);
  }
  Object.assign(state.camera, kept.camera);
  scrollTo({ top: kept.scroll, behavior: "instant" });
  controls.redraw();
}

function follow(controls) {
  const { live } = document.body.dataset;
  if (live === undefined) return;
  recall(controls);
  const note = document.getElementById("live");
  const events = new EventSource("changes");
  events.addEventListener("message", (event) => {
    const { version, text } = JSON.parse(event.data);
    note.textContent = text;
    if (version === live) return;
    remember(controls);
    location.reload();
  });
  events.addEventListener("error", () => { note.textContent = "kinform watch has ended; this is the last page."; });
}

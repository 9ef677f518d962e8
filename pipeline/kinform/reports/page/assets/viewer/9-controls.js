// Ties the state to the document: pointer, keys, lists, sliders, the graph, the plots.

class Controls {
  constructor(state, renderer) {
    Object.assign(this, { state, renderer, canvas: renderer.canvas, playing: false });
    this.id = (name) => document.getElementById(name);
    this.theme();
    this.pointer();
    this.keys();
    this.lists();
    this.tools();
    this.motion();
    this.proposals();
    this.graph();
    new ResizeObserver(() => {
      if (!this.state.camera.own) {
        this.state.camera.aspect = this.renderer.resize();
        this.reframe();
      }
      this.redraw();
    }).observe(this.canvas);
    for (const query of ["(prefers-color-scheme: dark)", "print"]) matchMedia(query).addEventListener("change", () => { this.theme(); this.paint(); });
  }

  redraw() {
    if (this.waiting) return;
    this.waiting = requestAnimationFrame(() => this.paint());
  }

  paint() {
    this.waiting = 0;
    this.state.place();
    this.renderer.draw(this.state);
    this.label();
    this.axes();
    const { gl } = this.renderer;
    const fault = gl.getError();
    if (fault && !gl.isContextLost()) document.body.dataset.fault = String(fault);
    document.body.dataset.frames = String(Number(document.body.dataset.frames || 0) + 1);
  }

  // The directions of x, y and z, in the corner.
  axes() {
    const view = this.state.camera.view();
    const box = this.id("triad");
    for (let k = 0; k < 3; k++) {
      const x = view[4 * k], y = -view[4 * k + 1], behind = view[4 * k + 2] < -1e-6;
      const line = box.children[2 * k], text = box.children[2 * k + 1];
      line.setAttribute("x2", (21 * x).toFixed(2));
      line.setAttribute("y2", (21 * y).toFixed(2));
      text.setAttribute("x", (29 * x).toFixed(2));
      text.setAttribute("y", (29 * y).toFixed(2));
      line.classList.toggle("behind", behind);
      text.classList.toggle("behind", behind);
    }
  }

  // What was brought into view, again: the picture has another shape.
  reframe() {
    const { state } = this;
    state.place();
    if (state.aimed.length || state.finding >= 0) state.aim();
    else state.fitMotion();
  }

  // Everything stays in the picture, wherever the explosion and the motion take it.
  keep() {
    const { state } = this;
    state.place();
    if (!state.camera.own || !state.camera.sees(state.sweep())) state.fitMotion();
  }

  theme() {
    const style = getComputedStyle(document.body);
    const of = (name) => colourOf(style.getPropertyValue(name).trim());
    this.state.theme = {
      back: of("--stage"), line: of("--stage-line"), sign: of("--stage-sign"), chosen: of("--signal"),
      overlap: colourOf(this.state.scene.overlapColour),
      fits: Object.fromEntries(Object.entries(this.state.scene.fits).map(([fit, hex]) => [fit, colourOf(hex)])),
    };
    this.state.colours = this.state.scene.bodies.map((body) => colourOf(body.colour));
    this.state.ownColours = this.state.scene.parts.map((part) => (part.colour ? colourOf(part.colour) : null));
  }

  // ---- choosing

  choose(kind, index, focus = false) {
    const { state, state: { scene } } = this;
    if (kind === "finding") this.present(scene.findings[index]);
    if (kind === "part") state.choosePart(index);
    else if (kind === "joint") state.chooseJoint(index);
    else if (kind === "body") state.chooseBody(index);
    else if (kind === "finding") state.chooseFinding(index);
    else state.clear();
    if (focus && kind === "part") state.fit([index]);
    document.querySelectorAll("[data-chosen]").forEach((element) => { delete element.dataset.chosen; element.removeAttribute("aria-current"); });
    const mark = (selector) => document.querySelectorAll(selector).forEach((element) => {
      element.dataset.chosen = "";
      if (element.tagName === "BUTTON" || element.getAttribute("role") === "button") element.setAttribute("aria-current", "true");
    });
    let text = "";
    const called = (body) => body.title ? `${body.name} (${body.title})` : body.name;
    if (kind === "part") {
      const part = scene.parts[index];
      text = `Part ${part.name}, of body ${called(scene.bodies[part.body])}`;
      mark(`[data-part="${index}"]`);
      mark(`[data-body="${part.body}"]`);
    } else if (kind === "joint") {
      const joint = scene.joints[index];
      text = `Joint ${joint.wanted ? joint.wanted + ", " : ""}${joint.name}: ${joint.text}, ${joint.status}`;
      mark(`[data-joint="${index}"]`);
      joint.bodies.forEach((body) => mark(`svg [data-body="${body}"]`));
    } else if (kind === "body") {
      text = `Body ${called(scene.bodies[index])}`;
      mark(`[data-body="${index}"]`);
    } else if (kind === "finding") {
      const finding = scene.findings[index];
      text = [`Finding ${finding.code}`, [...finding.parts, ...finding.joints].join(", ")].filter(Boolean).join(": ");
      mark(`[data-finding="${index}"]`);
    }
    this.id("chosen").textContent = text || "Nothing is chosen";
    const chosen = document.querySelector(".panel [data-chosen]");
    if (chosen) this.reveal(chosen);
    this.redraw();
  }

  // Goes to the moment of the motion at which a finding shows; findings of the pose of the meshes show there.
  present(finding) {
    if (!this.id("motion")) return;
    this.play(false);
    if (finding.motion >= 0) {
      this.pickMotion(finding.motion, false);
      this.go(finding.time);
    } else if (this.state.motion) this.go(this.state.motion.kind === "simulation" ? this.state.motion.start : 0);
    this.state.place();
  }

  // Scrolls the list, never the page.
  reveal(element) {
    const box = element.closest(".panel");
    if (!box || !box.clientHeight) return;
    const top = element.getBoundingClientRect().top - box.getBoundingClientRect().top;
    if (top < 0 || top > box.clientHeight - 24) box.scrollTop += top - box.clientHeight / 2;
  }

  // ---- the canvas

  pointer() {
    const { canvas, state: { camera } } = this;
    const held = new Map();
    let travelled = 0;
    const place = (event) => {
      const box = canvas.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      held.set(event.pointerId, place(event));
      travelled = 0;
    });
    canvas.addEventListener("pointermove", (event) => {
      const now = place(event);
      const before = held.get(event.pointerId);
      if (!before) return void this.hovered(now);
      const dx = now[0] - before[0], dy = now[1] - before[1];
      travelled += Math.hypot(dx, dy);
      if (held.size === 2) {
        const other = [...held].find(([id]) => id !== event.pointerId)[1];
        const apart = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
        camera.zoom(apart(before) / apart(now));
        camera.pan(dx / 2 / canvas.clientHeight, dy / 2 / canvas.clientHeight);
      } else if (event.shiftKey || event.buttons & 6) camera.pan(dx / canvas.clientHeight, dy / canvas.clientHeight);
      else camera.orbit(dx * 0.008, dy * 0.008);
      held.set(event.pointerId, now);
      this.redraw();
    });
    const release = (event) => {
      if (held.delete(event.pointerId) && event.type === "pointerup" && travelled < 4 && event.button === 0) this.pressed(place(event));
    };
    canvas.addEventListener("pointerup", release);
    canvas.addEventListener("pointercancel", release);
    canvas.addEventListener("pointerleave", () => this.hovered(null));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("dblclick", (event) => {
      const hit = this.renderer.pick(this.state, ...place(event));
      if (hit?.part !== undefined) this.choose("part", hit.part, true);
    });
    // the wheel zooms once the picture was clicked, and else scrolls the page
    canvas.addEventListener("wheel", (event) => {
      if (document.activeElement !== canvas && !event.ctrlKey) return;
      event.preventDefault();
      camera.zoom(Math.exp(Math.max(-60, Math.min(60, event.deltaY)) * 0.0035));
      this.redraw();
    }, { passive: false });
  }

  pressed(at) {
    const hit = this.renderer.pick(this.state, ...at);
    this.canvas.focus({ preventScroll: true });
    if (hit?.part !== undefined) this.choose("part", hit.part);
    else if (hit?.joint !== undefined) this.choose("joint", hit.joint);
    else if (hit?.patch !== undefined && this.state.scene.patches.items[hit.patch].joint >= 0) this.choose("joint", this.state.scene.patches.items[hit.patch].joint);
    else this.choose(null, -1);
  }

  hovered(at) {
    const tip = this.id("tip");
    const hit = at && !this.playing ? this.renderer.pick(this.state, ...at) : null;
    const { scene } = this.state;
    let text = "";
    if (hit?.part !== undefined) text = scene.parts[hit.part].name;
    else if (hit?.joint !== undefined) text = `${scene.joints[hit.joint].name}: ${scene.joints[hit.joint].text}`;
    else if (hit?.patch !== undefined) {
      const patch = scene.patches.items[hit.patch];
      text = `${patch.parts.join(" and ")}: ${patch.text}`;
    }
    tip.hidden = !text;
    tip.textContent = text;
    if (text) {
      const room = this.canvas.clientWidth;
      tip.style.left = `${Math.min(at[0] + 14, Math.max(8, room - tip.offsetWidth - 8))}px`;
      tip.style.top = `${at[1] + 16}px`;
    }
    const part = hit?.part ?? -1;
    if (part !== this.state.hover) {
      this.state.hover = part;
      this.redraw();
    }
  }

  keys() {
    const { canvas, state, state: { camera } } = this;
    const step = (list, at, way) => (list ? (at + way + list) % list : -1);
    const actions = {
      ArrowLeft: (e) => (e.shiftKey ? camera.pan(0.06, 0) : camera.orbit(0.12, 0)),
      ArrowRight: (e) => (e.shiftKey ? camera.pan(-0.06, 0) : camera.orbit(-0.12, 0)),
      ArrowUp: (e) => (e.shiftKey ? camera.pan(0, 0.06) : camera.orbit(0, 0.12)),
      ArrowDown: (e) => (e.shiftKey ? camera.pan(0, -0.06) : camera.orbit(0, -0.12)),
      "+": () => camera.zoom(0.85), "=": () => camera.zoom(0.85), "-": () => camera.zoom(1.18),
      "1": () => camera.from("front"), "2": () => camera.from("right"), "3": () => camera.from("top"),
      "0": () => { camera.first(); state.fitMotion(); },
      f: () => this.fit(), x: () => this.flip("xray"), c: () => this.flip("contacts"), a: () => this.flip("joints"),
      e: () => this.explode(state.explosion > 0 ? 0 : 0.6),
      k: () => this.cutAway((state.cut.axis + 2) % 4 - 1),
      h: () => this.hide(), s: () => this.showAll(),
      p: (e) => this.choose("part", step(state.scene.parts.length, state.part, e.shiftKey ? -1 : 1)),
      j: (e) => state.scene.joints.length && this.choose("joint", step(state.scene.joints.length, state.joint, e.shiftKey ? -1 : 1)),
      " ": () => this.play(!this.playing),
      Escape: () => this.choose(null, -1),
    };
    canvas.addEventListener("keydown", (event) => {
      const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
      if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      action(event);
      this.redraw();
    });
  }

  // ---- lists and layers

  lists() {
    const main = this.id("main");
    main.addEventListener("click", (event) => {
      const element = event.target.closest("button[data-part],button[data-joint],button[data-body],button[data-finding]");
      if (!element) return;
      const kind = ["part", "joint", "body", "finding"].find((name) => name in element.dataset);
      this.choose(kind, Number(element.dataset[kind]));
      this.show();
    });
    main.addEventListener("change", (event) => {
      const { hides } = event.target.dataset;
      if (hides === undefined) return;
      if (event.target.checked) this.state.hidden.delete(Number(hides));
      else this.state.hidden.add(Number(hides));
      this.redraw();
    });
    // a link to a finding opens what it is folded in, and goes there in the view
    const follow = () => {
      const target = location.hash && document.getElementById(decodeURIComponent(location.hash.slice(1)));
      for (let box = target; box; box = box.parentElement) if (box.tagName === "DETAILS") box.open = true;
      target?.scrollIntoView({ block: "start" });
      const button = target?.querySelector("button[data-finding]");
      if (button) this.choose("finding", Number(button.dataset.finding));
    };
    addEventListener("hashchange", follow);
    main.addEventListener("click", (event) => {
      const link = event.target.closest("a[href^='#']");
      if (link && link.hash === location.hash) follow();
    });
  }

  // Brings the view into the window where it stands above the lists.
  show() {
    const box = this.id("view").getBoundingClientRect();
    if (box.top < -40 || box.bottom > innerHeight + 200) this.id("view").scrollIntoView({ block: "start", behavior: "smooth" });
  }

  hide() {
    const { state } = this;
    const chosen = state.scene.parts.map((_, k) => k).filter((k) => k === state.part || (state.body >= 0 && state.scene.parts[k].body === state.body));
    for (const k of chosen) {
      state.hidden.add(k);
      const box = document.querySelector(`[data-hides="${k}"]`);
      if (box) box.checked = false;
    }
    if (chosen.length) this.choose(null, -1);
  }

  showAll() {
    this.state.hidden.clear();
    document.querySelectorAll("[data-hides]").forEach((box) => { box.checked = true; });
    this.redraw();
  }

  tools() {
    for (const box of document.querySelectorAll("[data-layer]")) {
      box.checked = this.state.layers[box.dataset.layer];
      box.addEventListener("change", () => {
        this.state.layers[box.dataset.layer] = box.checked;
        this.id("fits").hidden = !this.state.layers.contacts;
        this.redraw();
      });
    }
    this.id("explode").addEventListener("input", (event) => this.explode(Number(event.target.value) / 100));
    this.id("cut").addEventListener("change", (event) => this.cutAway(Number(event.target.value)));
    this.id("cut-at").addEventListener("input", (event) => {
      this.state.cut.share = Number(event.target.value) / 1000;
      this.redraw();
    });
    this.id("cut-flip").addEventListener("click", () => {
      this.state.cut.flipped = !this.state.cut.flipped;
      this.section(this.state.cut.axis);
    });
    this.id("fit").addEventListener("click", () => this.fit());
    this.id("hide").addEventListener("click", () => this.hide());
    this.id("show-all").addEventListener("click", () => this.showAll());
    this.id("theme").addEventListener("click", () => {
      const dark = getComputedStyle(document.documentElement).colorScheme.startsWith("dark");
      document.documentElement.dataset.theme = dark ? "light" : "dark";
      this.theme();
      this.redraw();
    });
  }

  // Cuts across an axis, and takes away the side that is nearer to the eye.
  cutAway(axis) {
    const { camera, cut } = this.state;
    cut.flipped = axis >= 0 && camera.eye[axis] < camera.target[axis];
    this.section(axis);
  }

  // Cuts across an axis, x is 0; nowhere for −1.
  section(axis) {
    const { cut } = this.state;
    cut.axis = axis;
    this.id("cut").value = String(axis);
    this.id("cut-at").value = String(Math.round(1000 * cut.share));
    this.id("cut-flip").setAttribute("aria-pressed", String(cut.flipped));
    this.id("cut-at").disabled = this.id("cut-flip").disabled = axis < 0;
    this.redraw();
  }

  flip(layer) {
    const box = document.querySelector(`[data-layer="${layer}"]`);
    box.checked = !box.checked;
    box.dispatchEvent(new Event("change"));
  }

  explode(share) {
    this.state.explosion = share;
    this.id("explode").value = String(Math.round(100 * share));
    this.keep();
    this.redraw();
  }

  fit() {
    const { state } = this;
    if (state.part >= 0) state.fit([state.part]);
    else state.fitMotion();
    this.redraw();
  }

  // ---- motion

  motion() {
    const select = this.id("motion");
    if (!select) return;
    select.addEventListener("change", () => this.pickMotion(Number(select.value), true));
    this.id("play").addEventListener("click", () => this.play(!this.playing));
    this.id("time").addEventListener("input", (event) => {
      this.play(false);
      const { motion } = this.state;
      if (!motion) return;
      this.go(motion.start + (Number(event.target.value) / 1000) * (motion.end - motion.start));
    });
    if (select.options.length > 1) this.pickMotion(Number(select.options[1].value), false);
  }

  pickMotion(index, play) {
    const { state } = this;
    state.motion = state.motions[index] ?? null;
    this.id("motion").value = String(index);
    const { motion } = state;
    this.id("play").disabled = this.id("time").disabled = !motion;
    this.id("motion-note").textContent = motion?.note ?? "";
    this.id("moved").textContent = motion?.moved ?? "time";
    this.listMarks(motion);
    if (!motion) {
      this.play(false);
      this.showProposal();
      this.redraw();
      return;
    }
    this.direction = 1;
    this.keep();
    this.go(motion.kind === "simulation" ? motion.start : 0);
    this.play(play);
  }

  // Joints that may be meant: each slider moves what its joint would, each button copies its text.
  proposals() {
    const main = this.id("main");
    main.addEventListener("input", (event) => {
      const { proposes } = event.target.dataset;
      if (proposes === undefined) return;
      const share = Number(event.target.value) / 500 - 1;
      this.play(false);
      if (this.state.motion !== this.state.motions[proposes]) this.pickMotion(Number(proposes), false);
      this.go(share);
    });
    main.addEventListener("change", (event) => {
      if (event.target.dataset.proposes !== undefined) this.show();
    });
    main.addEventListener("click", async (event) => {
      const button = event.target.closest("button[data-copies]");
      if (!button) return;
      const box = document.querySelector(`[data-toml="${button.dataset.copies}"]`);
      let copied = true;
      try {
        await navigator.clipboard.writeText(box.textContent);
      } catch {
        copied = this.copySelected(box);
      }
      this.id("copied").textContent = copied ? "Copied: paste it into the manifest" : "Not copied: open TOML, and select it";
    });
  }

  // The older way, where a page may not write to the clipboard.
  copySelected(box) {
    const area = document.createElement("textarea");
    area.value = box.textContent;
    document.body.append(area);
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    return done;
  }

  // The sliders of proposals show what the view does.
  showProposal() {
    const { state } = this;
    for (const slider of document.querySelectorAll("[data-proposes]")) {
      const on = state.motion && state.motion === state.motions[slider.dataset.proposes];
      slider.value = on ? String(Math.round(500 * (state.time + 1))) : "500";
      const text = on ? this.moment(state.motion, state.time) : "";
      slider.closest(".proposed-tools").querySelector("output").textContent = text;
      if (text) slider.setAttribute("aria-valuetext", text);
      else slider.removeAttribute("aria-valuetext");
    }
  }

  // Ticks on the slider, and a button for each that goes there.
  listMarks(motion) {
    const signs = { collision: "✕", end: "▲" };
    const marks = motion?.marks ?? [];
    const go = (mark) => { this.play(false); this.go(mark.time); };
    this.id("marks").replaceChildren(...marks.map((mark) => {
      const tick = document.createElement("span");
      tick.className = mark.kind;
      tick.textContent = signs[mark.kind];
      tick.title = mark.text;
      tick.style.left = `${(100 * (mark.time - motion.start)) / (motion.end - motion.start)}%`;
      tick.addEventListener("click", () => go(mark));
      return tick;
    }));
    this.id("mark-list").replaceChildren(...marks.map((mark) => {
      const item = document.createElement("li"), button = document.createElement("button"), sign = document.createElement("span");
      button.type = "button";
      button.className = mark.kind;
      sign.setAttribute("aria-hidden", "true");
      sign.textContent = signs[mark.kind] + " ";
      button.append(sign, mark.text);
      button.addEventListener("click", () => go(mark));
      item.append(button);
      return item;
    }));
    this.id("mark-list").hidden = !marks.length;
  }

  // What the clock shows: seconds of a run, the value of the driving joint of a freedom.
  moment(motion, time) {
    if (motion.kind === "simulation") return `${time.toFixed(2)} s`;
    if (!motion.unit) return `${Math.round(100 * time)} %`;
    const value = Math.abs(time) * (time < 0 ? motion.ends[0] : motion.ends[1]);
    return `${value.toFixed(1).replace(/^-0\.0$/, "0.0")}${motion.unit}`;
  }

  // The names of parts that have run into each other, where they did.
  label() {
    const { state, canvas } = this;
    const box = this.id("spots");
    const see = M.multiply(state.camera.projection(), state.camera.view());
    const texts = new Map(state.spots.filter(({ text }) => text).map(({ text, place }) => [text, place]));
    const old = new Map([...box.children].map((child) => [child.textContent, child]));
    for (const [text, child] of old) if (!texts.has(text)) child.remove();
    for (const [text, place] of [...texts].slice(0, 12)) {
      let child = old.get(text);
      if (!child) {
        child = document.createElement("span");
        child.textContent = text;
        box.append(child);
      }
      const [x, y, , w] = [0, 1, 2, 3].map((r) => see[r] * place[0] + see[4 + r] * place[1] + see[8 + r] * place[2] + see[12 + r]);
      child.hidden = w <= 0;
      const left = (0.5 + (0.5 * x) / w) * canvas.clientWidth + 16, room = canvas.clientWidth - child.offsetWidth - 8;
      child.style.left = `${Math.max(8, Math.min(left, room))}px`;
      child.style.top = `${Math.max(4, Math.min((0.5 - (0.5 * y) / w) * canvas.clientHeight + 10, canvas.clientHeight - 30))}px`;
    }
  }

  go(time) {
    const { state, state: { motion } } = this;
    state.time = Math.min(motion.end, Math.max(motion.start, time));
    const share = (state.time - motion.start) / (motion.end - motion.start);
    const slider = this.id("time");
    slider.value = String(Math.round(1000 * share));
    const text = this.moment(motion, state.time);
    const struck = state.struck.map((mark) => mark.text);
    slider.setAttribute("aria-valuetext", [text, ...struck].join("; "));
    this.id("clock").textContent = text;
    this.showProposal();
    if (motion.kind === "simulation") {
      document.querySelectorAll("svg[data-from]").forEach((plot) => {
        const { from, to, left, right } = plot.dataset;
        const x = Number(left) + ((state.time - from) / (to - from)) * (right - left);
        const cursor = plot.querySelector(".cursor");
        cursor.setAttribute("transform", `translate(${x.toFixed(2)} 0)`);
        cursor.removeAttribute("visibility");
      });
    }
    this.redraw();
  }

  play(on) {
    const { state } = this;
    this.playing = on && Boolean(state.motion);
    const button = this.id("play");
    if (button) {
      button.textContent = this.playing ? "Pause" : "Play";
      button.setAttribute("aria-pressed", String(this.playing));
    }
    if (!this.playing) return;
    if (state.motion.kind === "simulation" && state.time >= state.motion.end) this.go(state.motion.start);
    let last = performance.now();
    const turn = ++this.run || (this.run = 1);
    const tick = (now) => {
      if (!this.playing || turn !== this.run) return;
      const passed = Math.min(0.1, Math.max(0, (now - last) / 1000));
      last = now;
      const { motion } = state;
      if (motion.kind === "simulation") {
        const next = state.time + passed;
        this.go(next > motion.end ? motion.start : next);
      } else {
        // to and fro, with rests at the ends
        this.phase = (Math.asin(state.time) || 0);
        if (this.direction < 0) this.phase = Math.PI - this.phase;
        const next = this.phase + 1.6 * passed;
        this.direction = Math.cos(next) >= 0 ? 1 : -1;
        this.go(Math.sin(next));
      }
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  // ---- the kinematic graph, linked both ways

  graph() {
    const act = (event) => {
      const node = event.target.closest("[data-body],[data-joint]");
      if (!node || (event.type === "keydown" && event.key !== "Enter" && event.key !== " ")) return;
      event.preventDefault();
      if (node.dataset.joint !== undefined) this.choose("joint", Number(node.dataset.joint));
      else this.choose("body", Number(node.dataset.body));
    };
    const box = this.id("graph");
    if (!box) return;
    box.addEventListener("click", act);
    box.addEventListener("keydown", act);
  }
}

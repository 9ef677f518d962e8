// What is shown: which parts, in which pose, what is chosen. Knows nothing of the document or of WebGL.

class State {
  constructor(scene, motions) {
    Object.assign(this, { scene, motions });
    this.camera = new Camera(scene.low, scene.high, scene.look);
    this.cut = { axis: -1, share: 0.5, flipped: false };
    this.aimed = [];
    this.layers = { edges: true, joints: true, contacts: false, overlaps: true, xray: false, own: false };
    this.hidden = new Set();
    this.explosion = 0;
    this.motion = null;
    this.time = 0;
    this.clear();
    this.hover = -1;
    for (const motion of motions) for (const mark of motion.marks) this.pin(motion, mark);
    this.centres();
    this.place();
  }

  clear() {
    Object.assign(this, { part: -1, joint: -1, body: -1, finding: -1, focus: null });
  }

  // The place of a mark in the axes of the body that carries it, and the numbers of its parts.
  pin(motion, mark) {
    mark.numbers = new Set(mark.parts.map((name) => this.scene.parts.findIndex((part) => part.name === name)));
    if (mark.place) mark.local = M.point(M.rigidInverse(motion.at(mark.time)[mark.body]), mark.place);
  }

  // Collisions that have happened by now: of a run in the order of time, of a freedom on this side of the meshes' pose.
  get struck() {
    if (!this.motion) return [];
    const near = 0.5 / 1000 * (this.motion.end - this.motion.start);
    return this.motion.marks.filter((mark) => {
      if (mark.kind !== "collision") return false;
      if (this.motion.kind === "simulation") return this.time >= mark.time - near;
      return Math.sign(mark.time) === Math.sign(this.time) && Math.abs(this.time) >= Math.abs(mark.time) - near;
    });
  }

  // Middle of each part and of each body, at the pose of the meshes.
  centres() {
    const { scene } = this;
    this.middles = scene.parts.map((part) => {
      const mesh = part.mesh >= 0 ? scene.meshes[part.mesh] : null;
      return M.point(part.pose, mesh ? V.add(mesh.low, V.scale(mesh.size, 0.5)) : [0, 0, 0]);
    });
    this.bodyMiddles = scene.bodies.map((_, b) => {
      const own = this.middles.filter((_, k) => scene.parts[k].body === b);
      return own.length ? V.scale(own.reduce(V.add, [0, 0, 0]), 1 / own.length) : [0, 0, 0];
    });
    this.middle = V.scale(V.add(scene.low, scene.high), 0.5);
  }

  // Poses of bodies and parts from motion and explosion.
  place() {
    const { scene, explosion } = this;
    const poses = this.motion ? this.motion.at(this.time) : scene.bodies.map(M.identity);
    const away = this.bodyMiddles.map((c) => V.scale(V.sub(c, this.middle), 1.1 * explosion));
    this.shown = poses.map((pose, b) => M.multiply(M.translation(away[b]), pose));
    const finding = this.finding >= 0 ? scene.findings[this.finding] : null;
    // of a finding its own marks alone
    const struck = this.struck.filter((mark) => !finding || (finding.meeting.length && finding.meeting.every((name) => mark.parts.includes(name))));
    this.spots = struck.filter((mark) => mark.local).map((mark) => ({ text: mark.text, place: M.point(this.shown[mark.body], mark.local) }));
    if (finding?.place && !finding.meeting.length) {
      const carrier = scene.parts.find((part) => finding.parts.includes(part.name));
      this.spots.push({ text: "", place: carrier ? M.point(this.shown[carrier.body], finding.place) : finding.place });
    }
    this.colliding = new Set(struck.flatMap((mark) => [...mark.numbers]));
    this.models = this.modelsAt(poses);
  }

  // Poses of parts with bodies at these poses, and the explosion.
  modelsAt(poses) {
    const { scene, explosion } = this;
    return scene.parts.map((part, k) => {
      const away = V.scale(V.sub(this.bodyMiddles[part.body], this.middle), 1.1 * explosion);
      const own = V.scale(V.sub(this.middles[k], this.bodyMiddles[part.body]), 0.9 * explosion);
      return M.multiply(M.translation(V.add(own, away)), M.multiply(poses[part.body], part.pose));
    });
  }

  // The plane that cuts: normal and distance; facets beyond it are not drawn.
  get plane() {
    const { axis, share, flipped } = this.cut;
    if (axis < 0) return [0, 0, 0, 1];
    const normal = [0, 0, 0], way = flipped ? -1 : 1;
    normal[axis] = way;
    return [...normal, way * (this.scene.low[axis] + share * (this.scene.high[axis] - this.scene.low[axis]))];
  }

  // Whether a part is of the other one of two revisions than the one that is shown.
  absent(k) {
    const { when } = this.scene.parts[k];
    return Boolean(when) && (when === "before") !== (this.motion !== null && this.time < 0.5);
  }

  look(k) {
    if (this.hidden.has(k) || this.absent(k)) return "hidden";
    if (this.layers.xray || (this.layers.contacts && this.joint < 0)) return "ghost";
    const body = this.scene.parts[k].body;
    if (this.focus) return this.focus.has(k) ? (this.layers.contacts ? "ghost" : "plain") : "ghost";
    if (this.joint >= 0) return this.scene.joints[this.joint].bodies.includes(body) && !this.layers.contacts ? "plain" : "ghost";
    return "plain";
  }

  // The colour of a part: of its body, or its own where that is wanted and nothing is marked on it; red where it has
  // run into another.
  colour(k) {
    const marked = this.finding >= 0 || this.colliding.has(k);
    const own = (this.layers.own && !marked && this.ownColours[k]) || this.colours[this.scene.parts[k].body];
    return this.colliding.has(k) ? own.map((x, i) => 0.6 * x + 0.4 * this.theme.overlap[i]) : own;
  }

  glow(k) {
    if (this.part === k || (this.body >= 0 && this.scene.parts[k].body === this.body)) return 1;
    return this.hover === k ? 0.6 : 0;
  }

  jointHidden(k) {
    if (this.joint >= 0) return this.joint !== k;
    const { name, bodies } = this.scene.joints[k];
    if (this.finding >= 0) return !this.scene.findings[this.finding].joints.includes(name);
    // of a joint that may be meant, only what lies between its sides
    const moves = this.motion?.kind === "proposal" ? bodies.map((body) => this.motion.moving.includes(body)) : [true, false];
    return moves[0] === moves[1];
  }

  patchHidden(item) {
    const gone = item.parts.some((name) => this.hidden.has(this.scene.parts.findIndex((part) => part.name === name)));
    return gone || (this.joint >= 0 && item.joint !== this.joint);
  }

  overlapHidden(item) {
    if (this.finding >= 0) {
      const finding = this.scene.findings[this.finding];
      if (finding.motion >= 0 || !item.parts.every((name) => finding.parts.includes(name))) return true;
    }
    return item.parts.some((name) => this.hidden.has(this.scene.parts.findIndex((part) => part.name === name)));
  }

  choosePart(k) { this.clear(); this.part = k; }

  chooseJoint(k) { this.clear(); this.joint = k; }

  chooseBody(k) { this.clear(); this.body = k; }

  // A finding: its parts are shown, everything else is faint, and the eye goes to its place.
  chooseFinding(k) {
    this.clear();
    this.finding = k;
    const finding = this.scene.findings[k];
    const bodies = finding.joints.flatMap((name) => this.scene.joints.find((joint) => joint.name === name).bodies);
    const parts = this.scene.parts.map((_, n) => n).filter((n) => finding.parts.includes(this.scene.parts[n].name) || bodies.includes(this.scene.parts[n].body));
    if (parts.length) this.focus = new Set(parts);
    // of two parts that meet the larger one would hide the place
    const size = (n) => (this.scene.parts[n].mesh < 0 ? 0 : V.length(this.scene.meshes[this.scene.parts[n].mesh].size));
    const meeting = finding.meeting.map((name) => this.scene.parts.findIndex((part) => part.name === name)).sort((a, b) => size(b) - size(a));
    if (meeting.length > 1) this.focus.delete(meeting[0]);
    for (const n of parts) this.hidden.delete(n);
    this.place();
    this.camera.first();
    this.aim(parts);
  }

  // Look at these parts, as the picture of the chosen finding does where one is chosen.
  aim(parts = this.aimed) {
    this.aimed = parts;
    const finding = this.finding >= 0 ? this.scene.findings[this.finding] : null;
    if (!finding) {
      this.fit(parts);
      return;
    }
    const { margin, zoom, shift } = this.scene.look;
    this.camera.fit(this.extent(parts), margin);
    if (finding.place && parts.length) {
      this.camera.target = V.add(V.scale(this.camera.target, 1 - shift), V.scale(finding.place, shift));
      this.camera.distance /= zoom;
    }
  }

  // Look at parts at their present pose; at all that are shown where the list is empty.
  fit(parts) {
    this.aimed = parts;
    this.camera.fit(this.extent(parts));
  }

  // Look at all that is shown, wherever the motion takes it.
  fitMotion() {
    this.aimed = [];
    this.camera.fit(this.sweep());
  }

  // Corners of the boxes of all that is shown, over the whole motion.
  sweep() {
    const { motion } = this;
    if (!motion) return this.extent([]);
    const steps = Array.from({ length: 13 }, (_, k) => motion.start + (k / 12) * (motion.end - motion.start));
    return steps.flatMap((time) => this.extent([], this.modelsAt(motion.at(time))));
  }

  // Corners of the boxes of parts, or of all that are shown.
  extent(parts, models = this.models) {
    const list = parts.length ? parts : this.scene.parts.map((_, k) => k).filter((k) => !this.hidden.has(k));
    const points = [];
    for (const k of list) {
      const part = this.scene.parts[k];
      if (part.mesh < 0) continue;
      const mesh = this.scene.meshes[part.mesh];
      for (let c = 0; c < 8; c++) points.push(M.point(models[k], [0, 1, 2].map((i) => mesh.low[i] + ((c >> i) & 1) * mesh.size[i])));
    }
    const { low, high } = this.scene;
    if (!points.length) for (let c = 0; c < 8; c++) points.push([0, 1, 2].map((i) => (((c >> i) & 1) ? high : low)[i]));
    return points;
  }
}

// Draws one frame of the state on the canvas, and the same frame as numbers for picking.
// Numbers: 1 … P parts, then joints, then patches.

class Renderer {
  constructor(canvas, scene, blob) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: false, preserveDrawingBuffer: true });
    if (!gl) throw new Error("WebGL 2 is not available");
    Object.assign(this, { canvas, gl, scene });
    this.programs = Object.fromEntries(Object.entries(GLSL).map(([name, source]) => [name, programOf(gl, source)]));
    this.meshes = scene.meshes.map((entry) => new MeshBuffers(gl, meshOf(blob, entry)));
    this.overlaps = scene.overlaps.map((item) => (item.mesh ? new MeshBuffers(gl, meshOf(blob, item.mesh)) : null));
    const discs = scene.patches.rows ? columnsOf(blob, scene.patches.offset, scene.patches.rows, 7) : new Uint16Array(0);
    this.discs = new Instances(gl, [-1, -1, 1, -1, -1, 1, 1, 1], discs, [3, 3, 1], gl.UNSIGNED_SHORT, true);
    const signs = signsOf(scene.joints);
    this.signs = new Instances(gl, [0, -1, 0, 1, 1, -1, 1, 1], signs.data, [3, 3], gl.FLOAT, false);
    this.ranges = signs.ranges;
    const star = [];
    SIGNS.spherical(star, { point: [0, 0, 0], size: 1 });
    SIGNS.fixed(star, { point: [0, 0, 0], size: 2.6 });
    this.star = new Instances(gl, [0, -1, 0, 1, 1, -1, 1, 1], new Float32Array(star.flat(2)), [3, 3], gl.FLOAT, false);
    this.starStrokes = star.length;
    this.target = new PickTarget(gl);
    this.stale = true;
  }

  get firstJoint() { return this.scene.parts.length + 1; }
  get firstPatch() { return this.firstJoint + this.scene.joints.length; }

  resize() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.max(1, Math.round(this.canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(this.canvas.clientHeight * ratio));
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
    this.ratio = ratio;
    return width / height;
  }

  use(name) {
    const { gl } = this;
    const { program, at } = this.programs[name];
    gl.useProgram(program);
    gl.uniformMatrix4fv(at.view, false, this.view);
    gl.uniformMatrix4fv(at.projection, false, this.projection);
    if (at.cut) gl.uniform4fv(at.cut, this.cut);
    return at;
  }

  begin(camera, colour) {
    const { gl, canvas } = this;
    this.view = camera.view();
    this.projection = camera.projection();
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...colour, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    gl.depthMask(true);
  }

  mesh(at, buffers, model) {
    const { gl } = this;
    gl.uniformMatrix4fv(at.model, false, model);
    gl.uniform3fv(at.low, buffers.low);
    gl.uniform3fv(at.size, buffers.size);
  }

  // state: camera, poses of parts (models) and bodies, how each part is shown, layers, selection, theme.
  draw(state) {
    const { gl, scene } = this;
    state.camera.aspect = this.resize();
    this.cut = state.plane;
    this.begin(state.camera, state.theme.back);
    const opaque = [], ghosts = [];
    scene.parts.forEach((part, k) => {
      const look = state.look(k);
      if (part.mesh >= 0 && look !== "hidden") (look === "ghost" ? ghosts : opaque).push(k);
    });
    // facets a little further away than they are, by their slope: edges lie on them, and on nothing before them
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 2);
    this.parts(state, opaque, 0);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    if (state.layers.edges) this.edges(state, opaque, 0.55);
    if (state.layers.overlaps) this.red(state);
    if (state.layers.contacts) this.patches(state);
    if (state.layers.joints) this.strokes(state);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    this.parts(state, ghosts, 1);
    if (state.layers.edges) this.edges(state, ghosts, 0.05);
    gl.enable(gl.BLEND);
    // what lies behind something opaque shows through it faintly
    gl.depthFunc(gl.GREATER);
    if (state.layers.overlaps) this.red(state, 0.4);
    if (state.layers.joints) this.strokes(state, 0.42);
    gl.depthFunc(gl.LEQUAL);
    this.stars(state);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
    gl.bindVertexArray(null);
    this.stale = true;
  }

  // Where parts have run into each other: seen through everything.
  stars(state) {
    const { gl } = this;
    const at = this.use("stroke");
    gl.disable(gl.DEPTH_TEST);
    gl.uniform2f(at.screen, this.canvas.width / 2, this.canvas.height / 2);
    gl.uniform1f(at.width, 1.5 * this.ratio);
    for (const { place } of state.spots) {
      gl.uniformMatrix4fv(at.model, false, M.multiply(M.translation(place), M.scaling(0.022 * state.camera.distance * Math.tan(state.camera.angle))));
      gl.uniform4f(at.colour, ...state.theme.overlap, 1);
      this.star.draw(0, this.starStrokes);
    }
    gl.enable(gl.DEPTH_TEST);
  }

  parts(state, list, ghost) {
    const { gl, scene } = this;
    const at = this.use("solid");
    gl.uniform1f(at.ghost, ghost);
    gl.uniform1f(at.veil, 1);
    for (const k of list) {
      const buffers = this.meshes[scene.parts[k].mesh];
      this.mesh(at, buffers, state.models[k]);
      gl.uniform3fv(at.colour, state.colour(k));
      gl.uniform1f(at.glow, state.glow(k));
      gl.bindVertexArray(buffers.solid);
      gl.drawElements(gl.TRIANGLES, buffers.triangles, gl.UNSIGNED_INT, 0);
    }
  }

  edges(state, list, strength) {
    const { gl, scene } = this;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    const at = this.use("edge");
    for (const k of list) {
      const buffers = this.meshes[scene.parts[k].mesh];
      if (!buffers.lines) continue;
      this.mesh(at, buffers, state.models[k]);
      gl.uniform4f(at.colour, ...state.theme.line, strength);
      gl.bindVertexArray(buffers.edge);
      gl.drawElements(gl.LINES, buffers.lines, gl.UNSIGNED_INT, 0);
    }
    gl.disable(gl.BLEND);
  }

  red(state, veil = 1) {
    const { gl, scene } = this;
    const at = this.use("solid");
    gl.uniform1f(at.ghost, 0);
    gl.uniform1f(at.veil, veil);
    gl.uniform1f(at.glow, 0);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(-2, -8);
    scene.overlaps.forEach((item, k) => {
      if (!this.overlaps[k] || state.overlapHidden(item)) return;
      this.mesh(at, this.overlaps[k], state.shown[item.body]);
      gl.uniform3fv(at.colour, state.theme.overlap);
      gl.bindVertexArray(this.overlaps[k].solid);
      gl.drawElements(gl.TRIANGLES, this.overlaps[k].triangles, gl.UNSIGNED_INT, 0);
    });
    gl.disable(gl.POLYGON_OFFSET_FILL);
  }

  patches(state, numbered = false) {
    const { gl, scene } = this;
    const at = this.use("disc");
    const { low, size } = scene.patches;
    gl.uniform3fv(at.low, low.slice(0, 3));
    gl.uniform3fv(at.size, size.slice(0, 3));
    gl.uniform1f(at.largest, size[6]);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(-1, -4);
    scene.patches.items.forEach((item, k) => {
      if (state.patchHidden(item)) return;
      gl.uniformMatrix4fv(at.model, false, state.shown[item.body]);
      gl.uniform4f(at.colour, ...(numbered ? colourOfNumber(this.firstPatch + k) : [...state.theme.fits[item.fit], 1]));
      this.discs.draw(item.start, item.count);
    });
    gl.disable(gl.POLYGON_OFFSET_FILL);
  }

  strokes(state, strength = 1, numbered = false) {
    const { gl, scene } = this;
    const at = this.use("stroke");
    gl.uniform2f(at.screen, this.canvas.width / 2, this.canvas.height / 2);
    scene.joints.forEach((joint, k) => {
      if (state.jointHidden(k)) return;
      const chosen = state.joint === k || state.finding >= 0;
      gl.uniform1f(at.width, (numbered ? 5 : chosen ? 1.9 : 1.1) * this.ratio);
      gl.uniformMatrix4fv(at.model, false, state.shown[joint.bodies[0]]);
      const colour = numbered ? colourOfNumber(this.firstJoint + k) : [...(state.finding >= 0 ? state.theme.overlap : chosen ? state.theme.chosen : state.theme.sign), strength];
      gl.uniform4f(at.colour, ...colour);
      this.signs.draw(...this.ranges[k]);
    });
  }

  // What lies under a point of the canvas (CSS pixels): {part}, {joint} or {patch} with its number, or null.
  pick(state, x, y) {
    const { gl, scene } = this;
    if (this.stale) {
      this.target.begin(this.canvas.width, this.canvas.height);
      this.begin(state.camera, [0, 0, 0]);
      const at = this.use("edge");
      scene.parts.forEach((part, k) => {
        if (part.mesh < 0 || state.look(k) === "hidden") return;
        if (state.look(k) === "ghost" && state.layers.contacts) return;
        const buffers = this.meshes[part.mesh];
        this.mesh(at, buffers, state.models[k]);
        gl.uniform4f(at.colour, ...colourOfNumber(k + 1));
        gl.bindVertexArray(buffers.solid);
        gl.drawElements(gl.TRIANGLES, buffers.triangles, gl.UNSIGNED_INT, 0);
      });
      if (state.layers.contacts) this.patches(state, true);
      if (state.layers.joints) {
        gl.clear(gl.DEPTH_BUFFER_BIT);
        this.strokes(state, 1, true);
      }
      gl.bindVertexArray(null);
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      this.stale = false;
    }
    const number = this.target.read(Math.round(x * this.ratio), this.canvas.height - 1 - Math.round(y * this.ratio));
    if (number === 0) return null;
    if (number < this.firstJoint) return { part: number - 1 };
    if (number < this.firstPatch) return { joint: number - this.firstJoint };
    return { patch: number - this.firstPatch };
  }
}

const colourOfNumber = (n) => [(n & 255) / 255, ((n >> 8) & 255) / 255, ((n >> 16) & 255) / 255, 1];

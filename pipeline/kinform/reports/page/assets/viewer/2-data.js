// Unpacks the scene: JSON with the names, and one deflated blob that holds the numbers.
// Layout of the blob: see packing.py. Columns are differences, triangles are distances from the highest vertex.

async function unpack() {
  const scene = JSON.parse(document.getElementById("scene").textContent);
  const packed = atob(document.getElementById("blob").textContent.trim());
  const bytes = new Uint8Array(packed.length);
  for (let k = 0; k < packed.length; k++) bytes[k] = packed.charCodeAt(k);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return { scene, blob: new Uint8Array(await new Response(stream).arrayBuffer()) };
}

// (rows, columns) of 16-bit numbers, row by row.
function columnsOf(blob, offset, rows, columns) {
  const out = new Uint16Array(rows * columns);
  const high = offset + rows * columns;
  for (let c = 0; c < columns; c++) {
    let value = 0;
    for (let r = 0; r < rows; r++) {
      const k = c * rows + r;
      value = (value + blob[offset + k] + (blob[high + k] << 8)) & 65535;
      out[r * columns + c] = value;
    }
  }
  return out;
}

function trianglesOf(blob, offset, count) {
  const out = new Uint32Array(3 * count);
  const middle = offset + 3 * count;
  const high = middle + 3 * count;
  let highest = 0;
  for (let k = 0; k < out.length; k++) {
    const back = blob[offset + k] | (blob[middle + k] << 8) | (blob[high + k] << 16);
    out[k] = highest - back;
    if (back === 0) highest++;
  }
  return out;
}

function linesOf(blob, offset, count) {
  const halves = columnsOf(blob, offset, count, 4);
  const out = new Uint32Array(2 * count);
  for (let k = 0; k < count; k++) {
    out[2 * k] = halves[4 * k] | (halves[4 * k + 2] << 16);
    out[2 * k + 1] = halves[4 * k + 1] | (halves[4 * k + 3] << 16);
  }
  return out;
}

// Unit normals of the vertices from the facets around them, as signed bytes. Places are in steps of the box.
function normalsOf(places, triangles, size) {
  const sum = new Float32Array(places.length);
  const [sx, sy, sz] = size;
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    const ux = (places[b] - places[a]) * sx, uy = (places[b + 1] - places[a + 1]) * sy, uz = (places[b + 2] - places[a + 2]) * sz;
    const vx = (places[c] - places[a]) * sx, vy = (places[c + 1] - places[a + 1]) * sy, vz = (places[c + 2] - places[a + 2]) * sz;
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    sum[a] += nx; sum[a + 1] += ny; sum[a + 2] += nz;
    sum[b] += nx; sum[b + 1] += ny; sum[b + 2] += nz;
    sum[c] += nx; sum[c + 1] += ny; sum[c + 2] += nz;
  }
  const out = new Int8Array((4 * places.length) / 3);
  for (let v = 0, o = 0; v < sum.length; v += 3, o += 4) {
    const length = Math.hypot(sum[v], sum[v + 1], sum[v + 2]) || 1;
    out[o] = Math.round((127 * sum[v]) / length);
    out[o + 1] = Math.round((127 * sum[v + 1]) / length);
    out[o + 2] = Math.round((127 * sum[v + 2]) / length);
  }
  return out;
}

// One mesh, ready for buffers.
function meshOf(blob, entry) {
  const places = columnsOf(blob, entry.places, entry.vertices, 3);
  const triangles = trianglesOf(blob, entry.triangles, entry.faces);
  return { places, triangles, normals: normalsOf(places, triangles, entry.size), lines: linesOf(blob, entry.edges, entry.lines), low: entry.low, size: entry.size };
}

// Poses of all bodies at a share of the way between two frames.
class Motion {
  constructor(blob, entry, bodies) {
    Object.assign(this, entry);
    this.count = bodies;
    this.moving = entry.bodies;
    this.table = columnsOf(blob, entry.offset, entry.frames, 7 * entry.bodies.length);
  }

  get start() { return this.time[0]; }
  get end() { return this.time[this.time.length - 1]; }

  value(frame, body, k) {
    return this.low[k] + (this.table[(frame * this.moving.length + body) * 7 + k] / 65535) * this.size[k];
  }

  at(time) {
    let frame = 0, beyond = this.time.length - 1;
    while (beyond - frame > 1) {
      const middle = (frame + beyond) >> 1;
      if (this.time[middle] <= time) frame = middle; else beyond = middle;
    }
    const share = Math.min(1, Math.max(0, (time - this.time[frame]) / (this.time[beyond] - this.time[frame] || 1)));
    const poses = Array.from({ length: this.count }, M.identity);
    this.moving.forEach((body, k) => {
      const mixed = [0, 1, 2, 3, 4, 5, 6].map((i) => this.value(frame, k, i) * (1 - share) + this.value(beyond, k, i) * share);
      const q = mixed.slice(3);
      const length = Math.hypot(...q) || 1;
      poses[body] = M.pose(mixed.slice(0, 3), q.map((x) => x / length));
    });
    return poses;
  }
}

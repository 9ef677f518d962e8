// The signs of joints: an axis with an arc for a turn, arrows for a slide, rings for a ball, a helix for a screw.
// Each is a list of strokes [from, to] in the world at the pose of the meshes.

function arrowHead(strokes, tip, direction, size) {
  const [u, v] = V.across(direction);
  const root = V.sub(tip, V.scale(direction, size));
  for (const side of [u, V.scale(u, -1), v, V.scale(v, -1)]) strokes.push([V.add(root, V.scale(side, 0.42 * size)), tip]);
}

function arc(strokes, centre, axis, radius, from, to, rise, arrow) {
  const [u, v] = V.across(axis);
  const steps = Math.max(8, Math.ceil(Math.abs(to - from) * 9));
  const at = (s) => {
    const angle = from + (to - from) * s;
    const out = V.add(V.scale(u, radius * Math.cos(angle)), V.scale(v, radius * Math.sin(angle)));
    return V.add(V.add(centre, out), V.scale(axis, rise * (s - 0.5)));
  };
  for (let k = 0; k < steps; k++) strokes.push([at(k / steps), at((k + 1) / steps)]);
  if (arrow) arrowHead(strokes, at(1), V.unit(V.sub(at(1), at(1 - 0.6 / steps))), 0.32 * radius);
}

function turning(strokes, point, axis, size) {
  const reach = V.scale(axis, 1.5 * size);
  strokes.push([V.sub(point, reach), V.add(point, reach)]);
  arc(strokes, V.add(point, V.scale(axis, 1.15 * size)), axis, 0.5 * size, 0.3, 5.3, 0, true);
}

function sliding(strokes, point, axis, size) {
  const reach = V.scale(axis, 1.5 * size);
  strokes.push([V.sub(point, reach), V.add(point, reach)]);
  arrowHead(strokes, V.add(point, reach), axis, 0.34 * size);
  arrowHead(strokes, V.sub(point, reach), V.scale(axis, -1), 0.34 * size);
}

const SIGNS = {
  revolute: (s, j) => turning(s, j.point, j.axis, j.size),
  prismatic: (s, j) => sliding(s, j.point, j.axis, j.size),
  cylindrical: (s, j) => {
    sliding(s, j.point, j.axis, j.size);
    arc(s, j.point, j.axis, 0.5 * j.size, 0.3, 5.3, 0, true);
  },
  screw: (s, j) => {
    const reach = V.scale(j.axis, 1.5 * j.size);
    s.push([V.sub(j.point, reach), V.add(j.point, reach)]);
    const turns = 6 * Math.PI * (j.right ? 1 : -1);
    arc(s, j.point, j.axis, 0.45 * j.size, 0, turns, 1.8 * j.size, true);
  },
  planar: (s, j) => {
    const [u, v] = V.across(j.axis);
    sliding(s, j.point, u, 0.8 * j.size);
    sliding(s, j.point, v, 0.8 * j.size);
    arc(s, j.point, j.axis, 0.5 * j.size, 0.3, 5.3, 0, true);
  },
  spherical: (s, j) => {
    for (const axis of [[1, 0, 0], [0, 1, 0], [0, 0, 1]]) arc(s, j.point, axis, 0.8 * j.size, 0, 2 * Math.PI, 0, false);
  },
  universal: (s, j) => {
    turning(s, j.point, j.axis, j.size);
    turning(s, j.point, j.axis2, j.size);
  },
  fixed: (s, j) => {
    const h = 0.3 * j.size;
    for (const d of [[h, h, h], [h, -h, h], [-h, h, h], [-h, -h, h]]) s.push([V.sub(j.point, d), V.add(j.point, d)]);
  },
  general: (s, j) => {
    for (const twist of j.twists) {
      const spin = twist.slice(0, 3), slide = twist.slice(3);
      const rate = V.length(spin);
      if (rate > 1e-9) {
        const axis = V.scale(spin, 1 / rate);
        // the point of the screw's axis that is nearest to the joint
        const foot = V.scale(V.cross(spin, slide), 1 / (rate * rate));
        const along = V.dot(V.sub(j.point, foot), axis);
        turning(s, V.add(foot, V.scale(axis, along)), axis, 0.8 * j.size);
      } else if (V.length(slide) > 1e-12) sliding(s, j.point, V.unit(slide), 0.8 * j.size);
    }
    if (!s.length) SIGNS.fixed(s, j);
  },
};

// All strokes of all joints as one buffer, and where each joint's begin.
function signsOf(joints) {
  const strokes = [], ranges = [];
  for (const joint of joints) {
    const own = [];
    const drawable = joint.axis || ["spherical", "fixed", "general"].includes(joint.type);
    (drawable ? SIGNS[joint.type] ?? SIGNS.fixed : SIGNS.fixed)(own, joint);
    ranges.push([strokes.length, own.length]);
    strokes.push(...own);
  }
  return { data: new Float32Array(strokes.flat(2)), ranges };
}

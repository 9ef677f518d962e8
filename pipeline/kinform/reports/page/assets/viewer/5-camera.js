// An eye that goes around what it looks at; z stays up.

class Camera {
  constructor(low, high, look) {
    this.home = { low, high, look };
    // whether the user has come nearer or gone aside since all was last brought into view
    this.own = false;
    this.whole = Math.max(V.length(V.sub(high, low)), 1e-9);
    this.angle = (28 * Math.PI) / 180;
    this.aspect = 1.4;
    this.target = V.scale(V.add(low, high), 0.5);
    this.distance = this.whole / Math.sin(this.angle / 2) / 2;
    this.first();
  }

  first() {
    this.turn = this.home.look.turn;
    this.rise = this.home.look.rise;
  }

  get wide() { return this.aspect < 1 ? 2 * Math.atan(Math.tan(this.angle / 2) / this.aspect) : this.angle; }

  // Come as near as lets all points be seen.
  fit(points, margin = 1.12) {
    this.own = false;
    const view = this.view();
    const axes = [[view[0], view[4], view[8]], [view[1], view[5], view[9]], [view[2], view[6], view[10]]];
    const seen = points.map((p) => axes.map((axis) => V.dot(axis, p)));
    const low = [0, 1, 2].map((k) => Math.min(...seen.map((p) => p[k])));
    const high = [0, 1, 2].map((k) => Math.max(...seen.map((p) => p[k])));
    const middle = [0, 1, 2].map((k) => (low[k] + high[k]) / 2);
    this.target = axes.reduce((sum, axis, k) => V.add(sum, V.scale(axis, middle[k])), [0, 0, 0]);
    const up = Math.tan(this.wide / 2), across = up * this.aspect;
    const needed = seen.map((p) => Math.max(Math.abs(p[0] - middle[0]) / across, Math.abs(p[1] - middle[1]) / up) * margin + p[2] - middle[2]);
    this.distance = Math.max(...needed, this.whole * 0.01);
  }

  // Whether all points are in the picture.
  sees(points) {
    const see = M.multiply(this.projection(), this.view());
    return points.every((p) => {
      const [x, y, w] = [0, 1, 3].map((r) => see[r] * p[0] + see[4 + r] * p[1] + see[8 + r] * p[2] + see[12 + r]);
      return w > 0 && Math.abs(x) <= w && Math.abs(y) <= w;
    });
  }

  get eye() {
    const c = Math.cos(this.rise);
    return V.add(this.target, V.scale([c * Math.cos(this.turn), c * Math.sin(this.turn), Math.sin(this.rise)], this.distance));
  }

  view() { return M.look(this.eye, this.target, [0, 0, 1]); }

  projection() {
    const middle = V.scale(V.add(this.home.low, this.home.high), 0.5);
    const reach = 2.2 * this.whole + V.length(V.sub(this.target, middle));
    const near = Math.max(this.distance - reach, this.distance * 0.02);
    return M.perspective(this.wide, this.aspect, near, this.distance + reach);
  }

  orbit(dx, dy) {
    this.turn -= dx;
    this.rise = Math.min(1.55, Math.max(-1.55, this.rise + dy));
  }

  // Shares of the height of the picture.
  pan(dx, dy) {
    this.own = true;
    const view = this.view();
    const reach = 2 * this.distance * Math.tan(this.angle / 2);
    const right = [view[0], view[4], view[8]], up = [view[1], view[5], view[9]];
    this.target = V.add(this.target, V.add(V.scale(right, -dx * reach), V.scale(up, dy * reach)));
  }

  zoom(factor) {
    this.own = true;
    this.distance = Math.max(this.whole * 0.01, this.distance * factor);
  }

  from(direction) {
    [this.turn, this.rise] = { front: [-Math.PI / 2, 0], right: [0, 0], top: [-Math.PI / 2, 1.55] }[direction];
  }
}

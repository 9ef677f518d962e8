// An eye that goes around what it looks at; z stays up.

class Camera {
  constructor(low, high) {
    this.home = { low, high };
    this.angle = (28 * Math.PI) / 180;
    this.reset();
  }

  reset() {
    this.turn = -0.95;
    this.rise = 0.42;
    this.fit(this.home.low, this.home.high);
  }

  fit(low, high) {
    this.target = V.scale(V.add(low, high), 0.5);
    this.radius = Math.max(V.length(V.sub(high, low)) / 2, 1e-9);
    this.distance = (1.06 * this.radius) / Math.sin(this.angle / 2);
  }

  get eye() {
    const c = Math.cos(this.rise);
    return V.add(this.target, V.scale([c * Math.cos(this.turn), c * Math.sin(this.turn), Math.sin(this.rise)], this.distance));
  }

  view() { return M.look(this.eye, this.target, [0, 0, 1]); }

  projection(aspect) {
    const whole = V.length(V.sub(this.home.high, this.home.low)) * 2 + V.length(V.sub(this.target, V.scale(V.add(this.home.low, this.home.high), 0.5)));
    const near = Math.max(this.distance - whole, this.distance * 0.02);
    const wide = aspect < 1 ? 2 * Math.atan(Math.tan(this.angle / 2) / aspect) : this.angle;
    return M.perspective(wide, aspect, near, this.distance + whole);
  }

  orbit(dx, dy) {
    this.turn -= dx;
    this.rise = Math.min(1.55, Math.max(-1.55, this.rise + dy));
  }

  // Shares of the height of the picture.
  pan(dx, dy) {
    const view = this.view();
    const reach = 2 * this.distance * Math.tan(this.angle / 2);
    const right = [view[0], view[4], view[8]], up = [view[1], view[5], view[9]];
    this.target = V.add(this.target, V.add(V.scale(right, -dx * reach), V.scale(up, dy * reach)));
  }

  zoom(factor) {
    const least = this.home ? V.length(V.sub(this.home.high, this.home.low)) * 0.01 : 0;
    this.distance = Math.max(least, this.distance * factor);
  }

  from(direction) {
    [this.turn, this.rise] = { front: [-Math.PI / 2, 0], right: [0, 0], top: [-Math.PI / 2, 1.55] }[direction];
  }
}

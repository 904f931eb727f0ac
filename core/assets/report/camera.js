// Orthographic camera: a point of the part, the scale, and two unit vectors that span the screen.

const PLANES = { xy: ["X", "Y"], xz: ["X", "Z"], yz: ["Y", "Z"] };
const TAU = 2 * Math.PI;

class Camera {
  constructor(low, high, view) {
    this.low = low;
    this.high = high;
    this.setView(view);
  }

  setView(view) {
    this.view = view;
    this.fitted = false;
    const unit = { X: [1, 0, 0], Y: [0, 1, 0], Z: [0, 0, 1] };
    if (view === "3d") {
      this.yaw = -0.65;
      this.pitch = 0.55;
      this.turn(0, 0);
    } else {
      [this.right, this.up] = PLANES[view].map((a) => unit[a]);
    }
  }

  // Rotates about the vertical and tips towards the viewer, both in radians.
  turn(yaw, pitch) {
    this.yaw = (this.yaw + yaw) % TAU;
    this.pitch = Math.min(TAU / 4, Math.max(-TAU / 4, this.pitch + pitch));
    const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    this.right = [cy, -sy, 0];
    this.up = [sy * sp, cy * sp, cp];
  }

  resize(width, height) {
    this.width = width;
    this.height = height;
    if (!this.fitted) this.fit();
  }

  // Shows the whole part with a margin for the enlarged deviation.
  fit() {
    let [x, y] = [0, 0];
    this.center = this.low.map((v, k) => (v + this.high[k]) / 2);
    for (let corner = 0; corner < 8; corner++) {
      const p = this.low.map((v, k) => ((corner >> k) & 1 ? this.high[k] : v) - this.center[k]);
      x = Math.max(x, Math.abs(dot(p, this.right)));
      y = Math.max(y, Math.abs(dot(p, this.up)));
    }
    const room = 0.8;
    this.scale = Math.min(room * this.width / 2 / Math.max(x, 1e-6), room * this.height / 2 / Math.max(y, 1e-6));
    this.fitted = true;
  }

  x(px, py, pz) {
    const [c, r] = [this.center, this.right];
    return this.width / 2 + this.scale * ((px - c[0]) * r[0] + (py - c[1]) * r[1] + (pz - c[2]) * r[2]);
  }

  y(px, py, pz) {
    const [c, u] = [this.center, this.up];
    return this.height / 2 - this.scale * ((px - c[0]) * u[0] + (py - c[1]) * u[1] + (pz - c[2]) * u[2]);
  }

  pan(dx, dy) {
    this.center = this.center.map((c, k) => c - (dx * this.right[k] - dy * this.up[k]) / this.scale);
  }

  // Zooms about a point of the screen.
  zoom(factor, x, y) {
    const scale = Math.min(1e6, Math.max(1e-3, this.scale * factor));
    const [dx, dy] = [x - this.width / 2, y - this.height / 2];
    this.pan(-dx, -dy);
    this.scale = scale;
    this.pan(dx, dy);
  }
}

function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

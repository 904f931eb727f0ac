// Orthographic camera: a point of the part, the scale, and two unit vectors that span the screen.

const PLANES = { xy: ["X", "Y"], xz: ["X", "Z"], yz: ["Y", "Z"] };
const TAU = 2 * Math.PI;

class Camera {
  // `points`: columns of the points that the whole part has.
  constructor(points, view) {
    this.points = points;
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
    const across = this.range(this.right), upwards = this.range(this.up);
    const [x, y] = [across, upwards].map(([low, high]) => (low + high) / 2);
    this.center = this.right.map((r, k) => x * r + y * this.up[k]);
    const [width, height] = [across, upwards].map(([low, high]) => Math.max(high - low, 1e-6));
    const margin = Math.min(120, 0.24 * Math.min(this.width, this.height));
    this.scale = Math.min((this.width - margin) / width, (this.height - margin) / height);
    this.fitted = true;
  }

  // Least and largest component of the points along a unit vector.
  range(direction) {
    const [x, y, z] = this.points;
    let [low, high] = [Infinity, -Infinity];
    for (let i = 0; i < x.length; i++) {
      const component = x[i] * direction[0] + y[i] * direction[1] + z[i] * direction[2];
      low = Math.min(low, component);
      high = Math.max(high, component);
    }
    return [low, high];
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

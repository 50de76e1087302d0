// The camera as mouse and keys move it. Vectors are arrays of three numbers, in metres.

const add = (a, b, s = 1) => a.map((v, i) => v + s * b[i]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (v) => Math.sqrt(dot(v, v));
const unit = (v) => v.map((c) => c / length(v));

// A vector turned about a unit axis (Rodrigues).
function turned(v, axis, angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const along = (1 - c) * dot(axis, v);
  const side = cross(axis, v);
  return v.map((component, i) => c * component + s * side[i] + along * axis[i]);
}

export class Camera {
  constructor() {
    this.pivot = null;
  }

  // The view, and what the scene calls up: orbits turn about that.
  take(view, worldUp) {
    this.view = structuredClone(view);
    this.worldUp = worldUp;
  }

  // To the right of somebody who stands at the camera.
  get side() {
    return cross(this.view.forward, this.view.up);
  }

  // 1, or −1 where left and right are exchanged in the picture.
  get sign() {
    return this.view.mirrored ? -1 : 1;
  }

  // To the right in the picture.
  get right() {
    return this.side.map((c) => c * this.sign);
  }

  // What is turned about: what is under the cursor, else a point in front of the camera.
  around(point) {
    if (point) this.pivot = point;
  }

  get centre() {
    const { position_m, forward, focus_distance_m } = this.view;
    return this.pivot ?? add(position_m, forward, focus_distance_m ?? 1);
  }

  get depth() {
    return Math.max(1e-6, Math.abs(dot(add(this.centre, this.view.position_m, -1), this.view.forward)));
  }

  // Turns by angles about the centre: to the right, and up. It stops short of looking along the axis.
  orbit(yaw, pitch) {
    const { position_m, forward, up } = this.view;
    const centre = this.centre;
    const height = Math.asin(Math.min(1, Math.max(-1, -dot(forward, this.worldUp))));
    const limit = 0.49 * Math.PI;
    const bounded = Math.min(limit, Math.max(-limit, height + pitch)) - height;
    const about = (v) => turned(turned(v, this.side, -bounded), this.worldUp, -yaw * this.sign);
    const from = about(add(position_m, centre, -1));
    const newForward = unit(about(forward));
    // Upright again, so that small errors do not add up.
    const side = unit(cross(newForward, about(up)));
    this.view.position_m = add(centre, from);
    this.view.forward = newForward;
    this.view.up = cross(side, newForward);
  }

  // Moves across the picture so that what is at the depth of the centre follows the mouse: by parts of the picture's height.
  pan(right, up) {
    const height = this.view.height_m ?? 2 * this.depth * Math.tan(0.5 * this.view.vertical_fov_rad);
    const move = add(add([0, 0, 0], this.right, right * height), this.view.up, up * height);
    this.view.position_m = add(this.view.position_m, move);
    if (this.pivot) this.pivot = add(this.pivot, move);
  }

  // Comes closer to the centre: factor 0.5 halves the distance.
  dolly(factor) {
    if (this.view.height_m) {
      this.view.height_m *= factor;
      return;
    }
    const away = add(this.view.position_m, this.centre, -1);
    this.view.position_m = add(this.centre, away, factor);
    if (this.view.focus_distance_m) this.view.focus_distance_m = Math.max(1e-6, this.view.focus_distance_m + (factor - 1) * this.depth / factor);
  }

  // Moves in the view's own directions, in units of the distance to the centre.
  walk(right, up, forward) {
    const step = this.depth;
    let move = add([0, 0, 0], this.right, right * step);
    move = add(move, this.view.up, up * step);
    move = add(move, this.view.forward, forward * step);
    this.view.position_m = add(this.view.position_m, move);
  }

  // Brings a depth into focus, where there is a lens.
  focus(depth) {
    if (!this.view.lens_radius_m || !(depth > 0)) return false;
    this.view.focus_distance_m = depth;
    return true;
  }
}

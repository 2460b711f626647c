// A camera that turns around a target, by mouse, touch and keyboard.

import { cross, minus, plus, unit } from "./matrices.js";

const TURN = 0.008, STEP = 0.1; // radians a pixel, and a key
const ZOOM = 1.15; // the factor of a key, and of 100 pixels of a wheel
const NEAREST = 0.15, FARTHEST = 4; // metres
const LOWEST = 0.03, HIGHEST = 1.55; // radians above the horizon

export class Orbit {
  constructor(canvas, view, changed) {
    Object.assign(this, { canvas, view, changed, pointers: new Map() });
    this.reset();
    canvas.addEventListener("pointerdown", (event) => this.press(event));
    canvas.addEventListener("pointermove", (event) => this.drag(event));
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => this.pointers.delete(event.pointerId));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  get eye() {
    const level = Math.cos(this.height) * this.distance;
    return plus(this.target, [level * Math.cos(this.heading), level * Math.sin(this.heading), Math.sin(this.height) * this.distance]);
  }

  reset() {
    const [x, y, z] = minus(this.view.eye, this.view.target);
    this.target = [...this.view.target];
    this.distance = Math.hypot(x, y, z);
    this.heading = Math.atan2(y, x);
    this.height = Math.asin(z / this.distance);
    this.changed();
  }

  turn(right, up) {
    this.heading -= right;
    this.height = Math.min(HIGHEST, Math.max(LOWEST, this.height + up));
    this.changed();
  }

  zoom(factor) {
    this.distance = Math.min(FARTHEST, Math.max(NEAREST, this.distance * factor));
    this.changed();
  }

  // Move the target along the image, by shares of the image's height.
  pan(right, up) {
    const back = unit(minus(this.eye, this.target)), side = unit(cross([0, 0, 1], back)), above = cross(back, side);
    const size = 2 * this.distance * Math.tan(this.view.angle / 2);
    this.target = plus(plus(this.target, side, right * size), above, up * size).map((each) => Math.min(2, Math.max(-2, each)));
    this.changed();
  }

  press(event) {
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    event.preventDefault();
  }

  drag(event) {
    const before = this.pointers.get(event.pointerId);
    if (before === undefined) return;
    const now = [event.clientX, event.clientY], [x, y] = minus(now, before), share = 1 / this.canvas.clientHeight;
    if (this.pointers.size === 2) {
      const [other] = [...this.pointers].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
      this.zoom(Math.hypot(...minus(before, other)) / Math.max(1, Math.hypot(...minus(now, other))));
      this.pan(-x * share / 2, y * share / 2);
    } else if (event.buttons & 6 || event.shiftKey) this.pan(-x * share, y * share);
    else this.turn(x * TURN, y * TURN);
    this.pointers.set(event.pointerId, now);
  }

  // The wheel scrolls the page until the view has the focus; pinching a touchpad zooms at once.
  wheel(event) {
    if (!event.ctrlKey && document.activeElement !== this.canvas) return;
    event.preventDefault();
    this.zoom(ZOOM ** (event.deltaY * (event.deltaMode === 1 ? 0.3 : 0.01)));
  }

  key(event) {
    const [right, up] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key] ?? [0, 0];
    if (event.altKey || event.ctrlKey || event.metaKey) return;
    if (right || up) event.shiftKey ? this.pan(right * STEP / 2, up * STEP / 2) : this.turn(-right * STEP, up * STEP);
    else if (event.key === "+" || event.key === "=") this.zoom(1 / ZOOM);
    else if (event.key === "-") this.zoom(ZOOM);
    else if (event.key === "Home") this.reset();
    else return;
    event.preventDefault();
  }
}

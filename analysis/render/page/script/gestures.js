// SPDX-License-Identifier: BSD-3-Clause
// Mouse, touch and keys over a chart, told to its `handler` as
//   point({x, y})           the pointer rests here; point(null): it left
//   select(from, to)        a box was drawn from corner to corner; box(from, to) while it is drawn
//   zoom({x, y}, factor)    nearer or farther about a place
//   move(dx, dy)            the picture follows the hand
//   reset()                 everything is wanted again
// in pixels of `surface`. Dragging draws a box, or moves the picture: with Shift, and where the
// surface is for that.

const LEAST_BOX = 6;

/** How to do something with the mouse and with fingers, as far as this machine has them. */
function handsSay(mouse, fingers) {
  const has = (query) => matchMedia(query).matches;
  if (has("(pointer: coarse)")) return fingers;
  return has("(any-pointer: coarse)") ? `${mouse} On a touch screen: ${fingers}` : mouse;
}

class Gestures {
  constructor(surface, handler, drag = "box") {
    this.surface = surface;
    this.handler = handler;
    this.drag = drag;
    this.fingers = new Map();
    this.corner = null;
    const listen = (type, call, options) =>
      surface.addEventListener(type, call.bind(this), options);
    listen("pointerdown", this.down);
    listen("pointermove", this.moved);
    listen("pointerup", this.up);
    listen("pointercancel", this.cancel);
    listen("pointerleave", this.leave);
    listen("wheel", this.wheel, {passive: false});
    listen("dblclick", this.doubled);
    listen("keydown", this.key);
  }

  place(event) {
    const box = this.surface.getBoundingClientRect();
    return {x: event.clientX - box.left, y: event.clientY - box.top};
  }

  down(event) {
    if (event.pointerType === "touch") {
      this.fingers.set(event.pointerId, this.place(event));
      this.handler.point(this.fingers.size === 1 ? this.place(event) : null);
    } else if (event.button === 0) {
      this.surface.setPointerCapture(event.pointerId);
      this.corner = this.place(event);
      this.last = this.corner;
      this.moving = event.shiftKey || this.drag === "move";
    }
  }

  moved(event) {
    const here = this.place(event);
    if (this.fingers.has(event.pointerId)) {
      this.finger(event.pointerId, here);
    } else if (this.corner && this.moving) {
      this.handler.move(here.x - this.last.x, here.y - this.last.y);
    } else if (this.corner) {
      this.handler.box(this.corner, here);
    } else {
      this.handler.point(here);
    }
    this.last = here;
  }

  /** One finger reads values, two zoom and move. */
  finger(id, here) {
    const before = [...this.fingers.values()];
    this.fingers.set(id, here);
    if (this.fingers.size === 1) {
      this.handler.point(here);
      return;
    }
    const after = [...this.fingers.values()];
    const middle = ([a, b]) => ({x: (a.x + b.x) / 2, y: (a.y + b.y) / 2});
    const apart = ([a, b]) => Math.max(Math.hypot(a.x - b.x, a.y - b.y), 10);
    this.handler.zoom(middle(before), apart(before) / apart(after));
    this.handler.move(middle(after).x - middle(before).x, middle(after).y - middle(before).y);
  }

  up(event) {
    const here = this.place(event);
    const corner = this.corner;
    this.cancel(event);
    if (!corner || this.moving) return;
    const drawn = Math.max(Math.abs(here.x - corner.x), Math.abs(here.y - corner.y));
    if (drawn >= LEAST_BOX) this.handler.select(corner, here);
  }

  cancel(event) {
    this.fingers.delete(event.pointerId);
    if (this.corner && !this.moving) this.handler.box(null);
    this.corner = null;
  }

  leave(event) {
    if (event.pointerType !== "touch") this.handler.point(null);
  }

  /** A wheel scrolls the page until the chart was clicked, or with Ctrl, which is a pinch too. */
  wheel(event) {
    const wanted = event.ctrlKey || event.metaKey || document.activeElement === this.surface;
    if (!wanted) return;
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 20 : 1;
    this.handler.zoom(this.place(event), Math.exp(clamp(event.deltaY * lines, -200, 200) / 400));
  }

  doubled(event) {
    event.preventDefault();
    this.handler.reset();
  }

  key(event) {
    const box = this.surface.getBoundingClientRect();
    const middle = {x: box.width / 2, y: box.height / 2};
    const actions = {
      ArrowLeft: () => this.handler.move(box.width / 10, 0),
      ArrowRight: () => this.handler.move(-box.width / 10, 0),
      "+": () => this.handler.zoom(middle, 0.7),
      "-": () => this.handler.zoom(middle, 1 / 0.7),
      Escape: () => this.handler.reset(),
    };
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (this.drag === "move" || !(event.key in actions)) return;
    event.preventDefault();
    actions[event.key]();
  }
}

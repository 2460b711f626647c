// The player of an episode: the view, play and pause, a time line with the actions, and speeds.

import { readEpisode } from "./episode.js";
import { Orbit } from "./orbit.js";
import { Renderer } from "./renderer.js";

const SLOW = 70, PATIENCE = 3; // milliseconds of a frame, and slow frames in a row after which quality is lowered
const SPEEDS = [0.25, 0.5, 1, 2, 4];
const HINT = "Drag to turn, drag with the right button or with two fingers to move, pinch or use the wheel to zoom. In the view: arrow keys turn, with Shift they move, + and - zoom, Home resets, Space plays.";

export function hasWebGl() {
  const gl = document.createElement("canvas").getContext("webgl2");
  gl?.getExtension("WEBGL_lose_context")?.loseContext(); // browsers allow few contexts
  return gl !== null;
}

function tag(name, properties, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

// Show the player of a .glb file in an element; without WebGL 2, one line says so.
export async function showEpisode(box, buffer, { autoplay = !matchMedia("(prefers-reduced-motion)").matches } = {}) {
  if (!hasWebGl()) {
    box.replaceChildren(tag("p", { role: "alert" }, "This browser shows no 3D scenes: WebGL 2 is missing or switched off."));
    return;
  }
  const episode = readEpisode(buffer), { actions } = episode, end = episode.times.at(-1);
  let time = 0, playing = false, asked = 0, before = 0, current = -2, closed = false, slow = 0;

  const canvas = tag("canvas", { tabindex: "0", role: "application", "aria-label": "3D view of the robot that executes the task", "aria-describedby": "player-hint" });
  const now = tag("p", { class: "player-now", role: "status", "aria-live": "polite" });
  const clock = tag("span", { class: "player-clock" });
  const line = tag("input", { type: "range", min: "0", max: String(end), step: "0.01", value: "0", "aria-label": "Time", oninput: () => { pause(); seek(Number(line.value)); } });
  const play = tag("button", { type: "button", onclick: () => (playing ? pause() : start()) }, "Play");
  const speed = tag("select", {}, ...SPEEDS.map((each) => tag("option", { value: each, ...(each === 1 ? { selected: "" } : {}) }, `${each}×`)));
  const marks = actions.map(({ begin, end: last }, i) => {
    const mark = tag("span", {}, String(i + 1));
    mark.style.flexGrow = Math.max(0.01, last - begin);
    return mark;
  });
  const steps = actions.map(({ name, begin }) => tag("button", { type: "button", onclick: () => { pause(); seek(begin); } }, name));
  box.replaceChildren(tag("div", { class: "player" },
    canvas, now,
    tag("div", { class: "player-marks", "aria-hidden": "true" }, ...marks), line,
    tag("div", { class: "player-row" }, play,
      tag("button", { type: "button", onclick: () => jump(-1) }, "One action back"),
      tag("button", { type: "button", onclick: () => jump(1) }, "One action on"),
      tag("label", {}, "Speed ", speed),
      tag("button", { type: "button", onclick: () => orbit.reset() }, "Reset view"), clock),
    tag("ol", { class: "player-actions", "aria-label": "Actions" }, ...steps.map((each) => tag("li", {}, each))),
    tag("p", { class: "player-hint", id: "player-hint" }, HINT)));

  let renderer = new Renderer(canvas, episode);
  const orbit = new Orbit(canvas, episode.view, ask);
  const resized = new ResizeObserver(ask);

  function ask() {
    if (asked === 0 && !closed) asked = requestAnimationFrame(frame);
  }

  function frame(stamp) {
    asked = 0;
    if (!box.contains(canvas)) { close(); return; }
    if (playing) {
      const passed = Math.max(0, stamp - before);
      seek(Math.min(end, time + Math.min(0.25, passed / 1000) * Number(speed.value)));
      before = stamp;
      slow = passed > SLOW ? slow + 1 : 0;
      if (slow === PATIENCE) { slow = 0; renderer.lower(); }
      if (time === end) pause();
    }
    renderer.draw(time, orbit.eye, orbit.target);
    if (playing) ask();
  }

  // The number of the current action, from 0; -1 before the first one.
  const action = () => actions.findLastIndex(({ begin }) => time >= begin - 1e-4);

  function seek(to) {
    time = to;
    line.value = String(time);
    const number = action(), done = time === end;
    clock.textContent = `${time.toFixed(1)} of ${end.toFixed(1)} s`;
    line.setAttribute("aria-valuetext", `${clock.textContent}: ${actions[number]?.name ?? "before the first action"}`);
    if (current !== (done ? -3 : number)) {
      current = done ? -3 : number;
      now.textContent = done ? "The task is done." : actions[number]?.name ?? "Initial state";
      for (const list of [steps, marks]) list.forEach((each, i) => (i === number ? each.setAttribute("aria-current", "step") : each.removeAttribute("aria-current")));
    }
    ask();
  }

  function jump(by) {
    pause();
    const number = action();
    // Once an action has gone on for a while, back means its beginning.
    const back = by < 0 && number >= 0 && time - actions[number].begin > 0.3 ? number : number + by;
    seek(back >= actions.length ? end : back < 0 ? 0 : actions[back].begin);
  }

  function start() {
    if (time === end) seek(0);
    playing = true;
    play.textContent = "Pause";
    before = performance.now();
    ask();
  }

  function pause() {
    playing = false;
    play.textContent = "Play";
  }

  function close() {
    closed = true;
    cancelAnimationFrame(asked);
    resized.disconnect();
    renderer.close();
  }

  canvas.addEventListener("keydown", (event) => {
    if (event.key !== " ") return;
    event.preventDefault();
    if (playing) pause(); else start();
  });
  canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
  canvas.addEventListener("webglcontextrestored", async () => {
    renderer = new Renderer(canvas, episode);
    await renderer.load();
    ask();
  });
  await renderer.load();
  resized.observe(canvas);
  seek(0);
  if (autoplay) start();
}

// The task on the screen before physics: its verdict, its film strip, and the robot that executes it.

import { fill, find, make, sameResults } from "./elements.js";
import { hasWebGl, showEpisode } from "./player.js";
import { ask, askPicture, begin, end, Problem } from "./requests.js";

const KIND = "physics";
let query = ""; // of the page with the task; "" without one
let judged = ""; // the fields of the task and the effort that the verdict on the page belongs to
let longest = 0; // seconds
let running = null; // the timer of the progress line
let addresses = []; // of the pictures that are shown
const SCENE = ["The robot executes the task", "scene", showScene];
const FILM = ["The robot executes the task; its video is made", "film", showFilm];

// The task of a page, if it shows a whole one.
export function showPhysics(whole, state) {
  if (whole && state === query) return;
  stop();
  query = whole ? state : "";
  find("physics").hidden = !whole;
  clear();
}

export function withPhysics(vocabulary) {
  longest = vocabulary.longest_physics;
  find("validating").addEventListener("submit", (event) => {
    event.preventDefault();
    work(["Drawing the film strip", "strip", showStrip]);
  });
  find("demonstrate").addEventListener("click", () => work(hasWebGl() ? SCENE : FILM));
  find("stop").addEventListener("click", () => { stop(); find("validate").focus(); });
  addEventListener("pagehide", stop);
}

function clear() {
  addresses.forEach((each) => URL.revokeObjectURL(each));
  addresses = [];
  judged = "";
  ["progress", "verdict", "strip", "scene", "film", "physics-same"].forEach((id) => fill(id));
}

function stop() {
  if (running === null) return;
  end(KIND);
  rest("Stopped.");
}

function rest(...lines) {
  clearInterval(running);
  running = null;
  find("stop").hidden = true;
  fill("seconds");
  fill("progress", ...lines);
}

// Ask for the verdict and then for a picture, which only a feasible task has.
async function work(picture) {
  stop();
  begin(KIND);
  const begun = Date.now();
  const own = setInterval(() => fill("seconds", `${Math.round((Date.now() - begun) / 1000)} s, at most ${longest} s a step`), 1000);
  running = own;
  find("stop").hidden = false;
  const fields = { state: query, seed: find("trial-seed").value || "0", budget: find("budget").value, tier: find("tier").value };
  if (judged !== JSON.stringify(fields)) clear();
  try {
    for (const [what, view, show] of [["Judging the task", "verdict", showVerdict], picture]) {
      fill("progress", `${what} ...`);
      const found = await (view === "verdict" ? ask : askPicture)(KIND, view, fields);
      if (running !== own) return;
      if (found === null) { rest("Stopped."); return; }
      if (!(await show(found))) break;
      judged = JSON.stringify(fields);
    }
    rest();
  } catch (error) {
    if (!(error instanceof Problem)) throw error;
    if (running === own) rest(...error.lines.map((line) => make("span", { class: "bad" }, line)));
  }
}

function showVerdict(verdict) {
  const line = (name, text) => text === "" ? null : make("p", {}, `${name}: ${text}`);
  fill("verdict", make("p", { class: verdict.status === "feasible" ? "good" : "bad" }, make("strong", {}, verdict.words)),
    line("Cause", verdict.cause), line("Nearest", verdict.nearest),
    verdict.causes.length ? line("Failed attempts", verdict.causes.map(([cause, number]) => `${cause} (${number})`).join(", ")) : null,
    make("p", { class: "quiet" }, verdict.effort));
  fill("physics-same", make("details", {}, make("summary", {}, "As a command or in Python"), ...sameResults(verdict.same)));
  return verdict.status === "feasible";
}

function address(content) {
  addresses.push(URL.createObjectURL(content));
  return addresses.at(-1);
}

function showStrip(content) {
  const source = address(content);
  fill("strip", make("a", { href: source, target: "_blank", title: "Open the picture alone" },
    make("img", { src: source, alt: "Film strip: the state after each action, with the action and its effects below" })));
  return true;
}

async function showScene(content) {
  const box = make("div", {});
  fill("scene", box, make("p", { class: "row" },
    make("a", { href: address(content), download: "task.glb" }, "Download the 3D scene (.glb)"),
    make("button", { type: "button", onclick: () => work(FILM) }, "Make a video")));
  await showEpisode(box, await content.arrayBuffer());
  return true;
}

function showFilm(content) {
  const source = address(content), label = "The robot executes the task";
  fill("film", content.type.startsWith("video/")
    ? make("video", { src: source, controls: true, autoplay: !matchMedia("(prefers-reduced-motion)").matches, loop: true, playsinline: true, "aria-label": label })
    : make("img", { src: source, alt: label }),
    make("p", {}, make("a", { href: source, download: content.type.startsWith("video/") ? "task.mp4" : "task.webp" }, "Download the video")));
  return true;
}

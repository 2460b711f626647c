// The page of a task space. Its state is the query of its link; every view comes from the server.

import { choice, fill, find, grouped, make, percent, sameResults, withArrows } from "./elements.js";
import { showPhysics, withPhysics } from "./physics.js";
import { ask, begin, doing, hideProblem, Problem, showProblem } from "./requests.js";
import { withTheme } from "./theme.js";

const WATCHING = 1000; // milliseconds between two looks at what the server is doing
const TYPING = 150; // milliseconds without a key until a condition is counted
let state = new URLSearchParams(location.search);
let vocabulary = null;
let extra = []; // what led here, such as a sample

function changed(change) {
  const next = new URLSearchParams(state);
  change(next);
  return next;
}

function without(fields, name, text) {
  const kept = fields.getAll(name).filter((each) => each !== text);
  fields.delete(name);
  kept.forEach((each) => fields.append(name, each));
}

function go(query, from = []) {
  state = new URLSearchParams(query);
  extra = from;
  history.pushState(null, "", `?${state}`);
  show();
}

async function show() {
  begin("page");
  hideProblem();
  showConditions();
  const query = state.toString();
  const ended = watch();
  try {
    const plan = await ask("page", "plan", { state: query });
    if (plan === null) return;
    state = new URLSearchParams(plan.query);
    history.replaceState(null, "", `?${state}`);
    showPlan(plan);
    await Promise.all([showComparison(), plan.count === "0" ? showWhy() : showFacets()]);
  } catch (error) {
    if (find("number").textContent === "") fill("title", vocabulary.domain); // the link itself is wrong
    showProblem(error);
  } finally {
    ended();
  }
}

// Show what the server is doing while a view takes long, and why it will; return a function that ends this.
let watching = null;
function watch() {
  clearInterval(watching);
  fill("doing");
  fill("note");
  const own = setInterval(async () => {
    const { words, note } = await doing();
    if (own !== watching) return;
    fill("doing", words === "" ? "" : `At work: ${words} ...`);
    if (find("note").textContent !== note) fill("note", note);
  }, WATCHING);
  watching = own;
  return () => {
    if (own !== watching) return;
    clearInterval(own);
    watching = null;
    fill("doing");
    fill("note");
  };
}

function showPlan(plan) {
  const noun = plan.count === "1" ? plan.level : `${plan.level}s`;
  document.title = `${plan.title} - prag-asp explore`;
  fill("title", plan.title);
  const share = plan.count === plan.total ? "" : ` of ${grouped(plan.total)} (${percent(plan.share)})`;
  fill("number", `${grouped(plan.count)} ${noun}${share}` +
    (plan.count === "0" ? "" : `, from rank ${grouped(plan.first_rank)}`));
  find("length").value = plan.length;
  find("apart").checked = plan.level === "plan";
  fill("alike", plan.interchangeable.length === 0 ? "No entities are interchangeable." :
    `Interchangeable: ${plan.interchangeable.map((each) => each.join(", ")).join("; ")}.`);
  find("undo").disabled = find("restart").disabled = plan.steps.length < 2;
  fill("plan", ...plan.steps.map((step, place) => stepOf(step, place, plan.steps.length - 1)));
  showTree(plan.tree);
  showActions(plan);
  fill("same", ...sameResults([...extra, ...plan.same]));
  fill("empty");
  const whole = plan.steps.length - 1 === plan.length && plan.length > 0 && plan.count !== "0";
  showPhysics(vocabulary.has_scene && whole, state.toString());
}

function stepOf(step, place, last) {
  const head = make("div", { class: "row" }, place ? make("code", {}, step.action) : "Initial state",
    make("span", { class: "count quiet" }, `${grouped(step.count)} left`),
    place < last ? make("button", { type: "button", onclick: () => go(step.query) }, "Back to here") : null);
  if (step.true === null) return make("li", {}, head, make("p", { class: "quiet" }, "The facts are not known yet."));
  const facts = [
    ...step.true.map((fact) => step.changed.includes(fact)
      ? make("span", { class: "new" }, `+ ${fact}`) : make("span", {}, fact)),
    ...step.undone.map((fact) => make("span", { class: "gone" }, `- ${fact}`)),
  ];
  if (place === last) return make("li", {}, head, make("div", { class: "facts" }, ...facts));
  const summary = place ? [...step.changed.map((fact) => `+ ${fact}`), ...step.undone.map((fact) => `- ${fact}`)] : [];
  return make("li", {}, head, make("details", {},
    make("summary", { class: "quiet" }, summary.join("  ") || `${step.true.length} ${step.true.length === 1 ? "fact" : "facts"}`),
    make("div", { class: "facts" }, ...facts)));
}

function showTree(tree) {
  if (tree === null || tree.readings.length === 0) { fill("tree"); return; }
  const node = (part) => make("li", {}, make("code", {}, part.term),
    part.parts.length ? make("ul", {}, ...part.parts.map(node)) : null);
  const unfinished = tree.unfinished.map((term) => make("li", {}, make("code", {}, term),
    make("span", { class: "quiet" }, " (in an unfinished composite)")));
  fill("tree", make("h3", {}, `Composites (${grouped(tree.number)} ${tree.number === "1" ? "reading" : "readings"})`),
    ...tree.readings.map((reading) => make("div", { class: "tree" }, make("ul", {}, ...reading.map(node), ...unfinished))));
}

function showActions(plan) {
  const focused = find("actions").contains(document.activeElement);
  const whole = plan.steps.length - 1 === plan.length;
  find("filtering").hidden = plan.actions.length < 12;
  fill("actions", ...plan.actions.map((each) => make("li", { "data-term": each.action },
    choice(each.action, each.count, each.share, percent(each.share),
      { onclick: () => go(each.query), title: `ranks from ${grouped(each.first_rank)}` }))),
    whole && plan.count !== "0" ? make("li", {}, `The ${plan.level} is complete.`) : null);
  filter();
  if (focused) (find("actions").querySelector("button") ?? find("undo")).focus();
}

function filter() {
  const text = find("filtering").hidden ? "" : find("filter").value.trim();
  for (const item of find("actions").children) item.hidden = !(item.dataset.term ?? text).includes(text);
}

async function showWhy() {
  fill("facets");
  fill("facets-note", "Nothing is left.");
  fill("empty", make("p", {}, "Nothing is left; looking for the reason ..."));
  const why = await ask("page", "why", { state });
  if (why === null) return;
  const lines = [];
  if (why.conditions.length) {
    lines.push("These conditions exclude every task:", make("ul", {}, ...why.conditions.map((each) => make("li", {}, make("code", {}, each)))));
  }
  if (why.lines.length) {
    lines.push("These lines together exclude every task:", make("ul", {}, ...why.lines.map((each) => make("li", {}, make("code", {}, each)))));
  } else if (why.conditions.length) lines.push("They do so without any line that restricts plans.");
  else if (why.empty) lines.push("No line excludes it: the declarations of the domain alone allow none.");
  fill("empty", ...lines, ...sameResults([why.same]));
}

async function showFacets() {
  fill("facets-note", "Counting ...");
  let view;
  try {
    view = await ask("page", "facets", { state });
  } catch (error) {
    if (!(error instanceof Problem)) throw error;
    fill("facets");
    fill("facets-note", ...error.lines);
    return;
  }
  if (view === null) return;
  const open = view.facets.filter((each) => each.holding === "" || each.chosen !== view.count || each.excluded !== view.count);
  const fixed = open.filter((each) => each.holding === view.count);
  const free = open.filter((each) => each.holding !== view.count && each.chosen !== "0" &&
    !(each.holding !== "" && each.chosen === view.count && each.excluded === view.count));
  free.sort((one, other) => Number(other.share) - Number(one.share));
  fill("facets", ...free.map(facetOf));
  fill("facets-note", `${grouped(String(free.length))} open` + (fixed.length ? `; in all: ${fixed.map((each) => each.facts.join(" or ")).join(", ")}` : ""));
}

function facetOf(facet) {
  const term = facet.facts.join(" or ");
  const note = facet.holding === "" ? "not counted; choose it to count" : `known in ${percent(facet.share)}; leaves ${grouped(facet.chosen)}`;
  return make("li", {},
    choice(term, facet.holding, facet.share || "0", note, { onclick: () => add(facet.choose) }),
    make("button", { type: "button", onclick: () => add(facet.exclude), "aria-label": `not ${term}`,
      title: facet.excluded === "" ? facet.exclude : `${facet.exclude}: leaves ${grouped(facet.excluded)}` }, "not"));
}

function add(text) {
  go(changed((fields) => fields.append("where", text)));
}

function showConditions() {
  fill("conditions", ...state.getAll("where").map((text) => make("li", {}, make("code", {}, text),
    make("button", { type: "button", "aria-label": `Remove ${text}`,
      onclick: () => go(changed((fields) => without(fields, "where", text))) }, "×"))));
}

async function showComparison() {
  const box = find("comparison");
  box.hidden = !state.has("beside");
  if (box.hidden) return;
  const view = await ask("page", "compare", { state });
  if (view === null) return;
  const row = (name, number, note = "") => make("tr", {}, make("th", { scope: "row" }, name),
    make("td", {}, grouped(number)), make("td", {}, note));
  const named = (side) => side.where.join(" and ") || "no condition";
  fill("comparison", make("h3", {}, `Compared by ${view.level}s, whatever the chosen actions`),
    view.distinguishes ? make("p", { class: "quiet" }, "A condition distinguishes interchangeable entities, so plans are counted.") : null,
    make("div", { class: "scroll" }, make("table", {}, make("tbody", {},
      row(named(view.first), view.first.count, `${percent(view.first.share_of_overlap)} of it in both`),
      row(named(view.second), view.second.count, `${percent(view.second.share_of_overlap)} of it in both`),
      row("both", view.both), row("only the first", view.first.only), row("only the second", view.second.only),
      row("either", view.either), row("without conditions", view.all)))),
    ...sameResults([view.same]),
    make("button", { type: "button", onclick: () => go(changed((fields) => fields.delete("beside"))) }, "End the comparison"));
}

// Conditions that are typed or composed

function compose() {
  const keyword = find("keyword").value, name = find("name").value;
  if (keyword === "") return;
  const middle = { "has at least": " 1", "uses at least": " 1", "after 1:": "" }[keyword] ?? "";
  find("condition").value = vocabulary.whole.includes(keyword) ? keyword : `${keyword}${middle} ${name}`.trim();
  typed();
}

function showNames() {
  const keyword = find("keyword").value.split(" ")[0];
  const states = ["ends", "achieves", "starts", "after"].includes(keyword);
  const entities = ["uses", "avoids"].includes(keyword);
  const names = states ? vocabulary.facts : entities
    ? [...vocabulary.classes, ...vocabulary.entities.map(([name]) => name)] : vocabulary.names;
  fill("name", ...names.map((name) => make("option", {}, name)));
  find("name").hidden = vocabulary.whole.includes(keyword) || find("keyword").value === "";
}

let waiting = null;
function typed() {
  clearTimeout(waiting);
  begin("typing");
  const text = find("condition").value.trim();
  find("condition").removeAttribute("aria-invalid");
  if (text === "") { fill("typed"); return; }
  fill("typed", "Counting ...");
  waiting = setTimeout(async () => {
    try {
      const view = await ask("typing", "count", { state: changed((fields) => fields.append("where", text)) });
      if (view !== null) fill("typed", `leaves ${grouped(view.count)}`);
    } catch (error) {
      if (!(error instanceof Problem)) throw error;
      find("condition").setAttribute("aria-invalid", "true");
      fill("typed", make("span", { class: "bad" }, error.lines[0]));
    }
  }, TYPING);
}

function withForms() {
  find("adding").addEventListener("submit", (event) => {
    event.preventDefault();
    const text = find("condition").value.trim();
    if (text === "" || find("condition").hasAttribute("aria-invalid")) return;
    find("condition").value = "";
    typed();
    add(text);
  });
  find("beside").addEventListener("click", () => {
    const text = find("condition").value.trim();
    if (text !== "" && !find("condition").hasAttribute("aria-invalid")) go(changed((fields) => fields.append("beside", text)));
  });
  find("condition").addEventListener("input", typed);
  find("keyword").addEventListener("change", () => { showNames(); compose(); });
  find("name").addEventListener("change", compose);
  find("length").addEventListener("change", () => go(changed((fields) => {
    fields.set("length", find("length").value || "0");
    const kept = fields.getAll("do").slice(0, Number(find("length").value));
    fields.delete("do");
    kept.forEach((each) => fields.append("do", each));
  })));
  find("apart").addEventListener("change", () => go(changed((fields) => {
    fields.delete("by");
    if (find("apart").checked) fields.set("by", "plan");
  })));
  find("undo").addEventListener("click", undo);
  find("restart").addEventListener("click", () => go(changed((fields) => fields.delete("do"))));
  find("ranking").addEventListener("submit", (event) => jump(event, "rank", { rank: find("rank").value || "0" }));
  find("sampling").addEventListener("submit", (event) => {
    const seed = find("seed").value || "0";
    jump(event, "sample", { seed, weighted: find("weighted").checked ? "1" : "" });
    find("seed").value = String(Number(seed) + 1);
  });
  find("filter").addEventListener("input", filter);
  document.addEventListener("keydown", (event) => {
    if (event.key === "Backspace" && !["INPUT", "SELECT"].includes(event.target.tagName) && !find("undo").disabled) {
      event.preventDefault();
      undo();
    }
  });
}

function undo() {
  go(changed((fields) => {
    const kept = fields.getAll("do").slice(0, -1);
    fields.delete("do");
    kept.forEach((each) => fields.append("do", each));
  }));
}

async function jump(event, view, fields) {
  event.preventDefault();
  begin("page");
  hideProblem();
  try {
    const found = await ask("page", view, { state, ...fields });
    if (found !== null) go(found.query, [found.same]);
  } catch (error) {
    showProblem(error);
  }
}

async function start() {
  withTheme(find("theme"));
  withForms();
  ["actions", "facets"].forEach((id) => withArrows(find(id)));
  addEventListener("popstate", () => { state = new URLSearchParams(location.search); extra = []; show(); });
  try {
    vocabulary = await ask("start", "vocabulary");
  } catch (error) {
    showProblem(error);
    return;
  }
  withPhysics(vocabulary);
  find("weighting").hidden = !vocabulary.weighted;
  find("weighted").checked = vocabulary.weighted;
  const kinds = ["", "uses", "uses at least", "avoids", "has at least", "lacks", "ends", "achieves", "matches", ...vocabulary.whole];
  fill("keyword", ...kinds.map((kind) => make("option", { value: kind }, kind || "compose ...")));
  showNames();
  await show();
}

start();

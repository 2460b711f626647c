// The page of a program's answer sets. Its state is the query of its link; every view comes from the server.

import { choice, fill, find, grouped, make, percent, sameResults, withArrows } from "./elements.js";
import { ask, begin, hideProblem, Problem, showProblem } from "./requests.js";
import { withTheme } from "./theme.js";

const TYPING = 150; // milliseconds without a key until facets are filtered
let state = new URLSearchParams(location.search);
let undoing = "";

function changed(name, value) {
  const next = new URLSearchParams(state);
  next.delete(name);
  if (value !== "") next.set(name, value);
  return next;
}

function go(query) {
  state = new URLSearchParams(query);
  history.pushState(null, "", `?${state}`);
  show();
}

async function show() {
  begin("page");
  hideProblem();
  const patience = setTimeout(() => fill("facets-note", "Counting ..."), TYPING);
  try {
    const view = await ask("page", "models", { state });
    clearTimeout(patience);
    if (view === null) return;
    state = new URLSearchParams(view.query);
    history.replaceState(null, "", `?${state}`);
    showModels(view);
    if (view.count === "0") await showConflict();
  } catch (error) {
    clearTimeout(patience);
    showProblem(error);
  }
}

function showModels(view) {
  document.title = `${view.title} - prag-asp explore`;
  fill("title", view.title);
  const share = view.count === "0" ? "" : ` (${percent(view.share)})`;
  const of = view.share === "" || view.decisions.length === 0 ? "" : ` of ${grouped(view.total)}${share}`;
  fill("number", view.count === "" ? "The number of answer sets is not known." :
    `${grouped(view.count)} answer ${view.count === "1" ? "set" : "sets"}${of}`);
  fill("notes", view.notes.join(" "));
  if (view.problem !== "") showProblem(new Problem([view.problem]));
  undoing = view.undo;
  find("undo").disabled = find("restart").disabled = view.decisions.length === 0;
  fill("decisions", ...view.decisions.map(decisionOf));
  fill("empty");
  listAtoms("certain", view.certain);
  listAtoms("impossible", view.impossible);
  showFacets(view);
  showSample(view.sample);
  fill("same", ...sameResults(view.same));
}

function decisionOf(decision, place, all) {
  return make("li", { class: "row" }, make("code", {}, decision.literal),
    make("span", { class: "count quiet" }, decision.count === "" ? "" : `${grouped(decision.count)} left`),
    place < all.length - 1 ? make("button", { type: "button", onclick: () => go(decision.back) }, "Back to here") : null,
    make("button", { type: "button", "aria-label": `Drop ${decision.literal}`, onclick: () => go(decision.without) }, "×"));
}

function listAtoms(id, list) {
  const more = list.number - list.atoms.length;
  fill(id, ...(list.number ? list.atoms : ["-"]).map((atom) => make("span", {}, atom)),
    more > 0 ? make("span", { class: "quiet" }, `and ${more} more`) : null);
}

function showFacets(view) {
  const focused = find("facets").contains(document.activeElement);
  const hidden = view.matching - view.facets.length;
  fill("facets-note", view.count === "" ? "Choosing or excluding atoms makes counting easier." : view.open === 0 ?
    (view.count === "0" ? "Nothing is left." : "No choice is left.") : `${grouped(String(view.open))} open` +
    (view.matching < view.open ? `, ${grouped(String(view.matching))} with this text` : "") +
    (hidden > 0 ? `; the first ${view.facets.length} are listed, filter for others` : ""));
  if (document.activeElement !== find("find")) find("find").value = state.get("find") ?? "";
  find("sort").value = state.get("sort") ?? "name";
  fill("facets", ...view.facets.map(facetOf));
  if (focused) (find("facets").querySelector("button") ?? find("undo")).focus();
}

function facetOf(facet) {
  const weight = facet.significance === null ? "" : `, significance ${percent(facet.significance.share)}`;
  const note = facet.count === "" ? "" : `${percent(facet.share)}${weight}`;
  const other = facet.significance_of_excluding;
  const exact = facet.significance === null ? {} : { title: `significance ${facet.significance.exact}` };
  return make("li", {},
    choice(facet.atom, facet.count, facet.share || "0", note, { onclick: () => go(facet.choose), ...exact }),
    make("button", { type: "button", onclick: () => go(facet.exclude), "aria-label": `not ${facet.atom}`,
      title: facet.excluded === "" ? `not ${facet.atom}` :
        `leaves ${grouped(facet.excluded)}${other === null ? "" : `, significance ${other.exact}`}` }, "not"));
}

function showSample(sample) {
  if (state.has("seed")) find("seed").value = state.get("seed");
  if (sample === null) fill("sample");
  else if (sample.number === 0) fill("sample", "An answer set that shows nothing.");
  else listAtoms("sample", sample);
}

async function showConflict() {
  fill("empty", make("p", {}, "Nothing is left; looking for the reason ..."));
  const why = await ask("page", "conflict", { state });
  if (why === null) return;
  const lines = make("ul", {}, ...why.lines.map((line) => make("li", {}, make("code", {}, line))));
  const told = why.optimal ? "Answer sets agree with these choices, but none of them is optimal." :
    `These lines together exclude every answer set${why.minimal ? "" : ", and perhaps fewer do"}:`;
  fill("empty", make("p", {}, told), why.optimal ? null : lines, ...sameResults([why.same]));
}

let waiting = null;
function withForms() {
  find("find").addEventListener("input", () => {
    clearTimeout(waiting);
    waiting = setTimeout(() => go(changed("find", find("find").value.trim())), TYPING);
  });
  find("sort").addEventListener("change", () => go(changed("sort", find("sort").value)));
  find("undo").addEventListener("click", () => go(undoing));
  find("restart").addEventListener("click", () => go(changed("where", "")));
  find("sampling").addEventListener("submit", (event) => {
    event.preventDefault();
    const seed = find("seed").value || "0";
    go(changed("seed", state.get("seed") === seed ? String(Number(seed) + 1) : seed));
  });
  document.addEventListener("keydown", (event) => {
    if (event.key === "Backspace" && !["INPUT", "SELECT"].includes(event.target.tagName) && !find("undo").disabled) {
      event.preventDefault();
      go(undoing);
    }
  });
}

withTheme(find("theme"));
withForms();
withArrows(find("facets"));
addEventListener("popstate", () => { state = new URLSearchParams(location.search); show(); });
show();

// Elements of the page, made from plain values; texts are never read as HTML.

export const find = (id) => document.getElementById(id);

export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name === "width") element.style.width = value;
    else if (value !== false && value !== undefined) element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.filter((child) => child !== null));
  return element;
}

export function fill(id, ...children) {
  find(id).replaceChildren(...children.filter((child) => child !== null));
}

// Digits in groups of three; the numbers are texts because they may exceed 2^53.
export const grouped = (digits) => digits.replace(/\B(?=(\d{3})+$)/g, ",");

// A number in few characters: exact up to `EXACT` digits, and rounded down beyond them.
const EXACT = 40;
const brief = (digits) => digits.length <= EXACT ? grouped(digits) :
  `about ${digits[0]}.${digits.slice(1, 4)} x 10^${digits.length - 1}`;

// A share as per cent; the texts "0" and "1" are exact, all others are rounded.
export function percent(share) {
  const value = Number(share) * 100;
  if (share === "0" || share === "1") return share === "1" ? "100.0 %" : "0 %";
  if (value === 0) return "< 0.0001 %";
  if (value >= 99.95) return "> 99.9 %";
  return `${value >= 10 ? value.toFixed(1) : value.toPrecision(3)} %`;
}

// A button with a bar behind its text.
export function choice(term, count, share, note, properties) {
  return make("button", { type: "button", class: "choice", ...properties },
    make("span", { class: "fill", width: `${Math.min(100, Number(share) * 100)}%`, "aria-hidden": "true" }),
    make("span", { class: "term" }, term),
    make("span", { class: "count" }, count === "" ? note : `${brief(count)} · ${note}`));
}

// Arrow keys move between the buttons of a list.
export function withArrows(list) {
  list.addEventListener("keydown", (event) => {
    const move = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (move === undefined || event.target.tagName !== "BUTTON") return;
    const buttons = [...list.querySelectorAll("li:not([hidden]) button")];
    const next = buttons[buttons.indexOf(event.target) + move];
    if (next) { next.focus(); event.preventDefault(); }
  });
}

export function sameResults(list) {
  return list.flatMap((same) => [
    make("h3", { class: "quiet" }, same.what),
    same.shell ? code(same.shell) : null,
    same.python ? code(same.python) : null,
  ]).filter((element) => element !== null);
}

function code(text) {
  return make("div", {},
    make("pre", { tabindex: "0", "aria-label": "Command or Python" }, text),
    make("button", { type: "button", onclick: (event) => copy(text, event.target) }, "Copy"));
}

async function copy(text, button) {
  try {
    await navigator.clipboard.writeText(text);
    button.textContent = "Copied";
  } catch {
    button.textContent = "Select the text to copy it";
  }
}

// Requests to the server. Each has the number of its state: a newer one ends the work on older ones of this window.

import { fill, find, make } from "./elements.js";

const own = crypto.getRandomValues(new Uint32Array(2)).join("-");
const latest = new Map();
const running = new Map();

export class Problem extends Error {
  constructor(lines) {
    super(lines.join("\n"));
    this.lines = lines;
  }
}

// Show the lines of a problem on the page; any other error is a fault of ours, and goes on.
export function showProblem(error) {
  if (!(error instanceof Problem)) throw error;
  find("problem").hidden = false;
  fill("problem", ...error.lines.map((line) => make("span", {}, line)));
}

export function hideProblem() {
  find("problem").hidden = true;
}

// Begin a new state of a kind of requests, and end those of older states.
export function begin(kind) {
  running.get(kind)?.abort();
  running.set(kind, new AbortController());
  latest.set(kind, (latest.get(kind) ?? 0) + 1);
}

// Tell the server that the results of a kind of requests are no longer needed.
export function end(kind) {
  begin(kind);
  const query = new URLSearchParams({ window: `${own}/${kind}`, number: latest.get(kind) });
  fetch(`api/end?${query}`, { keepalive: true }).catch(() => null); // a server that is gone has ended, too
}

// Return the view, or null if a newer state of this kind has begun.
export const ask = (kind, view, fields = {}) => answer(kind, view, fields, (response) => response.json());

// Return the picture that a view gives as a blob, or null if a newer state of this kind has begun.
export const askPicture = (kind, view, fields) => answer(kind, view, fields, (response) => response.blob());

// Return what the server is doing, in words; empty texts if it does not answer.
export async function doing() {
  try {
    return await (await fetch("api/doing")).json();
  } catch {
    return { words: "", note: "" };
  }
}

async function answer(kind, view, fields, read) {
  const number = latest.get(kind) ?? 0;
  const query = new URLSearchParams({ ...fields, window: `${own}/${kind}`, number });
  let response, value;
  let refused = false;
  try {
    response = await fetch(`api/${view}?${query}`, { signal: running.get(kind)?.signal });
    const plain = !response.ok || response.headers.get("Content-Type") === "application/json";
    value = await (plain ? response.json() : read(response));
    refused = plain && "refused" in value; // a mistake of the user, not of the page
  } catch (error) {
    if (error.name === "AbortError" || number !== (latest.get(kind) ?? 0)) return null;
    throw new Problem(["the command does not answer; start prag-asp explore again, and open its new link"]);
  }
  if (number !== (latest.get(kind) ?? 0) || response.status === 409) return null;
  if (refused) throw new Problem(value.refused);
  if (!response.ok) throw new Problem(value.lines);
  return value;
}

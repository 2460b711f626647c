// Show the final state of a plan in the PDDL extension of VS Code: the true fluents of prag_asp by their first argument.

const fluents = FLUENTS; // by the atoms of the PDDL domain; its other atoms only control the order of actions

function escaped(text) {
  return text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
}

function visualizeStateHtml(plan, finalState, displayWidth) {
  const rows = new Map();
  for (const { variableName, value } of finalState) {
    const fluent = fluents[variableName.toLowerCase()];
    if (value !== true || fluent === undefined) continue;
    rows.set(fluent.about, [...(rows.get(fluent.about) ?? []), escaped(fluent.text)]);
  }
  const cells = [...rows].map(([about, texts]) => `<tr><th style="text-align:left;vertical-align:top">${escaped(about)}</th><td>${texts.join("<br>")}</td></tr>`);
  return `<table style="max-width:${displayWidth}px">${cells.join("")}</table>`;
}

module.exports = { visualizeStateHtml };

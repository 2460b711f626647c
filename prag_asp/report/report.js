// The page of a report: figures, filters, lists, film strips, tooltips and CSV files, from the values in the page.

const data = JSON.parse(document.getElementById("report-data").textContent);
const { tasks } = data;
const tableOf = Object.fromEntries(data.tables.map((table) => [table.name, table]));
const placeOf = new Map(tasks.number.map((number, at) => [number, at]));
const form = document.getElementById("filters");
const STEP = 50; // rows that a list shows at first, and with each further press
const LONG = 40; // characters of a text that needs a wide column

const lengthOf = (at) => tasks.plans[at].length;
const planOf = (at) => tasks.plans[at].map((letter) => tasks.letters[letter]).join(" ");
const records = (table) => table.rows.map((row) => Object.fromEntries(table.columns.map((name, at) => [name, row[at]])));

function chosen() {
  return Object.fromEntries([...new FormData(form)].filter(([, value]) => value));
}

function fits(at, wanted) {
  return (!wanted.length || lengthOf(at) === Number(wanted.length))
    && (!wanted.split || tasks.part[at] === wanted.split)
    && (!wanted.action || tasks.plans[at].some((letter) => tasks.names[letter] === wanted.action))
    && (!wanted.entity || tasks.own[at].some((entity) => tasks.entities[entity] === wanted.entity));
}

// Figures that depend on the filters, from the tasks at some places; null if a filter leaves nothing to show.
const filteredPlots = {
  lengths: (plot, places) => counted(plot, places, lengthOf),
  entities: (plot, places) => counted(plot, places, (at) => tasks.own[at].length),
  frequencies_names: (plot, places, wanted) => frequencies(plot, places, wanted, "names"),
  frequencies_classes: (plot, places, wanted) => frequencies(plot, places, wanted, "classes"),
  frequencies_actions: (plot, places, wanted) => frequencies(plot, places, wanted, "letters"),
  map: (plot, places) => {
    const kept = new Set(places.map((at) => tasks.number[at]));
    const series = plot.series.map((each) => {
      const own = each.tasks.map((task, at) => [task, at]).filter(([task]) => kept.has(task));
      const of = (values) => own.map(([, at]) => values[at]);
      return { ...each, places: of(each.places), heights: of(each.heights), tasks: of(each.tasks), ringed: of(each.ringed) };
    });
    return { ...plot, series };
  },
  results: (plot, places, wanted) => results(plot, wanted),
};

function counted(plot, places, valueOf) {
  const found = new Map();
  for (const at of places) found.set(valueOf(at), (found.get(valueOf(at)) ?? 0) + 1);
  const pairs = [...found].sort((one, other) => one[0] - other[0]);
  return { ...plot, series: [{ ...plot.series[0], places: pairs.map(([value]) => value), heights: pairs.map(([, count]) => count) }] };
}

// The given occurrences in the chosen tasks; the expected ones follow from the numbers of tasks of each length, unless
// an action or an entity is chosen.
function frequencies(plot, places, wanted, feature) {
  const given = new Map(plot.categories.map((value) => [value, 0]));
  const ofLength = new Map();
  const plans = feature === "letters" && tasks.canonical ? tasks.canonical : tasks.plans;
  for (const at of places) {
    ofLength.set(lengthOf(at), (ofLength.get(lengthOf(at)) ?? 0) + 1);
    for (const letter of plans[at]) {
      const value = tasks[feature][letter];
      if (given.has(value)) given.set(value, given.get(value) + 1);
    }
  }
  const heights = plot.categories.map((value) => given.get(value));
  const series = [{ ...plot.series[0], heights }];
  if (!wanted.action && !wanted.entity) {
    const expected = new Map(plot.categories.map((value) => [value, 0]));
    for (const row of records(tableOf.frequencies))
      if (`frequencies_${row.feature}` === plot.name && expected.has(row.value))
        expected.set(row.value, expected.get(row.value) + (row.expected / row.tasks) * (ofLength.get(row.length) ?? 0));
    series.push({ ...plot.series[1], heights: plot.categories.map((value) => expected.get(value)) });
  }
  return { ...plot, series };
}

// Rates of whole episodes, all and by length; Wilson's interval at 95 %.
function results(plot, wanted) {
  const episodes = shownEpisodes(wanted);
  const policies = [...new Set(episodes.map((row) => row.policy))];
  const lengths = [...new Set(episodes.map((row) => row.length))].sort((one, other) => one - other);
  const groups = [["all episodes", () => true], ...lengths.map((length) => [`length ${length}`, (row) => row.length === length])];
  const series = policies.map((policy) => {
    const rates = groups
      .map(([, belongs], place) => [place, episodes.filter((row) => row.policy === policy && belongs(row))])
      .filter(([, rows]) => rows.length)
      .map(([place, rows]) => [place, ...wilson(rows.filter((row) => row.success === "yes").length, rows.length)]);
    const column = (at) => rates.map((rate) => rate[at]);
    return { name: policy, style: "dots", places: column(0), heights: column(1), lows: column(2), highs: column(3) };
  });
  return { ...plot, categories: groups.map(([name]) => name), series };
}

function wilson(successes, trials) {
  const z = 1.959963984540054, share = successes / trials;
  const middle = share + (z * z) / (2 * trials);
  const spread = z * Math.sqrt((share * (1 - share)) / trials + (z * z) / (4 * trials * trials));
  const scale = 1 + (z * z) / trials;
  return [share, successes ? (middle - spread) / scale : 0, successes < trials ? (middle + spread) / scale : 1];
}

function shownEpisodes(wanted) {
  return records(tableOf.episodes).filter((row) =>
    (!wanted.length || row.length === Number(wanted.length))
    && (!wanted.split || row.part === wanted.split)
    && (!wanted.action || row.plan.split(" ").some((action) => action.split("(")[0] === wanted.action))
    && (!wanted.entity || row.plan.split(/[\s(),]+/).includes(wanted.entity)));
}

// The map shows the number of the task of each point, which its table has.
for (const plot of data.plots.filter((each) => each.name === "map")) {
  const rows = records(tableOf.map);
  for (const series of plot.series) {
    const own = rows.filter((row) => `length ${row.length}` === series.name);
    series.tasks = own.map((row) => row.task);
    series.ringed = own.map((row) => row.task in data.strips);
  }
}

let state = { wanted: {}, places: tasks.number.map((_, at) => at) };

function currentPlot(plot) {
  if (!plot.filtered || !Object.keys(state.wanted).length) return plot;
  return filteredPlots[plot.name](plot, state.places, state.wanted);
}

function drawFigure(figure) {
  const plot = currentPlot(data.plots.find((each) => each.name === figure.dataset.plot));
  const box = figure.querySelector(".plot") ?? figure.insertBefore(document.createElement("div"), figure.firstChild);
  box.className = "plot";
  const empty = !plot.series.some((each) => each.places.length);
  box.innerHTML = empty ? '<p class="note">No task fits the filters.</p>' : plotSvg(plot, Math.max(280, figure.clientWidth));
}

const figures = [...document.querySelectorAll("figure[data-plot]")];

function listRows(name) {
  if (name === "episodes") {
    const { columns } = tableOf.episodes;
    return { columns, rows: shownEpisodes(state.wanted).map((row) => columns.map((each) => row[each])) };
  }
  const rows = state.places.map((at) => [tasks.number[at], tasks.part[at], lengthOf(at), tasks.own[at].length, planOf(at), tasks.instruction[at]]);
  return { columns: ["task", "part", "length", "entities", "plan", "instruction"], rows };
}

function tableHtml(columns, rows) {
  const side = columns.map((_, at) => {
    if (rows.length && rows.every((row) => typeof row[at] === "number")) return "";
    return rows.some((row) => String(row[at]).length > LONG) ? ' class="left long"' : ' class="left"';
  });
  const cells = (row, tag) => row.map((value, at) => `<${tag}${side[at]}>${escapeText(tag === "td" ? grouped(value ?? "") : value)}</${tag}>`).join("");
  return `<table><thead><tr>${cells(columns, "th")}</tr></thead><tbody>${rows.map((row) => `<tr>${cells(row, "td")}</tr>`).join("")}</tbody></table>`;
}

function showList(box, count = STEP) {
  const { columns, rows } = listRows(box.dataset.list);
  const left = rows.length - count;
  const more = left > 0 ? `<button type="button">Show ${grouped(Math.min(left, STEP))} more of ${grouped(left)}</button>` : "";
  box.innerHTML = `<div class="scroll" role="region" tabindex="0" aria-label="${box.dataset.list}">${tableHtml(columns, rows.slice(0, count))}</div>${more}`;
  box.querySelector("button")?.addEventListener("click", () => showList(box, count + STEP));
}

function showStrips() {
  const box = document.getElementById("strips");
  if (!box) return;
  const shown = Object.keys(data.strips).map(Number).filter((number) => placeOf.has(number) && fits(placeOf.get(number), state.wanted));
  box.innerHTML = shown.map((number) => {
    const at = placeOf.get(number);
    const part = tasks.part[at] ? `, ${escapeText(tasks.part[at])}` : "";
    return `<figure class="strip"><figcaption><b>Task ${number}${part}.</b> ${escapeText(tasks.instruction[at])}</figcaption><div class="scroll" tabindex="0"><img src="${data.strips[number]}" alt="${escapeText(planOf(at))}"></div></figure>`;
  }).join("") || '<p class="note">No task with a film strip fits the filters.</p>';
}

function update() {
  const wanted = chosen();
  state = { wanted, places: tasks.number.map((_, at) => at).filter((at) => fits(at, wanted)) };
  const all = data.total > tasks.number.length ? ` (a sample of ${grouped(data.total)})` : "";
  document.getElementById("shown").textContent = `${grouped(state.places.length)} of ${grouped(tasks.number.length)} tasks${all}`;
  figures.forEach(drawFigure);
  document.querySelectorAll("[data-list]").forEach((box) => showList(box));
  showStrips();
  history.replaceState(null, "", Object.keys(wanted).length ? `#${new URLSearchParams(wanted)}` : location.pathname + location.search);
}

function csvField(value) {
  const text = value === null || value === undefined ? "" : String(value);
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

function saveCsv(name) {
  const { columns, rows } = tableOf[name] && name !== "episodes" ? tableOf[name] : listRows(name);
  const text = [columns, ...rows].map((row) => `${row.map(csvField).join(",")}\r\n`).join("");
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  link.download = `${name}.csv`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

const bubble = document.getElementById("tip");
function showTip(event) {
  const mark = event.target.closest?.("[data-tip], [data-task]");
  bubble.hidden = !mark;
  if (!mark) return;
  if (mark.dataset.tip) bubble.textContent = mark.dataset.tip;
  else {
    const number = Number(mark.dataset.task), at = placeOf.get(number);
    const strip = data.strips[number] ? `<img src="${data.strips[number]}" alt="">` : "";
    bubble.innerHTML = at === undefined
      ? `Task ${number}`
      : `<b>Task ${number}.</b> ${escapeText(tasks.instruction[at])}<br><span class="plan">${escapeText(planOf(at))}</span>${strip}`;
  }
  const { clientX: x, clientY: y } = event;
  const left = Math.min(x + 14, innerWidth - bubble.offsetWidth - 8);
  const below = y + 18 + bubble.offsetHeight < innerHeight;
  bubble.style.left = `${Math.max(8, left)}px`;
  bubble.style.top = `${below ? y + 18 : Math.max(8, y - bubble.offsetHeight - 10)}px`;
}

function readLink() {
  const wanted = new URLSearchParams(location.hash.slice(1));
  for (const field of form.querySelectorAll("select")) {
    const value = wanted.get(field.name);
    field.value = [...field.options].some((option) => option.value === value) ? value : "";
  }
}

readLink();
addEventListener("hashchange", () => {
  if (location.hash !== "" && !location.hash.includes("=")) return; // a section of the page
  readLink();
  update();
});
form.addEventListener("change", update);
form.addEventListener("submit", (event) => event.preventDefault());
form.addEventListener("reset", () => setTimeout(update));
document.addEventListener("click", (event) => {
  const name = event.target.dataset?.csv;
  if (name) saveCsv(name);
});
document.addEventListener("pointermove", showTip);
document.addEventListener("pointerdown", showTip);
document.addEventListener("keydown", (event) => { if (event.key === "Escape") bubble.hidden = true; });
addEventListener("resize", () => figures.forEach(drawFigure));
update();
document.documentElement.dataset.ready = "yes";

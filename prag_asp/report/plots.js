// Figures as inline SVG: `plotSvg(plot, width)` returns the text of a figure of the given width in pixels.

const escapeText = (text) =>
  String(text).replace(/[&<>"']/g, (sign) => `&#${sign.charCodeAt(0)};`);
const colour = (number) => `var(--series-${(number % 6) + 1})`;
const grouped = (value) => {
  const text = String(value);
  if (/^-?\d+$/.test(text)) return text.replace(/\B(?=(\d{3})+$)/g, ",");
  return typeof value === "number" ? String(Number(value.toPrecision(4))) : text;
};

// At most `most` round numbers that cover low to high; of whole numbers only, if `whole`.
function ticks(low, high, most, whole) {
  const raw = (high - low) / Math.max(most, 1) || 1;
  const power = 10 ** Math.floor(Math.log10(raw));
  let step = [1, 2, 5, 10].map((each) => each * power).find((each) => each >= raw - 1e-12);
  if (whole) step = Math.max(1, Math.round(step));
  const found = [];
  for (let at = Math.ceil(low / step - 1e-9); at * step <= high + 1e-9 * step; at++) found.push(at * step);
  return found;
}

function heightText(plot, value) {
  if (plot.share) return `${Number((100 * value).toPrecision(3))} %`;
  if (!plot.logarithmic) return grouped(value);
  return Math.abs(value) < 5 ? grouped(10 ** value) : `10^${value.toFixed(2)}`;
}

function tip(plot, series, at) {
  const place = plot.categories.length ? plot.categories[series.places[at]] : `${plot.across} ${grouped(series.places[at])}`;
  const interval = series.lows.length
    ? ` (${heightText(plot, series.lows[at])} to ${heightText(plot, series.highs[at])})`
    : "";
  return escapeText(`${series.name}, ${place}: ${heightText(plot, series.heights[at])}${interval}`);
}

function legend(plot) {
  if (plot.series.length < 2) return "";
  const keys = plot.series.map(
    (series, number) =>
      `<span class="key"><svg width="22" height="12" aria-hidden="true">${symbol(series, number, 11, 6)}</svg>${escapeText(series.name)}</span>`,
  );
  return `<div class="legend">${keys.join("")}</div>`;
}

function symbol(series, number, x, y) {
  const stroke = `stroke="${colour(number)}" stroke-width="2"`;
  if (series.style === "bars") return `<rect x="${x - 6}" y="${y - 5}" width="12" height="10" fill="${colour(number)}"/>`;
  if (series.style === "marks") return `<path d="M${x} ${y - 6}v12" ${stroke} stroke-width="3"/>`;
  const line = series.style === "dots" ? "" : `<path d="M${x - 10} ${y}h20" ${stroke} ${series.style === "dashed" ? 'stroke-dasharray="4 3"' : ""}/>`;
  return line + (series.style === "dashed" ? "" : dot(series, number, x, y));
}

// Series differ by colour and by shape.
function dot(series, number, across, up, extra = "") {
  const [x, y] = [Number(across), Number(up)];
  const size = 4;
  const shapes = [
    `<circle cx="${x}" cy="${y}" r="${size}"`,
    `<rect x="${x - size}" y="${y - size}" width="${2 * size}" height="${2 * size}"`,
    `<path d="M${x} ${y - size - 1}l${size + 1} ${2 * size}h${-2 * size - 2}z"`,
    `<path d="M${x} ${y - size - 1}l${size + 1} ${size + 1}l${-size - 1} ${size + 1}l${-size - 1} ${-size - 1}z"`,
  ];
  return `${shapes[number % shapes.length]} fill="${colour(number)}" ${extra}/>`;
}

function plotSvg(plot, width) {
  const drawn = plot.kind === "map" ? mapSvg(plot, width) : plot.categories.length ? rowsSvg(plot, width) : linesSvg(plot, width);
  return legend(plot) + drawn;
}

const svg = (plot, width, height, content) =>
  `<svg role="img" aria-label="${escapeText(plot.title)}" viewBox="0 0 ${width} ${height}" width="${width}" height="${height}">${content}</svg>`;

function linesSvg(plot, width) {
  const height = Math.round(Math.min(380, Math.max(240, width * 0.5)));
  const [left, right, top, bottom] = [64, 16, 12, 48];
  const xs = plot.series.flatMap((each) => each.places);
  const ys = plot.series.flatMap((each) => [...each.heights, ...each.lows, ...each.highs]);
  const half = plot.kind === "columns" ? plot.width / 2 : 0;
  let [x0, x1] = [Math.min(...xs) - half, Math.max(...xs) + half];
  if (x0 === x1) [x0, x1] = [x0 - 1, x1 + 1];
  let [y0, y1] = plot.share ? [0, 1] : [Math.min(0, Math.floor(Math.min(...ys))), Math.max(...ys)];
  if (plot.logarithmic) y1 = Math.ceil(y1 - 1e-9);
  if (y0 === y1) y1 = y0 + 1;
  const x = (value) => left + ((value - x0) / (x1 - x0)) * (width - left - right);
  const y = (value) => height - bottom - ((value - y0) / (y1 - y0)) * (height - top - bottom);
  const whole = plot.name !== "distances";
  const parts = ticks(y0, y1, height / 50, plot.logarithmic || plot.kind === "columns" || !plot.share && y1 > 5).map((value) => {
    const text = plot.logarithmic
      ? `10<tspan dy="-5" font-size="10">${value}</tspan>`
      : plot.share ? `${Math.round(100 * value)} %` : grouped(value);
    return `<path class="grid" d="M${left} ${y(value)}H${width - right}"/><text x="${left - 8}" y="${y(value) + 4}" text-anchor="end">${text}</text>`;
  });
  for (const value of ticks(x0, x1, width / 70, whole))
    parts.push(`<text x="${x(value)}" y="${height - bottom + 18}" text-anchor="middle">${grouped(value)}</text>`);
  parts.push(`<text x="${(left + width - right) / 2}" y="${height - 8}" text-anchor="middle">${escapeText(plot.across)}</text>`);
  parts.push(`<text transform="translate(14 ${(top + height - bottom) / 2}) rotate(-90)" text-anchor="middle">${escapeText(plot.up)}</text>`);
  plot.series.forEach((series, number) => {
    if (series.style === "line" || series.style === "dashed") {
      const path = series.places.map((place, at) => `${at ? "L" : "M"}${x(place)} ${y(series.heights[at])}`).join("");
      parts.push(`<path d="${path}" fill="none" stroke="${colour(number)}" stroke-width="2" ${series.style === "dashed" ? 'stroke-dasharray="6 4"' : ""}/>`);
    }
    series.places.forEach((place, at) => {
      const text = `data-tip="${tip(plot, series, at)}"`;
      if (plot.kind === "columns") {
        const [from, to] = [x(place - plot.width / 2), x(place + plot.width / 2)];
        const tall = y(y0) - y(series.heights[at]);
        parts.push(`<rect x="${from + 0.5}" y="${y(series.heights[at])}" width="${Math.max(to - from - 1, 1)}" height="${tall}" fill="${colour(number)}" ${text}/>`);
        return;
      }
      if (series.lows.length)
        parts.push(`<path d="M${x(place)} ${y(series.lows[at])}V${y(series.highs[at])}" stroke="${colour(number)}" stroke-width="2"/>`);
      parts.push(series.style === "dashed" && series.places.length > 40 ? "" : dot(series, number, x(place), y(series.heights[at]), text));
    });
  });
  return svg(plot, width, height, parts.join(""));
}

// A row for each category: bars, marks, or dots with intervals. On narrow pages, labels stand above the rows.
function rowsSvg(plot, width) {
  const narrow = width < 560;
  const longest = Math.max(...plot.categories.map((each) => each.length));
  const left = narrow ? 8 : Math.min(30 + longest * 7, width * 0.45);
  const right = 24;
  const inner = plot.kind === "intervals" ? plot.series.length * 14 : 16;
  const row = inner + (narrow ? 24 : 8);
  const height = plot.categories.length * row + 52;
  const most = plot.share ? 1 : Math.max(...plot.series.flatMap((each) => each.heights), 1e-9);
  const x = (value) => left + (value / most) * (width - left - right);
  const parts = ticks(0, most, (width - left) / 90, !plot.share && most > 4).map((value) => {
    const text = plot.share ? `${Math.round(100 * value)} %` : grouped(value);
    return `<path class="grid" d="M${x(value)} 0V${height - 46}"/><text x="${x(value)}" y="${height - 28}" text-anchor="middle">${text}</text>`;
  });
  parts.push(`<text x="${(left + width - right) / 2}" y="${height - 6}" text-anchor="middle">${escapeText(plot.across)}</text>`);
  plot.categories.forEach((name, at) => {
    const fits = Math.floor((narrow ? width : left - 12) / 7);
    const text = name.length > fits ? `${name.slice(0, fits - 1)}…` : name;
    parts.push(narrow
      ? `<text x="${left}" y="${at * row + 15}">${escapeText(text)}</text>`
      : `<text x="${left - 8}" y="${at * row + row / 2 + 4}" text-anchor="end">${escapeText(text)}</text>`);
  });
  const middle = (place) => place * row + (narrow ? 20 : 4) + inner / 2;
  plot.series.forEach((series, number) =>
    series.places.forEach((place, at) => {
      const [value, text] = [x(series.heights[at]), `data-tip="${tip(plot, series, at)}"`];
      if (series.style === "bars")
        parts.push(`<rect x="${left}" y="${middle(place) - 7}" width="${Math.max(value - left, 0.5)}" height="14" fill="${colour(number)}" ${text}/>`);
      else if (series.style === "marks")
        parts.push(`<path d="M${value} ${middle(place) - 9}v18" stroke="${colour(number)}" stroke-width="4" ${text}/>`);
      else {
        const y = middle(place) + (number - (plot.series.length - 1) / 2) * 14;
        parts.push(`<path d="M${x(series.lows[at])} ${y}H${x(series.highs[at])}" stroke="${colour(number)}" stroke-width="2"/>`);
        parts.push(dot(series, number, value, y, text));
      }
    }),
  );
  return svg(plot, width, height, parts.join(""));
}

// Points without scales; `tasks` of a series are the numbers that the page shows of a point.
function mapSvg(plot, width) {
  const size = Math.min(width, 620);
  const xs = plot.series.flatMap((each) => each.places);
  const ys = plot.series.flatMap((each) => each.heights);
  const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const scale = (size - 24) / (Math.max(x1 - x0, y1 - y0) || 1);
  const height = Math.round((y1 - y0) * scale) + 24;
  const parts = plot.series.map((series, number) =>
    series.places.map((place, at) => {
      const [x, y] = [12 + (place - x0) * scale, height - 12 - (series.heights[at] - y0) * scale];
      const task = series.tasks ? `data-task="${series.tasks[at]}"` : "";
      const ring = series.ringed?.[at] ? 'class="ringed"' : "";
      return dot(series, number, x.toFixed(1), y.toFixed(1), `fill-opacity="0.75" ${task} ${ring}`);
    }).join(""),
  );
  const frame = `<rect class="grid" x="0.5" y="0.5" width="${size - 1}" height="${height - 1}" fill="none"/>`;
  return svg(plot, size, height, frame + parts.join(""));
}

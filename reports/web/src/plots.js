// Interactive plots. Those over time share their cursor with the replay.
import uPlot from "uplot";

const height = 270;
const followMs = 120;  // while playing, cursors move at most this often

function style(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

// Curves on the union of their abscissas, as uPlot wants them.
function align(curves) {
  const xs = [...new Set(curves.flatMap((c) => c.x))].filter((x) => x !== null).sort((a, b) => a - b);
  const place = new Map(xs.map((x, i) => [x, i]));
  const spread = (curve, values) => {
    const out = new Array(xs.length).fill(undefined);
    curve.x.forEach((x, i) => x !== null && (out[place.get(x)] = values[i]));
    return out;
  };
  return { xs, spread };
}

function positive(values, log) {
  return log ? values.map((v) => (v > 0 ? v : undefined)) : values;
}

function tick(value) {
  if (value === null || value === undefined) return "";
  const size = Math.abs(value);
  return size !== 0 && (size < 1e-3 || size >= 1e5) ? value.toExponential(0) : String(Number(value.toPrecision(6)));
}

function number(value) {
  if (value === null || value === undefined) return "–";
  const size = Math.abs(value);
  return size !== 0 && size < 1e-3 ? value.toExponential(2) : String(Number(value.toPrecision(4)));
}

// Where a logarithmic axis is ruled: at 1, 2 and 5 of each decade, at decades where there are more
// than two of them, and at every n-th decade where they would run into each other.
function decades(low, high) {
  const [first, last] = [Math.floor(Math.log10(low)), Math.ceil(Math.log10(high))];
  const apart = Math.max(1, Math.ceil((last - first) / 8));
  const steps = Math.log10(high / low) > 2 ? [1] : [1, 2, 5];
  const out = [];
  for (let exponent = first; exponent <= last; ++exponent) {
    if (exponent % apart !== 0) continue;
    for (const step of steps) out.push(Number(`${step}e${exponent}`));
  }
  return out.filter((value) => value >= low && value <= high);
}

// A cross where a flagged curve stops to be trusted.
function crosses(plot, figure) {
  const { ctx } = plot;
  const arm = 5 * devicePixelRatio;
  ctx.save();
  ctx.lineWidth = 2.5 * devicePixelRatio;
  for (const curve of figure.curves) {
    if (curve.flagged_from === undefined) continue;
    const at = curve.x.findIndex((x) => x !== null && x >= curve.flagged_from - 1e-9);
    if (at < 0 || curve.y[at] === null) continue;
    const [x, y] = [plot.valToPos(curve.x[at], "x", true), plot.valToPos(curve.y[at], "y", true)];
    ctx.strokeStyle = curve.colour;
    ctx.beginPath();
    for (const side of [-arm, arm]) {
      ctx.moveTo(x - arm, y - side);
      ctx.lineTo(x + arm, y + side);
    }
    ctx.stroke();
  }
  ctx.restore();
}

// In a cost plot a curve may come back in x: it is drawn as points only.
function options(figure, width, data) {
  const axis = (side) => ({
    label: side.text, labelSize: 18, labelGap: 2, labelFont: "11px system-ui", font: "11px system-ui",
    stroke: style("--soft"), grid: { stroke: style("--line"), width: 1 },
    ticks: { stroke: style("--line"), width: 1, size: 5 }, gap: 4,
    values: (_, ticks) => ticks.map(tick), size: side === figure.y ? 54 : 26,
    ...(side.log ? { splits: (_, __, low, high) => decades(low, high), filter: (_, ticks) => ticks } : {}),
  });
  const dash = (c) => (c.dash ? c.dash.split(" ").map(Number) : []);
  const series = [{ label: figure.x.text, value: (_, v) => number(v) }];
  const bands = [];
  for (const curve of figure.curves) {
    const isFlagged = curve.flagged_from !== undefined;
    series.push({
      label: curve.legend,
      stroke: isFlagged ? curve.colour + "73" : curve.colour, class: isFlagged ? "flagged" : undefined,
      width: figure.lines ? 1.8 : 0, dash: dash(curve), spanGaps: true,
      points: { show: figure.markers, size: 8, fill: curve.colour }, value: (_, v) => number(v),
    });
    if (curve.low) {
      const at = series.length;
      for (let k = 0; k < 2; ++k) {
        series.push({ label: "", stroke: "transparent", points: { show: false }, spanGaps: true, class: "band" });
      }
      bands.push({ series: [at + 1, at], fill: curve.colour + "26" });
    }
  }
  const scale = (side, values) => {
    const finite = values.filter((v) => v !== undefined && v !== null);
    const log = side.log;
    const low = Math.min(...finite);
    const high = Math.max(...finite);
    if (low === high && !log) return { range: () => [low - 1, high + 1] };
    return log ? { distr: 3, range: () => [low / 1.6, high * 1.6] } : { distr: 1 };
  };
  return {
    width, height, series, bands,
    scales: { x: { time: false, ...scale(figure.x, data[0]) }, y: scale(figure.y, data.slice(1).flat()) },
    axes: [axis(figure.x), axis(figure.y)],
    hooks: { draw: [(plot) => crosses(plot, figure)] },
    legend: { live: figure.over_time }, cursor: { y: false, drag: { x: true, y: false } },
  };
}

function draw(host, figure, clock) {
  const { xs, spread } = align(figure.curves);
  const data = [positive(xs, figure.x.log)];
  for (const curve of figure.curves) {
    data.push(positive(spread(curve, curve.y), figure.y.log));
    if (curve.low) data.push(positive(spread(curve, curve.low), figure.y.log), positive(spread(curve, curve.high), figure.y.log));
  }
  const title = document.createElement("p");
  title.className = "plot-title";
  title.textContent = figure.title;
  const place = document.createElement("div");
  host.prepend(title, place);
  let plot = null;
  let following = false;
  let seen = true;
  let followed = 0;
  const make = () => {
    plot?.destroy();
    plot = new uPlot(options(figure, host.clientWidth, data), data, place);
    place.classList.toggle("timeless", !figure.over_time);
    place.querySelectorAll(".u-series.band").forEach((row) => (row.style.display = "none"));
    plot.over.addEventListener("pointermove", () => {
      if (figure.over_time && !clock.playing && plot.cursor.left >= 0) {
        clock.seek(plot.posToVal(plot.cursor.left, "x"), plot);
      }
    });
    plot.over.addEventListener("click", () => {
      if (figure.over_time) clock.seek(plot.posToVal(plot.cursor.left, "x"), plot);
    });
    if (figure.over_time) follow(clock.time, null);
  };
  const follow = (time, source) => {
    const now = performance.now();
    if (source === plot || following || !seen || (clock.playing && now - followed < followMs)) return;
    followed = now;
    following = true;
    plot.setCursor({ left: plot.valToPos(time, "x"), top: plot.over.clientHeight / 2 }, false);
    following = false;
  };
  make();
  if (figure.over_time) clock.subscribe(follow);
  let width = host.clientWidth;
  new ResizeObserver(() => {
    if (host.clientWidth === width) return;
    width = host.clientWidth;
    plot.setSize({ width, height });
  }).observe(host);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", make);
  new IntersectionObserver(([entry]) => {
    seen = entry.isIntersecting;
    if (seen && figure.over_time) follow(clock.time, null);
  }).observe(host);
  host.dataset.ready = "true";
}

// Draws each figure when it comes near the screen.
export function drawPlots(figures, clock) {
  const byId = new Map(figures.map((figure) => [figure.id, figure]));
  const drawn = new Set();
  const drawOnce = (host) => {
    if (drawn.has(host)) return;
    drawn.add(host);
    const figure = byId.get(host.dataset.figure);
    if (figure) draw(host, figure, clock);
  };
  const watcher = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (entry.isIntersecting) drawOnce(entry.target);
    }
  }, { rootMargin: "600px" });
  const hosts = [...document.querySelectorAll("figure[data-figure]")];
  for (const host of hosts) {
    host.style.minHeight = `${height + 60}px`;
    watcher.observe(host);
  }
  return () => hosts.forEach((host) => {
    host.closest("details:not([open])")?.setAttribute("open", "");
    drawOnce(host);
  });
}

// Pictures of the stage with its labels, for `brickbench render`.
import { modes, scale as colourScale } from "./colours.js";

// Lines of at most `width` pixels; words that are longer are broken.
function wrapped(context, text, width) {
  const lines = [""];
  for (const word of text.split(/(?<=[ ,/_])/)) {
    for (let rest = word; rest; ) {
      const line = lines[lines.length - 1];
      let fits = rest.length;
      while (fits > 0 && context.measureText(line + rest.slice(0, fits)).width > width) --fits;
      if (fits < rest.length && line) fits = 0;
      if (fits === 0 && !line) fits = 1;
      lines[lines.length - 1] += rest.slice(0, fits);
      rest = rest.slice(fits);
      if (rest) lines.push("");
    }
  }
  return lines;
}

// Who is seen, in as many lines as it takes.
function label(context, text, colour, x, y, width, size) {
  context.font = `600 ${size}px system-ui, sans-serif`;
  const lines = wrapped(context, text, width - 2 * size);
  const wide = Math.max(...lines.map((line) => context.measureText(line).width));
  const height = (1.3 * lines.length + 0.4) * size;
  context.fillStyle = "rgba(255, 255, 255, 0.86)";
  context.fillRect(x, y, wide + 1.5 * size, height);
  context.fillStyle = colour;
  context.fillRect(x, y, 5, height);
  context.fillStyle = "#1c2127";
  lines.forEach((line, i) => context.fillText(line, x + 0.9 * size, y + (1.25 + 1.3 * i) * size));
}

// The time, and what the colours mean, in a strip of its own from y on.
function footer(context, text, mode, limit, x, y, size) {
  context.font = `${size}px system-ui, sans-serif`;
  const bar = mode === "material" ? 0 : 5 * size;
  const legend = mode === "material" ? "" : `${modes[mode].name} 0 … ${limit.toPrecision(2)} ${modes[mode].unit}`;
  const gap = legend ? 1.2 * size : 0;
  context.fillStyle = "#ffffff";
  context.fillRect(0, y, context.canvas.width, 1.7 * size + 1);
  context.fillStyle = "#1c2127";
  context.fillText(text, x + 0.6 * size, y + 1.2 * size);
  if (!legend) return;
  let at = x + 0.6 * size + context.measureText(text).width + gap;
  const colour = [0, 0, 0];
  for (let i = 0; i < bar; ++i) {
    colourScale(i / bar, colour, 0);
    context.fillStyle = `rgb(${colour.map((c) => Math.round(255 * c)).join(" ")})`;
    context.fillRect(at + i, y + 0.5 * size, 1.5, 0.8 * size);
  }
  at += bar + 0.5 * gap;
  context.fillStyle = "#1c2127";
  context.fillText(legend, at, y + 1.2 * size);
}

// Fixes the size of the stage (CSS pixels) and shows these engines from this side; all engines if
// the list is empty.
export function arrange({ stage, controls }, { view, width, engines = [], colour, contacts }) {
  const wanted = stage.views.flatMap(({ view: v }, i) =>
    (engines.length === 0 || engines.includes(v.engine) ? [i] : []));
  stage.host.style.width = `${width}px`;
  stage.ratio = 1;
  stage.adaptive = false;
  stage.contacts = contacts;
  controls.mode.value = colour;
  controls.colour();
  stage.show(wanted);
  stage.preset(view);
}

// A data URL of the stage at this time; `type` is image/png or image/jpeg.
export function picture({ stage, controls }, clock, time, type) {
  clock.seek(time);
  stage.draw();
  const { columns, rows, cellWidth, cellHeight } = stage.layout;
  const canvas = document.createElement("canvas");
  const size = Math.round(15 * Math.min(1.4, Math.max(0.8, cellWidth / 480)));
  // Videos need even sizes.
  canvas.width = stage.canvas.width & ~1;
  canvas.height = (stage.canvas.height + Math.ceil(1.7 * size)) & ~1;
  const context = canvas.getContext("2d");
  context.drawImage(stage.canvas, 0, 0);
  stage.visible.forEach((index, place) => {
    const { view } = stage.views[index];
    label(context, view.note ? `${view.engine}, ${view.note}` : view.engine, view.colour, (place % columns) * cellWidth + 8,
      Math.floor(place / columns) * cellHeight + 8, cellWidth - 16, size);
  });
  footer(context, `${clock.time.toFixed(3)} s`, controls.mode.value, controls.limit, 2,
    rows * cellHeight, size);
  return canvas.toDataURL(type, 0.92);
}

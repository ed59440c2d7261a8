// Pictures of the stage with its labels, for `brickbench render`.

function label(context, text, detail, colour, x, y, scale) {
  context.font = `600 ${15 * scale}px system-ui, sans-serif`;
  const width = context.measureText(text).width + 22 * scale;
  context.fillStyle = "rgba(255, 255, 255, 0.86)";
  context.fillRect(x, y, width, 26 * scale);
  context.fillStyle = colour;
  context.fillRect(x, y, 5 * scale, 26 * scale);
  context.fillStyle = "#1c2127";
  context.fillText(text, x + 13 * scale, y + 18 * scale);
  if (detail) context.fillText(detail, x + width + 10 * scale, y + 18 * scale);
}

// Fixes the size of the stage (CSS pixels) and shows these engines from this side; all engines if
// the list is empty.
export function arrange(stage, { view, width, engines = [] }) {
  const wanted = stage.views.flatMap(({ view: v }, i) =>
    (engines.length === 0 || engines.includes(v.engine) ? [i] : []));
  stage.host.style.width = `${width}px`;
  stage.ratio = 1;
  stage.adaptive = false;
  stage.show(wanted);
  stage.preset(view);
}

// A data URL of the stage at this time; `type` is image/png or image/jpeg.
export function picture(stage, clock, time, type) {
  clock.seek(time);
  stage.draw();
  const { columns, cellWidth, cellHeight } = stage.layout;
  const canvas = document.createElement("canvas");
  // Videos need even sizes.
  canvas.width = stage.canvas.width & ~1;
  canvas.height = stage.canvas.height & ~1;
  const context = canvas.getContext("2d");
  context.drawImage(stage.canvas, 0, 0);
  const scale = Math.max(0.8, cellWidth / 640);
  stage.visible.forEach((index, place) => {
    const { view } = stage.views[index];
    label(context, view.engine, place === 0 ? `${clock.time.toFixed(3)} s` : "", view.colour,
      (place % columns) * cellWidth + 10, Math.floor(place / columns) * cellHeight + 10, scale);
  });
  return canvas.toDataURL(type, 0.92);
}

// Buttons, sliders and keys around the stage.
import { gradient, modes } from "./colours.js";
import { presets } from "./stage.js";

function element(tag, properties = {}, ...children) {
  const node = Object.assign(document.createElement(tag), properties);
  node.append(...children);
  return node;
}

function choice(label, options, onChange) {
  const select = element("select", { ariaLabel: label });
  for (const [value, text] of options) select.append(element("option", { value, textContent: text }));
  select.addEventListener("change", () => onChange(select.value));
  return select;
}

const speeds = [0.05, 0.1, 0.25, 0.5, 1, 2];

export class Controls {
  constructor(host, stage, clock) {
    this.stage = stage;
    this.clock = clock;
    this.playButton = element("button", { textContent: "▶ Play", title: "space" });
    this.playButton.addEventListener("click", () => clock.play(!clock.playing));
    const step = (n, text, title) => {
      const button = element("button", { textContent: text, title, ariaLabel: title });
      button.addEventListener("click", () => this.step(n));
      return button;
    };
    this.slider = element("input", { type: "range", min: 0, max: 1, step: "any", value: 0, ariaLabel: "time" });
    this.slider.addEventListener("input", () => clock.seek(Number(this.slider.value)));
    this.readout = element("span", { className: "clock" });
    this.speed = choice("speed", speeds.map((s) => [s, `${s}×`]), (v) => (clock.speed = Number(v)));
    this.speed.value = clock.speed;
    const views = element("span", { className: "group" });
    presets.forEach((name, i) => {
      const button = element("button", { textContent: name, title: `key ${i + 1}` });
      button.addEventListener("click", () => stage.preset(name));
      views.append(button);
    });
    this.follow = element("button", { textContent: "follow projectile", title: "f", ariaPressed: "false" });
    this.follow.addEventListener("click", () => this.toggleFollow());
    this.contacts = element("button", { textContent: "contact points", title: "k", ariaPressed: "false" });
    this.contacts.addEventListener("click", () => this.toggleContacts());
    this.mode = choice("colour by", Object.entries(modes).map(([k, m]) => [k, `colour: ${m.name}`]),
      () => this.colour());
    this.legend = element("span", { className: "legend" });
    this.ghost = choice("ghost", [["-1", "no ghost"]], (v) => {
      stage.ghost = Number(v);
      stage.dirty = true;
    });
    this.engines = element("div", { className: "bar engines" });
    host.append(
      element("div", { className: "bar" }, this.playButton,
        element("span", { className: "group" }, step(-1, "◀", "step back (left arrow)"),
          step(1, "▶", "step on (right arrow)")), this.speed,
        element("span", { className: "grow" }, this.slider, this.readout)),
      element("div", { className: "bar" }, views, this.follow, this.contacts, this.mode, this.legend, this.ghost,
        element("span", { className: "hint",
          textContent: "drag: orbit · right drag: pan · wheel: zoom · space, arrows, 1–4, f, k, c, g, + −" })),
      this.engines);
    clock.subscribe(() => this.refresh());
  }

  load(scene, runs) {
    this.scene = scene;
    this.runs = runs;
    this.clock.end = Math.max(...runs.map((run) => run.times[run.frames - 1]));
    this.slider.max = this.clock.end;
    const mover = scene.bodies.some((body) => body.role === "projectile");
    this.follow.hidden = !mover;
    this.contacts.hidden = !runs.some((run) => run.contacts);
    this.mode.querySelector("[value=penetration]").disabled = !runs.some((run) => run.penetrations);
    this.ghost.replaceChildren(element("option", { value: "-1", textContent: "no ghost" }),
      ...scene.views.map((view, i) => element("option", { value: i, textContent: `ghost: ${view.engine}` })));
    this.engines.replaceChildren(...scene.views.map((view, i) => {
      const box = element("input", { type: "checkbox", checked: this.stage.visible.includes(i) });
      box.addEventListener("change", () => this.stage.show(
        [...this.engines.querySelectorAll("input")].flatMap((b, k) => (b.checked ? [k] : []))));
      const swatch = element("i", { className: "swatch" });
      swatch.style.background = view.colour;
      const label = element("label", {}, box, swatch, view.engine);
      return view.flagged_from === undefined ? label : element("span", { className: "group" }, label, this.flag(view));
    }));
    this.mode.value = "material";
    this.stage.ghost = -1;
    this.clock.playing = false;
    this.colour();
    this.clock.seek(0);
  }

  // A button that goes to the first flagged step of a run.
  flag(view) {
    const button = element("button", { className: "flag", textContent: `! ${view.flagged_from.toFixed(3)} s`,
      title: `${view.note}: not to be trusted from here on` });
    button.addEventListener("click", () => {
      this.clock.play(false);
      this.clock.seek(view.flagged_from);
    });
    return button;
  }

  // One recorded frame on or back.
  step(n) {
    this.clock.play(false);
    const times = this.runs[this.stage.visible[0] ?? 0].times;
    const at = times.findIndex((t) => t > this.clock.time + 1e-9);
    const now = at < 0 ? times.length - 1 : at - 1;
    const between = n < 0 && times[now] < this.clock.time - 1e-9;
    this.clock.seek(times[Math.min(Math.max(now + n + (between ? 1 : 0), 0), times.length - 1)]);
  }

  toggleFollow() {
    this.stage.follow = !this.stage.follow;
    this.follow.ariaPressed = String(this.stage.follow);
    this.stage.dirty = true;
  }

  toggleContacts() {
    this.stage.contacts = !this.stage.contacts;
    this.contacts.ariaPressed = String(this.stage.contacts);
    this.stage.dirty = true;
  }

  // The scale ends at the 98 % quantile over all bodies and views, so that one far brick does not
  // hide the rest.
  colour() {
    const mode = this.mode.value;
    const values = [];
    for (const { actors, run } of this.stage.views) {
      actors.mode = mode;
      if (mode === "material") continue;
      for (let f = 0; f < run.frames - 1; f += Math.max(1, Math.floor(run.frames / 12))) {
        this.scene.bodies.forEach((body, b) => {
          if (body.role === "brick") values.push(actors.value(b, { frame: f, share: 1 }));
        });
      }
    }
    values.sort((a, b) => a - b);
    const limit = values[Math.floor(0.98 * (values.length - 1))] || 1;
    this.limit = limit;
    this.stage.setMode(mode, limit);
    this.legend.replaceChildren();
    if (mode === "material") return;
    const bar = element("i");
    bar.style.background = gradient;
    this.legend.append("0", bar, `${limit.toPrecision(2)} ${modes[mode].unit}`);
  }

  refresh() {
    this.playButton.textContent = this.clock.playing ? "⏸ Pause" : "▶ Play";
    this.slider.value = this.clock.time;
    this.readout.textContent = `${this.clock.time.toFixed(3)} / ${this.clock.end.toFixed(2)} s`;
  }

  key(event) {
    const cycle = (select) => {
      const options = [...select.options].filter((o) => !o.disabled);
      select.value = options[(options.findIndex((o) => o.value === select.value) + 1) % options.length].value;
      select.dispatchEvent(new Event("change"));
    };
    const faster = (n) => {
      const i = Math.min(Math.max(speeds.indexOf(this.clock.speed) + n, 0), speeds.length - 1);
      this.clock.speed = speeds[i];
      this.speed.value = speeds[i];
    };
    const many = event.shiftKey ? 10 : 1;
    const actions = {
      " ": () => this.clock.play(!this.clock.playing),
      ArrowLeft: () => this.step(-many), ArrowRight: () => this.step(many),
      Home: () => this.clock.seek(0), End: () => this.clock.seek(this.clock.end),
      f: () => this.follow.hidden || this.toggleFollow(),
      k: () => this.contacts.hidden || this.toggleContacts(),
      c: () => cycle(this.mode), g: () => cycle(this.ghost),
      "+": () => faster(1), "=": () => faster(1), "-": () => faster(-1),
    };
    presets.forEach((name, i) => (actions[i + 1] = () => this.stage.preset(name)));
    const action = actions[event.key];
    if (action) {
      event.preventDefault();
      action();
    }
  }
}

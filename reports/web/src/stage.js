// The 3D stage: one WebGL context, one scissor viewport per engine, one camera for all of them.
import {
  BufferGeometry, Color, Float32BufferAttribute, Fog, LineBasicMaterial, LineSegments, Mesh,
  MeshBasicMaterial, PerspectiveCamera, PlaneGeometry, Scene, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Actors } from "./actors.js";
import { Dots } from "./dots.js";
import { frameAt } from "./decode.js";

const directions = {
  "three-quarter": [-0.62, -1, 0.42], front: [0, -1, 0.04], side: [-1, 0, 0.04], top: [0, -0.001, 1],
};
export const presets = Object.keys(directions);
const slowFrameMs = 70;

// A grid of (2 n)^2 squares in short pieces: some software renderers lose long lines that pass the
// camera.
function squares(n, step) {
  const points = [];
  for (let i = -n; i <= n; ++i) {
    for (let k = -n; k < n; ++k) {
      points.push(i * step, k * step, 0, i * step, (k + 1) * step, 0);
      points.push(k * step, i * step, 0, (k + 1) * step, i * step, 0);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
  return new LineSegments(geometry, new LineBasicMaterial());
}

// Whether WebGL has no GPU here: then smooth edges cost more than they are worth.
function drawsInSoftware() {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return true;
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER);
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

export class Stage {
  constructor(host, clock) {
    this.host = host;
    this.clock = clock;
    this.canvas = document.createElement("canvas");
    host.append(this.canvas);
    this.renderer = new WebGLRenderer({
      canvas: this.canvas, antialias: !drawsInSoftware(), powerPreference: "high-performance",
    });
    this.renderer.setScissorTest(true);
    // Pixels per CSS pixel: full when still, less while playing where the machine is slow.
    this.fullRatio = Math.min(window.devicePixelRatio || 1, 2);
    this.playRatio = this.fullRatio;
    this.ratio = this.fullRatio;
    this.adaptive = true;
    this.camera = new PerspectiveCamera(32, 1, 0.01, 500);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener("change", () => (this.dirty = true));
    this.labels = [];
    this.views = [];
    this.visible = [];
    this.ghost = -1;
    this.follow = false;
    this.contacts = false;
    this.dirty = true;
    this.frames = 0;
    this.costs = [];
    this.scene = new Scene();
    this.dark = matchMedia("(prefers-color-scheme: dark)");
    this.dark.addEventListener("change", () => this.dress());
    new ResizeObserver(() => this.resize()).observe(host);
    clock.subscribe(() => {
      this.markLabels();
      this.dirty = true;
    });
  }

  // `runs`: decoded views in the order of `scene.views`.
  load(scene, runs) {
    this.scene.clear();
    this.bodies = scene.bodies;
    this.views = scene.views.map((view, i) => ({
      view, run: runs[i], actors: new Actors(scene.bodies, runs[i]),
      ghost: new Actors(scene.bodies, runs[i], view.colour),
      dots: runs[i].contacts ? new Dots(runs[i]) : null,
    }));
    for (const { actors, ghost, dots } of this.views) {
      for (const { mesh } of [...actors.meshes, ...ghost.meshes]) this.scene.add(mesh);
      if (dots) this.scene.add(dots.mesh);
    }
    this.projectile = scene.bodies.findIndex((body) => body.role === "projectile");
    this.box = this.extent();
    this.furnish();
    this.show(scene.views.map((_, i) => i).slice(0, this.host.clientWidth < 560 ? 2 : 4));
    this.preset("three-quarter");
  }

  // What the camera frames: the bricks at the start, and where most of them are at the end.
  extent() {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    const movers = this.bodies.map((body, b) => ({ body, b })).filter((x) => x.body.role !== "fixed");
    const bricks = movers.filter((x) => x.body.role === "brick");
    const focus = bricks.length > 0 ? bricks : movers.length > 0 ? movers :
      this.bodies.map((body, b) => ({ body, b })).filter((x) => x.body.shape !== "plane");
    const run = this.views[0].run;
    const add = (k, value, reach) => {
      low[k] = Math.min(low[k], value - reach);
      high[k] = Math.max(high[k], value + reach);
    };
    for (const { body, b } of focus) {
      const reach = body.shape === "sphere" ? body.half[0] : Math.hypot(...body.half) * 0.7;
      for (let k = 0; k < 3; ++k) add(k, run.positions[3 * b + k], reach);
    }
    const size = Math.max(...high.map((h, k) => h - low[k]));
    for (let k = 0; k < 3; ++k) {
      const ends = this.views.flatMap(({ run: r }) => focus.map(({ b }) =>
        r.positions[3 * ((r.frames - 1) * r.bodies + b) + k])).sort((a, b) => a - b);
      const [from, to] = [0.05, 0.95].map((q) => ends[Math.floor(q * (ends.length - 1))]);
      low[k] = Math.min(low[k], Math.max(from, low[k] - 0.6 * size));
      high[k] = Math.max(high[k], Math.min(to, high[k] + 0.6 * size));
    }
    return { low, high, size };
  }

  furnish() {
    const { low, high, size } = this.box;
    const span = 16 * size;
    this.floor = new Mesh(new PlaneGeometry(span, span), new MeshBasicMaterial());
    const plane = this.bodies.findIndex((body) => body.shape === "plane");
    const height = plane >= 0 ? this.views[0].run.positions[3 * plane + 2] : low[2];
    const step = 10 ** Math.round(Math.log10(size / 4));
    this.grid = squares(Math.min(40, Math.ceil(span / step / 2)), step);
    for (const item of [this.floor, this.grid]) {
      item.position.set((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, height);
      this.scene.add(item);
    }
    // Painted in order, without depth: floor, then grid, then what stands on it.
    this.floor.material.depthWrite = false;
    this.floor.renderOrder = -2;
    this.grid.renderOrder = -1;
    this.grid.material.depthWrite = false;
    this.floor.visible = this.grid.visible = plane >= 0;
    this.dress();
  }

  dress() {
    const dark = this.dark.matches;
    this.background = new Color(dark ? 0x1b2026 : 0xdfe6ec);
    this.scene.fog = new Fog(this.background);
    if (this.floor) {
      this.floor.material.color.set(dark ? 0x2a3038 : 0xc9d1d8);
      this.grid.material.color.set(dark ? 0x56616c : 0x8e9aa5);
    }
    this.dirty = true;
  }

  show(indices) {
    this.visible = indices;
    this.resize();
  }

  cells() {
    const width = this.host.clientWidth;
    const count = Math.max(this.visible.length, 1);
    const columns = width < 560 ? 1 : count === 1 ? 1 : count <= 4 ? 2 : 3;
    const rows = Math.ceil(count / columns);
    const cellWidth = width / columns;
    const shape = count === 1 ? 0.5 : width < 560 ? 0.62 : 0.56;
    return { columns, rows, cellWidth, cellHeight: Math.round(cellWidth * shape) };
  }

  resize() {
    if (this.views.length === 0) return;
    this.layout = this.cells();
    const { columns, rows, cellWidth, cellHeight } = this.layout;
    this.host.style.height = `${rows * cellHeight}px`;
    this.renderer.setPixelRatio(this.ratio);
    this.renderer.setSize(this.host.clientWidth, rows * cellHeight, false);
    this.camera.aspect = cellWidth / cellHeight;
    this.camera.updateProjectionMatrix();
    for (const label of this.labels) label.remove();
    this.labels = this.visible.map((index, place) => {
      const { view } = this.views[index];
      const label = document.createElement("div");
      label.className = "view-label";
      label.style.left = `${(place % columns) * cellWidth}px`;
      label.style.top = `${Math.floor(place / columns) * cellHeight}px`;
      label.style.borderColor = view.colour;
      label.style.maxWidth = `${cellWidth - 16}px`;
      label.textContent = view.engine;
      if (view.flagged_from !== undefined) label.dataset.flaggedFrom = view.flagged_from;
      if (view.note) {
        const note = document.createElement("small");
        note.textContent = view.note;
        label.title = view.note;
        label.append(note);
      }
      this.host.append(label);
      return label;
    });
    this.markLabels();
    this.dirty = true;
  }

  // A label stands out from the first flagged step of its run on.
  markLabels() {
    for (const label of this.labels) {
      const from = label.dataset.flaggedFrom;
      label.classList.toggle("flagged", from !== undefined && this.clock.time >= Number(from) - 1e-9);
    }
  }

  // Moves the camera so that the box fills the view from this side.
  preset(name) {
    const { low, high } = this.box;
    const centre = new Vector3(...low.map((l, k) => (l + high[k]) / 2));
    const back = new Vector3(...directions[name]).normalize();
    const right = new Vector3().crossVectors(new Vector3(0, 0, 1), back).normalize();
    const up = new Vector3().crossVectors(back, right);
    const tanY = Math.tan((this.camera.fov * Math.PI) / 360);
    const tanX = tanY * this.camera.aspect;
    let distance = 0;
    for (let corner = 0; corner < 8; ++corner) {
      const p = new Vector3(...low.map((l, k) => ((corner >> k) & 1 ? high[k] : l))).sub(centre);
      distance = Math.max(distance, p.dot(back) + Math.abs(p.dot(right)) / tanX,
        p.dot(back) + Math.abs(p.dot(up)) / tanY);
    }
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(back, 1.08 * distance);
    this.camera.near = distance / 200;
    this.camera.far = distance * 20;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.dirty = true;
  }

  setMode(mode, limit) {
    for (const { actors } of this.views) {
      actors.mode = mode;
      actors.limit = limit;
    }
    this.dirty = true;
  }

  followProjectile() {
    const place = frameAt(this.views[this.visible[0]].run.times, this.clock.time);
    const where = this.views[this.visible[0]].actors.position(this.projectile, place, new Vector3());
    const shift = where.sub(this.controls.target);
    this.camera.position.add(shift);
    this.controls.target.add(shift);
    this.controls.update();
  }

  draw() {
    if (this.views.length === 0 || !this.layout) return;
    const { columns, rows, cellWidth, cellHeight } = this.layout;
    if (this.follow && this.projectile >= 0 && this.visible.length > 0) this.followProjectile();
    this.renderer.setScissor(0, 0, this.host.clientWidth, rows * cellHeight);
    this.renderer.setViewport(0, 0, this.host.clientWidth, rows * cellHeight);
    // Far lines of the floor fade into the sky instead of flickering.
    const reach = this.camera.position.distanceTo(this.controls.target);
    this.scene.fog.near = 1.1 * reach;
    this.scene.fog.far = 4 * reach;
    this.renderer.setClearColor(this.background);
    this.renderer.clear();
    for (const { actors, ghost } of this.views) {
      actors.show(false);
      ghost.show(false);
    }
    this.visible.forEach((index, place) => {
      const { actors, dots } = this.views[index];
      const ghost = this.ghost >= 0 && this.ghost !== index ? this.views[this.ghost].ghost : null;
      actors.update(this.clock.time);
      actors.show(true);
      if (ghost) {
        ghost.update(this.clock.time);
        ghost.show(true);
      }
      if (dots && this.contacts) {
        dots.update(this.clock.time);
        dots.mesh.visible = true;
      }
      const x = (place % columns) * cellWidth;
      const y = (rows - 1 - Math.floor(place / columns)) * cellHeight;
      this.renderer.setViewport(x, y, cellWidth, cellHeight);
      this.renderer.setScissor(x + 1, y + 1, cellWidth - 2, cellHeight - 2);
      this.renderer.render(this.scene, this.camera);
      actors.show(false);
      if (ghost) ghost.show(false);
      if (dots) dots.mesh.visible = false;
    });
    ++this.frames;
    this.dirty = false;
  }

  // Called once per animation frame. Lowers the resolution where the machine is slow.
  tick(now) {
    const elapsed = this.before ? now - this.before : 0;
    this.before = now;
    this.clock.advance(Math.min(elapsed, 250) / 1000);
    const wanted = this.clock.playing ? this.playRatio : this.fullRatio;
    if (this.adaptive && wanted !== this.ratio) {
      this.ratio = wanted;
      this.resize();
    }
    if (!this.dirty) return;
    if (this.clock.playing) {
      this.costs.push(elapsed);
      if (this.costs.length >= 8) {
        const median = this.costs.sort((a, b) => a - b)[4];
        if (median > slowFrameMs && this.playRatio > 0.6) {
          this.playRatio = this.playRatio > 1 ? 1 : Math.max(0.6, this.playRatio * 0.8);
        }
        this.costs = [];
      }
    }
    this.draw();
  }
}

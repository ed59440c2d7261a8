// The page: data from the <script> element, plots, and the replay.
import { Clock } from "./clock.js";
import { Controls } from "./controls.js";
import { decodeView } from "./decode.js";
import { arrange, picture } from "./picture.js";
import { drawPlots } from "./plots.js";
import { Stage } from "./stage.js";

const data = JSON.parse(document.getElementById("data").textContent);
const clock = new Clock();
const drawAllPlots = drawPlots(data.figures, clock);

async function openReplay(host) {
  const stageHost = document.createElement("div");
  stageHost.className = "stage";
  stageHost.tabIndex = 0;
  const chooser = document.createElement("div");
  chooser.className = "bar";
  host.append(chooser, stageHost);
  let stage;
  try {
    stage = new Stage(stageHost, clock);
  } catch (error) {
    stageHost.className = "bar";
    stageHost.textContent = `No 3D view: this browser offers no WebGL (${error.message}).`;
    return null;
  }
  const controls = new Controls(host, stage, clock);
  const load = async (index) => {
    const scene = data.scenes[index];
    stageHost.dataset.state = "loading";
    const runs = await Promise.all(scene.views.map((view) => decodeView(view, scene.bodies.length)));
    stage.load(scene, runs);
    controls.load(scene, runs);
    stage.draw();
    stageHost.dataset.state = "ready";
  };
  const select = document.createElement("select");
  select.ariaLabel = "scene";
  data.scenes.forEach((scene, i) => select.append(new Option(scene.name, i)));
  select.addEventListener("change", () => load(Number(select.value)));
  chooser.append(select);
  chooser.hidden = data.scenes.length < 2;
  addEventListener("keydown", (event) => {
    if (event.target.closest("input:not([type=range]), select, textarea")) return;
    if (event.target.closest("button") && event.key === " ") return;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { top, bottom } = host.getBoundingClientRect();
    if (bottom > 0 && top < innerHeight) controls.key(event);
  });
  await load(0);
  const loop = (now) => {
    stage.tick(now);
    requestAnimationFrame(loop);
  };
  requestAnimationFrame(loop);
  return { stage, controls, load };
}

// What tests and `brickbench render` drive.
const host = document.querySelector("[data-replay]");
const ready = host ? openReplay(host) : Promise.resolve(null);
window.brickbench = { data, clock, ready, drawAllPlots, arrange, picture };
ready.catch((error) => {
  console.error(error);
  host.append(`The replay could not be opened: ${error.message}`);
});

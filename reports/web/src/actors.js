// The bodies of one view: instanced boxes and spheres, shaded in one cheap shader of our own, so
// that software rendering is quick and every brick has edges.
import {
  BoxGeometry, Color, DynamicDrawUsage, InstancedBufferAttribute, InstancedMesh, Matrix4, Quaternion,
  ShaderMaterial, SphereGeometry, Vector3,
} from "three";
import { frameAt } from "./decode.js";
import { materialColour, scale } from "./colours.js";

const vertexShader = `
  attribute vec3 tint;
  varying vec3 vColour;
  varying vec2 vUv;
  void main() {
    mat4 m = modelMatrix * instanceMatrix;
    vec3 n = normalize(mat3(m) * (normal / vec3(dot(m[0].xyz, m[0].xyz), dot(m[1].xyz, m[1].xyz),
      dot(m[2].xyz, m[2].xyz))));
    float light = 0.58 + 0.30 * max(dot(n, normalize(vec3(-0.35, -0.75, 0.55))), 0.0)
      + 0.22 * max(n.z, 0.0);
    vColour = tint * light;
    vUv = uv;
    gl_Position = projectionMatrix * viewMatrix * m * vec4(position, 1.0);
  }`;
const fragmentShader = `
  uniform float alpha;
  uniform float edges;
  varying vec3 vColour;
  varying vec2 vUv;
  void main() {
    vec2 d = min(vUv, 1.0 - vUv) / max(fwidth(vUv), vec2(1e-5));
    float edge = edges * (1.0 - smoothstep(0.4, 1.5, min(d.x, d.y)));
    gl_FragColor = vec4(vColour * (1.0 - 0.55 * edge), alpha);
  }`;

function material(edges, alpha) {
  return new ShaderMaterial({
    vertexShader, fragmentShader, transparent: alpha < 1, depthWrite: alpha === 1,
    uniforms: { alpha: { value: alpha }, edges: { value: edges } },
  });
}

const matrix = new Matrix4();
const position = new Vector3();
const turn = new Quaternion();
const turnNext = new Quaternion();
const size = new Vector3();
const colour = new Float32Array(3);

export class Actors {
  constructor(bodies, run, ghostColour = null) {
    this.bodies = bodies;
    this.run = run;
    this.ghost = ghostColour;
    this.meshes = [];
    const shown = bodies.map((body, index) => ({ body, index })).filter((x) =>
      x.body.shape !== "plane" && !(ghostColour && x.body.role === "fixed"));
    for (const shape of ["box", "sphere"]) {
      const items = shown.filter((x) => x.body.shape === shape);
      if (items.length === 0) continue;
      const geometry = shape === "box" ? new BoxGeometry(2, 2, 2) : new SphereGeometry(1, 20, 14);
      const alpha = ghostColour ? 0.28 : 1;
      const mesh = new InstancedMesh(geometry, material(shape === "box" ? 1 : 0, alpha), items.length);
      const tint = new InstancedBufferAttribute(new Float32Array(3 * items.length), 3);
      tint.setUsage(DynamicDrawUsage);
      mesh.instanceMatrix.setUsage(DynamicDrawUsage);
      geometry.setAttribute("tint", tint);
      mesh.frustumCulled = false;
      mesh.visible = false;
      this.meshes.push({ mesh, items, tint });
    }
    this.mode = "material";
    this.limit = 1;
    this.tinted = "";
  }

  show(visible) {
    for (const { mesh } of this.meshes) mesh.visible = visible;
  }

  // Interpolated position of body b at the place {frame, share}.
  position(b, place, out = position) {
    const { positions, bodies, frames } = this.run;
    const from = 3 * (place.frame * bodies + b);
    const to = 3 * (Math.min(place.frame + 1, frames - 1) * bodies + b);
    out.fromArray(positions, from);
    for (const [k, axis] of ["x", "y", "z"].entries()) {
      out[axis] += place.share * (positions[to + k] - out[axis]);
    }
    return out;
  }

  // The number that the colour shows, in SI units.
  value(b, place) {
    const { positions, penetrations, bodies, frames, times } = this.run;
    if (this.mode === "penetration") {
      return penetrations ? penetrations[(place.share > 0.5 ? Math.min(place.frame + 1, frames - 1) :
        place.frame) * bodies + b] : 0;
    }
    if (this.mode === "speed") {
      const next = Math.min(place.frame + 1, frames - 1);
      const p = 3 * (place.frame * bodies + b);
      const q = 3 * (next * bodies + b);
      const dt = times[next] - times[place.frame] || 1;
      return Math.hypot(positions[q] - positions[p], positions[q + 1] - positions[p + 1],
        positions[q + 2] - positions[p + 2]) / dt;
    }
    this.position(b, place);
    return Math.hypot(position.x - positions[3 * b], position.y - positions[3 * b + 1],
      position.z - positions[3 * b + 2]);
  }

  update(time) {
    const place = frameAt(this.run.times, time);
    const { orientations, bodies, frames } = this.run;
    const next = Math.min(place.frame + 1, frames - 1);
    const key = this.mode === "material" ? "material" : `${this.mode} ${time} ${this.limit}`;
    for (const { mesh, items, tint } of this.meshes) {
      for (let i = 0; i < items.length; ++i) {
        const { body, index } = items[i];
        this.position(index, place);
        turn.fromArray(orientations, 4 * (place.frame * bodies + index));
        turnNext.fromArray(orientations, 4 * (next * bodies + index));
        turn.normalize().slerp(turnNext.normalize(), place.share);
        size.fromArray(body.half);
        matrix.compose(position, turn, size).toArray(mesh.instanceMatrix.array, 16 * i);
        if (key !== this.tinted) this.paint(body, index, place, tint.array, 3 * i);
      }
      mesh.instanceMatrix.needsUpdate = true;
      if (key !== this.tinted) tint.needsUpdate = true;
    }
    this.tinted = key;
  }

  paint(body, index, place, array, at) {
    if (this.ghost) {
      new Color(this.ghost).toArray(colour);
    } else if (this.mode === "material" || body.role === "fixed") {
      materialColour(body.role, index, colour, 0);
    } else {
      scale(this.value(index, place) / this.limit, colour, 0);
    }
    array.set(colour, at);
  }
}

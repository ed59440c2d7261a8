// The contact points of one view, drawn over the bricks: most of them lie between two.
import { BufferGeometry, DynamicDrawUsage, Float32BufferAttribute, Points, PointsMaterial } from "three";
import { frameAt } from "./decode.js";

export class Dots {
  constructor(run) {
    this.run = run;
    const { offsets } = run.contacts;
    let most = 0;
    for (let f = 0; f + 1 < offsets.length; ++f) most = Math.max(most, offsets[f + 1] - offsets[f]);
    this.positions = new Float32BufferAttribute(new Float32Array(3 * Math.max(most, 1)), 3);
    this.positions.setUsage(DynamicDrawUsage);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", this.positions);
    this.mesh = new Points(geometry, new PointsMaterial({
      color: 0x00b4f0, fog: false, size: 3.5, sizeAttenuation: false, depthTest: false, transparent: true, opacity: 0.85,
    }));
    this.mesh.renderOrder = 2;
    this.mesh.frustumCulled = false;
    this.mesh.visible = false;
  }

  // The points of the last frame that has any in the page.
  update(time) {
    const { offsets, points, stride } = this.run.contacts;
    const { frame, share } = frameAt(this.run.times, time);
    const now = Math.min(share >= 1 ? frame + 1 : frame, this.run.frames - 1);
    const from = offsets[now - (now % stride)];
    const to = offsets[now - (now % stride) + 1];
    this.positions.array.set(points.subarray(3 * from, 3 * to));
    this.positions.needsUpdate = true;
    this.mesh.geometry.setDrawRange(0, to - from);
  }
}

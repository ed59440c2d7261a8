// Recorded motion, as reports/src/replay.cpp encodes it.

async function inflate(base64) {
  const packed = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Contact points as reports/src/replay.cpp encodes them: { offsets: Uint32Array (frames + 1), points:
// Float32Array (points, 3), stride } or null.
async function decodeContacts(view) {
  if (!view.contacts) return null;
  const bytes = await inflate(view.contacts);
  const words = bytes.length / 4;
  const frames = view.times.length;
  let at = 0;
  const run = (count, store) => {
    let value = 0;
    for (let i = 0; i < count; ++i, ++at) {
      const zigzag = (bytes[at] | (bytes[words + at] << 8) | (bytes[2 * words + at] << 16) |
        (bytes[3 * words + at] << 24)) >>> 0;
      value += (zigzag >>> 1) ^ -(zigzag & 1);
      store(i, value);
    }
  };
  const offsets = new Uint32Array(frames + 1);
  run(frames, (f, count) => (offsets[f + 1] = offsets[f] + count));
  const total = offsets[frames];
  if (words !== frames + 3 * total) throw new Error(`${view.engine}: contacts do not fit`);
  const points = new Float32Array(3 * total);
  for (let k = 0; k < 3; ++k) run(total, (i, value) => (points[3 * i + k] = value * view.contact_lattice));
  return { offsets, points, stride: view.contact_stride };
}

// { times, bodies, frames, positions: Float32Array (frames, bodies, 3), orientations (frames,
// bodies, 4) as x y z w, penetrations (frames, bodies) or null, contacts }
export async function decodeView(view, bodies) {
  const bytes = await inflate(view.data);
  const frames = view.times.length;
  const words = bytes.length / 4;
  const channel = bodies * frames;
  const expected = channel * (view.has_penetration ? 8 : 7);
  if (words !== expected) throw new Error(`${view.engine}: ${words} words instead of ${expected}`);
  const positions = new Float32Array(3 * channel);
  const orientations = new Float32Array(4 * channel);
  const penetrations = view.has_penetration ? new Float32Array(channel) : null;
  let at = 0;
  const read = (out, width, offset, lattice) => {
    let value = 0;
    for (let f = 0; f < frames; ++f, ++at) {
      const zigzag = (bytes[at] | (bytes[words + at] << 8) | (bytes[2 * words + at] << 16) |
        (bytes[3 * words + at] << 24)) >>> 0;
      value += (zigzag >>> 1) ^ -(zigzag & 1);
      out[f * width + offset] = value * lattice;
    }
  };
  for (let k = 0; k < 3; ++k) {
    for (let b = 0; b < bodies; ++b) read(positions, 3 * bodies, 3 * b + k, view.position_lattice);
  }
  for (let b = 0; b < bodies; ++b) {
    for (let k = 0; k < 4; ++k) {
      read(orientations, 4 * bodies, 4 * b + ((k + 3) % 4), view.quaternion_lattice);
    }
  }
  if (penetrations) {
    for (let b = 0; b < bodies; ++b) read(penetrations, bodies, b, view.penetration_lattice);
  }
  const contacts = await decodeContacts(view);
  return { times: view.times, bodies, frames, positions, orientations, penetrations, contacts };
}

// The frame before t and the share of the way to the next one.
export function frameAt(times, t) {
  let low = 0;
  let high = times.length - 1;
  if (t <= times[0] || high === 0) return { frame: 0, share: 0 };
  if (t >= times[high]) return { frame: high - 1, share: 1 };
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle;
    else high = middle;
  }
  return { frame: low, share: (t - times[low]) / (times[high] - times[low]) };
}

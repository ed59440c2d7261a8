// Colour scales of the 3D view: cividis-like, readable with every kind of colour vision.
const stops = [[0x20, 0x3a, 0x70], [0x4f, 0x57, 0x6c], [0x7c, 0x7b, 0x78], [0xb8, 0xa8, 0x66],
  [0xff, 0xe0, 0x3f]];

export function scale(share, out, at) {
  const x = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
  const i = Math.min(Math.floor(x), stops.length - 2);
  for (let k = 0; k < 3; ++k) {
    out[at + k] = (stops[i][k] + (stops[i + 1][k] - stops[i][k]) * (x - i)) / 255;
  }
}

export const gradient =
  `linear-gradient(to right, ${stops.map((s) => `rgb(${s.join(" ")})`).join(", ")})`;

// Bricks of a slightly different shade each, the same in all views; the projectile stands out.
export function materialColour(role, index, out, at) {
  if (role === "projectile") {
    out[at] = 0.84; out[at + 1] = 0.12; out[at + 2] = 0.36;
    return;
  }
  const shade = 0.86 + 0.22 * (((index * 2654435761) >>> 8) % 1000) / 1000;
  const base = role === "fixed" ? [0.52, 0.55, 0.58] : [0.80, 0.66, 0.52];
  for (let k = 0; k < 3; ++k) out[at + k] = Math.min(1, base[k] * shade);
}

export const modes = {
  material: { name: "material", unit: "" },
  displacement: { name: "displacement", unit: "m" },
  speed: { name: "speed", unit: "m/s" },
  penetration: { name: "penetration", unit: "m" },
};

// The one time that replay and plots share.
export class Clock {
  constructor() {
    this.time = 0;
    this.end = 0;
    this.speed = 0.25;
    this.playing = false;
    this.listeners = [];
  }
  subscribe(listener) {
    this.listeners.push(listener);
  }
  seek(time, source = null) {
    this.time = Math.min(Math.max(time, 0), this.end);
    for (const listener of this.listeners) listener(this.time, source);
  }
  play(on) {
    if (on && this.time >= this.end) this.seek(0);
    this.playing = on;
    for (const listener of this.listeners) listener(this.time, null);
  }
  advance(elapsed) {
    if (!this.playing) return;
    const next = this.time + elapsed * this.speed;
    if (next >= this.end) this.playing = false;
    this.seek(next);
  }
}

"use strict";
// The one instant and the one stretch of time that plots and cars show.

const clock = {
  now: 0,
  begin: 0,
  end: 1,
  range: [0, 1],
  speed: 1,
  playing: false,
  follows: false, // whether what comes sets the instant, and no hand
  onTime: new Set(),
  onRange: new Set(),

  /** Show another instant [s]. */
  set(time) {
    this.now = Math.min(Math.max(time, this.begin), this.end);
    for (const listener of this.onTime) listener(this.now);
  },

  /** Show another stretch of time [s], no longer than all and no shorter than a millisecond. */
  zoom(begin, end) {
    const low = Math.max(begin, this.begin);
    const high = Math.min(end, this.end);
    if (!(high - low >= 1e-3) || (low === this.range[0] && high === this.range[1])) return;
    this.range = [low, high];
    for (const listener of this.onRange) listener(low, high);
  },

  /** Zoom about the present instant; a factor below 1 shows less. */
  zoomBy(factor) {
    const [begin, end] = this.range;
    const centre = this.now >= begin && this.now <= end ? this.now : (begin + end) / 2;
    this.zoom(centre - (centre - begin) * factor, centre + (end - centre) * factor);
  },

  all() {
    this.zoom(this.begin, this.end);
  },

  /** Let time run, or stop it; at the end it begins anew. */
  play(on) {
    this.playing = on;
    if (!on) return;
    if (this.now >= this.end) this.set(this.begin);
    let last = performance.now();
    const tick = (present) => {
      if (!this.playing) return;
      this.set(this.now + ((present - last) / 1000) * this.speed);
      last = present;
      if (this.now >= this.end) this.playing = false;
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  },
};

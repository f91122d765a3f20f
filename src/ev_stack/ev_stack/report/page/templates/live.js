"use strict";
// The signals of a running graph: rows come one by one, and the oldest ones go.

const MOST = 6000; // samples that are kept
const LOST_AT_ONCE = 1000; // the oldest ones, so that arrays are not moved for each sample
const live = { times: [], values: {}, groups: [], run: { name: "", car: null, channels: {} } };

/** Samples of a channel, which grow. */
function samples(run, channel) {
  return live.values[channel];
}

/** Instants of the samples [s], which grow. */
function instants() {
  return live.times;
}

/** Other columns, another car or another run: begin with empty series. */
function relaid({ channels, groups, car }) {
  live.times = [];
  live.groups = groups;
  live.values = Object.fromEntries(channels.map((channel) => [channel, []]));
  live.run = { name: "", car, channels: Object.fromEntries(channels.map((channel) => [channel, true])) };
}

/** Take a row of numbers over; false if it does not fit or is no later than the last one. */
function took([time, ...numbers]) {
  const series = Object.values(live.values);
  if (series.length !== numbers.length || time <= live.times[live.times.length - 1]) return false;
  live.times.push(time);
  series.forEach((values, n) => values.push(Number.isFinite(numbers[n]) ? numbers[n] : null));
  if (live.times.length > MOST) for (const values of [live.times, ...series]) values.splice(0, LOST_AT_ONCE);
  return true;
}

"use strict";
// What is computed with series of samples.

/** Index of the last instant that is not after `time`, at least 0. */
function indexAt(times, time) {
  let low = 0;
  let high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= time + 1e-9) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** Second minus first at the instants of the first, between samples of the second linear; null where one has none. */
function difference(times, first, otherTimes, second) {
  return Array.from(times, (time, n) => {
    if (first[n] == null || time < otherTimes[0] || time > otherTimes[otherTimes.length - 1] + 1e-9) return null;
    const before = indexAt(otherTimes, time);
    const after = Math.min(before + 1, otherTimes.length - 1);
    if (second[before] == null || second[after] == null) return null;
    const span = otherTimes[after] - otherTimes[before];
    const part = span > 0 ? Math.min(Math.max((time - otherTimes[before]) / span, 0), 1) : 0;
    return second[before] + (second[after] - second[before]) * part - first[n];
  });
}

/** A number with so many decimals, and without a sign where these are all zero. */
function fixed(value, decimals) {
  return (Number(value.toFixed(decimals)) + 0).toFixed(decimals);
}

/** A number with five digits that count. */
function digits(value) {
  return value == null ? "–" : String(Number(value.toPrecision(5)));
}

"use strict";
// Packed signals of the page (see writing.py, `pack`), unpacked when something draws them first.

const INDEX = JSON.parse(document.getElementById("index").textContent);
const GAP = 0;
const unpacked = new Map();

/** Samples of a channel: a Float64Array, or an array with null for gaps; undefined if the run has no such channel. */
async function samples(run, channel) {
  const packed = run.channels[channel];
  return packed && unpackedOnce(packed);
}

/** Instants of a run [s]. */
function instants(run) {
  return unpackedOnce(run.time);
}

function unpackedOnce(packed) {
  if (!unpacked.has(packed)) unpacked.set(packed, unpack(packed));
  return unpacked.get(packed);
}

async function unpack({ block, low, step, count, planes }) {
  const bytes = await inflated(document.getElementById(`block-${block}`).textContent);
  const mask = 2 ** (8 * planes) - 1;
  const values = new Float64Array(count);
  const gaps = [];
  let code = 0;
  for (let n = 0; n < count; n++) {
    let change = 0;
    for (let plane = 0; plane < planes; plane++) change |= bytes[plane * count + n] << (8 * plane);
    code = (code + change) & mask;
    if (code === GAP) gaps.push(n);
    values[n] = low + (code - 1) * step;
  }
  if (!gaps.length) return values;
  const withGaps = Array.from(values);
  for (const n of gaps) withGaps[n] = null;
  return withGaps;
}

async function inflated(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

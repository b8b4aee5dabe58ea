/*!
@license Plots: Observable Plot, Copyright 2020-2023 Observable, Inc.; D3, Copyright 2010-2023 Mike Bostock. ISC licence:
Permission to use, copy, modify, and/or distribute this software for any purpose with or without fee is hereby granted,
provided that the above copyright notice and this permission notice appear in all copies. THE SOFTWARE IS PROVIDED "AS
IS" AND THE AUTHOR DISCLAIMS ALL WARRANTIES WITH REGARD TO THIS SOFTWARE INCLUDING ALL IMPLIED WARRANTIES OF
MERCHANTABILITY AND FITNESS. IN NO EVENT SHALL THE AUTHOR BE LIABLE FOR ANY SPECIAL, DIRECT, INDIRECT, OR CONSEQUENTIAL
DAMAGES OR ANY DAMAGES WHATSOEVER RESULTING FROM LOSS OF USE, DATA OR PROFITS, WHETHER IN AN ACTION OF CONTRACT,
NEGLIGENCE OR OTHER TORTIOUS ACTION, ARISING OUT OF OR IN CONNECTION WITH THE USE OR PERFORMANCE OF THIS SOFTWARE.
*/
// The style of all plots. Observable Plot draws them as SVG, which prints and scales; colours come from the
// style sheet.

import { plot } from '@observablehq/plot';

const MARGINS = 62; // margins of the page and a figure, left and right
// No wider than a phone, so that letters keep their size.
const widthUpTo = (most) => Math.max(320, Math.min(most, innerWidth - MARGINS));
const WIDTH = widthUpTo(560);
export const FULL_WIDTH = widthUpTo(1140); // of a figure alone in its row
const MOST_BUCKETS = 20000; // far more than a plot has pixels, and than a run of ten minutes has frames
const STYLE = { fontSize: '13px', background: 'transparent', color: 'var(--soft)', overflow: 'visible' };

/** A plot with `marks`; `title` is the accessible description. */
export function draw(title, marks, options = {}) {
  const marginBottom = 42; // the label of the axis is below its numbers
  const drawn = plot({ width: WIDTH, height: 272, marginLeft: 48, marginBottom, grid: true, style: STYLE, ariaLabel: title, marks, ...options });
  // One picture for a screen reader: Plot labels groups ("bar"), which have no role that allows it.
  drawn.setAttribute('role', 'img');
  drawn.querySelectorAll('g[aria-label]').forEach((group) => group.removeAttribute('aria-label'));
  return drawn;
}

/** Ranges of x and y for a plot with equal scales on both axes that is neither too high nor too flat. */
export function evenRanges(xs, ys) {
  const [lowest, highest] = [0.3, 0.8]; // height relative to width
  const spread = (values) => (values.length ? extent(values) : [0, 1]);
  const widened = ([low, high], size) => [(low + high - size) / 2, (low + high + size) / 2];
  const [x, y] = [spread(xs), spread(ys)];
  const margin = 1.08;
  const width = margin * Math.max(x[1] - x[0], (y[1] - y[0]) / highest, 0.1);
  const height = Math.max(margin * (y[1] - y[0]), lowest * width);
  return { x: widened(x, width), y: widened(y, height) };
}

/** Rows from columns: { t: [0, 1], mm: [5, 6] } -> [{ t: 0, mm: 5 }, { t: 1, mm: 6 }]. */
export function rows(columns) {
  const names = Object.keys(columns);
  return columns[names[0]].map((_, i) => Object.fromEntries(names.map((name) => [name, columns[name][i]])));
}

/** [least, greatest] of the values; as arguments of Math.min, those of a long run would overflow the stack. */
export function extent(values) {
  return values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
}

/** Successive rows together, so that no plot of a long run is drawn of more than MOST_BUCKETS; else each alone. */
export function buckets(rows) {
  const size = Math.max(1, Math.ceil(rows.length / MOST_BUCKETS));
  return Array.from({ length: Math.ceil(rows.length / size) }, (_, i) => rows.slice(i * size, (i + 1) * size));
}

/** The rows with the least and the greatest `y` of every bucket: peaks stay. */
export function outline(rows, y) {
  return buckets(rows).flatMap((bucket) => {
    const low = bucket.reduce((a, b) => (b[y] < a[y] ? b : a));
    const high = bucket.reduce((a, b) => (b[y] > a[y] ? b : a));
    return bucket.filter((row) => row === low || row === high);
  });
}

/** The quantile at `share` of the values. */
export function quantile(values, share) {
  const sorted = Float64Array.from(values).sort();
  return sorted[Math.floor(share * (sorted.length - 1))];
}

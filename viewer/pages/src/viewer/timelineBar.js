// The bar of the timeline: for each run the state of every frame, keyframes and loops; a plot; and the cursor over all of
// them.

import { millimetres } from '../shared/format.js';

const BAR_PX = 10; // height of a coloured bar
const MARKS_PX = 10; // height of the keyframes' ticks and the loops' marks below it
const STATUS_COLORS = ['--good', '--loop', '--bad'];
const PLOT_COLORS = ['--before', '--after']; // of two runs
const LABELS = {
  tracked: (figure) => `${figure} tracked`,
  errorM: (figure) => `error ${millimetres(figure)}`,
  sigmaM: (figure) => `\u03c3 ${millimetres(figure)}`,
  ms: (figure) => `${figure.toFixed(0)} ms`,
};

export class TimelineBar {
  /** Draws into `canvas`, a slider; calls onSeek(timeS) when the user points at a moment. */
  constructor(canvas, onSeek) {
    Object.assign(this, { canvas, onSeek });
    this.still = document.createElement('canvas'); // all but the cursor
    this.tracks = [];
    const seek = ({ offsetX }) => this.tracks.length > 0 && onSeek(this.timeAt(offsetX));
    canvas.onpointerdown = (event) => {
      canvas.setPointerCapture(event.pointerId);
      seek(event);
    };
    canvas.onpointermove = (event) => event.buttons > 0 && seek(event);
    new ResizeObserver(() => this.redraw()).observe(canvas);
    new MutationObserver(() => this.redraw()).observe(document.documentElement, { attributeFilter: ['data-theme'] });
  }

  /** `moments`: how many there are, of all tracks. */
  show(tracks, figure, moments) {
    Object.assign(this, { tracks, figure });
    this.timeS = undefined; // of the cursor
    this.loops = tracks.map(() => []);
    this.endS = Math.max(1e-9, ...tracks.map(({ endS }) => endS));
    this.canvas.setAttribute('aria-valuemax', moments - 1);
    this.redraw();
  }

  /** Plots another figure of the frames. */
  plot(figure) {
    this.figure = figure;
    this.redraw();
  }

  /** `loops`: for each track the frames of the keyframes that loops connect. */
  markLoops(loops) {
    this.loops = loops;
    this.redraw();
  }

  /** Moves the cursor to a moment, of that number. */
  point(timeS, number) {
    this.timeS = timeS;
    this.canvas.setAttribute('aria-valuenow', number);
    this.draw();
  }

  describe(text) {
    this.canvas.setAttribute('aria-valuetext', text);
  }

  timeAt(x) {
    return (Math.max(0, x) / Math.max(1, this.canvas.clientWidth)) * this.endS;
  }

  /** The column of a moment in the drawing. */
  column(timeS) {
    return (timeS / this.endS) * (this.still.width - 1);
  }

  redraw() {
    if (this.tracks.length === 0 || this.canvas.clientWidth === 0) return;
    for (const canvas of [this.canvas, this.still]) {
      canvas.width = this.canvas.clientWidth * devicePixelRatio;
      canvas.height = this.canvas.clientHeight * devicePixelRatio;
    }
    const paint = this.still.getContext('2d');
    this.tracks.forEach((track, i) => {
      const top = i * (BAR_PX + MARKS_PX) * devicePixelRatio;
      this.drawStatus(paint, track, top);
      this.drawMarks(paint, track, this.loops[i], top + BAR_PX * devicePixelRatio);
    });
    this.drawPlots(paint);
    this.draw();
  }

  color(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name);
  }

  /** The worst state wins where several frames share a column. */
  drawStatus(paint, { frames, timeS }, top) {
    const height = BAR_PX * devicePixelRatio;
    STATUS_COLORS.map((name) => this.color(name)).forEach((color, status) => {
      paint.fillStyle = color;
      for (let i = 0; i < frames.count; ++i) {
        if (frames.status[i] !== status) continue;
        const [from, to] = [i, Math.min(i + 1, frames.count - 1)].map((frame) => Math.floor(this.column(timeS[frame])));
        paint.fillRect(from, top, Math.max(1, to - from), height);
      }
    });
  }

  drawMarks(paint, { keyframes, timeS }, loops, top) {
    const size = MARKS_PX * devicePixelRatio;
    paint.fillStyle = this.color('--soft');
    for (const frame of keyframes) paint.fillRect(Math.floor(this.column(timeS[frame])), top, devicePixelRatio, 0.5 * size);
    paint.fillStyle = this.color('--loop');
    for (const frame of loops) {
      const x = this.column(timeS[frame]);
      paint.beginPath();
      paint.moveTo(x, top);
      paint.lineTo(x - 0.5 * size, top + size);
      paint.lineTo(x + 0.5 * size, top + size);
      paint.fill();
    }
  }

  /** The figure of every track, in one scale. */
  drawPlots(paint) {
    const most = this.tracks.reduce((max, { frames }) => frames[this.figure].reduce((own, figure) => Math.max(own, figure), max), 0);
    if (!most) return;
    const top = (this.tracks.length * (BAR_PX + MARKS_PX) + 2) * devicePixelRatio;
    const y = (figure) => this.still.height - 1 - (figure / most) * (this.still.height - 1 - top);
    const colors = this.tracks.length > 1 ? PLOT_COLORS : ['--ink'];
    this.tracks.forEach((track, i) => this.drawPlot(paint, track, y, this.color(colors[i])));
    this.drawLabel(paint, `up to ${LABELS[this.figure](most)}`, top);
  }

  /** The range of the figure in every column. */
  drawPlot(paint, { frames, timeS }, y, color) {
    const figures = frames[this.figure];
    paint.strokeStyle = color;
    paint.lineWidth = devicePixelRatio;
    paint.beginPath();
    let column = -1;
    let [low, high] = [0, 0];
    for (let i = 0; i < frames.count; ++i) {
      const here = Math.floor(this.column(timeS[i]));
      if (here !== column) {
        if (column >= 0) [low, high].forEach((figure) => paint.lineTo(column, y(figure)));
        [column, low, high] = [here, Infinity, -Infinity];
      }
      [low, high] = [Math.min(low, figures[i]), Math.max(high, figures[i])];
    }
    [low, high].forEach((figure) => paint.lineTo(column, y(figure)));
    paint.stroke();
  }

  drawLabel(paint, text, top) {
    paint.fillStyle = this.color('--soft');
    paint.font = `${10 * devicePixelRatio}px system-ui, sans-serif`;
    paint.strokeStyle = this.color('--card'); // keeps the label legible on the line
    paint.lineWidth = 4 * devicePixelRatio;
    const label = [text, 3 * devicePixelRatio, top + 9 * devicePixelRatio];
    paint.strokeText(...label);
    paint.fillText(...label);
  }

  draw() {
    const paint = this.canvas.getContext('2d');
    paint.clearRect(0, 0, this.canvas.width, this.canvas.height);
    paint.drawImage(this.still, 0, 0);
    if (this.timeS === undefined) return;
    paint.fillStyle = this.color('--camera');
    paint.fillRect(Math.round(this.column(this.timeS)) - devicePixelRatio, 0, 2 * devicePixelRatio, this.canvas.height);
  }
}

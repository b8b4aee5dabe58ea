// The bar of the timeline: the state of every frame, keyframes, loops, a plot, and the cursor over all of them.

import { millimetres } from '../shared/format.js';

const BAR_PX = 10; // height of the coloured bar
const MARKS_PX = 10; // height of the keyframes' ticks and the loops' marks below it
const STATUS_COLORS = ['--good', '--loop', '--bad'];
const LABELS = { tracked: (figure) => `${figure} tracked`, sigmaM: (figure) => `\u03c3 ${millimetres(figure)}`, ms: (figure) => `${figure.toFixed(0)} ms` };

export class TimelineBar {
  /** Draws into `canvas`, a slider; calls onSeek(stampS) when the user points at a moment. */
  constructor(canvas, onSeek) {
    Object.assign(this, { canvas, onSeek });
    this.still = document.createElement('canvas'); // all but the cursor
    this.loops = [];
    const seek = ({ offsetX }) => this.frames && onSeek(this.stampAt(offsetX));
    canvas.onpointerdown = (event) => {
      canvas.setPointerCapture(event.pointerId);
      seek(event);
    };
    canvas.onpointermove = (event) => event.buttons > 0 && seek(event);
    new ResizeObserver(() => this.redraw()).observe(canvas);
    new MutationObserver(() => this.redraw()).observe(document.documentElement, { attributeFilter: ['data-theme'] });
  }

  show(frames, keyframes, figure) {
    Object.assign(this, { frames, keyframes, figure });
    this.frame = undefined;
    this.loops = [];
    this.canvas.setAttribute('aria-valuemax', frames.count - 1);
    this.redraw();
  }

  /** Plots another figure of the frames. */
  plot(figure) {
    this.figure = figure;
    this.redraw();
  }

  /** `frames`: those of the keyframes that loops connect. */
  markLoops(frames) {
    this.loops = frames;
    this.redraw();
  }

  /** Moves the cursor. */
  point(frame) {
    this.frame = frame;
    this.draw();
  }

  describe(text) {
    this.canvas.setAttribute('aria-valuenow', this.frame);
    this.canvas.setAttribute('aria-valuetext', text);
  }

  get startS() {
    return this.frames.stampS[0];
  }

  get durationS() {
    return Math.max(1e-9, this.frames.stampS.at(-1) - this.startS);
  }

  stampAt(x) {
    return this.startS + (Math.max(0, x) / Math.max(1, this.canvas.clientWidth)) * this.durationS;
  }

  /** The column of a frame in the drawing. */
  column(frame) {
    return ((this.frames.stampS[frame] - this.startS) / this.durationS) * (this.still.width - 1);
  }

  redraw() {
    if (!this.frames || this.canvas.clientWidth === 0) return;
    for (const canvas of [this.canvas, this.still]) {
      canvas.width = this.canvas.clientWidth * devicePixelRatio;
      canvas.height = this.canvas.clientHeight * devicePixelRatio;
    }
    const paint = this.still.getContext('2d');
    this.drawStatus(paint);
    this.drawMarks(paint);
    this.drawPlot(paint);
    this.draw();
  }

  color(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name);
  }

  /** The worst state wins where several frames share a column. */
  drawStatus(paint) {
    const height = BAR_PX * devicePixelRatio;
    STATUS_COLORS.map((name) => this.color(name)).forEach((color, status) => {
      paint.fillStyle = color;
      for (let i = 0; i < this.frames.count; ++i) {
        if (this.frames.status[i] !== status) continue;
        const [from, to] = [i, Math.min(i + 1, this.frames.count - 1)].map((frame) => Math.floor(this.column(frame)));
        paint.fillRect(from, 0, Math.max(1, to - from), height);
      }
    });
  }

  drawMarks(paint) {
    const [top, size] = [BAR_PX * devicePixelRatio, MARKS_PX * devicePixelRatio];
    paint.fillStyle = this.color('--soft');
    for (const frame of this.keyframes) paint.fillRect(Math.floor(this.column(frame)), top, devicePixelRatio, 0.5 * size);
    paint.fillStyle = this.color('--loop');
    for (const frame of this.loops) {
      const x = this.column(frame);
      paint.beginPath();
      paint.moveTo(x, top);
      paint.lineTo(x - 0.5 * size, top + size);
      paint.lineTo(x + 0.5 * size, top + size);
      paint.fill();
    }
  }

  /** The range of the figure in every column. */
  drawPlot(paint) {
    const figures = this.frames[this.figure];
    const most = figures?.reduce((max, figure) => Math.max(max, figure), 0);
    if (!most) return;
    const top = (BAR_PX + MARKS_PX + 2) * devicePixelRatio;
    const y = (figure) => this.still.height - 1 - (figure / most) * (this.still.height - 1 - top);
    paint.strokeStyle = this.color('--ink');
    paint.lineWidth = devicePixelRatio;
    paint.beginPath();
    let column = -1;
    let [low, high] = [0, 0];
    for (let i = 0; i < this.frames.count; ++i) {
      const here = Math.floor(this.column(i));
      if (here !== column) {
        if (column >= 0) [low, high].forEach((figure) => paint.lineTo(column, y(figure)));
        [column, low, high] = [here, Infinity, -Infinity];
      }
      [low, high] = [Math.min(low, figures[i]), Math.max(high, figures[i])];
    }
    [low, high].forEach((figure) => paint.lineTo(column, y(figure)));
    paint.stroke();
    paint.fillStyle = this.color('--soft');
    paint.font = `${10 * devicePixelRatio}px system-ui, sans-serif`;
    paint.strokeStyle = this.color('--card'); // keeps the label legible on the line
    paint.lineWidth = 4 * devicePixelRatio;
    const label = [`up to ${LABELS[this.figure](most)}`, 3 * devicePixelRatio, top + 9 * devicePixelRatio];
    paint.strokeText(...label);
    paint.fillText(...label);
  }

  draw() {
    const paint = this.canvas.getContext('2d');
    paint.clearRect(0, 0, this.canvas.width, this.canvas.height);
    paint.drawImage(this.still, 0, 0);
    if (this.frame === undefined) return;
    paint.fillStyle = this.color('--camera');
    paint.fillRect(Math.round(this.column(this.frame)) - devicePixelRatio, 0, 2 * devicePixelRatio, this.canvas.height);
  }
}

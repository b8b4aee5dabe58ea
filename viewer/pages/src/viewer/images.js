// The camera's images: colour with features, and depth.

const TRACKED = '#35e07c';
const UNTRACKED = '#ff5d5d';
const FULL_SCALE = 65535; // of an image coordinate

export class Images {
  constructor(section) {
    this.section = section;
    this.color = section.querySelector('#colorImage');
    this.depth = section.querySelector('#depthImage');
    this.keyframeCanvases = [this.color, section.querySelector('#otherImage')];
    this.keyframes = []; // shown in them
    this.features = new Uint16Array(0);
  }

  async take({ kind, body }) {
    if (kind === 'features') {
      this.features = body;
      if (this.bitmap) this.drawColor();
    } else if (kind === 'colorImage') {
      const bitmap = await decoded(body);
      if (!bitmap) return;
      this.bitmap?.close();
      this.bitmap = bitmap;
      this.drawColor();
    } else if (kind === 'depthImage') {
      const bitmap = await decoded(body);
      if (!bitmap) return;
      draw(this.depth, bitmap);
      bitmap.close(); // pixels are released long before the garbage is collected
    } else {
      return;
    }
    this.section.hidden = false;
  }

  /** Shows the image of a keyframe, with a caption; `side` 1: of the run that is compared. */
  async showKeyframe(jpeg, caption, side) {
    const canvas = this.keyframeCanvases[side];
    const figure = canvas.closest('figure');
    figure.querySelector('figcaption').textContent = caption;
    figure.hidden = false;
    this.depth.closest('figure').hidden = true;
    if (this.keyframes[side] === jpeg) return;
    this.keyframes[side] = jpeg;
    await drawJpeg(canvas, jpeg, () => this.keyframes[side] === jpeg);
    this.section.hidden = false;
  }

  /** An image and its features arrive separately, and unchanged features not at all, so both trigger a redraw. */
  drawColor() {
    const paint = draw(this.color, this.bitmap);
    const { width, height } = this.color;
    for (let i = 0; i < this.features.length; i += 4) {
      const [x, y, tracked] = this.features.subarray(i, i + 3);
      paint.fillStyle = tracked ? TRACKED : UNTRACKED;
      paint.fillRect((x / FULL_SCALE) * width - 1, (y / FULL_SCALE) * height - 1, tracked ? 3 : 2, tracked ? 3 : 2);
    }
  }
}

/** Draws a JPEG if it is still wanted once decoded. */
export async function drawJpeg(canvas, jpeg, isWanted = () => true) {
  const bitmap = await decoded(jpeg);
  if (bitmap && isWanted()) draw(canvas, bitmap);
  bitmap?.close();
}

/** Shows what is known of a keyframe's image in a figure: its picture, `name` and further words below it. */
export function showPicture(figure, jpeg, name, words, isWanted) {
  const canvas = figure.querySelector('canvas');
  figure.querySelector('figcaption').textContent = `${name}${words}${jpeg ? '' : ', no image'}`;
  canvas.setAttribute('aria-label', `image of ${name}`);
  canvas.hidden = jpeg === undefined;
  if (jpeg) drawJpeg(canvas, jpeg, isWanted);
}

/** The image; undefined if it is damaged: the next one comes soon. */
function decoded(jpeg) {
  return createImageBitmap(jpeg).catch(() => undefined);
}

function draw(canvas, bitmap) {
  canvas.width = bitmap.width;
  canvas.height = bitmap.height;
  const paint = canvas.getContext('2d');
  paint.drawImage(bitmap, 0, 0);
  return paint;
}

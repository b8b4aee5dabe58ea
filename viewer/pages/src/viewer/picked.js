// What a click shows: a keyframe with its image and loops, or a point with its coordinates.

import { lengthText, millimetres } from '../shared/format.js';
import { drawJpeg } from './images.js';

export class Picked {
  constructor({ world, view, timeline }, section) {
    Object.assign(this, { world, view, timeline, section });
    this.canvas = section.querySelector('canvas');
  }

  clear() {
    this.section.hidden = true;
  }

  /** `place` is in the scene; its coordinates are shown in the frame of the path. */
  showPlace(place) {
    const inWorld = this.world.group.worldToLocal(place.clone());
    const { cameraPose } = this.world;
    const camera = cameraPose && inWorld.clone().setFromMatrixPosition(cameraPose);
    this.canvas.hidden = true;
    this.list('point', [
      ['x, y, z', `${inWorld.toArray().map((x) => x.toFixed(3)).join(', ')} m`],
      ['above the floor', roundedText(Math.max(0, place.y - this.view.box.min.y))],
      ['from the camera', camera && roundedText(camera.distanceTo(inWorld))],
      ['from the viewpoint', roundedText(this.view.cameraControls.camera.position.distanceTo(place))],
    ]);
  }

  showKeyframe(keyframe) {
    const moment = this.timeline.locate(keyframe);
    const figure = (name) => moment?.frames[name][moment.frame];
    const [sigmaM, errorM] = ['sigmaM', 'errorM'].map(figure);
    const loops = this.loopsOf(keyframe);
    const jpeg = this.world.pictures.of(keyframe);
    this.canvas.hidden = jpeg === undefined;
    if (jpeg) drawJpeg(this.canvas, jpeg);
    this.list(`keyframe ${keyframe}`, [
      ['stamp', moment && `${figure('stampS').toFixed(3)} s`],
      ['\u03c3 of the position', sigmaM > 0 ? millimetres(sigmaM) : undefined],
      ['error', errorM > 0 ? millimetres(errorM) : undefined],
      ['features tracked', figure('tracked') || undefined],
      ['loops with', loops.length > 0 ? loops.join(', ') : undefined],
    ]);
    if (moment) this.timeline.seek(moment.timeS);
  }

  loopsOf(keyframe) {
    const { loops } = this.world;
    const others = [];
    for (let i = 0; i < loops.length; i += 2) {
      if (loops[i] === keyframe) others.push(loops[i + 1]);
      if (loops[i + 1] === keyframe) others.push(loops[i]);
    }
    return others;
  }

  /** Unknown figures are left out. */
  list(title, figures) {
    this.section.hidden = false;
    this.section.querySelector('h2').textContent = title;
    const rows = figures.filter(([, figure]) => figure !== undefined).map(([what, figure]) => {
      const [name, value] = [document.createElement('dt'), document.createElement('dd')];
      [name.textContent, value.textContent] = [what, figure];
      return [name, value];
    });
    this.section.querySelector('dl').replaceChildren(...rows.flat());
    this.section.scrollIntoView({ block: 'nearest' });
  }
}

/** A length to the millimetre. */
function roundedText(metres) {
  return lengthText(Math.round(1000 * metres) / 1000);
}

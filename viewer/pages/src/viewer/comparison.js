// Two compared maps: which differences are drawn, the objects that changed, and the pictures of the selected one.

import { Matrix4, Vector3 } from 'three';

import { count, lengthText } from '../shared/format.js';
import { element, figureRows, mark, markedCheckbox } from './elements.js';
import { showPicture } from './images.js';
import { SelectList } from './selectList.js';

const at = (id) => document.getElementById(id);
const VIEW_FROM = 2.5; // sizes of an object that it is best seen from
const NEAREST_M = 1.2;
const CENTRAL = 0.8; // of half an image, within which it shows an object

export class Comparison {
  constructor({ world, view }, setOrbit) {
    Object.assign(this, { world, view, setOrbit });
    this.list = new SelectList(at('objectList'), (object) => this.select(object));
    at('closeObject').onclick = () => this.deselect();
    this.clear();
  }

  clear() {
    this.objects = [];
    this.list.show([]);
    this.name(false);
    this.deselect();
  }

  take(table) {
    this.table = table;
    this.objects = table.objects;
    this.world.showDifferences(table.pieces);
    this.name(true);
    this.makeLayers();
    const { length } = this.objects;
    at('objectCount').textContent = length;
    at('alignedBy').textContent = `Aligned by ${table.loopsBetween === 1 ? 'one place' : `${table.loopsBetween} places`} recognised in both.`;
    at('noObjects').hidden = length > 0;
    this.list.show([...this.objects.keys()], (i) => this.content(this.objects[i]));
  }

  /** Shows the section, and names what the other controls are for, if two maps are compared. */
  name(compared) {
    at('comparison').hidden = !compared;
    at('color').querySelector('[value=camera]').textContent = compared ? 'difference' : 'image colour';
    document.querySelector('[data-layer=path]').nextSibling.textContent = compared ? 'path before' : 'path';
  }

  /** A checkbox for each kind of difference, with the number of its points. */
  makeLayers() {
    const { before, after, names } = this.table;
    const of = (change) => this.objects.filter((object) => object.change === change).length;
    const too = of('moved') > 0 ? ', moved ones counted too' : '';
    const layers = [
      ['gone', `gone: ${objectsText(of('gone'))}`, `${count(before.gone)} points${too}`],
      ['added', `added: ${objectsText(of('added'))}`, `${count(after.added)} points${too}`],
      ['moved', `moved: ${objectsText(of('moved'))}`, 'pale where they were'],
      ['restBefore', `rest of ${names[0]}`, `${count(before.same)} points seen again, ${count(before.unseen)} not looked at`],
      ['restAfter', `rest of ${names[1]}`, `${count(after.same)} points seen before, ${count(after.unseen)} not looked at`],
    ];
    at('differences').replaceChildren(
      ...layers.flatMap(([layer, text, what]) => {
        const box = markedCheckbox(layer, text, true, (checked) => {
          this.world.showDifference(layer, checked);
          this.view.dirty = true;
        });
        return [box, element('small', {}, what)];
      }),
    );
  }

  content({ change, surface_m2: surfaceM2, moved_by_m: movedByM }) {
    const far = movedByM === undefined ? '' : `by ${lengthText(movedByM)}`;
    return [element('div', {}, mark(change), element('b', {}, change), element('span', {}, far)), element('small', {}, areaText(surfaceM2))];
  }

  /** Shows an object: its boxes, its pictures, and a view of it. */
  select(i) {
    const object = this.objects[i];
    this.list.mark(i);
    this.world.selectBoxes([object.boxBefore, object.boxAfter]);
    this.view.dirty = true;
    const views = this.bestKeyframes(object);
    this.showCard(object, views);
    this.flyTo(object, views);
  }

  deselect() {
    at('object').hidden = true;
    this.list.mark(undefined);
    this.world.selectBoxes([]);
    this.view.dirty = true;
  }

  showCard(object, views) {
    const { change, surface_m2: surfaceM2, center_m: centerM, moved_to_m: movedToM } = object;
    const placeText = (place) => `${place.map((x) => x.toFixed(2)).join(', ')} m`;
    at('object').hidden = false;
    at('object').querySelector('h2').replaceChildren(mark(change), change);
    const figures = [['surface', areaText(surfaceM2)], ['at', placeText(centerM)]];
    if (movedToM) figures.push(['now at', placeText(movedToM)]);
    at('object').querySelector('dl').replaceChildren(...figureRows(figures));
    views.forEach((keyframe, visit) => {
      const figure = at('object').querySelectorAll('figure')[visit];
      const words = keyframe === undefined ? '' : `, ${visit === 0 ? 'before' : 'after'}`;
      const jpeg = keyframe === undefined ? undefined : this.world.pictures.of(keyframe);
      const selected = this.list.selected;
      const name = keyframe === undefined ? this.table.names[visit] : `keyframe ${keyframe} of ${this.table.names[visit]}`;
      showPicture(figure, jpeg, name, words, () => this.list.selected === selected);
    });
  }

  /** The keyframes of both maps that show the place of an object best; undefined: none does. */
  bestKeyframes({ boxBefore, boxAfter }) {
    return [[boxBefore, boxAfter], [boxAfter, boxBefore]].map(([own, other], visit) => this.bestKeyframe(boundsOf([own ?? other]), visit));
  }

  bestKeyframe({ centre, sizeM }, visit) {
    const { poses, frustum } = this.world;
    const wantedM = Math.max(NEAREST_M, VIEW_FROM * sizeM);
    const [first, end] = visit === 0 ? [0, this.table.keyframesBefore] : [this.table.keyframesBefore, poses.count];
    let best = { off: Infinity };
    for (let keyframe = first; keyframe < end; ++keyframe) {
      const inCamera = centre.clone().applyMatrix4(new Matrix4().copy(poses.at(keyframe)).invert());
      const seen = inCamera.z > 0 && [inCamera.x, inCamera.y].every((x, axis) => Math.abs(x) < CENTRAL * frustum[axis] * inCamera.z);
      const off = Math.abs(Math.log(inCamera.z / wantedM));
      if (seen && off < best.off) best = { off, keyframe };
    }
    return best.keyframe;
  }

  /** Looks at an object from the keyframe that has it in view best. */
  flyTo(object, views) {
    const { group, poses } = this.world;
    const { cameraControls } = this.view;
    const { centre, sizeM } = boundsOf([object.boxBefore, object.boxAfter]);
    const target = centre.applyMatrix4(group.matrixWorld);
    const keyframe = object.change === 'gone' ? views[0] : views[1];
    this.setOrbit();
    cameraControls.setManualControl();
    const back = cameraControls.camera.position.clone().sub(target).setLength(Math.max(NEAREST_M, VIEW_FROM * sizeM));
    const position = keyframe === undefined ? target.clone().add(back) : new Vector3().setFromMatrixPosition(poses.at(keyframe)).applyMatrix4(group.matrixWorld);
    cameraControls.goTo({ position, target });
  }
}

/** The centre and the size of boxes, given by their corners in the world; missing ones are left out. */
function boundsOf(boxes) {
  const corners = boxes.filter((box) => box).flat().map((corner) => new Vector3(...corner));
  const centre = corners.reduce((sum, corner) => sum.add(corner), new Vector3()).divideScalar(corners.length);
  return { centre, sizeM: 2 * Math.max(...corners.map((corner) => corner.distanceTo(centre))) };
}

function objectsText(number) {
  return number === 1 ? '1 object' : `${number} objects`;
}

function areaText(areaM2) {
  return `${areaM2.toFixed(2)} m\u00b2`;
}

// Sliders that clip the map to a box along the axes of the floor grid.

export class ClipBox {
  /** `sliders` are from 0 to 100, each with data-clip="min x", "max x", ... */
  constructor(sliders, view) {
    Object.assign(this, { sliders: [...sliders], view });
    for (const slider of this.sliders) slider.oninput = () => this.apply();
  }

  /** A slider at its end does not clip. */
  apply() {
    const { box, clip } = this.view;
    clip.min.setScalar(-Infinity);
    clip.max.setScalar(Infinity);
    for (const slider of this.sliders) {
      const [end, axis] = slider.dataset.clip.split(' ');
      const share = Number(slider.value) / Number(slider.max);
      const free = share === (end === 'min' ? 0 : 1);
      if (!free) clip[end][axis] = box.min[axis] + share * (box.max[axis] - box.min[axis]);
      slider.setAttribute('aria-valuetext', free ? 'off' : `${(100 * share).toFixed(0)} %`);
    }
    this.view.dirty = true;
  }

  reset() {
    for (const slider of this.sliders) slider.value = slider.dataset.clip.startsWith('min') ? slider.min : slider.max;
    this.apply();
  }
}

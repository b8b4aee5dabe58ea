// The slider that cuts off higher points, with its label: metres above the floor, or "off".

const STEP_SHARE = 0.05; // key step, as a share of the map's height

export class HeightCut {
  constructor(slider, output, view) {
    Object.assign(this, { slider, output, view });
    slider.oninput = () => this.set(Number(slider.value) === Number(slider.max) ? Infinity : (slider.value / slider.max) * this.heightM);
    this.show();
  }

  get floorM() {
    return this.view.box.isEmpty() ? 0 : this.view.box.min.y;
  }

  get heightM() {
    return this.view.box.isEmpty() ? 1 : Math.max(1e-6, this.view.box.max.y - this.view.box.min.y);
  }

  /** Cuts that far above the floor; at the top of the map, not at all. */
  set(aboveFloorM) {
    this.view.cutAtM = aboveFloorM >= this.heightM ? Infinity : this.floorM + Math.max(0, aboveFloorM);
    this.view.dirty = true;
    this.show();
  }

  /** Moves up or down in steps. */
  move(steps) {
    const from = Math.min(this.view.cutAtM - this.floorM, this.heightM);
    this.set(from + steps * STEP_SHARE * this.heightM);
  }

  /** Updates the slider; the map may have grown. */
  show() {
    const { slider, output, view } = this;
    const off = view.cutAtM === Infinity;
    const aboveFloorM = off ? this.heightM : view.cutAtM - this.floorM;
    slider.value = (slider.max * aboveFloorM) / this.heightM;
    output.textContent = off ? 'off' : `${aboveFloorM.toFixed(2)} m`;
    slider.setAttribute('aria-valuetext', off ? 'off' : `${aboveFloorM.toFixed(2)} metres above the floor`);
  }
}

// A list of which one entry is selected, by mouse or by keys.

import { element } from './elements.js';

export class SelectList {
  /** `list`: an element with the role of a listbox; calls onSelect(item) when the user selects an entry. */
  constructor(list, onSelect) {
    Object.assign(this, { list, onSelect, items: [], selected: undefined });
    list.onkeydown = (event) => this.onKey(event);
    list.onclick = ({ target }) => {
      const row = target.closest('li');
      if (row) onSelect(Number(row.dataset.item));
    };
  }

  /** Lists items, which are numbers; content(item) returns the nodes of an entry. */
  show(items, content = () => []) {
    this.items = items;
    this.list.hidden = items.length === 0;
    this.list.replaceChildren(
      ...items.map((item) => {
        const row = element('li', { id: `${this.list.id}${item}`, role: 'option' }, ...content(item));
        row.dataset.item = item;
        return row;
      }),
    );
  }

  /** Selects the next or previous entry; the first or last if none is selected. */
  step(by) {
    if (this.items.length === 0) return;
    const from = this.items.indexOf(this.selected);
    const last = this.items.length - 1;
    const to = from < 0 ? (by > 0 ? 0 : last) : Math.min(Math.max(0, from + by), last);
    this.onSelect(this.items[to]);
  }

  onKey(event) {
    const moves = { ArrowDown: 1, ArrowUp: -1, Home: -Infinity, End: Infinity, Enter: 0 };
    if (!(event.key in moves) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation(); // those are keys of the timeline, too
    if (event.key === 'Enter' && this.selected !== undefined) this.onSelect(this.selected);
    else this.step(moves[event.key] || 1);
  }

  /** Marks an entry as selected; undefined: none. */
  mark(item) {
    this.selected = item;
    for (const row of this.list.children) row.setAttribute('aria-selected', Number(row.dataset.item) === item);
    const row = document.getElementById(`${this.list.id}${item}`);
    if (!row) return this.list.removeAttribute('aria-activedescendant');
    this.list.setAttribute('aria-activedescendant', row.id);
    row.scrollIntoView({ block: 'nearest' });
  }
}

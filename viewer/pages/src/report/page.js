// The building blocks of every section.

/** An element with attributes and children; text is never parsed as markup. */
export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children.filter((child) => child !== undefined));
  return made;
}

export function section(title, ...children) {
  return element('section', {}, element('h2', {}, title), ...children);
}

/** A line in place of what cannot be shown. */
export function problem(what, error) {
  return element('p', { class: 'soft' }, `${what} cannot be shown: ${error.message}`);
}

/** Figures side by side if there is space. */
export function row(...figures) {
  return element('div', { class: 'row' }, ...figures);
}

export function figure(content, caption) {
  return element('figure', {}, content, element('figcaption', {}, caption));
}

/** A table that scrolls where it is too wide, by keys, too; `numbers` lists the numeric columns. */
export function table(head, rows, numbers = []) {
  const line = (cells, name) =>
    element('tr', {}, ...cells.map((cell, i) => element(name, numbers.includes(i) ? { class: 'number' } : {}, cell)));
  return element('div', { class: 'table', tabindex: '0' }, element('table', {}, line(head, 'th'), ...rows.map((cells) => line(cells, 'td'))));
}

/** The names of several runs in their colours. */
export function legend(runs, ...others) {
  const entries = [...others, ...runs.map(({ name, color }) => [name, color])];
  return element(
    'p',
    { class: 'legend' },
    ...entries.map(([name, color]) => element('span', {}, element('i', { style: `background:${color}` }), name)),
  );
}

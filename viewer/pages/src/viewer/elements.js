// Elements of the page, made here.

/** An element with properties and, beside them, a role; with children: nodes or texts. */
export function element(name, properties, ...children) {
  const { role, ...others } = properties;
  const made = Object.assign(document.createElement(name), others);
  if (role) made.setAttribute('role', role);
  made.append(...children);
  return made;
}

/** A coloured mark; the style sheet has the colour of each class. */
export function mark(kind) {
  return element('i', { className: `mark ${kind}` });
}

/** A checkbox with a mark and a text; calls onChange(whether it is checked). */
export function markedCheckbox(kind, text, checked, onChange) {
  const input = element('input', { type: 'checkbox', value: kind, checked });
  input.onchange = () => onChange(input.checked);
  return element('label', {}, input, mark(kind), text);
}

/** The rows of a description list: [what, figure] pairs. */
export function figureRows(figures) {
  return figures.map(([what, figure]) => element('div', {}, element('dt', {}, what), element('dd', {}, `${figure}`)));
}

// On a narrow screen the panel collapses into a row of buttons; each opens one section above it.

/** `row` holds buttons with data-opens="ID of a section". */
export function makeCollapsible(row) {
  const buttons = [...row.querySelectorAll('[data-opens]')];
  const section = (button) => document.getElementById(button.dataset.opens);
  const open = (chosen) =>
    buttons.forEach((button) => {
      const on = button === chosen && button.getAttribute('aria-expanded') !== 'true';
      button.setAttribute('aria-expanded', on);
      section(button).classList.toggle('open', on);
    });
  buttons.forEach((button) => (button.onclick = () => open(button)));
  open(undefined);

  // Empty sections have no button.
  const offer = () => buttons.forEach((button) => (button.hidden = section(button).hidden));
  const watcher = new MutationObserver(offer);
  buttons.forEach((button) => watcher.observe(section(button), { attributes: true, attributeFilter: ['hidden'] }));
  offer();
}

// The keyboard shortcuts and their table, shown by ?.

/** Key, label, description, and name of the action. */
const KEYS = [
  [' ', 'Space', 'pause or resume the run, or its replay', 'pause'],
  ['ArrowLeft', '←', 'previous frame of a saved run; with Shift keyframe', 'earlier'],
  ['ArrowRight', '→', 'next frame of a saved run; with Shift keyframe', 'later'],
  ['Home', 'Home', 'first frame', 'first'],
  ['End', 'End', 'last frame', 'last'],
  ['s', 'S', 'one frame', 'step'],
  ['f', 'F', 'fit the map', 'fit'],
  ['r', 'R', 'reset the view', 'reset'],
  ['1', '1', 'oblique view', 'oblique'],
  ['2', '2', 'top view', 'top'],
  ['3', '3', 'side view', 'side'],
  ['4', '4', 'follow the camera', 'follow'],
  ['5', '5', 'view from inside a room', 'inside'],
  ['Enter', 'Enter', 'pick or measure at the centre of the view', 'pickCentre'],
  ['m', 'M', 'next tool: select, distance, angle, height', 'nextTool'],
  ['Delete', 'Del', 'remove all measures', 'clear'],
  ['c', 'C', 'next colouring', 'nextColor'],
  ['u', 'U', 'next up axis, for files that do not specify it', 'nextUp'],
  ['g', 'G', 'floor grid on or off', 'grid'],
  ['e', 'E', 'eye-dome lighting on or off', 'shading'],
  ['l', 'L', 'loop edges on or off', 'loops'],
  ['d', 'D', 'cloud and mesh, mesh, or cloud', 'nextSurface'],
  ['n', 'N', 'next loop of a saved run; with Shift the previous', 'nextLoop'],
  ['o', 'O', 'next object that differs between two maps; with Shift the previous', 'nextObject'],
  ['Escape', 'Esc', 'close the selected loop or object', 'close'],
  ['[', '[', 'lower the cut', 'lowerCut'],
  [']', ']', 'raise the cut', 'raiseCut'],
  ['-', '−', 'smaller points', 'smallerPoints'],
  ['+', '+', 'larger points', 'largerPoints'],
  ['p', 'P', 'screenshot', 'screenshot'],
  ['?', '?', 'this table', 'help'],
];
const OTHER_NAMES = { h: 'f', '=': '+' };
const MOVES = ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', 'Home', 'End'];

/** Calls `actions[name]()` when its key is pressed, and fills `table`. */
export function listenToKeys(actions, table) {
  table.replaceChildren(...KEYS.map(([, written, what]) => row(written, what)));
  addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || isHandledByElement(event)) return;
    const key = OTHER_NAMES[event.key] ?? (event.key.length === 1 ? event.key.toLowerCase() : event.key);
    const known = KEYS.find(([own]) => own === key);
    if (!known) return;
    event.preventDefault();
    actions[known[3]](event);
  });
}

/** Letters select in a list, the space bar toggles a checkbox, arrows move a slider, and Enter presses a button. */
function isHandledByElement({ target, key }) {
  return target.matches('select, dialog *') || (key === 'Enter' && target.matches('button, summary')) || ((key === ' ' || MOVES.includes(key)) && target.matches('input'));
}

function row(written, what) {
  const line = document.createElement('tr');
  const [key, text] = [document.createElement('th'), document.createElement('td')];
  key.append(Object.assign(document.createElement('kbd'), { textContent: written }));
  text.textContent = what;
  line.append(key, text);
  return line;
}

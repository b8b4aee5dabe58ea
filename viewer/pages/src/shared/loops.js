// What became of loops, in words. The names are those of run.json.

export const LOOP_STATUSES = ['accepted', 'provisional', 'rejected', 'withdrawn'];

const REASONS = {
  'keyframes agree': 'several keyframes agree',
  'fits the map': 'the map predicted it',
  loaded: 'it came with a loaded map',
  'too few keyframes': 'too few keyframes agree',
  ambiguous: 'another place fits as well',
  'different scale': 'the place has another size in each visit',
  'does not fit': 'odometry, loops or surfaces contradict it',
  'looks different': 'views that should show the same do not',
  'by the user': 'it was taken out by hand',
};

/** A sentence without its full stop; empty if the reason is unknown. */
export function reasonText(reason) {
  return REASONS[reason] ?? '';
}

export function keyframesText(support) {
  return support === 1 ? '1 keyframe' : `${support} keyframes`;
}

/** Of one visit relative to the other. */
export function scaleText(scale) {
  return typeof scale === 'number' ? scale.toFixed(3) : 'unknown';
}

// Numbers as people read them.

/** 1234567 -> "1 234 567" with thin spaces; nothing for nothing. */
export function count(number) {
  return number?.toLocaleString('en').replaceAll(',', '\u202f');
}

/** 0.0123 -> "12.3 mm". */
export function millimetres(metres) {
  return `${(1000 * metres).toFixed(1)} mm`;
}

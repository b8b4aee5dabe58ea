// Human-readable numbers.

/** 1234567 -> "1 234 567" with thin spaces; undefined stays undefined. */
export function count(number) {
  return number?.toLocaleString('en').replaceAll(',', '\u202f');
}

/** 0.0123 -> "12.3 mm". */
export function millimetres(metres) {
  return `${(1000 * metres).toFixed(1)} mm`;
}

/** A round length in a suitable unit: "2 km", "1 m", "50 cm", "5 mm". */
export function lengthText(metres) {
  const [unit, inMetres] = [['km', 1000], ['m', 1], ['cm', 0.01], ['mm', 0]].find(([, least]) => metres >= least * (1 - 1e-9));
  return `${Number((metres / (inMetres || 0.001)).toPrecision(3))} ${unit}`;
}

// Light or dark: chosen in the page and remembered by the browser, else as the system prefers.

const KEY = 'kinloop.theme';

/** Connects `list`, whose options are 'auto', 'light' and 'dark'. */
export function listenToTheme(list) {
  const prefersLight = matchMedia('(prefers-color-scheme: light)');
  const preferred = () => (prefersLight.matches ? 'light' : 'dark');
  const apply = () => (document.documentElement.dataset.theme = list.value === 'auto' ? preferred() : list.value);
  prefersLight.onchange = apply;
  list.value = remembered();
  if (!list.value) list.value = 'auto';
  list.onchange = () => {
    apply();
    remember(list.value);
  };
  apply();
}

/** Storage may be forbidden. */
function remembered() {
  try {
    return localStorage.getItem(KEY) ?? 'auto';
  } catch {
    return 'auto';
  }
}

function remember(theme) {
  try {
    localStorage.setItem(KEY, theme);
  } catch {
    // It holds until the page is closed.
  }
}

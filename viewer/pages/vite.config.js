// Builds one page (--mode viewer or --mode report) into one self-contained HTML file with inline scripts and
// styles, so that kinloop can serve it from memory and a report opens from disk without a network.
// Vite 2 is the last version for the Node.js of every supported system (Ubuntu 22.04 has 12.22). It is used
// only to build; its development server, in which newer versions fixed vulnerabilities, is never started.
import { defineConfig } from 'vite';

/** Moves every script and style of the bundle into the page. */
function inlineEverything() {
  const inlined = (html, file, tag) => {
    const reference = new RegExp(`<(?:script|link)[^>]*(?:src|href)="/${file}"[^>]*>(?:</script>)?`);
    return html.replace(reference, () => tag);
  };
  return {
    name: 'inline-everything',
    enforce: 'post',
    generateBundle(_, bundle) {
      const page = Object.values(bundle).find((file) => file.fileName.endsWith('.html'));
      for (const { fileName, type, code, source } of Object.values(bundle)) {
        if (fileName.endsWith('.html')) continue;
        // "</script" inside a string of the code would end the enclosing element.
        const tag =
          type === 'chunk'
            ? `<script type="module">${code.replace(/<\/script/g, '<\\/script')}</script>`
            : `<style>${source}</style>`;
        page.source = inlined(page.source, fileName, tag);
        delete bundle[fileName];
      }
    },
  };
}

export default defineConfig(({ mode }) => ({
  build: {
    target: 'es2020',
    emptyOutDir: false,
    cssCodeSplit: false,
    modulePreload: false,
    polyfillModulePreload: false,
    chunkSizeWarningLimit: 5000,
    rollupOptions: { input: `${mode}.html`, output: { inlineDynamicImports: true } },
  },
  plugins: [inlineEverything()],
}));

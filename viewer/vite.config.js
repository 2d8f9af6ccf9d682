// SPDX-License-Identifier: Apache-2.0
import { defineConfig } from "vite";

/** Puts script and style into the page: one file, which needs no server and no network. PAGE: which one. */
function onePage() {
  return {
    name: "one-page",
    enforce: "post",
    generateBundle(_, bundle) {
      const page = Object.values(bundle).find((file) => file.fileName.endsWith(".html"));
      let script = "", style = "";
      for (const file of Object.values(bundle)) {
        if (file === page) continue;
        if (file.type === "chunk") script += file.code;
        else style += file.source;
        delete bundle[file.fileName];
      }
      page.source = page.source
        .replace(/\s*<script[^>]*src=[^>]*><\/script>/, "")
        .replace(/\s*<link[^>]*stylesheet[^>]*>/, "")
        .replace("</head>", () => `<style>${style.trim()}</style>\n</head>`)
        .replace("</body>", () =>
          `<script type="module">${script.trim().replaceAll("</script", "<\\/script")}</script>\n</body>`);
    },
  };
}

export default defineConfig({
  base: "./",
  plugins: [onePage()],
  build: {
    outDir: "built",
    emptyOutDir: false,
    modulePreload: false,
    target: "es2022",
    rollupOptions: { input: `${process.env.PAGE ?? "report"}.html` },
  },
});

// Builds the page into the folder that the command embeds; web/dist leads there. Names carry no hash: the command lists them.
import { defineConfig } from "vite";

export default defineConfig({
  base: "./",
  server: { fs: { allow: ["../.."] } },
  build: {
    outDir: "../../crates/feedwright/assets/app",
    // The engine stands beside the page, and is built apart.
    emptyOutDir: false,
    target: "es2022",
    modulePreload: false,
    rolldownOptions: {
      output: { entryFileNames: "app.js", assetFileNames: "app[extname]" },
    },
  },
  worker: { format: "es", rolldownOptions: { output: { entryFileNames: "engine.js" } } },
});

// SPDX-License-Identifier: BSD-3-Clause
// Makes viewer.html: src/page.html with style and program in place of their marks. node bundle.mjs OUT
import { build } from "esbuild";
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const source = (name) => join(here, "src", name);
const read = (name) => readFileSync(source(name), "utf8");

const bundle = await build({ entryPoints: [source("main.js")], bundle: true, minify: true, write: false, format: "iife",
  target: "es2020", legalComments: "eof", charset: "ascii", logLevel: "error" });
// "</script" in a string of the program would end the element.
const program = bundle.outputFiles[0].text.replaceAll("</script", "<\\/script");
const page = read("page.html").replace("/*STYLE*/", () => read("style.css")).replace("/*PROGRAM*/", () => program);
writeFileSync(process.argv[2], page);

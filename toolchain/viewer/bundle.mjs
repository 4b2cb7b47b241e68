// SPDX-License-Identifier: BSD-3-Clause
// Makes one page of src/PAGE and src/PROGRAM, with style and program in place of their marks. node bundle.mjs OUT PAGE PROGRAM
import { build } from "esbuild";
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const source = (name) => join(here, "src", name);
const read = (name) => readFileSync(source(name), "utf8");
const [out, html, entry] = process.argv.slice(2);

const bundle = await build({ entryPoints: [source(entry)], bundle: true, minify: true, write: false, format: "iife",
  target: "es2020", legalComments: "eof", charset: "ascii", logLevel: "error" });
// "</script" in a string of the program would end the element.
const program = bundle.outputFiles[0].text.replaceAll("</script", "<\\/script");
const page = read(html).replace("/*STYLE*/", () => read("style.css")).replace("/*PROGRAM*/", () => program);
writeFileSync(out, page);

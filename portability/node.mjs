// node node.mjs MODULE CORPUS: renders the corpus by the module in Node.

import { readFile } from "node:fs/promises";
import { argv, stdout } from "node:process";
import { lines } from "./corpus.mjs";

const [module, corpus] = await Promise.all(argv.slice(2, 4).map((path) => readFile(path)));
for await (const line of lines(module, corpus)) {
    stdout.write(`${line}\n`);
}

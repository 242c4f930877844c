// What the grammar makes of pieces of scripts.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import test from "node:test";

const require = createRequire(import.meta.url);
const oniguruma = require("vscode-oniguruma");
const { INITIAL, Registry, parseRawGrammar } = require("vscode-textmate");

const wasm = await readFile(require.resolve("vscode-oniguruma/release/onig.wasm"));
await oniguruma.loadWASM(wasm);
const file = new URL("../syntaxes/rtscript.tmLanguage.json", import.meta.url);
const registry = new Registry({
  onigLib: Promise.resolve({
    createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
    createOnigString: (text) => new oniguruma.OnigString(text),
  }),
  loadGrammar: async () => parseRawGrammar(await readFile(file, "utf8"), file.pathname),
});
const grammar = await registry.loadGrammar("source.rtscript");

// Each word with its innermost scope, "rtscript" left out.
function scopes(text) {
  let state = INITIAL;
  const found = [];
  for (const line of text.split("\n")) {
    const { tokens, ruleStack } = grammar.tokenizeLine(line, state);
    state = ruleStack;
    for (const token of tokens) {
      const word = line.slice(token.startIndex, token.endIndex).trim();
      if (word) {
        found.push([word, token.scopes.at(-1).replace(/\.rtscript$/, "")]);
      }
    }
  }
  return found;
}

function scope(text, word) {
  return scopes(text).find(([found]) => found === word)?.[1];
}

const cases = [
  ["sphere(1);", "sphere", "support.function"],
  ["tower(1);", "tower", "entity.name.function.call"],
  ["let sphere = 1;", "sphere", "variable.other.declaration"],
  ["fn tower(h) { }", "tower", "entity.name.function"],
  ["let a = PI;", "PI", "support.constant"],
  ["group { box(); }", "group", "keyword.control.block"],
  ['define "car" { }', "define", "keyword.control.block"],
  ["parts::ball()", "parts", "entity.name.namespace"],
  ["parts::ball()", "ball", "entity.name.function.call"],
  ["v.x = 2;", "x", "variable.other.property"],
  ["for i in 0..10 { }", "0", "constant.numeric"],
  ["for i in 0..10 { }", "10", "constant.numeric"],
  ["for i in 0..10 { }", "..", "keyword.operator"],
  ["let a = 1.5e-3;", "1.5e-3", "constant.numeric"],
  ["#{ min: 0 }", "min", "variable.other.property"],
  ['diffuse("#ff8800");', "#ff8800", "constant.other.color"],
  ['print("a // b");', "a // b", "string.quoted.double"],
  ["`a ${sphere(1)} b`", "sphere", "support.function"],
  ["/// Doc", "/// Doc", "comment.line.documentation"],
  ["// no", "// no", "comment.line.double-slash"],
  ["/* a /* b */ c */ sphere(1)", "sphere", "support.function"],
  ["private fn f() { }", "private", "storage.modifier"],
];

for (const [text, word, wanted] of cases) {
  test(`${word} in ${text}`, () => assert.equal(scope(text, word), wanted));
}

test("a string ends with its line", () => {
  assert.equal(scope('let a = "b;\nsphere(1);', "sphere"), "support.function");
});

test("a template goes over lines and through braces", () => {
  const found = scopes("`a ${#{ b: {} }}\nmiddle` + sphere(1)");
  assert.equal(found.find(([word]) => word === "middle")[1], "string.template");
  assert.equal(found.find(([word]) => word === "sphere")[1], "support.function");
});

// node browser.mjs CHROMIUM MODULE CORPUS: renders the corpus by the module in headless Chromium, which gets it from a
// server on the loopback interface and hands the lines back.

import { spawn } from "node:child_process";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { argv, exit, stderr, stdout } from "node:process";

const [chromium, module, corpus] = argv.slice(2, 5);
const LONGEST_MS = 20 * 60 * 1000;

const page = `<!doctype html><title>corpus</title><script type="module">
import { lines } from "./corpus.mjs";
const load = async (path) => new Uint8Array(await (await fetch(path)).arrayBuffer());
let text = "";
try {
    for await (const line of lines(await load("module"), await load("corpus"))) text += line + "\\n";
} catch (error) {
    text += "failed " + error + "\\n";
}
await fetch("lines", { method: "POST", body: text });
</script>`;

const js = await readFile(new URL("corpus.mjs", import.meta.url));
const answers = {
    "/": ["text/html", page],
    "/corpus.mjs": ["text/javascript", js],
    "/module": ["application/wasm", await readFile(module)],
    "/corpus": ["application/octet-stream", await readFile(corpus)],
};

const profile = await mkdtemp(join(tmpdir(), "portability-"));
let browser;
const done = new Promise((resolve, reject) => {
    const server = createServer((request, response) => {
        if (request.method === "POST") {
            const parts = [];
            request.on("data", (part) => parts.push(part));
            request.on("end", () => {
                response.end();
                resolve(Buffer.concat(parts));
            });
            return;
        }
        const [type, body] = answers[request.url] ?? [undefined, undefined];
        response.writeHead(body === undefined ? 404 : 200, { "Content-Type": type ?? "text/plain" });
        response.end(body ?? "");
    });
    server.listen(0, "127.0.0.1", () => {
        const flags = [
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--no-first-run",
            `--user-data-dir=${profile}`,
        ];
        browser = spawn(chromium, [...flags, `http://127.0.0.1:${server.address().port}/`], { stdio: "ignore" });
        browser.on("error", reject);
        browser.on("exit", (code) => reject(new Error(`Chromium ended with ${code}`)));
    });
    setTimeout(() => reject(new Error("Chromium took too long")), LONGEST_MS);
});

let status = 0;
try {
    stdout.write(await done);
} catch (error) {
    stderr.write(`${error.message}\n`);
    status = 1;
}
if (browser !== undefined && browser.exitCode === null) {
    browser.removeAllListeners("exit");
    const ended = new Promise((resolve) => browser.on("exit", resolve));
    browser.kill();
    await ended;
}
await rm(profile, { recursive: true, force: true, maxRetries: 5 });
exit(status);

// Renders the corpus by the WebAssembly module, in Node and in a browser alike.

/** One line of text for each scene; the module gets nothing from outside but the corpus. */
export async function* lines(bytes, corpus) {
    const module = await WebAssembly.compile(bytes);
    const imports = WebAssembly.Module.imports(module);
    if (imports.length > 0) {
        throw new Error(`the module must import nothing, not ${JSON.stringify(imports)}`);
    }
    const start = () => {
        const { exports } = new WebAssembly.Instance(module, {});
        const room = exports.room(corpus.length);
        new Uint8Array(exports.memory.buffer, room, corpus.length).set(corpus);
        const scenes = exports.load();
        const text = (address) =>
            new TextDecoder().decode(new Uint8Array(exports.memory.buffer, address, exports.length()));
        return { scenes, path: (i) => text(exports.path(i)), render: (i) => text(exports.render(i)) };
    };
    let instance = start();
    for (let i = 0; i < instance.scenes; i++) {
        const path = instance.path(i);
        let line;
        try {
            line = instance.render(i);
        } catch (error) {
            // What trapped is not to be trusted any more.
            line = `${path} trap ${error.message}`;
            instance = start();
        }
        yield line;
    }
}

// @ts-check
// Which engine a page has: a report brings its own, a notebook's answers through a port, and all others are served by the program.

import { element } from "./dom.js";
import { EngineError, unpacked } from "./engine.js";
import { NativeEngine } from "./engine-native.js";
import { PortEngine } from "./engine-port.js";
import { WasmEngine } from "./engine-wasm.js";

/** @typedef {import("./engine.js").Engine} Engine */

/** What of a report stands in an element. @param {string} id @returns {Blob} */
function packedIn(id) {
    const text = atob(element(id).textContent);
    const bytes = new Uint8Array(text.length);
    for (let k = 0; k < text.length; k++) bytes[k] = text.charCodeAt(k);
    return new Blob([bytes]);
}

/** The module's bytes. @returns {Promise<ArrayBuffer>} */
async function moduleBytes() {
    if (element("report-module")) return unpacked(packedIn("report-module"), "gzip");
    const isServed = !element("report-engine");
    const reply = isServed ? await fetch("firsthit.wasm.gz") : null;
    if (!reply?.ok) throw new EngineError("This page has no WebAssembly module to read files with.");
    return unpacked(await reply.blob(), "gzip");
}

/** A worker: of a report from its text, else from the server. */
function worker() {
    const text = element("report-worker")?.textContent;
    if (text === undefined) return new Worker("worker.js", { type: "module" });
    const address = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
    const made = new Worker(address);
    // Only then it has surely been read.
    made.addEventListener("message", () => URL.revokeObjectURL(address), { once: true });
    return made;
}

/** The engine that the page begins with. @returns {Promise<Engine>} */
export async function engineOfPage() {
    const told = element("report-engine")?.textContent;
    if (!told) return new NativeEngine();
    const { kind, ...about } = JSON.parse(told);
    if (kind === "port") return PortEngine.start();
    const content = await unpacked(packedIn("report-scene"), "gzip");
    return WasmEngine.start({ worker, module: await moduleBytes(), name: "scene.fhs", content, about });
}

/** An engine for a file that was dropped: it is read in the page, and goes nowhere else. @param {File} file @returns {Promise<Engine>} */
export async function engineOfFile(file) {
    const content = await file.arrayBuffer();
    return WasmEngine.start({ worker, module: await moduleBytes(), name: file.name, content, about: null });
}

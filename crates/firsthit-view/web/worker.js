// @ts-check
// A worker: it holds one module with one scene, and answers questions one after the other.

import { Broken, Firsthit } from "./firsthit.mjs";

/** @typedef {{id: number, module: ArrayBuffer, name: string, content: ArrayBuffer} | {id: number, question: any, about: object}} Asked */

/** @type {Firsthit | null} */
let firsthit = null;

/** @param {Asked} asked */
async function answered(asked) {
    if ("module" in asked) {
        firsthit = await Firsthit.start(await WebAssembly.compile(asked.module));
        return firsthit.load(asked.name, new Uint8Array(asked.content));
    }
    if (!firsthit) throw new Broken("the module did not start");
    return firsthit.ask(asked.question, asked.about);
}

self.onmessage = async (/** @type {MessageEvent<Asked>} */ { data }) => {
    try {
        const { answer, pixels } = await answered(data);
        self.postMessage({ id: data.id, answer, pixels }, { transfer: [pixels.buffer] });
    } catch (error) {
        const why = error instanceof Error ? error.message : String(error);
        self.postMessage({ id: data.id, error: why, isBroken: error instanceof Broken });
    }
};

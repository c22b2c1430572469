// @ts-check
// The engine of a page that another window embeds: questions and answers go through a port that it sends. Notebooks carry them so.

import { doublingSteps, EngineError, painted } from "./engine.js";
import { say } from "./status.js";

/** @typedef {import("./engine.js").Engine} Engine */
/** @typedef {import("./engine.js").FlatCamera} FlatCamera */
/** @typedef {import("./engine.js").FrameRequest} FrameRequest */
/** @typedef {import("./engine.js").Painted} Painted */
/** @typedef {import("./engine.js").Visibility} Visibility */
/** @typedef {{json: any, pixels: Uint8Array<ArrayBuffer>}} Answer */

/** After so long, in milliseconds, the page says that it waits. */
const PATIENCE = 10_000;

/** @implements {Engine} */
export class PortEngine {
    /** @type {Map<number, {resolve: (answer: Answer) => void, reject: (error: Error) => void}>} */
    #waiting = new Map();
    #count = 0;

    /** @param {MessagePort} port */
    constructor(port) {
        this.port = port;
        port.onmessage = ({ data }) => {
            const asked = this.#waiting.get(data.id);
            this.#waiting.delete(data.id);
            if (data.error !== undefined) asked?.reject(new EngineError(data.error));
            else asked?.resolve({ json: JSON.parse(data.json), pixels: new Uint8Array(data.pixels ?? []) });
        };
    }

    /** Waits for the port. @returns {Promise<PortEngine>} */
    static start() {
        return new Promise((resolve) => {
            const hear = (/** @type {MessageEvent} */ event) => {
                if (event.source !== parent || event.data !== "firsthit" || !event.ports[0]) return;
                removeEventListener("message", hear);
                resolve(new PortEngine(event.ports[0]));
            };
            addEventListener("message", hear);
            parent.postMessage("firsthit", "*");
        });
    }

    info() {
        return this.#json("info", {});
    }

    /** @param {FlatCamera} camera @param {[number, number]} pixel @param {Visibility} part @returns {Promise<any>} */
    probe(camera, pixel, part) {
        return this.#json("probe", { camera, pixel, part });
    }

    /** @param {Visibility} part @param {boolean} svg @returns {Promise<any>} */
    section(part, svg) {
        return this.#json("section", { part, svg });
    }

    /** @param {FlatCamera} camera @returns {Promise<any>} */
    cameraText(camera) {
        return this.#json("camera", { camera });
    }

    async alive() {}

    /** @param {number} samples */
    steps(samples) {
        return doublingSteps(samples);
    }

    /** @param {FrameRequest} request @param {AbortSignal} signal @returns {Promise<Painted>} */
    async frame(request, signal) {
        const started = performance.now();
        const { json, pixels } = await this.#ask("frame", request);
        signal.throwIfAborted();
        return painted({ ...json, seconds: (performance.now() - started) / 1000 }, new Blob([pixels]));
    }

    /** Frames come one after the other here: none ends another. */
    another() {
        return this;
    }

    close() {}

    /** @param {string} question @param {object} about @returns {Promise<any>} */
    async #json(question, about) {
        return (await this.#ask(question, about)).json;
    }

    /** @param {string} question @param {object} about @returns {Promise<Answer>} */
    #ask(question, about) {
        const id = ++this.#count;
        return new Promise((resolve, reject) => {
            this.#waiting.set(id, { resolve, reject });
            this.port.postMessage({ id, question, about: JSON.stringify(about) });
            // It goes on waiting: a kernel that is busy with a cell answers afterwards.
            setTimeout(() => {
                if (this.#waiting.has(id)) say("The kernel is busy, or has ended.", true);
            }, PATIENCE);
        });
    }
}

// @ts-check
// The engine of this program's server: each question is a request, and carries the token.

import { EngineError, painted } from "./engine.js";
import { remember, remembered } from "./storage.js";

/** @typedef {import("./engine.js").Engine} Engine */
/** @typedef {import("./engine.js").FlatCamera} FlatCamera */
/** @typedef {import("./engine.js").FrameRequest} FrameRequest */
/** @typedef {import("./engine.js").Painted} Painted */
/** @typedef {import("./engine.js").Visibility} Visibility */

const KEY = "firsthit-token";

/** The token: of the address, which is cleared of it, or of this tab's memory. */
function takeToken() {
    const given = location.hash.slice(1);
    if (given) {
        remember(KEY, given);
        history.replaceState(null, "", location.pathname);
    }
    return given || (remembered(KEY) ?? "");
}

/** @implements {Engine} */
export class NativeEngine {
    /** @param {string} [token] the address's, where it is known already */
    constructor(token) {
        this.token = token ?? takeToken();
        this.page = crypto.randomUUID();
    }

    /** @returns {Promise<any>} */
    info() {
        return this.#json("/info", {});
    }

    /** @param {FlatCamera} camera @param {[number, number]} pixel @param {Visibility} part @returns {Promise<any>} */
    probe(camera, pixel, part) {
        return this.#json("/probe", { camera, pixel, part });
    }

    /** @param {Visibility} part @param {boolean} svg @returns {Promise<any>} */
    section(part, svg) {
        return this.#json("/section", { part, svg });
    }

    /** @param {FlatCamera} camera @returns {Promise<any>} */
    cameraText(camera) {
        return this.#json("/camera", { camera });
    }

    alive() {
        return this.#json("/alive", {});
    }

    /** The server stops a frame when a newer one is asked for. */
    steps() {
        return [1, 4, null];
    }

    /** @param {FrameRequest} request @param {AbortSignal} signal @returns {Promise<Painted>} */
    async frame(request, signal) {
        const reply = await this.#ask("/frame", request, signal);
        const about = JSON.parse(reply.headers.get("X-Firsthit-Frame") ?? "{}");
        return painted(about, await reply.blob());
    }

    another() {
        return new NativeEngine(this.token);
    }

    close() {}

    /** @param {string} path @param {object} question @returns {Promise<any>} */
    async #json(path, question) {
        const reply = await this.#ask(path, question);
        return reply.json();
    }

    /** @param {string} path @param {object} question @param {AbortSignal} [signal] */
    async #ask(path, question, signal) {
        const headers = { "X-Firsthit-Token": this.token, "X-Firsthit-Page": this.page, "Content-Type": "application/json" };
        let reply;
        try {
            reply = await fetch(path, { method: "POST", headers, body: JSON.stringify(question), signal: signal ?? null });
        } catch (error) {
            if (signal?.aborted) throw error;
            throw new EngineError("The program has ended, or cannot be reached.");
        }
        if (!reply.ok) {
            const said = await reply.text();
            if (reply.status === 403) throw new EngineError("This page has no token: open the address that firsthit view printed.");
            let why = said;
            try {
                why = JSON.parse(said).error ?? said;
            } catch { /* it is plain text */ }
            throw new EngineError(why, reply.status === 409);
        }
        return reply;
    }
}

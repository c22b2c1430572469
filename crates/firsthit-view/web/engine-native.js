// @ts-check
// The engine of this program's server: each question is a request, and carries the token.

/** @typedef {{position: number[], aim: number[], up: number[], projection: "perspective" | "orthographic", ray_start: "eye" | "viewplane", focal_length: number, width: number, height: number, rows: number, columns: number}} Sight */
/** @typedef {{normal: number[], offset: number}} Cut */
/** @typedef {{hidden: number[] | null, only: number[] | null, cut: Cut | null}} Part */
/** @typedef {{camera: Sight, channel: string, samples: number | null, is_lit: boolean, light: string | null, sun: number[] | null, ground: boolean | null, edges: number | null, part: Part}} Look */
/** @typedef {{rows: number, columns: number, samples: number, seconds: number, components?: number, dtype?: "float32" | "int32"}} About */
/** @typedef {{about: About, blob?: Blob, image?: ImageBitmap, values?: Float32Array | Int32Array}} Painted */

/** What the server refused, or that it is gone. */
export class EngineError extends Error {
    /** @param {string} why @param {number} [status] */
    constructor(why, status = 0) {
        super(why);
        /** Whether a newer frame of the same page took its place. */
        this.isSuperseded = status === 409;
    }
}

const KEY = "firsthit-token";

/** The token: of the address, which is cleared of it, or of this tab's memory. */
function takeToken() {
    const given = location.hash.slice(1);
    if (given) {
        sessionStorage.setItem(KEY, given);
        history.replaceState(null, "", location.pathname);
    }
    return given || sessionStorage.getItem(KEY) || "";
}

export class NativeEngine {
    constructor() {
        this.token = takeToken();
        this.page = crypto.randomUUID();
    }

    /** @returns {Promise<any>} */
    info() {
        return this.#json("/info", {});
    }

    /** @param {Sight} camera @param {[number, number]} pixel column and row @param {Part} part @returns {Promise<any>} */
    probe(camera, pixel, part) {
        return this.#json("/probe", { camera, pixel, part });
    }

    /** @param {Sight} camera @returns {Promise<any>} */
    say(camera) {
        return this.#json("/say", { camera });
    }

    /** Tells the server that the page is still there. */
    alive() {
        return this.#json("/alive", {});
    }

    /** @param {Look} look @param {AbortSignal} signal @returns {Promise<Painted>} */
    async frame(look, signal) {
        const reply = await this.#ask("/frame", look, signal);
        /** @type {About} */
        const about = JSON.parse(reply.headers.get("X-Firsthit-Frame") ?? "{}");
        const blob = await reply.blob();
        if (about.dtype === undefined) {
            return { about, blob, image: await createImageBitmap(blob) };
        }
        const unpacked = blob.stream().pipeThrough(new DecompressionStream("deflate"));
        const bytes = await new Response(unpacked).arrayBuffer();
        const values = about.dtype === "int32" ? new Int32Array(bytes) : new Float32Array(bytes);
        return { about, values };
    }

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
            throw new EngineError(why, reply.status);
        }
        return reply;
    }
}

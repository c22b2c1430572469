// @ts-check
// The picture: which frames are asked for, and when. One is on its way at a time; the newest camera waits.

import { words } from "./dom.js";
import { EngineError } from "./engine.js";
import { say } from "./status.js";

/** @typedef {import("./engine.js").FrameRequest} FrameRequest */
/** @typedef {import("./engine.js").Painted} Painted */

/** So long nothing moves before the picture is made in full, in milliseconds. */
const STILL = 120;
/** A frame while something moves shall take no longer, in milliseconds. */
const MOVING = 45;

export class View {
    /**
     * @param {import("./engine.js").Engine} engine
     * @param {(rows: number, columns: number) => FrameRequest} request what to ask for, of that size
     * @param {(painted: Painted, request: FrameRequest, isDone: boolean) => void} paint is told whether the picture is as good as it gets
     * @param {() => void} rested is told when the picture is as good as it gets
     */
    constructor(engine, request, paint, rested) {
        this.engine = engine;
        this.request = request;
        this.paint = paint;
        this.rested = rested;
        /** Pixels of the stage. */
        this.rows = 1;
        this.columns = 1;
        /** A frame's pixels along an edge while something moves, as a share of the stage's. */
        this.share = 0.5;
        this.isWanted = false;
        /** @type {AbortController | null} */
        this.onItsWay = null;
        this.isMoving = false;
        /** @type {number | undefined} */
        this.timer = undefined;
        this.number = 0;
        /** Pixels that the picture has in any case, in place of the stage's. @type {[number, number] | null} */
        this.fixed = null;
        /** The last picture in full, if it is. @type {Painted | null} */
        this.full = null;
    }

    /** Rows and columns of the whole picture. */
    get shape() {
        return this.fixed ?? [this.rows, this.columns];
    }

    /** @param {number} rows @param {number} columns */
    resize(rows, columns) {
        [this.rows, this.columns] = [rows, columns];
        this.moved();
    }

    /** No more frames. */
    end() {
        clearTimeout(this.timer);
        this.number++;
        this.isWanted = false;
        this.onItsWay?.abort();
    }

    /** Something is to be seen otherwise, and may go on changing. */
    moved() {
        clearTimeout(this.timer);
        this.timer = setTimeout(() => this.settled(), STILL);
        this.isWanted = true;
        this.full = null;
        document.body.dataset.busy = "yes";
        if (this.isMoving) return;
        // What is on its way is a still picture of before.
        this.onItsWay?.abort();
        this.isMoving = true;
        this.#move();
    }

    /** Frames while something moves: coarse, without shadows. */
    async #move() {
        try {
            while (this.isWanted) {
                this.isWanted = false;
                const share = this.fixed ? 1 : this.share;
                const size = this.shape.map((edge) => Math.max(1, Math.round(edge * share)));
                const started = performance.now();
                const request = { ...this.request(size[0], size[1]), samples: 1, is_lit: false };
                if (!(await this.#show(request))) break;
                const took = performance.now() - started;
                // Edges by the square root of the time.
                const fitting = this.share * Math.sqrt(MOVING / Math.max(took, 1));
                this.share = Math.max(0.1, Math.min(1, 0.5 * this.share + 0.5 * fitting));
            }
        } catch (error) {
            say(words(error), true);
        } finally {
            this.isMoving = false;
        }
    }

    /** Nothing moves: the picture in full, and then with light and samples. */
    async settled() {
        const number = ++this.number;
        while (this.isMoving) await new Promise((resolve) => setTimeout(resolve, 5));
        if (number !== this.number) return;
        const [rows, columns] = this.shape;
        const whole = this.request(rows, columns);
        // In the chapter a pixel is one ray, without the noise of lights.
        const isLit = !this.fixed && whole.channel === "color";
        /** @type {(number | null)[]} */
        let steps = [];
        for (let request = { ...whole, samples: /** @type {number | null} */ (1), is_lit: false }; ; ) {
            const isDone = !isLit || (request.is_lit && steps.length === 0);
            const painted = await this.#show(request, isDone);
            if (!painted || number !== this.number || this.isMoving) return;
            if (isDone) break;
            document.body.dataset.busy = "refining";
            if (!request.is_lit) steps = this.engine.steps(painted.about.full_samples, rows * columns);
            request = { ...whole, samples: steps.shift() ?? null, is_lit: true };
        }
        document.body.dataset.busy = "no";
        this.rested();
    }

    /** Asks for a frame and paints it; null where it did not come. @param {FrameRequest} request @param {boolean} [isDone] whether no better one follows */
    async #show(request, isDone = false) {
        const control = new AbortController();
        this.onItsWay = control;
        try {
            const painted = await this.engine.frame(request, control.signal);
            if (control.signal.aborted) return null;
            this.paint(painted, request, isDone);
            const { rows, columns, seconds } = painted.about;
            this.full = request.is_lit && request.samples === null ? painted : null;
            const count = painted.about.samples;
            const more = request.samples === null ? "" : " so far";
            const samples = request.is_lit ? `, ${count} sample${count === 1 ? "" : "s"}${more}` : "";
            say(`${rows} × ${columns} pixels${samples}, ${(1000 * seconds).toFixed(0)} ms`, false);
            return painted;
        } catch (error) {
            const isExpected = control.signal.aborted || (error instanceof EngineError && error.isSuperseded);
            if (!isExpected) say(words(error), true);
            return null;
        } finally {
            if (this.onItsWay === control) this.onItsWay = null;
        }
    }
}

// @ts-check
// The chapter alive: a camera by its own numbers, its viewplane, and one pixel's ray to its hit and its colour.

import { add, dot, times, unit } from "./camera.js";
import { ChapterDrawing } from "./chapter-drawing.js";
import { ChapterFields } from "./chapter-fields.js";
import { element, named } from "./dom.js";
import { MARK, strokeOutlined } from "./label.js";
import { formula } from "./letters.js";
import { readOut, unknown } from "./readout.js";

/** @typedef {import("./camera.js").Vector} Vector */
/** @typedef {import("./engine.js").FlatCamera} FlatCamera */

export class Chapter {
    /**
     * @param {any} info
     * @param {import("./camera.js").OrbitCamera} camera the page's
     * @param {import("./engine.js").Engine} engine makes the picture behind the drawing
     * @param {() => import("./engine.js").FrameRequest} request what the page asks for
     * @param {() => void} changed
     */
    constructor(info, camera, engine, request, changed) {
        this.camera = camera;
        /** Lengths and counts of the viewplane, while the chapter is open. @type {Record<string, number> | null} */
        this.plane = null;
        /** The pixel that is followed, what it shows, and its colour. @type {{pixel: [number, number], probed: any, color: number[]} | null} */
        this.followed = null;
        this.fields = new ChapterFields(() => {
            this.#read();
            changed();
        });
        this.drawing = new ChapterDrawing(camera, info.bounds, engine, request, () => this.#drawn());
        const panel = element("chapter");
        panel.addEventListener("toggle", () => {
            if (panel.open) this.#begin();
            else this.plane = null;
            changed();
            // It may have opened below what is seen.
            if (panel.open) panel.scrollIntoView({ block: "start" });
        });
        element("chapter-start").addEventListener("change", () => {
            camera.rayStart = element("chapter-start").value;
            changed();
        });
    }

    get isOpen() {
        return element("chapter").open && this.plane !== null;
    }

    /** The viewplane stands at a third of the way to what is looked at, and rays start there. */
    #begin() {
        const { camera } = this;
        const [M, N] = [12, 16];
        const z_p = Number((0.35 * camera.distance).toPrecision(3));
        const high = camera.projection === "perspective" ? (camera.height * z_p) / camera.focal : camera.height;
        const h = Number(high.toPrecision(3));
        camera.rayStart = "viewplane";
        this.#set({ z_p, h, w: Number(((h * N) / M).toPrecision(3)), M, N });
        this.#write();
        this.drawing.frame();
    }

    /** Takes a viewplane, and gives it to the camera. @param {Record<string, number>} plane */
    #set(plane) {
        this.plane = plane;
        const { camera } = this;
        [camera.focal, camera.height] = [plane.z_p, plane.h];
        camera.given = { ...camera.given, rows: plane.M, columns: plane.N, width: plane.w, height: plane.h };
    }

    /** Takes the viewplane of another camera. @param {FlatCamera} given */
    take(given) {
        const isSmall = ChapterFields.isSmall(given.rows, given.columns);
        const [M, N] = isSmall ? [given.rows, given.columns] : [this.plane?.M ?? 12, this.plane?.N ?? 16];
        this.#set({ z_p: given.focal_length, w: given.width, h: given.height, M, N });
    }

    /** Numbers of the camera, which the mouse may have moved. */
    #write() {
        const { camera } = this;
        if (this.plane && camera.height !== this.plane.h) {
            // It came nearer with parallel rays, or changes from those.
            const w = (this.plane.w * camera.height) / this.plane.h;
            this.#set({ ...this.plane, z_p: camera.focal, w, h: camera.height });
        }
        const lengths = Object.entries(this.plane ?? {}).map(([name, number]) => [name, [number]]);
        this.fields.write({ x_c: camera.position, u_c: camera.aim, v_up: camera.up, ...Object.fromEntries(lengths) });
        element("chapter-size").textContent = `${this.plane?.M} × ${this.plane?.N}`;
        element("chapter-start").value = camera.rayStart;
    }

    /** Takes what was typed, where it makes sense. */
    #read() {
        const read = this.fields.read();
        if (!read) return;
        const { x_c, u_c, v_up, ...lengths } = read;
        const { camera } = this;
        [camera.position, camera.aim, camera.up] = /** @type {Vector[]} */ ([x_c, u_c, v_up]);
        this.#set(Object.fromEntries(Object.entries(lengths).map(([name, [number]]) => [name, number])));
    }

    /** The camera by the chapter's numbers. @returns {FlatCamera} */
    flat() {
        const { M, N } = /** @type {Record<string, number>} */ (this.plane);
        return this.camera.flat(M, N);
    }

    /** The viewplane's frame: its middle, and its axes. */
    #frame() {
        const [right, up] = this.camera.axes();
        const z_p = this.plane?.z_p ?? 1;
        return { middle: add(this.camera.position, times(z_p, unit(this.camera.aim))), right, up };
    }

    /** What there is to draw. @returns {import("./chapter-drawing.js").Drawn | null} */
    #drawn() {
        if (!this.isOpen || !this.plane) return null;
        const { w, h, M, N } = this.plane;
        const { middle, right, up } = this.#frame();
        const onPlane = (/** @type {number} */ x, /** @type {number} */ y) => add(middle, add(times(x * w, right), times(y * h, up)));
        const isParallel = this.camera.projection === "orthographic";
        return { eye: this.camera.position, middle, onPlane, M, N, isParallel, followed: this.followed };
    }

    /** The camera has moved, or the numbers are others. */
    moved() {
        if (!this.isOpen) return;
        this.#write();
        this.followed = null;
        this.#explain();
        this.drawing.renew();
    }

    /** @param {[number, number]} pixel row and column @param {any} probed @param {number[]} color */
    follow(pixel, probed, color) {
        this.followed = { pixel, probed, color };
        this.#explain();
        this.drawing.draw();
    }

    /** Frames the pixel that is followed, in the page's own picture. @param {CanvasRenderingContext2D} on @param {number} rows of the canvas @param {number} columns */
    frameFollowed(on, rows, columns) {
        if (!this.followed || !this.plane) return;
        const { followed: { pixel: [row, column] }, plane: { M, N } } = this;
        on.beginPath();
        on.rect((column * columns) / N, (row * rows) / M, columns / N, rows / M);
        strokeOutlined(on, MARK, 2);
    }

    /** Says everything that the chapter says of a ray, with the numbers of the pixel that is followed. */
    #explain() {
        if (!this.plane) return;
        const { w, h, M, N } = this.plane;
        const { middle, right, up } = this.#frame();
        const { pixel, probed, color } = this.followed ?? {};
        const [row, column] = pixel ?? [NaN, NaN];
        const [i, j] = [M - 1 - row, column];
        const [x, y] = [-w / 2 + (w / N) * (j + 0.5), -h / 2 + (h / M) * (i + 0.5)];
        const { ray, hit } = probed ?? {};
        const isParallel = this.camera.projection === "orthographic";
        // Parallel rays from the eye start in its plane.
        const start = this.camera.rayStart !== "eye" ? "p" : isParallel ? "p - z_p u_c" : "x_c";
        const name = (/** @type {string} */ text) => () => formula(text.replaceAll("-", "−"));
        const of = (/** @type {string} */ text, /** @type {number[]} */ numbers) => ({ name: name(text), numbers });
        const words = (/** @type {string} */ text, /** @type {string} */ said) => ({ name: name(text), text: pixel ? said : "–" });
        const shown = color?.slice(0, 3).join(", ") ?? "–";
        readOut(element("chapter-words"), [
            of("c_0 = x_c + z_p u_c", middle),
            of("u_x = u_c × v_up / |u_c × v_up|", right),
            of("u_z = -u_c,  u_y = u_z × u_x", up),
            words("pixel (row, column)", `(${row}, ${column})`),
            words("i = M - 1 - row,  j = column", `(${i}, ${j})`),
            of("p_x = -w/2 + (w/N)(j + ½)", [x]),
            of("p_y = -h/2 + (h/M)(i + ½)", [y]),
            of("p = c_0 + p_x u_x + p_y u_y", add(middle, add(times(x, right), times(y, up)))),
            of(isParallel ? "u_r = u_c" : "u_r = (p - x_c) / |p - x_c|", ray?.direction ?? unknown(3)),
            ...(start === "p" ? [] : [of(`start = ${start}`, ray?.origin ?? unknown(3))]),
            of(`t, o = shoot(${start}, u_r)`, [hit ? hit.t : pixel ? Infinity : NaN]),
            words("o", hit ? named(hit) : "no object"),
            of(`x = ${start} + t u_r`, hit?.position ?? unknown(3)),
            { ...words(`shade(t, ${start}, u_r, o), of 255`, shown), swatch: color && `rgb(${shown})` },
            of("normal at x", hit?.normal ?? unknown(3)),
            of("its cosine to the ray", [hit ? -dot(hit.normal, ray.direction) : NaN]),
        ]);
    }
}

// @ts-check
// The chapter's drawing: the camera, its viewplane and one ray, as a second camera sees them from aside.

import { add, OrbitCamera, times, unit } from "./camera.js";
import { element } from "./dom.js";
import { arrow } from "./keys.js";
import { label, MARK, strokeOutlined } from "./label.js";

/** @typedef {import("./camera.js").Vector} Vector */
/** @typedef {import("./engine.js").FlatCamera} FlatCamera */
/** What there is to draw. @typedef {{eye: Vector, middle: Vector, onPlane: (x: number, y: number) => Vector, M: number, N: number, isParallel: boolean, followed: {pixel: [number, number], probed: any, color: number[]} | null}} Drawn */

/** The most lines that are drawn of the viewplane's pixels, along an edge. */
const MOST_LINES = 48;
const PLANE = "#4fb3ff";
const AXIS = "#9be28f";
/** The corners of the viewplane, by shares of its width and height from the middle. @type {[number, number][]} */
const CORNERS = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];

export class ChapterDrawing {
    /** The second camera; it begins when the chapter is opened. @type {OrbitCamera | null} */
    #second = null;
    /** @type {ImageBitmap | null} */
    #behind = null;
    #isAsking = false;
    #isStale = false;

    /**
     * @param {OrbitCamera} camera the page's
     * @param {[Vector, Vector] | null} bounds the scene's
     * @param {import("./engine.js").Engine} engine makes the picture behind the drawing
     * @param {() => import("./engine.js").FrameRequest} request what the page asks for
     * @param {() => Drawn | null} drawn what there is to draw
     */
    constructor(camera, bounds, engine, request, drawn) {
        this.camera = camera;
        this.bounds = bounds ?? [[-1, -1, -1], [1, 1, 1]];
        this.engine = engine;
        this.request = request;
        this.drawn = drawn;
        this.canvas = element("chapter-scene");
        this.#handle();
    }

    /** Brings everything into the drawing. */
    frame() {
        const drawn = this.drawn();
        if (!drawn) return;
        const box = [0, 1, 2, 3, 4, 5, 6, 7].map((k) => [this.bounds[k & 1][0], this.bounds[(k >> 1) & 1][1], this.bounds[k >> 2][2]]);
        const places = [...CORNERS.map(([x, y]) => drawn.onPlane(x, y)), drawn.eye, ...box];
        const bounds = /** @type {[Vector, Vector]} */ ([Math.min, Math.max].map((most) => [0, 1, 2].map((axis) => most(...places.map((place) => place[axis])))));
        const { camera } = this;
        const aside = unit(add(times(-0.9, camera.axes()[0]), add(times(0.55, unit(camera.aim)), times(-0.45, camera.sceneUp))));
        const given = /** @type {FlatCamera} */ ({ ...camera.flat(3, 4), position: [0, 0, 0], aim: aside, up: camera.sceneUp, projection: "perspective", ray_start: "eye", focal_length: 1, width: (0.7 * 4) / 3, height: 0.7 });
        this.#second = new OrbitCamera(given, camera.sceneUp, bounds);
        this.#second.frame(4 / 3);
    }

    /** The scene is seen otherwise. */
    renew() {
        this.#isStale = true;
        this.draw();
    }

    draw() {
        const drawn = this.drawn();
        const second = this.#second;
        if (!second || !drawn) return;
        const scale = devicePixelRatio;
        const [rows, columns] = [this.canvas.clientHeight, this.canvas.clientWidth];
        [this.canvas.height, this.canvas.width] = [rows, columns].map((edge) => Math.max(1, Math.round(scale * edge)));
        const on = this.canvas.getContext("2d");
        on.scale(scale, scale);
        if (this.#behind) on.drawImage(this.#behind, 0, 0, columns, rows);
        const { eye, middle, onPlane, M, N, isParallel } = drawn;
        const placeOf = (/** @type {Vector} */ point) => second.pixelOf(point, rows, columns);
        const path = (/** @type {Vector[]} */ points) => {
            on.beginPath();
            const places = points.map(placeOf);
            places.forEach((place, k) => {
                if (place && places[k - 1]) on.lineTo(...place);
                else if (place) on.moveTo(...place);
            });
        };
        const thin = (/** @type {Vector[]} */ points, /** @type {string} */ color) => {
            path(points);
            [on.strokeStyle, on.lineWidth] = [color, 1];
            on.stroke();
        };
        for (let k = 1; k < N && N <= MOST_LINES; k++) thin([onPlane(k / N - 0.5, -0.5), onPlane(k / N - 0.5, 0.5)], "#7fb2dd88");
        for (let k = 1; k < M && M <= MOST_LINES; k++) thin([onPlane(-0.5, k / M - 0.5), onPlane(0.5, k / M - 0.5)], "#7fb2dd88");
        const corners = CORNERS.map(([x, y]) => onPlane(x, y));
        if (!isParallel) for (const corner of corners) thin([eye, corner], "#4fb3ffaa");
        path([...corners, corners[0], corners[1]]);
        strokeOutlined(on, PLANE, 2);
        path([eye, middle]);
        strokeOutlined(on, AXIS, 1.5);
        this.#drawFollowed(on, drawn, path, placeOf);
        for (const [text, point] of /** @type {[string, Vector][]} */ ([["x_c", eye], ["c_0", middle]])) {
            const place = placeOf(point);
            if (!place) continue;
            on.fillStyle = "#fff";
            on.beginPath();
            on.arc(...place, 3, 0, 2 * Math.PI);
            on.fill();
            label(on, text, place);
        }
        if (this.#isStale) this.#ask();
    }

    /** The pixel and its ray. @param {any} on @param {Drawn} drawn @param {(points: Vector[]) => void} path @param {(point: Vector) => [number, number] | null} placeOf */
    #drawFollowed(on, { followed, onPlane, M, N }, path, placeOf) {
        if (!followed) return;
        const { pixel: [row, column], probed: { ray, hit }, color } = followed;
        const [x, y] = [column / N - 0.5, 0.5 - (row + 1) / M];
        const square = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0], [1, 0]].map(([dx, dy]) => onPlane(x + dx / N, y + dy / M));
        path(square);
        on.fillStyle = `rgb(${color.slice(0, 3).join(" ")})`;
        on.fill();
        strokeOutlined(on, MARK, 2);
        const far = hit ? hit.position : add(ray.origin, times(3 * this.camera.size(), ray.direction));
        path([ray.origin, far]);
        strokeOutlined(on, MARK, 2);
        const end = hit && placeOf(far);
        if (!end) return;
        on.fillStyle = MARK;
        on.beginPath();
        on.arc(...end, 4, 0, 2 * Math.PI);
        on.fill();
        label(on, `t = ${Number(hit.t.toPrecision(5))}`, [end[0], end[1] + 10]);
    }

    /** A picture of the scene for the second camera; one at a time. */
    async #ask() {
        if (this.#isAsking || !this.#second) return;
        this.#isAsking = true;
        this.#isStale = false;
        try {
            const camera = this.#second.flat(this.canvas.height, this.canvas.width);
            const request = { ...this.request(), camera, channel: "color", samples: 1, is_lit: false, edges: 0 };
            request.part = { ...request.part, cut: null };
            const { image } = await this.engine.frame(request, new AbortController().signal);
            this.#behind?.close();
            this.#behind = image ?? null;
        } catch {
            // The drawing does without; the page's own picture says what is wrong.
        } finally {
            this.#isAsking = false;
        }
        this.draw();
    }

    #handle() {
        const { canvas } = this;
        const turn = (/** @type {number} */ x, /** @type {number} */ y) => {
            this.#second?.orbit(x, y);
            this.renew();
        };
        canvas.addEventListener("pointerdown", (/** @type {PointerEvent} */ event) => canvas.setPointerCapture(event.pointerId));
        canvas.addEventListener("pointermove", (/** @type {PointerEvent} */ event) => {
            if ((event.buttons & 1) !== 0) turn(event.movementX / 150, event.movementY / 150);
        });
        canvas.addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => {
            const way = arrow(event.key);
            if (!way) return;
            event.preventDefault();
            event.stopPropagation();
            turn(-0.1 * way[0], -0.1 * way[1]);
        });
        canvas.addEventListener(
            "wheel",
            (/** @type {WheelEvent} */ event) => {
                event.preventDefault();
                this.#second?.zoom(Math.exp(0.0015 * event.deltaY), 0, 0);
                this.renew();
            },
            { passive: false },
        );
    }
}
